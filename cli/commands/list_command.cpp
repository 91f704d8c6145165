// mortise list KIND: resources of any kind.
#include "cli/commands/list_command.h"

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "cli/client/command_flags.h"
#include "cli/client/filter_options.h"
#include "cli/client/resource_access.h"
#include "cli/client/resource_table.h"
#include "cli/commands/commands.h"
#include "common/base/errors.h"

namespace mortise::cli {
namespace {

struct ListOptions {
  std::string kind;
  FilterOptions filter;
  std::string subject;
  std::vector<std::string> states;
  int limit = 50;
};

absl::Status List(const ListOptions& options, Session& session, Output& output) {
  const ResourceKind* const kind = FindKind(options.kind);
  if (kind == nullptr) {
    return InvalidField("kind",
                        absl::StrCat("'", options.kind, "' is none of ", ResourceKindNames()));
  }
  ResourceQuery query{.subject = options.subject, .states = options.states, .limit = options.limit};
  MORTISE_ASSIGN_OR_RETURN(query.filter, ParseFilter(options.filter));
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  MORTISE_ASSIGN_OR_RETURN(const ResourceList list, ListResources(*client, *kind, query));
  ResourceTable table(absl::LocalTimeZone());
  nlohmann::ordered_json document = nlohmann::ordered_json::array();
  for (const Resource& resource : list.resources) {
    table.Add(*kind, *resource);
    if (!output.text()) document.push_back(ToJson(*resource));
  }
  table.Print(output);
  if (list.has_more) {
    output.Line(absl::StrCat("there are more than ", options.limit, "; see them with --limit"));
  }
  output.Document(document);
  return absl::OkStatus();
}

}  // namespace

void AddListOf(CLI::App& list, const std::string& kind, Session& session) {
  auto options = std::make_shared<ListOptions>();
  options->kind = kind;
  CommandFlags flags(list);
  if (kind.empty()) {
    flags.Add("kind", options->kind, absl::StrCat("One of ", ResourceKindNames()))->required();
  }
  AddFilterOptions(flags, options->filter);
  flags.Add("--subject", options->subject,
            "Only those of this, such as templates/table; of work orders plans/…", "subject");
  flags.Add("--state", options->states, "Only those in this state, such as held; again for more")
      ->allow_extra_args(false);
  flags.AlsoGives("--state", "states");
  flags.Add("--limit", options->limit, "At most so many")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  list.footer(kind.empty() ? "Example: mortise list fronts --label customer=acme --since 7d"
              : kind == "workOrders" ? "Example: mortise fab list --state in-progress --state held"
                                     : "Example: mortise map list --subject templates/table");
  flags.Run(session, [options](Session& s, Output& o) { return List(*options, s, o); });
}

void AddListCommand(CLI::App& app, Session& session) {
  AddListOf(*app.add_subcommand("list", "Resources of one kind, whoever made them"), "", session);
}

}  // namespace mortise::cli
