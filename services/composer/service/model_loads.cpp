#include "services/composer/service/model_loads.h"

#include "common/base/errors.h"
#include "common/files/template_codec.h"
#include "services/composer/holding/load_conditions.h"
#include "services/composer/service/bundle_contents.h"

namespace mortise::composer {

absl::StatusOr<v1::Template> LoadsOf(const OpenDesign& body, const OpenModel& model,
                                     ModelDrawings& drawings) {
  MORTISE_ASSIGN_OR_RETURN(const auto drawing, drawings.Get(model.name, body.drawing));
  MORTISE_ASSIGN_OR_RETURN(const BundleContents contents, ContentsOf(drawing->bundle));
  parametric::TemplateDefinition definition;
  MORTISE_ASSIGN_OR_RETURN(definition.boundary_conditions,
                           SupportsAndLoads(body.design, contents.items));
  v1::Template loads;
  *loads.mutable_boundary_conditions() = parametric::ToProto(definition).boundary_conditions();
  return loads;
}

}  // namespace mortise::composer
