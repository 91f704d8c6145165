#include "services/retrieval/families/family_manifold.h"

#include <string>
#include <utility>

#include "common/base/errors.h"
#include "services/retrieval/families/design_surface.h"

namespace mortise::retrieval {
namespace {

// What evaluations share; they come on several threads.
struct Family {
  std::shared_ptr<const templates::Template> function;
  std::shared_ptr<const Descriptor> descriptor;
  parametric::Structure structure;         // of the default design
  std::unique_ptr<BoundDescriptor> bound;  // to the default design's triangles
  Eigen::Index vertices = 0;               // of the default design
};

absl::StatusOr<Eigen::VectorXd> Describe(const Family& family, const Eigen::VectorXd& q) {
  MORTISE_ASSIGN_OR_RETURN(const parametric::EvaluatedDesign design, family.function->Evaluate(q));
  const mesh::SurfaceMesh surface = DesignSurface(design);
  if (design.structure == family.structure && surface.vertices.cols() == family.vertices) {
    return family.bound->Describe(surface.vertices);
  }
  return family.descriptor->Describe(surface);
}

// A number for a structure that is the same in every process: 28 bits of its key.
int NumberOf(const parametric::Structure& structure) {
  return static_cast<int>(std::stoul(parametric::KeyOf(structure).substr(0, 7), nullptr, 16));
}

}  // namespace

absl::StatusOr<std::unique_ptr<Manifold>> MakeFamilyManifold(
    std::shared_ptr<const templates::Template> function,
    std::shared_ptr<const Descriptor> descriptor) {
  const std::vector<parametric::Parameter>& parameters = function->parameters();
  const auto count = static_cast<Eigen::Index>(parameters.size());
  ManifoldFunctions functions;
  functions.lower.resize(count);
  functions.upper.resize(count);
  Eigen::VectorXd defaults(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const parametric::Parameter& parameter = parameters[static_cast<std::size_t>(i)];
    functions.lower[i] = parameter.minimum;
    functions.upper[i] = parameter.maximum;
    defaults[i] = parameter.default_value;
  }
  auto family = std::make_shared<Family>();
  MORTISE_ASSIGN_OR_RETURN(const parametric::EvaluatedDesign design, function->Evaluate(defaults));
  const mesh::SurfaceMesh surface = DesignSurface(design);
  MORTISE_ASSIGN_OR_RETURN(family->bound, descriptor->Bind(surface));
  family->vertices = surface.vertices.cols();
  if (design.structure) family->structure = *design.structure;
  family->function = std::move(function);
  family->descriptor = std::move(descriptor);

  const DescriptorProperties& properties = family->descriptor->properties();
  functions.dimension = properties.dimension;
  functions.noise = properties.sampling_noise / properties.natural_scale;
  functions.evaluate = [family](const Eigen::VectorXd& q) { return Describe(*family, q); };
  functions.structure = [family](const Eigen::VectorXd& q) {
    const absl::StatusOr<parametric::Structure> structure = family->function->StructureAt(q);
    return structure.ok() ? NumberOf(*structure) : 0;
  };
  return std::make_unique<FunctionManifold>(std::move(functions));
}

}  // namespace mortise::retrieval
