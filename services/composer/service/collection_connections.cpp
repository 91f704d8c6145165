#include "services/composer/service/collection_connections.h"

#include <grpcpp/grpcpp.h>

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "mortise/v1/catalog.grpc.pb.h"

namespace mortise::composer {
namespace {

constexpr int kPageSize = 1000;

// A failure that says nothing of a template, but that the catalog cannot answer now.
bool IsPassing(const absl::Status& status) {
  return absl::IsUnavailable(status) || absl::IsDeadlineExceeded(status) ||
         absl::IsCancelled(status);
}

absl::StatusOr<std::vector<v1::Template>> ListAssemblyTemplates(
    const std::shared_ptr<grpc::Channel>& catalog, const rpc::Origin& caller) {
  const auto stub = v1::CatalogService::NewStub(catalog);
  v1::ListTemplatesRequest request;
  request.set_page_size(kPageSize);
  request.set_kind(v1::ListTemplatesRequest::ASSEMBLY);
  std::vector<v1::Template> templates;
  do {
    MORTISE_ASSIGN_OR_RETURN(
        v1::ListTemplatesResponse page,
        rpc::CallUnary(*stub, &v1::CatalogService::Stub::ListTemplates, request, caller));
    for (v1::Template& each : *page.mutable_templates()) templates.push_back(std::move(each));
    request.set_page_token(page.next_page_token());
  } while (!request.page_token().empty());
  return templates;
}

}  // namespace

CollectionConnections::CollectionConnections(std::shared_ptr<grpc::Channel> catalog,
                                             OriginSource* origins, ModelDrawings* drawings,
                                             std::size_t capacity)
    : catalog_(std::move(catalog)), origins_(origins), drawings_(drawings), kept_(capacity) {}

absl::StatusOr<ConnectionOrigins> CollectionConnections::All(const rpc::Origin& caller,
                                                             const IsGivenUp& is_given_up) {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<v1::Template> templates,
                           ListAssemblyTemplates(catalog_, caller));
  ConnectionOrigins all;
  for (const v1::Template& each : templates) {
    if (is_given_up()) return absl::CancelledError("nobody waits for the answer any more");
    absl::StatusOr<ConnectionOrigin> read = Read(each.name(), each.revision(), caller);
    if (IsPassing(read.status())) return read.status();
    if (!read.ok()) {
      Log(LogLevel::kWarning, "connections of a template not read",
          {{"template", each.name()}, {"error", read.status().message()}});
      continue;
    }
    const std::string assembly = read->drawing->bundle.assembly().name();
    all.insert_or_assign(assembly, *std::move(read));
  }
  return all;
}

absl::StatusOr<ConnectionOrigin> CollectionConnections::Read(const std::string& name,
                                                             std::int64_t revision,
                                                             const rpc::Origin& caller) {
  using Made = SingleFlightCache<ConnectionOrigin>::Made;
  return kept_.Get(absl::StrCat(name, "/", revision), [&]() -> absl::StatusOr<Made> {
    MORTISE_ASSIGN_OR_RETURN(const ComponentOrigin origin, origins_->Get(name, revision, caller));
    ConnectionOrigin made{.drawing = origin.drawing, .connections = nullptr};
    MORTISE_ASSIGN_OR_RETURN(made.connections, drawings_->ConnectionsIn(*origin.drawing));
    const std::size_t bytes = origin.drawing->bundle.SpaceUsedLong();
    return Made{std::move(made), bytes};
  });
}

}  // namespace mortise::composer
