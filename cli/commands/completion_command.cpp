// mortise completion: a script that teaches a shell the commands and options of this program.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "cli/client/session.h"
#include "cli/commands/commands.h"
#include "common/base/errors.h"

namespace mortise::cli {
namespace {

// A word that can come next.
struct Word {
  std::string text;  // "list", "--kind"
  std::string description;
  bool is_option = false;
  bool takes_value = false;
};

// What can follow a command.
struct Place {
  std::string path;  // "catalog list"; empty at first
  std::vector<Word> words;
};

void AddOptions(const CLI::App& app, std::vector<Word>& words) {
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) {
      words.push_back({"--" + name, option->get_description(), true, option->get_type_size() > 0});
    }
  }
}

void Collect(const CLI::App& root, const CLI::App& app, const std::string& path,
             std::vector<Place>& places) {
  Place here{path, {}};
  for (const CLI::App* child : app.get_subcommands(nullptr)) {
    here.words.push_back({child->get_name(), child->get_description()});
    Collect(root, *child, path.empty() ? child->get_name() : path + " " + child->get_name(),
            places);
  }
  AddOptions(app, here.words);
  // Global options may stand behind a command; what each has of its own is there already.
  if (&app != &root) {
    std::vector<Word> global;
    AddOptions(root, global);
    for (Word& word : global) {
      const bool own = std::any_of(here.words.begin(), here.words.end(),
                                   [&](const Word& other) { return other.text == word.text; });
      if (!own) here.words.push_back(std::move(word));
    }
  }
  places.push_back(std::move(here));
}

// In single quotes, for bash and zsh.
std::string Quoted(const std::string& text) {
  return absl::StrCat("'", absl::StrReplaceAll(text, {{"'", R"('\'')"}}), "'");
}

std::string FishQuoted(const std::string& text) {
  return absl::StrCat("'", absl::StrReplaceAll(text, {{"\\", "\\\\"}, {"'", "\\'"}}), "'");
}

// The paths of all commands, each made by `quote`, with `separator` between.
std::string Paths(const std::vector<Place>& places, const char* separator,
                  std::string (*quote)(const std::string&)) {
  std::vector<std::string> paths;
  for (const Place& place : places) {
    if (!place.path.empty()) paths.push_back(quote(place.path));
  }
  return absl::StrJoin(paths, separator);
}

std::string BashScript(const std::vector<Place>& places) {
  std::string cases;
  for (const Place& place : places) {
    const std::string words = absl::StrJoin(
        place.words, " ", [](std::string* out, const Word& word) { out->append(word.text); });
    absl::StrAppend(&cases, "    ", Quoted(place.path), ") words=\"", words, "\" ;;\n");
  }
  return absl::StrCat(R"(# bash completion for mortise: source <(mortise completion bash)
_mortise() {
  local at="" next word words
  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    next="${at:+$at }$word"
    case "$next" in
      )",
                      Paths(places, "|", Quoted), R"() at="$next" ;;
    esac
  done
  case "$at" in
)",
                      cases, R"(  esac
  COMPREPLY=($(compgen -W "$words" -- "${COMP_WORDS[COMP_CWORD]}"))
  [ ${#COMPREPLY[@]} -gt 0 ] || COMPREPLY=($(compgen -f -- "${COMP_WORDS[COMP_CWORD]}"))
}
complete -F _mortise mortise)");
}

std::string ZshScript(const std::vector<Place>& places) {
  std::string cases;
  for (const Place& place : places) {
    absl::StrAppend(&cases, "    (", Quoted(place.path), ")\n      candidates=(\n");
    for (const Word& word : place.words) {
      const std::string entry = absl::StrCat(
          word.text, ":", absl::StrReplaceAll(word.description, {{"\\", "\\\\"}, {":", "\\:"}}));
      absl::StrAppend(&cases, "        ", Quoted(entry), "\n");
    }
    absl::StrAppend(&cases, "      ) ;;\n");
  }
  return absl::StrCat(R"(#compdef mortise
# zsh completion for mortise: source <(mortise completion zsh), after compinit
_mortise() {
  local at="" next word
  local -a candidates
  for word in "${(@)words[2,CURRENT-1]}"; do
    next="${at:+$at }$word"
    case "$next" in
      ()",
                      Paths(places, "|", Quoted), R"() at="$next" ;;
    esac
  done
  case "$at" in
)",
                      cases, R"(  esac
  _describe -o mortise candidates || _files
}
compdef _mortise mortise)");
}

std::string FishScript(const std::vector<Place>& places) {
  std::string script =
      absl::StrCat(R"(# fish completion for mortise: mortise completion fish | source
function __mortise_at
  set -l at ''
  for word in (commandline -opc)[2..-1]
    set -l next (string trim -- "$at $word")
    if contains -- $next )",
                   Paths(places, " ", FishQuoted), R"(
      set at $next
    end
  end
  test "$at" = "$argv[1]"
end
)");
  for (const Place& place : places) {
    const std::string begin =
        absl::StrCat("complete -c mortise -n ",
                     FishQuoted(absl::StrCat("__mortise_at ", FishQuoted(place.path))), " ");
    for (const Word& word : place.words) {
      absl::StrAppend(&script, begin, word.is_option ? "-l " : "-f -a ",
                      FishQuoted(word.is_option ? word.text.substr(2) : word.text),
                      word.takes_value ? " -r" : "", " -d ", FishQuoted(word.description), "\n");
    }
  }
  return script;
}

std::string Script(const std::string& shell, const CLI::App& app) {
  std::vector<Place> places;
  Collect(app, app, "", places);
  if (shell == "zsh") return ZshScript(places);
  return shell == "fish" ? FishScript(places) : BashScript(places);
}

}  // namespace

void AddCompletionCommand(CLI::App& app, Session& session) {
  auto shell = std::make_shared<std::string>("bash");
  CLI::App* completion = app.add_subcommand("completion", "Print a shell completion script");
  completion->add_option("shell", *shell, "bash, zsh or fish")
      ->check(CLI::IsMember({"bash", "zsh", "fish"}))
      ->capture_default_str();
  completion->footer(
      "Example: source <(mortise completion bash)\n"
      "With zsh: source <(mortise completion zsh); with fish: mortise completion fish | source");
  completion->callback([&app, &session, shell] {
    session.command = [&app, shell](Session&, Output& output) {
      const std::string script = Script(*shell, app);
      output.Line(script);
      output.Document(nlohmann::ordered_json{{"shell", *shell}, {"script", script}});
      return absl::OkStatus();
    };
  });
}

}  // namespace mortise::cli
