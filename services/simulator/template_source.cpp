#include "services/simulator/template_source.h"

#include <grpcpp/grpcpp.h>

#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/templates/template_codec.h"
#include "mortise/v1/catalog.grpc.pb.h"

namespace mortise::simulator {
namespace {

// A template's own digest does not see its items and materials change; results depend on them.
// Revisions and prices have no part in physics, but telling them apart costs little.
std::string BundleDigest(const v1::TemplateBundle& bundle) {
  std::string digests = bundle.template_().digest();
  for (const v1::Item& item : bundle.items()) digests += Sha256Hex(item.SerializeAsString());
  for (const v1::Material& material : bundle.materials()) {
    digests += Sha256Hex(material.SerializeAsString());
  }
  return Sha256Hex(digests);
}

}  // namespace

TemplateSource::TemplateSource(std::shared_ptr<grpc::Channel> catalog, std::size_t capacity)
    : catalog_(std::move(catalog)), capacity_(capacity) {}

std::shared_ptr<const CompiledTemplate> TemplateSource::Find(const std::string& name,
                                                             int64_t revision,
                                                             const std::string& digest) {
  const std::lock_guard lock(mutex_);
  for (auto entry = kept_.begin(); entry != kept_.end(); ++entry) {
    if ((*entry)->digest != digest || (*entry)->name != name || (*entry)->revision != revision) {
      continue;
    }
    kept_.splice(kept_.begin(), kept_, entry);
    return kept_.front();
  }
  return nullptr;
}

void TemplateSource::Keep(const std::shared_ptr<const CompiledTemplate>& compiled) {
  const std::lock_guard lock(mutex_);
  kept_.push_front(compiled);
  if (kept_.size() > capacity_) kept_.pop_back();
}

absl::StatusOr<std::shared_ptr<const CompiledTemplate>> TemplateSource::Get(
    const std::string& name, int64_t revision, const rpc::Origin& origin) {
  MORTISE_RETURN_IF_ERROR(ParseResourceName(name, "templates", "subject").status());
  if (revision < 0) return InvalidField("revision", "must not be negative");
  const auto stub = v1::CatalogService::NewStub(catalog_);
  v1::GetTemplateBundleRequest request;
  request.set_name(name);
  request.set_revision(revision);
  MORTISE_ASSIGN_OR_RETURN(
      const v1::TemplateBundle bundle,
      (rpc::CallUnary<v1::CatalogService::Stub, v1::GetTemplateBundleRequest, v1::TemplateBundle>(
          *stub, &v1::CatalogService::Stub::GetTemplateBundle, request, origin)));
  const std::string digest = BundleDigest(bundle);
  if (auto known = Find(name, bundle.template_().revision(), digest)) return known;
  MORTISE_ASSIGN_OR_RETURN(auto function, templates::Compile(bundle));
  auto compiled = std::make_shared<const CompiledTemplate>(
      CompiledTemplate{name, bundle.template_().revision(), digest, std::move(function)});
  Keep(compiled);
  return std::shared_ptr<const CompiledTemplate>(compiled);
}

absl::StatusOr<std::shared_ptr<const CompiledTemplate>> TemplateSource::GetByDigest(
    const std::string& name, int64_t revision, const std::string& digest,
    const rpc::Origin& origin) {
  if (auto known = Find(name, revision, digest)) return known;
  MORTISE_ASSIGN_OR_RETURN(auto compiled, Get(name, revision, origin));
  if (compiled->digest != digest) {
    return PreconditionFailed("TEMPLATE_CHANGED",
                              absl::StrCat("items or materials of ", name,
                                           " have changed since the evaluation was asked for"),
                              name);
  }
  return compiled;
}

}  // namespace mortise::simulator
