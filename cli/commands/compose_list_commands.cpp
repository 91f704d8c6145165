#include "cli/commands/compose_list_commands.h"

#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "cli/client/command_flags.h"
#include "cli/client/filter_options.h"
#include "cli/client/requests.h"
#include "cli/client/tag_options.h"
#include "cli/commands/compose_calls.h"
#include "cli/output/compose_output.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "mortise/v1/composer.grpc.pb.h"

namespace mortise::cli {
namespace {

struct NewModelOptions {
  std::string id, title;
  TagOptions tags;
};

absl::Status NewModel(const NewModelOptions& options, Session& session, Output& output) {
  v1::CreateModelRequest request;
  request.set_request_id(NewIdentifier());
  request.set_model_id(options.id);
  request.set_title(options.title);
  MORTISE_RETURN_IF_ERROR(AddTags(options.tags, &request));
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  MORTISE_ASSIGN_OR_RETURN(const v1::Model model,
                           AskComposer(*client, &v1::ComposerService::Stub::CreateModel, request));
  PrintModel(model, output);
  return absl::OkStatus();
}

absl::Status ListModels(const FilterOptions& options, Session& session, Output& output) {
  v1::ListModelsRequest filters;
  MORTISE_ASSIGN_OR_RETURN(*filters.mutable_filter(), ParseFilter(options));
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::ComposerService::NewStub(client->channel());
  v1::ListModelsResponse all;
  std::vector<std::vector<std::string>> rows;
  const absl::Status listed = ListAll<v1::ListModelsRequest, v1::ListModelsResponse>(
      *client, [&](auto... a) { return stub->ListModels(a...); },
      [&](const v1::ListModelsResponse& page) {
        for (const v1::Model& model : page.models()) {
          rows.push_back({model.name(), model.title(), absl::StrCat("revision ", model.revision()),
                          absl::StrCat(model.components_size(), " components")});
          *all.add_models() = model;
        }
      },
      filters);
  MORTISE_RETURN_IF_ERROR(listed);
  output.Table({"name", "title", "revision", "components"}, rows);
  output.DocumentOf(all);
  return absl::OkStatus();
}

}  // namespace

void AddComposeNewAndList(CLI::App& compose, Session& session) {
  auto made = std::make_shared<NewModelOptions>();
  CommandFlags create(*compose.add_subcommand("new", "Begin an empty model"));
  create.Add("model", made->id, "Its id, such as desk; chosen if absent", "model_id");
  create.Add("--title", made->title, "Its title, for people", "title");
  AddTagOptions(create, made->tags);
  create.command().footer("Example: mortise compose new desk --title \"My desk\"");
  create.Run(session, [made](Session& s, Output& o) { return NewModel(*made, s, o); });

  auto listed = std::make_shared<FilterOptions>();
  CommandFlags list(*compose.add_subcommand("list", "The models there are"));
  AddFilterOptions(list, *listed);
  list.command().footer("Example: mortise compose list --creator ada");
  list.Run(session, [listed](Session& s, Output& o) { return ListModels(*listed, s, o); });
}

}  // namespace mortise::cli
