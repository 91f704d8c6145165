// mortise operations list|show|watch|cancel: long work, whoever started it.
#include <google/protobuf/util/time_util.h>
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "cli/client/command_flags.h"
#include "cli/client/filter_options.h"
#include "cli/client/long_work.h"
#include "cli/client/session.h"
#include "cli/commands/commands.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/operations.grpc.pb.h"

namespace mortise::cli {
namespace {

struct ListOptions {
  std::vector<std::string> states;
  bool active = false;  // those that are pending or running
  std::string service;
  std::string kind;
  std::string subject;
  FilterOptions filter;
  int limit = 50;
};

// "simulator/0198c1" to "operations/simulator/0198c1".
std::string FullName(const std::string& name) {
  return absl::StartsWith(name, "operations/") ? name : absl::StrCat("operations/", name);
}

std::string StateText(const v1::Operation& operation) {
  if (operation.state() == v1::Operation::RUNNING && operation.cancel_requested()) {
    return "cancelling";
  }
  return absl::AsciiStrToLower(v1::Operation::State_Name(operation.state()));
}

// "DiscoverFront" of "mortise.v1.ParetoService/DiscoverFront"; the kind where that is not known.
std::string MethodText(const v1::Operation& operation) {
  const std::size_t slash = operation.method().find('/');
  return slash == std::string::npos ? operation.kind() : operation.method().substr(slash + 1);
}

std::string ProgressText(const v1::Progress& progress) {
  if (progress.total() == 0) return progress.message();
  return absl::StrCat(progress.done(), "/", progress.total(), "  ", progress.message());
}

std::string Shortened(const std::string& text) {
  constexpr std::size_t kLongest = 48;
  if (text.size() <= kLongest) return text;
  std::size_t end = kLongest;
  while (end > 0 && (text[end] & 0xC0) == 0x80) --end;  // not within a character
  return absl::StrCat(text.substr(0, end), "…");
}

std::string Age(const google::protobuf::Timestamp& since) {
  const absl::Time begin =
      absl::FromUnixMicros(google::protobuf::util::TimeUtil::TimestampToMicroseconds(since));
  const double seconds = std::max(0.0, absl::ToDoubleSeconds(absl::Now() - begin));
  if (seconds < 120) return absl::StrFormat("%.0f s", seconds);
  if (seconds < 7200) return absl::StrFormat("%.0f min", seconds / 60);
  if (seconds < 172800) return absl::StrFormat("%.0f h", seconds / 3600);
  return absl::StrFormat("%.0f d", seconds / 86400);
}

absl::StatusOr<v1::ListOperationsRequest> RequestOf(const ListOptions& options) {
  v1::ListOperationsRequest request;
  for (const std::string& state : options.states) {
    v1::Operation::State value = v1::Operation::STATE_UNSPECIFIED;
    v1::Operation::State_Parse(absl::AsciiStrToUpper(state), &value);
    request.add_states(value);
  }
  if (options.active) {
    request.add_states(v1::Operation::PENDING);
    request.add_states(v1::Operation::RUNNING);
  }
  request.set_service(options.service);
  request.set_kind(options.kind);
  request.set_subject(options.subject);
  request.set_omit_results(true);
  MORTISE_ASSIGN_OR_RETURN(*request.mutable_filter(), ParseFilter(options.filter));
  return request;
}

absl::Status List(const ListOptions& options, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(v1::ListOperationsRequest request, RequestOf(options));
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::OperationService::NewStub(client->channel());
  nlohmann::ordered_json document = nlohmann::ordered_json::array();
  std::vector<std::vector<std::string>> rows;
  do {
    request.set_page_size(std::min(1000, options.limit - static_cast<int>(rows.size())));
    v1::ListOperationsResponse page;
    MORTISE_RETURN_IF_ERROR(client->Call([&](grpc::ClientContext& context) {
      return rpc::FromGrpc(stub->ListOperations(&context, request, &page));
    }));
    for (const v1::Operation& operation : page.operations()) {
      rows.push_back({operation.name(), StateText(operation), MethodText(operation),
                      operation.subject(), Shortened(ProgressText(operation.progress())),
                      Age(operation.create_time())});
      if (!output.text()) document.push_back(ToJson(operation));
    }
    request.set_page_token(page.next_page_token());
  } while (!request.page_token().empty() && static_cast<int>(rows.size()) < options.limit);
  output.Table({"operation", "state", "method", "subject", "progress", "age"}, rows);
  if (!request.page_token().empty()) {
    output.Line(absl::StrCat("there are more than ", options.limit, "; see them with --limit"));
  }
  output.Document(document);
  return absl::OkStatus();
}

void Print(const v1::Operation& operation, Output& output) {
  output.Line(absl::StrCat(operation.name(), ": ", StateText(operation)));
  const auto line = [&](const char* what, const std::string& text) {
    if (!text.empty()) output.Line(absl::StrFormat("  %-9s %s", what, text));
  };
  line("method", operation.method().empty() ? operation.kind() : operation.method());
  line("subject", operation.subject());
  line("creator", operation.creator());
  line("begun", absl::StrCat(Age(operation.create_time()), " ago"));
  line("changed", absl::StrCat(Age(operation.update_time()), " ago"));
  line("progress", ProgressText(operation.progress()));
  line("made", MadeBy(operation));
  if (operation.has_error()) line("error", operation.error().message());
  output.DocumentOf(operation);
}

absl::Status Show(const std::string& name, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  MORTISE_ASSIGN_OR_RETURN(const v1::Operation operation, GetOperation(*client, FullName(name)));
  Print(operation, output);
  return absl::OkStatus();
}

absl::Status Watch(const std::string& name, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  MORTISE_ASSIGN_OR_RETURN(const v1::Operation operation, GetOperation(*client, FullName(name)));
  MORTISE_ASSIGN_OR_RETURN(const v1::Operation done,
                           Follow(*client, {.when_left = WhenLeft::kGoesOn}, operation, output));
  Print(done, output);
  return absl::OkStatus();
}

struct CancelledOperation {
  v1::Operation operation;
  absl::Status unseen;  // why it is not known how it ended; OK if that is known or not wanted
};

// Asks one to stop, and waits until it has unless that is not wanted.
absl::StatusOr<CancelledOperation> CancelOne(const std::string& name, bool wait,
                                             const GatewayClient& client, Output& output) {
  const auto stub = v1::OperationService::NewStub(client.channel());
  v1::CancelOperationRequest request;
  request.set_request_id(NewIdentifier());
  request.set_name(name);
  v1::Operation operation;
  MORTISE_RETURN_IF_ERROR(client.Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc(stub->CancelOperation(&context, request, &operation));
  }));
  if (!wait || HasEnded(operation)) return CancelledOperation{std::move(operation), {}};
  auto ended = client.Follow(name, [&output](const v1::Operation& now) {
    output.Progress(now.progress().done(), now.progress().total(), now.progress().message());
  });
  output.EndProgress();
  if (ended.ok()) return CancelledOperation{*std::move(ended), {}};
  const absl::StatusOr<v1::Operation> now = GetOperation(client, name);
  if (now.ok()) operation = *now;
  return CancelledOperation{operation, HasEnded(operation) ? absl::OkStatus() : ended.status()};
}

