#include "services/simulator/template_source.h"

#include <grpcpp/grpcpp.h>

#include <map>
#include <set>

#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/templates/template_codec.h"
#include "mortise/v1/catalog.grpc.pb.h"

namespace mortise::simulator {
namespace {

constexpr std::size_t kShapeBytes = 64u << 20;
constexpr std::size_t kCompiledBytes = 256u << 20;

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

// The shapes of parts that an analysis joins: a part by itself is its triangles, and what only
// connects is left out.
std::set<std::string> ShapesThatAreJoined(const v1::TemplateBundle& bundle) {
  std::map<std::string, std::string> shape_of;  // by item
  for (const v1::Item& item : bundle.items()) shape_of[item.name()] = item.shape();
  std::set<std::string> shapes;
  int bearing = 0;
  for (const v1::AssemblyPart& part : bundle.assembly().parts()) {
    if (part.role() == v1::AssemblyPart::CONNECTING) continue;
    bearing += part.repeat().empty() ? 1 : 2;
    shapes.insert(part.shape().empty() ? shape_of[part.item()] : part.shape());
  }
  return bearing > 1 ? shapes : std::set<std::string>();
}

}  // namespace

TemplateSource::TemplateSource(std::shared_ptr<grpc::Channel> catalog, std::size_t capacity)
    : catalog_(catalog), capacity_(capacity), shapes_(std::move(catalog), kShapeBytes) {}

// What is exact serves those who need no surfaces, too.
std::shared_ptr<const CompiledTemplate> TemplateSource::Find(const std::string& name,
                                                             int64_t revision,
                                                             const std::string& digest,
                                                             bool is_exact) {
  const std::lock_guard lock(mutex_);
  for (auto entry = kept_.begin(); entry != kept_.end(); ++entry) {
    const CompiledTemplate& kept = **entry;
    if (kept.digest != digest || kept.name != name || kept.revision != revision) continue;
    if (is_exact && !kept.is_exact) continue;
    kept_.splice(kept_.begin(), kept_, entry);
    return kept_.front();
  }
  return nullptr;
}

void TemplateSource::Keep(const std::shared_ptr<const CompiledTemplate>& compiled) {
  const std::lock_guard lock(mutex_);
  kept_.push_front(compiled);
  std::size_t bytes = 0, count = 0;
  auto entry = kept_.begin();
  // The latest stays however large it is.
  for (; entry != kept_.end(); ++entry, ++count) {
    bytes += (*entry)->bytes;
    if (count == capacity_ || (count > 0 && bytes > kCompiledBytes)) break;
  }
  kept_.erase(entry, kept_.end());
}

absl::StatusOr<v1::TemplateBundle> TemplateSource::Ask(const std::string& name, int64_t revision,
                                                       const rpc::Origin& origin) {
  const auto stub = v1::CatalogService::NewStub(catalog_);
  v1::GetTemplateBundleRequest request;
  request.set_name(name);
  request.set_revision(revision);
  return rpc::CallUnary<v1::CatalogService::Stub, v1::GetTemplateBundleRequest, v1::TemplateBundle>(
      *stub, &v1::CatalogService::Stub::GetTemplateBundle, request, origin);
}

absl::StatusOr<std::shared_ptr<const CompiledTemplate>> TemplateSource::Compile(
    const v1::TemplateBundle& bundle, std::string digest, bool is_exact) {
  CompiledTemplate compiled{.name = bundle.template_().name(),
                            .revision = bundle.template_().revision(),
                            .digest = std::move(digest),
                            .is_exact = is_exact,
                            .bytes = 0,
                            .function = nullptr};
  for (const v1::Shape& shape : bundle.shapes()) compiled.bytes += shape.ByteSizeLong();
  MORTISE_ASSIGN_OR_RETURN(compiled.function, templates::Compile(bundle));
  auto kept = std::make_shared<const CompiledTemplate>(std::move(compiled));
  Keep(kept);
  return kept;
}

absl::StatusOr<std::shared_ptr<const CompiledTemplate>> TemplateSource::Get(
    const std::string& name, int64_t revision, const rpc::Origin& origin) {
  MORTISE_RETURN_IF_ERROR(ParseResourceName(name, "templates", "subject").status());
  if (revision < 0) return InvalidField("revision", "must not be negative");
  MORTISE_ASSIGN_OR_RETURN(v1::TemplateBundle bundle, Ask(name, revision, origin));
  std::string digest = BundleDigest(bundle);
  if (auto known = Find(name, bundle.template_().revision(), digest, false)) return known;
  MORTISE_RETURN_IF_ERROR(shapes_.AddMore(bundle, origin));
  return Compile(bundle, std::move(digest), false);
}

absl::StatusOr<std::shared_ptr<const CompiledTemplate>> TemplateSource::GetByDigest(
    const std::string& name, int64_t revision, const std::string& digest,
    const rpc::Origin& origin) {
  if (auto known = Find(name, revision, digest, true)) return known;
  MORTISE_ASSIGN_OR_RETURN(v1::TemplateBundle bundle, Ask(name, revision, origin));
  if (BundleDigest(bundle) != digest) {
    return PreconditionFailed("TEMPLATE_CHANGED",
                              absl::StrCat("items or materials of ", name,
                                           " have changed since the evaluation was asked for"),
                              name);
  }
  MORTISE_RETURN_IF_ERROR(shapes_.AddMore(bundle, origin));
  const std::set<std::string> joined = ShapesThatAreJoined(bundle);
  for (v1::Shape& shape : *bundle.mutable_shapes()) {
    if (joined.contains(shape.name())) MORTISE_RETURN_IF_ERROR(shapes_.AddExact(shape, origin));
  }
  return Compile(bundle, digest, true);
}

}  // namespace mortise::simulator
