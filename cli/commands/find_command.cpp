// mortise find TEXT: whatever another system knows by a number of its own.
#include <CLI/CLI.hpp>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "cli/client/command_flags.h"
#include "cli/client/resource_access.h"
#include "cli/client/resource_table.h"
#include "cli/commands/commands.h"
#include "common/base/errors.h"

namespace mortise::cli {
namespace {

// A caller may not see every kind (webhooks are an admin's), and a house need not have each
// service.
bool IsNotForCaller(const absl::Status& status) {
  return absl::IsPermissionDenied(status) || absl::IsUnimplemented(status);
}

absl::Status Find(const std::string& external_id, Session& session, Output& output) {
  if (external_id.empty()) return InvalidField("external id", "must not be empty");
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  ResourceQuery query{.limit = std::numeric_limits<int>::max()};
  query.filter.set_external_id(external_id);
  ResourceTable table(absl::LocalTimeZone());
  nlohmann::ordered_json document = nlohmann::ordered_json::array();
  for (const ResourceKind& kind : ResourceKinds()) {
    const absl::StatusOr<ResourceList> list = ListResources(*client, kind, query);
    if (IsNotForCaller(list.status())) {
      output.Note(absl::StrCat(kind.names, " were not searched: ", list.status().message()));
      continue;
    }
    MORTISE_RETURN_IF_ERROR(list.status());
    for (const Resource& resource : list->resources) {
      table.Add(kind, *resource);
      if (!output.text()) document.push_back(ToJson(*resource));
    }
  }
  table.Print(output);
  output.Document(document);
  return absl::OkStatus();
}

}  // namespace

void AddFindCommand(CLI::App& app, Session& session) {
  auto text = std::make_shared<std::string>();
  CommandFlags flags(*app.add_subcommand("find", "Whatever has an external id, of every kind"));
  flags.Add("text", *text, "The external id, letter by letter, such as 100-4711/A")->required();
  flags.AlsoGives("external id", "filter.external_id");  // as a person calls the text
  flags.command().footer("Example: mortise find 100-4711/A");
  flags.Run(session, [text](Session& s, Output& o) { return Find(*text, s, o); });
}

}  // namespace mortise::cli
