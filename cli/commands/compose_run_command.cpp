// mortise compose run SCRIPT: composes a model by a script, and saves it.
#include <google/protobuf/util/json_util.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/client/command_flags.h"
#include "cli/client/decimal_flags.h"
#include "cli/client/requests.h"
#include "cli/client/session.h"
#include "cli/commands/commands.h"
#include "cli/commands/compose_calls.h"
#include "cli/files/compose_script.h"
#include "cli/output/compose_output.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/base/files.h"
#include "common/base/identifiers.h"
#include "common/base/violation_lists.h"

namespace mortise::cli {
namespace {

using Json = nlohmann::ordered_json;
using Words = std::vector<std::string>;

struct RunOptions {
  std::filesystem::path script;
  std::string model, template_id;
  std::filesystem::path pictures;
  int from_line = 0;  // 0: all of it
  bool anew = false;
  bool unsaved = false;
};

// Commands that are about several models, or change none.
constexpr std::array kNoSteps = {"list", "show", "fork", "delete", "run"};

// ---- One command --------------------------------------------------------------------------------

// Gives an option another value than the words said.
void Replace(CLI::App& command, const std::string& option, const std::string& value) {
  CLI::Option* const replaced = command.get_option(option);
  replaced->clear();
  replaced->add_result(value);
  replaced->run_callback();
}

// Reads a command by the declarations of `mortise compose` itself, and gives what runs it to
// `session`, as long as `app` lives. INVALID_ARGUMENT for a wrong one.
absl::Status ReadCommand(const Words& words, CLI::App& app, Session& session) {
  AddComposeCommands(app, session);
  RequireDecimalNumbers(app);
  Words reversed(words.rbegin(), words.rend());
  reversed.emplace_back("compose");
  try {
    app.parse(std::move(reversed));
  } catch (const CLI::ParseError& error) {
    return absl::InvalidArgumentError(error.get_exit_code() == 0 ? "asks for help" : error.what());
  }
  return absl::OkStatus();
}

// Runs it without a word, and gives the document that it makes.
absl::StatusOr<std::string> RunCommand(const Words& words, const std::string& template_id,
                                       const Session& session) {
  CLI::App app;
  Session own = session;
  MORTISE_RETURN_IF_ERROR(ReadCommand(words, app, own));
  if (words[0] == "save" && !template_id.empty()) {
    Replace(*app.get_subcommand("compose")->get_subcommand("save"), "--template", template_id);
  }
  Output silent(Output::Form::kSilent);
  MORTISE_RETURN_IF_ERROR(own.command(own, silent));
  return silent.last_document();
}

template <typename Message>
absl::StatusOr<Message> FromDocument(const std::string& document) {
  Message message;
  const auto status = google::protobuf::util::JsonStringToMessage(document, &message);
  if (status.ok()) return message;
  return absl::InternalError(absl::StrCat("cannot read what came of a step: ", status.ToString()));
}

// The words of a line with the model, which comes first of all arguments.
Words WordsFor(const ScriptLine& line, const std::string& model) {
  Words words = line.words;
  if (words[0] == "new") {
    words[1] = model;
  } else {
    words.insert(words.begin() + 1, model);
  }
  return words;
}

// ---- Failures -----------------------------------------------------------------------------------

std::string PlaceOf(const ScriptLine& line) { return absl::StrCat("line ", line.number); }

// The failure of a line, which it names.
absl::Status At(const ScriptLine& line, const absl::Status& status) {
  std::vector<FieldViolation> violations = ViolationsOf(status);
  if (!violations.empty()) {
    for (FieldViolation& each : violations) {
      each.field = absl::StrCat(PlaceOf(line), each.field.empty() ? "" : ", ", each.field);
    }
    return InvalidFields(violations);
  }
  const std::string text = absl::StrCat(PlaceOf(line), ", ", line.text, ": ", status.message());
  return WithDetail(absl::Status(status.code(), text), DetailOf(status));
}

// Everything that is wrong with the words of the script, before any of it is run.
absl::Status CheckLines(const ComposeScript& script, const std::string& model) {
  std::vector<FieldViolation> findings;
  for (const ScriptLine& line : script.lines) {
    if (std::find(kNoSteps.begin(), kNoSteps.end(), line.words[0]) != kNoSteps.end()) {
      findings.push_back(
          {PlaceOf(line), absl::StrCat("`", line.words[0], "` is no step of a script")});
      continue;
    }
    CLI::App app;
    Session session;
    const absl::Status read = ReadCommand(WordsFor(line, model), app, session);
    if (!read.ok()) findings.push_back({PlaceOf(line), std::string(read.message())});
  }
  return findings.empty() ? absl::OkStatus() : InvalidFields(findings);
}

// ---- The whole ----------------------------------------------------------------------------------

class ScriptRun {
 public:
  ScriptRun(const RunOptions& options, ComposeScript script, Session& session, Output& output)
      : options_(options), script_(std::move(script)), session_(session), output_(output) {
    if (!options.model.empty()) script_.model = options.model;
  }

