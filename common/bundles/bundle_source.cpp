#include "common/bundles/bundle_source.h"

#include <grpcpp/grpcpp.h>

#include "common/base/digest.h"
#include "common/resources/resource_tags.h"
#include "mortise/v1/catalog.grpc.pb.h"

namespace mortise::bundles {
namespace {

// Revisions and prices have no part in physics, but telling them apart costs little.
template <typename Message>
std::string DigestOf(Message message) {
  resources::ClearTags(&message);
  message.clear_create_time();
  return Sha256Hex(message.SerializeAsString());
}

}  // namespace

absl::StatusOr<v1::TemplateBundle> FetchBundle(const std::shared_ptr<grpc::Channel>& catalog,
                                               const std::string& name, std::int64_t revision,
                                               const rpc::Origin& origin) {
  const auto stub = v1::CatalogService::NewStub(catalog);
  v1::GetTemplateBundleRequest request;
  request.set_name(name);
  request.set_revision(revision);
  return rpc::CallUnary<v1::CatalogService::Stub, v1::GetTemplateBundleRequest, v1::TemplateBundle>(
      *stub, &v1::CatalogService::Stub::GetTemplateBundle, request, origin);
}

bool IsPassingFailure(const absl::Status& status) {
  return absl::IsUnavailable(status) || absl::IsDeadlineExceeded(status) ||
         absl::IsCancelled(status) || absl::IsResourceExhausted(status) || absl::IsAborted(status);
}

std::string ContentDigest(const v1::TemplateBundle& bundle) {
  std::string digests = bundle.template_().digest();
  for (const v1::Item& item : bundle.items()) digests += DigestOf(item);
  for (const v1::Material& material : bundle.materials()) digests += DigestOf(material);
  return Sha256Hex(digests);
}

}  // namespace mortise::bundles