std::string CancelledText(const CancelledOperation& cancelled) {
  const std::string& name = cancelled.operation.name();
  if (!cancelled.unseen.ok()) {
    return absl::StrCat(name, ": cancelling, not seen to its end: ", cancelled.unseen.message());
  }
  const std::string made = MadeBy(cancelled.operation);
  return absl::StrCat(name, ": ", StateText(cancelled.operation),
                      made.empty() ? "" : absl::StrCat(", ", made, " is kept"));
}

absl::Status Cancel(const std::vector<std::string>& names, bool wait, Session& session,
                    Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  nlohmann::ordered_json document = nlohmann::ordered_json::array();
  absl::Status first;
  for (const std::string& name : names) {
    const auto cancelled = CancelOne(FullName(name), wait, *client, output);
    if (!cancelled.ok()) {
      // The others are asked to stop all the same.
      if (names.size() > 1) {
        output.Note(absl::StrCat(FullName(name), ": ", cancelled.status().message()));
      }
      first.Update(cancelled.status());
      continue;
    }
    output.Line(CancelledText(*cancelled));
    document.push_back(ToJson(cancelled->operation));
  }
  MORTISE_RETURN_IF_ERROR(first);
  output.Document(document);
  return absl::OkStatus();
}

void AddList(CLI::App& operations, Session& session) {
  auto options = std::make_shared<ListOptions>();
  CommandFlags flags(*operations.add_subcommand("list", "Those there are, newest first"));
  flags
      .Add("--state", options->states,
           "Only pending, running, succeeded, failed or cancelled ones; again for more")
      ->check(CLI::IsMember({"pending", "running", "succeeded", "failed", "cancelled"}));
  flags.AlsoGives("--state", "states");
  flags.command()
      .add_flag("--active", options->active, "Only those that are pending or running")
      ->excludes("--state");
  flags.Add("--service", options->service, "Only this service's, such as simulator", "service");
  flags.Add("--kind", options->kind, "Only of this kind, such as pareto.discovery", "kind");
  flags.Add("--subject", options->subject, "Only those that work on this, such as templates/table",
            "subject");
  AddFilterOptions(flags, options->filter);
  flags.Add("--limit", options->limit, "At most so many")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  flags.command().footer("Example: mortise operations list --active");
  flags.Run(session, [options](Session& s, Output& o) { return List(*options, s, o); });
}

}  // namespace