  absl::Status Run() {
    MORTISE_RETURN_IF_ERROR(CheckLines(script_, script_.model));
    MORTISE_RETURN_IF_ERROR(CheckFirstLine());
    MORTISE_RETURN_IF_ERROR(session_.Client().status());
    const ScriptLine* last = nullptr;
    for (std::size_t i = 0; i < script_.lines.size(); ++i) {
      const ScriptLine& line = script_.lines[i];
      if (line.number < options_.from_line) continue;
      if (options_.unsaved && line.words[0] == "save") continue;
      output_.Progress(static_cast<long>(i + 1), static_cast<long>(script_.lines.size()),
                       line.text);
      if (const absl::Status status = Step(line); !status.ok()) return Failed(line, last, status);
      last = &line;
    }
    if (const absl::Status status = SaveAtEnd(); !status.ok()) {
      output_.EndProgress();
      return status;
    }
    output_.EndProgress();
    return Report();
  }

 private:
  absl::Status CheckFirstLine() const {
    if (options_.from_line <= script_.lines.back().number) return absl::OkStatus();
    return InvalidField("--from-line",
                        absl::StrCat("the last command is in ", PlaceOf(script_.lines.back())));
  }

  absl::StatusOr<std::string> RunWords(const Words& words) const {
    return RunCommand(words, options_.template_id, session_);
  }

  absl::StatusOr<v1::Model> Present() const {
    MORTISE_ASSIGN_OR_RETURN(const std::string shown, RunWords({"show", script_.model}));
    return FromDocument<v1::Model>(shown);
  }

  absl::Status Step(const ScriptLine& line) {
    if (line.words[0] == "new" && options_.anew) {
      MORTISE_ASSIGN_OR_RETURN(const bool emptied, Empty(line));
      if (emptied) return absl::OkStatus();
    }
    MORTISE_ASSIGN_OR_RETURN(const std::string document, RunWords(WordsFor(line, script_.model)));
    if (line.words[0] == "save") return TakeSaved(document);
    saved_.Clear();
    return Draw(line);
  }

  absl::Status TakeSaved(const std::string& document) {
    MORTISE_ASSIGN_OR_RETURN(saved_, FromDocument<v1::SavedModel>(document));
    return absl::OkStatus();
  }

  // Takes back all that was done to a model that is there already: so what it was saved as gets a
  // new revision, where another model must not. False where there is none.
  absl::StatusOr<bool> Empty(const ScriptLine& line) const {
    absl::StatusOr<v1::Model> model = Present();
    if (absl::IsNotFound(model.status())) return false;
    MORTISE_RETURN_IF_ERROR(model.status());
    while (model->undo_steps() > 0) {
      MORTISE_ASSIGN_OR_RETURN(const std::string undone, RunWords({"undo", script_.model}));
      MORTISE_ASSIGN_OR_RETURN(*model, FromDocument<v1::Model>(undone));
    }
    if (model->components_size() > 0) {
      return PreconditionFailed(
          "MODEL_NOT_EMPTY", absl::StrCat(model->name(),
                                          " did not begin empty, it is a fork: delete it, or name "
                                          "another model by --model"));
    }
    MORTISE_RETURN_IF_ERROR(TakeTags(line));
    return true;
  }

