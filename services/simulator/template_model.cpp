#include "services/simulator/template_model.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/cad/assembly_surface.h"
#include "common/mesh/inside_point.h"
#include "common/parametric/part_shapes.h"

namespace mortise::simulator {
namespace {

using parametric::BoundaryConditionKind;
using parametric::EvaluatedDesign;
using parametric::EvaluatedPart;

absl::StatusOr<Material> MaterialOf(const std::vector<parametric::Material>& materials,
                                    const EvaluatedPart& part) {
  const parametric::Material* material = parametric::FindMaterial(materials, part.material);
  if (material == nullptr) {
    return InvalidField(
        absl::StrCat("part '", part.name, "'"),
        part.material.empty() ? "has no material" : absl::StrCat("there is no ", part.material));
  }
  return Material{material->name, material->density, material->youngs_modulus,
                  material->poissons_ratio, material->strength};
}

// The design without what only connects its parts.
EvaluatedDesign LoadBearing(const EvaluatedDesign& design) {
  EvaluatedDesign bearing = design;
  std::erase_if(bearing.parts, [](const EvaluatedPart& part) { return part.connecting; });
  return bearing;
}

// A single part as a surface; what its faces are called says on which of them conditions act.
absl::StatusOr<mesh::AssemblySurface> SurfaceOf(const EvaluatedPart& part) {
  const parametric::FacetedShape& shape = *part.faceted;
  mesh::AssemblySurface surface;
  surface.vertices = shape.surface.vertices;
  surface.triangles = shape.surface.triangles;
  surface.triangle_face = shape.triangle_face;
  for (const std::vector<std::string>& names : shape.face_names) {
    mesh::AssemblyFace face{.front_part = -1, .back_part = 0, .origins = {}};
    for (const std::string& name : names) face.origins.push_back({0, name});
    surface.faces.push_back(std::move(face));
  }
  MORTISE_ASSIGN_OR_RETURN(const Eigen::Vector3d inside, mesh::InsidePoint(shape.surface));
  surface.part_interior = inside;
  surface.part_names = {part.name};
  return surface;
}

absl::StatusOr<mesh::AssemblySurface> SurfaceOf(const EvaluatedDesign& design) {
  const bool faceted =
      std::any_of(design.parts.begin(), design.parts.end(),
                  [](const EvaluatedPart& part) { return part.faceted.has_value(); });
  if (!faceted) return cad::FuseAssembly(parametric::PartShapes(design));
  if (design.parts.size() != 1) return NotBuilt("analysing several parts that are no prisms");
  return SurfaceOf(design.parts[0]);
}

absl::Status AddCondition(const EvaluatedDesign& design, std::size_t index,
                          AnalysisCase& analysis) {
  const parametric::EvaluatedBoundaryCondition& condition = design.boundary_conditions[index];
  const mesh::NamedFace face{parametric::FindPart(design, condition.part), condition.face};
  if (face.part < 0) {
    return InvalidField(absl::StrCat("boundary_conditions[", index, "].part"),
                        absl::StrCat("there is no load-bearing part '", condition.part, "'"));
  }
  switch (condition.kind) {
    case BoundaryConditionKind::kFixed:
      analysis.supports.push_back({face});
      break;
    case BoundaryConditionKind::kForce:
      analysis.forces.push_back({face, condition.force});
      break;
    case BoundaryConditionKind::kPressure:
      analysis.pressures.push_back({face, condition.pressure});
      break;
    case BoundaryConditionKind::kHeatFlux:
    case BoundaryConditionKind::kTemperature:
      break;
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<DesignModel> MakeDesignModel(const std::vector<parametric::Material>& materials,
                                            const EvaluatedDesign& design) {
  const EvaluatedDesign bearing = LoadBearing(design);
  DesignModel model;
  MORTISE_ASSIGN_OR_RETURN(model.surface, SurfaceOf(bearing));
  for (const EvaluatedPart& part : bearing.parts) {
    MORTISE_ASSIGN_OR_RETURN(Material material, MaterialOf(materials, part));
    model.analysis.materials.push_back(std::move(material));
  }
  for (std::size_t i = 0; i < bearing.boundary_conditions.size(); ++i) {
    MORTISE_RETURN_IF_ERROR(AddCondition(bearing, i, model.analysis));
  }
  return model;
}

bool OffersGradient(const templates::Template& function, const std::string& metric) {
  return (metric == "mass" || metric == "volume") && function.OffersMassGradient();
}

absl::StatusOr<std::vector<MetricGradient>> MetricGradients(
    const templates::Template& function, const Eigen::VectorXd& parameters,
    const std::vector<std::string>& metrics) {
  std::vector<MetricGradient> gradients;
  for (const std::string& metric : metrics) {
    if (!OffersGradient(function, metric)) continue;
    MORTISE_ASSIGN_OR_RETURN(const parametric::MassProperties mass, function.Mass(parameters));
    gradients.push_back({metric, metric == "mass" ? mass.mass_gradient : mass.volume_gradient});
  }
  return gradients;
}

}  // namespace mortise::simulator