CLI::Option* AddDetach(CLI::App& command, bool& detach) {
  return command.add_flag("--detach", detach,
                          "Only start it, and print how to watch and cancel it");
}

void AddOperationCommands(CLI::App& app, Session& session) {
  CLI::App* operations = app.add_subcommand("operations", "Long work, whoever started it");
  operations->require_subcommand(1);
  AddList(*operations, session);

  auto name = std::make_shared<std::string>();
  CLI::App* show = operations->add_subcommand("show", "One of them as it is now");
  show->add_option("name", *name, "operations/…")->required();
  show->footer("Example: mortise operations show operations/pareto/0198c1 --json");
  show->callback([&session, name] {
    session.command = [name](Session& s, Output& o) { return Show(*name, s, o); };
  });

  CLI::App* watch = operations->add_subcommand("watch", "Follow one of them to its end");
  watch->add_option("name", *name, "operations/…")->required();
  watch->footer(
      "Example: mortise operations watch operations/pareto/0198c1\n"
      "Ctrl-C leaves it running");
  watch->callback([&session, name] {
    session.command = [name](Session& s, Output& o) { return Watch(*name, s, o); };
  });

  auto names = std::make_shared<std::vector<std::string>>();
  auto no_wait = std::make_shared<bool>(false);
  CLI::App* cancel =
      operations->add_subcommand("cancel", "Stop some of them; what is best so far is kept");
  cancel->add_option("names", *names, "operations/…")->required();
  cancel->add_flag("--no-wait", *no_wait, "Do not wait until they have stopped");
  cancel->footer(
      "Example: mortise operations cancel operations/pareto/0198c1\n"
      "That of a work order gives the order up; `mortise fab hold` only pauses it");
  cancel->callback([&session, names, no_wait] {
    session.command = [names, no_wait](Session& s, Output& o) {
      return Cancel(*names, !*no_wait, s, o);
    };
  });
  // Last: commands would inherit it.
  operations->footer("Example: mortise operations list --active");
}

}  // namespace mortise::cli
