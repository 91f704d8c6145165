// mortise catalog delete, mortise assembly delete.
#include "cli/commands/delete_commands.h"

#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "cli/client/command_flags.h"
#include "cli/client/requests.h"
#include "common/base/identifiers.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/assembly.grpc.pb.h"
#include "mortise/v1/catalog.grpc.pb.h"

namespace mortise::cli {
namespace {

struct DeleteOptions {
  std::string subject;
  std::int64_t revision = 0;  // 0: the latest
};

// The methods of one kind of resource.
template <typename Stub, typename GetRequest, typename Message, typename DeleteRequest,
          typename Response>
struct Methods {
  grpc::Status (Stub::*get)(grpc::ClientContext*, const GetRequest&, Message*);
  grpc::Status (Stub::*remove)(grpc::ClientContext*, const DeleteRequest&, Response*);
};

// Deletes the revision that is asked for, or the one that is the latest now.
template <typename Stub, typename GetRequest, typename Message, typename DeleteRequest,
          typename Response>
absl::Status DeleteOne(Stub& stub,
                       Methods<Stub, GetRequest, Message, DeleteRequest, Response> methods,
                       const std::string& name, std::int64_t revision, const GatewayClient& client,
                       Output& output) {
  if (revision == 0) {
    GetRequest get;
    get.set_name(name);
    Message present;
    MORTISE_RETURN_IF_ERROR(client.Call([&](grpc::ClientContext& context) {
      return rpc::FromGrpc((stub.*methods.get)(&context, get, &present));
    }));
    revision = present.revision();
  }
  DeleteRequest request;
  request.set_request_id(NewIdentifier());
  request.set_name(name);
  request.set_revision(revision);
  Response response;
  MORTISE_RETURN_IF_ERROR(client.Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc((stub.*methods.remove)(&context, request, &response));
  }));
  output.Line(absl::StrCat(name, " deleted, which was at revision ", revision));
  output.Document(nlohmann::ordered_json{{"name", name}, {"revision", revision}});
  return absl::OkStatus();
}

absl::Status DeleteFromCatalog(const DeleteOptions& options, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  using Service = v1::CatalogService::Stub;
  const auto stub = v1::CatalogService::NewStub(client->channel());
  const std::string& name = options.subject;
  if (absl::StartsWith(name, "items/")) {
    return DeleteOne(*stub, Methods{&Service::GetItem, &Service::DeleteItem}, name,
                     options.revision, *client, output);
  }
  if (absl::StartsWith(name, "materials/")) {
    return DeleteOne(*stub, Methods{&Service::GetMaterial, &Service::DeleteMaterial}, name,
                     options.revision, *client, output);
  }
  return DeleteOne(*stub, Methods{&Service::GetTemplate, &Service::DeleteTemplate},
                   ResourceName("templates", name), options.revision, *client, output);
}

absl::Status DeleteAssembly(const DeleteOptions& options, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  using Service = v1::AssemblyService::Stub;
  const auto stub = v1::AssemblyService::NewStub(client->channel());
  return DeleteOne(*stub, Methods{&Service::GetAssembly, &Service::DeleteAssembly},
                   ResourceName("assemblies", options.subject), options.revision, *client, output);
}

template <typename Run>
void AddDelete(CLI::App& group, const std::string& what, const std::string& subject,
               const std::string& example, Session& session, Run run) {
  const auto options = std::make_shared<DeleteOptions>();
  CommandFlags flags(*group.add_subcommand("delete", "Remove " + what + " that nothing uses"));
  flags.Add("name", options->subject, subject)->required();
  flags.Add("--revision", options->revision,
            "Only if this is its latest revision; else whichever is", "revision");
  flags.command().footer("Example: " + example);
  flags.Run(session, [options, run](Session& s, Output& o) { return run(*options, s, o); });
}

}  // namespace

void AddCatalogDelete(CLI::App& catalog, Session& session) {
  AddDelete(catalog, "a template, item or material", "Such as templates/table or items/dowel-8x35",
            "mortise catalog delete items/hex-nut-m16 --revision 1", session, DeleteFromCatalog);
}

void AddAssemblyDelete(CLI::App& assembly, Session& session) {
  AddDelete(assembly, "an assembly", "Such as bookshelf", "mortise assembly delete coat-rack",
            session, DeleteAssembly);
}

}  // namespace mortise::cli
