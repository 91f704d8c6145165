// mortise label NAME: the external ids and labels of any resource, and changes of them.
#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "cli/client/command_flags.h"
#include "cli/client/resource_access.h"
#include "cli/client/resource_table.h"
#include "cli/client/tag_changes.h"
#include "cli/commands/commands.h"
#include "common/base/errors.h"

namespace mortise::cli {
namespace {

struct LabelOptions {
  std::string name;
  TagChanges changes;
};

void Print(const google::protobuf::Message& resource, Output& output) {
  const Tags tags = TagsOf(resource);
  const std::string created = CreateTimeText(resource, absl::LocalTimeZone());
  const std::string creator = TextOfField(resource, "creator");
  output.Line(TextOfField(resource, "name"));
  const auto line = [&](const char* what, const std::string& text) {
    if (!text.empty()) output.Line(absl::StrFormat("  %-12s %s", what, text));
  };
  line("external ids", absl::StrJoin(tags.external_ids, ", "));
  line("labels", LabelsText(tags));
  line("creator", creator);
  line("created", created);
  const nlohmann::ordered_json all = ToJson(resource);
  nlohmann::ordered_json document;
  for (const char* const field :
       {"name", "revision", "external_ids", "labels", "creator", "create_time"}) {
    if (all.contains(field)) document[field] = all[field];
  }
  output.Document(document);
}

absl::Status Label(const LabelOptions& options, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(const ResourceKind* const kind, KindOfName(options.name));
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  MORTISE_ASSIGN_OR_RETURN(Resource resource, GetResource(*client, *kind, options.name));
  const Tags present = TagsOf(*resource);
  MORTISE_ASSIGN_OR_RETURN(const Tags wanted, WithChanges(present, options.changes));
  if (wanted != present) {
    MORTISE_ASSIGN_OR_RETURN(resource, ChangeTags(*client, *kind, *resource, wanted));
  }
  Print(*resource, output);
  return absl::OkStatus();
}

}  // namespace

void AddLabelCommand(CLI::App& app, Session& session) {
  auto options = std::make_shared<LabelOptions>();
  CommandFlags flags(*app.add_subcommand("label", "External ids and labels of any resource"));
  flags.Add("name", options->name, "Such as fronts/0198c1 or items/board-38x89")->required();
  flags.Add("change", options->changes.labels,
            "KEY=VALUE sets a label, KEY- takes one away; prints them if there is nothing to "
            "change");
  flags.AlsoGives("change", "labels");  // together with those that are there
  flags
      .Add("--external-id", options->changes.external_ids,
           "Adds what another system knows it by; again for more")
      ->allow_extra_args(false);
  flags.AlsoGives("--external-id", "external_ids");  // together with those that are there
  flags
      .Add("--no-external-id", options->changes.removed_external_ids,
           "Takes one away; again for more")
      ->allow_extra_args(false);
  flags.command().footer(
      "Example: mortise label fronts/0198c1 customer=acme draft- --external-id 100-4711/A");
  flags.Run(session, [options](Session& s, Output& o) { return Label(*options, s, o); });
}

}  // namespace mortise::cli
