#include "services/simulator/worker/template_source.h"

#include <map>
#include <set>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/bundles/bundle_source.h"
#include "common/files/metric_codec.h"
#include "common/templates/template_codec.h"
#include "mortise/v1/catalog.pb.h"

namespace mortise::simulator {
namespace {

constexpr std::size_t kSurfaceBytes = std::size_t{64} << 20;

std::string KeyOf(const std::string& name, int64_t revision, const std::string& digest,
                  bool is_exact) {
  return absl::StrCat(name, "/", revision, "/", digest, is_exact ? "/exact" : "");
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
    : catalog_(catalog),
      shapes_(std::move(catalog), kSurfaceBytes),
      kept_(capacity, Oversize::kAlone) {}

absl::StatusOr<TemplateSource::Kept::Made> TemplateSource::Compile(v1::TemplateBundle bundle,
                                                                   const std::string& digest,
                                                                   bool is_exact,
                                                                   const rpc::Origin& origin) {
  const std::set<std::string> joined =
      is_exact ? ShapesThatAreJoined(bundle) : std::set<std::string>();
  MORTISE_RETURN_IF_ERROR(shapes_.AddMore(bundle, joined, origin));
  for (v1::Shape& shape : *bundle.mutable_shapes()) {
    if (joined.contains(shape.name())) MORTISE_RETURN_IF_ERROR(shapes_.AddExact(shape, origin));
  }
  EvaluatedTemplate compiled{
      .name = bundle.template_().name(),
      .revision = bundle.template_().revision(),
      .digest = digest,
      .is_exact = is_exact,
      .design_template = nullptr,
      .metrics = parametric::FromProto(parametric::MetricDefinitionsOf(bundle.template_()))};
  MORTISE_ASSIGN_OR_RETURN(compiled.design_template, templates::Compile(bundle));
  const auto kind = bundle.template_().kind_case();
  compiled.gradients = GradientsOf(*compiled.design_template, kind == v1::Template::KIND_NOT_SET ||
                                                                  kind == v1::Template::kAssembly);
  const std::size_t bytes = compiled.design_template->MemoryUse();
  return Kept::Made{std::make_shared<const EvaluatedTemplate>(std::move(compiled)), bytes};
}

absl::StatusOr<std::shared_ptr<const EvaluatedTemplate>> TemplateSource::Get(
    const std::string& name, int64_t revision, const rpc::Origin& origin) {
  MORTISE_RETURN_IF_ERROR(ParseResourceName(name, "templates", "subject").status());
  if (revision < 0) return InvalidField("revision", "must not be negative");
  MORTISE_ASSIGN_OR_RETURN(v1::TemplateBundle bundle,
                           bundles::FetchBundle(catalog_, name, revision, origin));
  const std::string digest = bundles::ContentDigest(bundle);
  const int64_t present = bundle.template_().revision();
  // What is exact serves those who need no surfaces, too.
  if (const auto exact = kept_.Find(KeyOf(name, present, digest, true))) return *exact;
  return kept_.Get(KeyOf(name, present, digest, false),
                   [&] { return Compile(std::move(bundle), digest, false, origin); });
}

absl::StatusOr<std::shared_ptr<const EvaluatedTemplate>> TemplateSource::GetByDigest(
    const std::string& name, int64_t revision, const std::string& digest,
    const rpc::Origin& origin) {
  return kept_.Get(KeyOf(name, revision, digest, true), [&]() -> absl::StatusOr<Kept::Made> {
    MORTISE_ASSIGN_OR_RETURN(v1::TemplateBundle bundle,
                             bundles::FetchBundle(catalog_, name, revision, origin));
    if (bundles::ContentDigest(bundle) != digest) {
      return PreconditionFailed("TEMPLATE_CHANGED",
                                absl::StrCat("items or materials of ", name,
                                             " have changed since the evaluation was asked for"),
                                name);
    }
    return Compile(std::move(bundle), digest, true, origin);
  });
}

}  // namespace mortise::simulator
