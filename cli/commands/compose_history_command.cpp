// mortise compose history: what made each revision of a model, and what it changed.
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "cli/client/command_flags.h"
#include "cli/client/requests.h"
#include "cli/client/session.h"
#include "cli/commands/commands.h"
#include "common/base/errors.h"
#include "mortise/v1/composer.grpc.pb.h"

namespace mortise::cli {
namespace {

struct HistoryOptions {
  std::string model;
  std::int64_t after_revision = 0;
};

// "top added, frame changed".
std::string ComponentsText(const v1::ModelStep& step) {
  static const std::map<int, std::string> words = {{v1::ModelStep::ADDED, " added"},
                                                   {v1::ModelStep::CHANGED, " changed"},
                                                   {v1::ModelStep::REMOVED, " removed"}};
  std::vector<std::string> texts;
  for (const v1::ModelStep::Component& component : step.components()) {
    const auto word = words.find(component.change());
    texts.push_back(absl::StrCat(component.id(), word == words.end() ? "" : word->second));
  }
  return absl::StrJoin(texts, ", ");
}

absl::Status History(const HistoryOptions& options, Session& session, Output& output) {
  v1::ListModelStepsRequest request;
  request.set_name(ResourceName("models", options.model));
  request.set_after_revision(options.after_revision);
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::ComposerService::NewStub(client->channel());
  v1::ListModelStepsResponse all;
  std::vector<std::vector<std::string>> rows;
  const absl::Status listed = ListAll<v1::ListModelStepsRequest, v1::ListModelStepsResponse>(
      *client, [&](auto... a) { return stub->ListModelSteps(a...); },
      [&](const v1::ListModelStepsResponse& page) {
        for (const v1::ModelStep& step : page.steps()) {
          rows.push_back({absl::StrCat(step.revision()), step.text(), step.user(),
                          ComponentsText(step), absl::StrCat(step.parts_size(), " parts")});
          *all.add_steps() = step;
        }
      },
      request);
  MORTISE_RETURN_IF_ERROR(listed);
  output.Table({"revision", "what", "who", "components", "changed"}, rows);
  output.DocumentOf(all);
  return absl::OkStatus();
}

}  // namespace

void AddComposeHistoryCommand(CLI::App& compose, Session& session) {
  auto options = std::make_shared<HistoryOptions>();
  CommandFlags flags(*compose.add_subcommand("history", "List what made each revision of a model"));
  flags.Add("model", options->model, "Model, such as desk", "name")->required();
  flags.Add("--after-revision", options->after_revision,
            "Only what came after this revision; all if absent", "after_revision");
  flags.command().footer("Example: mortise compose history desk --after-revision 3");
  flags.Run(session, [options](Session& s, Output& o) { return History(*options, s, o); });
}

}  // namespace mortise::cli
