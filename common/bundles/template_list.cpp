#include "common/bundles/template_list.h"

#include <grpcpp/grpcpp.h>

#include <utility>

#include "common/base/errors.h"
#include "mortise/v1/catalog.grpc.pb.h"

namespace mortise::bundles {
namespace {

constexpr int kPageSize = 1000;

}  // namespace

absl::StatusOr<std::vector<v1::Template>> ListTemplates(
    const std::shared_ptr<grpc::Channel>& catalog, v1::ListTemplatesRequest request,
    const rpc::Origin& origin, const rpc::RetryOptions& retry) {
  const auto stub = v1::CatalogService::NewStub(catalog);
  request.set_page_size(kPageSize);
  std::vector<v1::Template> templates;
  do {
    MORTISE_ASSIGN_OR_RETURN(
        v1::ListTemplatesResponse page,
        rpc::CallUnary(*stub, &v1::CatalogService::Stub::ListTemplates, request, origin, retry));
    for (v1::Template& each : *page.mutable_templates()) templates.push_back(std::move(each));
    request.set_page_token(page.next_page_token());
  } while (!request.page_token().empty());
  return templates;
}

}  // namespace mortise::bundles