  // Gives the model the title of the script's first line.
  absl::Status TakeTags(const ScriptLine& line) const {
    CLI::App app;
    Session session;
    MORTISE_RETURN_IF_ERROR(ReadCommand(WordsFor(line, script_.model), app, session));
    v1::UpdateModelRequest request;
    request.set_request_id(NewIdentifier());
    request.mutable_model()->set_name(ResourceName("models", script_.model));
    request.mutable_model()->set_title(app.get_subcommand("compose")
                                           ->get_subcommand("new")
                                           ->get_option("--title")
                                           ->as<std::string>());
    request.mutable_update_mask()->add_paths("title");
    MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session_.Client());
    return AskComposer(*client, &v1::ComposerService::Stub::UpdateModel, request).status();
  }

  absl::Status Draw(const ScriptLine& line) const {
    if (options_.pictures.empty()) return absl::OkStatus();
    const auto path =
        options_.pictures / absl::StrFormat("%03d-%s.png", line.number, line.words[0]);
    const absl::Status drawn =
        RunWords({"show", script_.model, "--picture", path.string()}).status();
    return DetailOf(drawn).reason == "MODEL_EMPTY" ? absl::OkStatus() : drawn;
  }

  absl::Status SaveAtEnd() {
    if (options_.unsaved || !saved_.template_().empty()) return absl::OkStatus();
    MORTISE_ASSIGN_OR_RETURN(const std::string document, RunWords({"save", script_.model}));
    return TakeSaved(document);
  }

  // Tells what a failure leaves, and how to go on.
  absl::Status Failed(const ScriptLine& line, const ScriptLine* last, const absl::Status& status) {
    output_.EndProgress();
    if (line.words[0] == "new") {
      if (absl::IsAlreadyExists(status)) {
        output_.Note("Compose it --anew, or another by --model NAME.");
      }
      return At(line, status);
    }
    output_.Note(absl::StrFormat(
        "models/%s is as %s left it. Mend the script, and go on with: mortise compose run %s%s "
        "--from-line %d",
        script_.model, last == nullptr ? "it was" : PlaceOf(*last), options_.script.string(),
        options_.model.empty() ? "" : " --model " + options_.model, line.number));
    return At(line, status);
  }

  absl::Status Report() {
    MORTISE_ASSIGN_OR_RETURN(const v1::Model model, Present());
    if (output_.text()) {
      PrintModel(model, output_);
      if (!saved_.template_().empty()) {
        output_.Line(absl::StrFormat("%s, revision %d, of %s", saved_.template_(),
                                     saved_.template_revision(), saved_.assembly()));
      }
    }
    Json warnings = Json::array();
    for (const v1::ModelWarning& warning : model.warnings()) warnings.push_back(ToJson(warning));
    output_.Document({{"template", saved_.template_()},
                      {"template_revision", saved_.template_revision()},
                      {"model", model.name()},
                      {"revision", model.revision()},
                      {"digest", model.digest()},
                      {"components", model.components_size()},
                      {"parts", model.parts_size()},
                      {"warnings", warnings}});
    return absl::OkStatus();
  }

  const RunOptions& options_;
  ComposeScript script_;
  Session& session_;
  Output& output_;
  v1::SavedModel saved_;  // what the model was saved as since it changed last
};

absl::Status RunScript(const RunOptions& options, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(const std::string text, ReadFile(options.script, kMaxScriptBytes));
  MORTISE_ASSIGN_OR_RETURN(ComposeScript script, ParseComposeScript(text));
  return ScriptRun(options, std::move(script), session, output).Run();
}

}  // namespace

void AddComposeRunCommand(CLI::App& compose, Session& session) {
  auto options = std::make_shared<RunOptions>();
  CommandFlags run(*compose.add_subcommand("run", "Compose by a script, and save"));
  run.Add("script", options->script, "File with a command in each line")->required();
  run.Add("--model", options->model, "Id of the model, instead of that in the script", "model_id");
  run.Add("--template", options->template_id,
          "Id of the template that is saved, instead of that in the script", "template_id");
  run.Add("--from-line", options->from_line, "Go on with this line, where the model is already")
      ->check(CLI::PositiveNumber);
  run.Add("--pictures", options->pictures, "Folder for a picture of every step");
  run.command().add_flag("--anew", options->anew,
                         "Take back all steps of the model, if there is one, before");
  run.command().add_flag("--unsaved", options->unsaved, "Do not save, whatever the script says");
  run.command().footer("Example: mortise compose run collection/compositions/stepped_bookcase.txt");
  run.Run(session, [options](Session& s, Output& o) { return RunScript(*options, s, o); });
}

}  // namespace mortise::cli
