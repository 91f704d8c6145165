#include "services/composer/catalog/origin_source.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/bundles/bundle_source.h"
#include "mortise/v1/template.pb.h"

namespace mortise::composer {
namespace {

constexpr std::size_t kSurfaceBytes = std::size_t{64} << 20;

}  // namespace

OriginSource::OriginSource(std::shared_ptr<grpc::Channel> catalog)
    : catalog_(catalog), shapes_(std::move(catalog), kSurfaceBytes) {}

absl::StatusOr<ComponentOrigin> OriginSource::Get(const std::string& name, std::int64_t revision,
                                                  const rpc::Origin& caller) {
  MORTISE_RETURN_IF_ERROR(ParseResourceName(name, "templates", "template").status());
  if (revision < 0) return InvalidField("template_revision", "must not be negative");
  absl::StatusOr<v1::TemplateBundle> fetched =
      bundles::FetchBundle(catalog_, name, revision, caller);
  // The catalog names its own fields.
  if (absl::IsInvalidArgument(fetched.status())) {
    return InvalidField("template_revision", std::string(fetched.status().message()));
  }
  MORTISE_RETURN_IF_ERROR(fetched.status());
  v1::TemplateBundle& bundle = *fetched;
  if (!bundle.template_().has_assembly()) {
    return InvalidField("template", absl::StrCat(name,
                                                 " is not of an assembly: there is nothing "
                                                 "that it could be connected by"));
  }
  // What is stretched in pieces, or turned, is made of the exact solid.
  MORTISE_RETURN_IF_ERROR(
      shapes_.AddMore(bundle, {bundle.more_shapes().begin(), bundle.more_shapes().end()}, caller));
  MORTISE_RETURN_IF_ERROR(shapes_.AddExact(*bundle.mutable_shapes(), caller));
  v1::AssemblyBundle assembly;
  *assembly.mutable_assembly() = std::move(*bundle.mutable_assembly());
  *assembly.mutable_items() = std::move(*bundle.mutable_items());
  *assembly.mutable_materials() = std::move(*bundle.mutable_materials());
  *assembly.mutable_shapes() = std::move(*bundle.mutable_shapes());
  MORTISE_ASSIGN_OR_RETURN(Drawing drawing, ReadDrawing(assembly));
  return ComponentOrigin{.template_name = name,
                         .revision = bundle.template_().revision(),
                         .group = bundle.template_().assembly().group(),
                         .drawing = std::make_shared<const Drawing>(std::move(drawing))};
}

}  // namespace mortise::composer
