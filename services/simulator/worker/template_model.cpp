#include "services/simulator/worker/template_model.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/assembly/parametric_assembly.h"
#include "common/base/errors.h"
#include "common/cad/stretch/solid_shape.h"
#include "common/cad/surface/assembly_surface.h"
#include "common/design/costs/design_cost.h"
#include "common/design/part_shapes.h"
#include "common/fields/control_variables.h"
#include "common/mesh/measures/inside_point.h"
#include "common/templates/features/edge_samples.h"
#include "services/simulator/worker/design_conditions.h"

namespace mortise::simulator {
namespace {

using parametric::EvaluatedDesign;
using parametric::EvaluatedPart;

constexpr std::size_t kMaxFaces = 100'000;  // the kernel fuses 76,000 in half a minute
constexpr std::size_t kNamesTold = 4;

// Along which axis of the design an axis of the part's item lies.
Eigen::Vector3d DirectionOf(parametric::Axis item_axis, const EvaluatedPart& part) {
  const int length = static_cast<int>(part.length_axis);
  const int thickness = static_cast<int>(part.thickness_axis);
  switch (item_axis) {
    case parametric::Axis::kX:
      return Eigen::Vector3d::Unit(length);
    case parametric::Axis::kY:
      return Eigen::Vector3d::Unit(3 - length - thickness);
    default:
      return Eigen::Vector3d::Unit(thickness);
  }
}

Orthotropy OrthotropyOf(const parametric::OrthotropicElasticity& elasticity,
                        const parametric::Item& item, const EvaluatedPart& part) {
  const parametric::OrthotropicElasticity& e = elasticity;
  Orthotropy orthotropy;
  orthotropy.youngs_modulus = {e.youngs_modulus_l, e.youngs_modulus_r, e.youngs_modulus_t};
  orthotropy.poissons_ratio = {e.poissons_ratio_lr, e.poissons_ratio_rt, e.poissons_ratio_lt};
  orthotropy.shear_modulus = {e.shear_modulus_lr, e.shear_modulus_rt, e.shear_modulus_lt};
  orthotropy.axes = GrainAxes(DirectionOf(item.grain_axis.value_or(parametric::Axis::kX), part),
                              DirectionOf(item.radial_axis.value_or(parametric::Axis::kZ), part));
  return orthotropy;
}

// With its grain where the part is made of an item; of other parts nobody says which way it runs.
absl::StatusOr<Material> MaterialOf(const templates::TemplateHead& head,
                                    const EvaluatedPart& part) {
  const parametric::Material* known = parametric::FindMaterial(head.materials, part.material);
  if (known == nullptr) {
    return PreconditionFailed(
        "NO_MATERIAL",
        part.material.empty()
            ? absl::StrCat("part '", part.name, "' has no material: give it an item that has one")
            : absl::StrCat("part '", part.name, "': there is no ", part.material),
        absl::StrCat("part '", part.name, "'"));
  }
  Material material{
      known->name,     known->density,           known->youngs_modulus,      known->poissons_ratio,
      known->strength, known->thermal_expansion, known->thermal_conductivity};
  const parametric::Item* item = parametric::FindItem(head.items, part.item);
  if (known->orthotropic && item != nullptr) {
    material.orthotropy = OrthotropyOf(*known->orthotropic, *item, part);
    // The catalog knows one number of each, for all directions.
    material.orthotropy->thermal_expansion.setConstant(known->thermal_expansion);
    material.orthotropy->conductivity.setConstant(known->thermal_conductivity);
  }
  return material;
}

// Whether the boxes of two parts meet.
bool Touch(const EvaluatedPart& a, const EvaluatedPart& b) {
  return (a.minimum - b.maximum).maxCoeff() <= cad::kDrawingTolerance &&
         (b.minimum - a.maximum).maxCoeff() <= cad::kDrawingTolerance;
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

// Gives the faces of shapes all their names; the kernel's solids know the first of each only.
void NameFaces(const EvaluatedDesign& bearing, mesh::AssemblySurface& surface) {
  for (mesh::AssemblyFace& face : surface.faces) {
    const std::vector<mesh::NamedFace> known = face.origins;
    for (const mesh::NamedFace& origin : known) {
      const EvaluatedPart& part = bearing.parts[static_cast<std::size_t>(origin.part)];
      if (!part.faceted) continue;
      for (const std::vector<std::string>& names : part.faceted->face_names) {
        if (names.front() != origin.name) continue;
        for (std::size_t i = 1; i < names.size(); ++i) {
          face.origins.push_back({origin.part, names[i]});
        }
      }
    }
  }
}

// Whether all that bears of an assembly has exact surfaces: triangulated anew, these keep the
// sections of what is round (cad/assembly_surface.h), which triangles drawn once for all sizes do
// not.
bool HasExactSurfaces(const templates::Template::AssemblyDesign& drawn,
                      const EvaluatedDesign& design) {
  const std::vector<parametric::PlacedPart> placed = drawn.assembly->PartsAt(drawn.q);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (design.parts[i].connecting) continue;
    const auto& shape = drawn.assembly->ShapeOf(placed[i]);
    if (shape != nullptr && shape->brep.empty()) return false;
  }
  return true;
}

// What only connects is not made: nobody needs its shape to stretch.
absl::StatusOr<std::vector<cad::Solid>> BearingSolids(
    const templates::Template::AssemblyDesign& drawn, const EvaluatedDesign& design) {
  const std::vector<parametric::PlacedPart> placed = drawn.assembly->PartsAt(drawn.q);
  std::vector<cad::Solid> solids;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const EvaluatedPart& part = design.parts[i];
    if (part.connecting) continue;
    const auto& shape = drawn.assembly->ShapeOf(placed[i]);
    absl::StatusOr<cad::Solid> solid =
        shape == nullptr ? cad::Solid::FromPart(parametric::PartShapeOf(part))
                         : cad::SolidOfShape(*shape, placed[i].stretch, part.name);
    if (!solid.ok()) return UnderField(absl::StrCat("part '", part.name, "'"), solid.status());
    solids.push_back(shape == nullptr ? *std::move(solid)
                                      : cad::MovedSolid(*solid, placed[i].box.minimum));
  }
  return solids;
}

// The solid that is `part`, whose faces are told apart by their index: several may have the same
// first name.
absl::StatusOr<mesh::AssemblySurface> FuseSolid(const cad::Solid& solid, const EvaluatedPart& part,
                                                double element_size) {
  std::vector<std::string> numbers;
  for (std::size_t i = 0; i < solid.face_names().size(); ++i) numbers.push_back(absl::StrCat(i));
  MORTISE_ASSIGN_OR_RETURN(
      mesh::AssemblySurface surface,
      cad::FuseAssembly({cad::WithFaceNames(solid, numbers)}, {.element_size = element_size}));
  for (mesh::AssemblyFace& face : surface.faces) {
    const std::vector<mesh::NamedFace> pieces_of = std::move(face.origins);
    face.origins.clear();
    for (const mesh::NamedFace& origin : pieces_of) {
      const auto index = std::find(numbers.begin(), numbers.end(), origin.name) - numbers.begin();
      for (const std::string& name : part.faceted->face_names[static_cast<std::size_t>(index)]) {
        face.origins.push_back({origin.part, name});
      }
    }
  }
  surface.part_names = {part.name};
  return surface;
}

// A design that is one solid. Where the kernel cannot fuse it as it is, its triangles as drawn.
absl::StatusOr<mesh::AssemblySurface> SurfaceOfSolid(const templates::Template& function,
                                                     const Eigen::VectorXd& parameters,
                                                     const EvaluatedPart& part,
                                                     double element_size) {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<cad::Solid> solids, function.Solids(parameters));
  absl::StatusOr<mesh::AssemblySurface> fused = FuseSolid(solids.front(), part, element_size);
  if (fused.ok() || absl::IsFailedPrecondition(fused.status())) return fused;
  return SurfaceOf(part);
}

// Parts of an assembly, some of which have shapes.
absl::StatusOr<mesh::AssemblySurface> FuseShapes(const templates::Template::AssemblyDesign& drawn,
                                                 const EvaluatedDesign& design,
                                                 const EvaluatedDesign& bearing,
                                                 double element_size) {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<cad::Solid> solids, BearingSolids(drawn, design));
  std::size_t faces = 0;
  for (const cad::Solid& solid : solids) faces += solid.face_names().size();
  if (faces > kMaxFaces) {
    return TooLarge(absl::StrCat("the analysis of parts with ", faces, " faces together"),
                    absl::StrCat(kMaxFaces, " faces: take exact surfaces instead of triangles"));
  }
  MORTISE_ASSIGN_OR_RETURN(mesh::AssemblySurface surface,
                           cad::FuseAssembly(solids, {.element_size = element_size}));
  NameFaces(bearing, surface);
  return surface;
}

absl::StatusOr<mesh::AssemblySurface> SurfaceOf(const templates::Template& function,
                                                const Eigen::VectorXd& parameters,
                                                const EvaluatedDesign& design,
                                                const EvaluatedDesign& bearing,
                                                double element_size) {
  const bool has_shapes =
      std::any_of(bearing.parts.begin(), bearing.parts.end(),
                  [](const EvaluatedPart& part) { return part.faceted.has_value(); });
  if (!has_shapes) return cad::FuseAssembly(parametric::PartShapes(bearing));
  MORTISE_ASSIGN_OR_RETURN(const auto drawn, function.AssemblyAt(parameters));
  if (!drawn) {
    return function.HasExactSurfaces()
               ? SurfaceOfSolid(function, parameters, bearing.parts[0], element_size)
               : SurfaceOf(bearing.parts[0]);
  }
  if (bearing.parts.size() == 1 && !HasExactSurfaces(*drawn, design)) {
    return SurfaceOf(bearing.parts[0]);
  }
  return FuseShapes(*drawn, design, bearing, element_size);
}

// The vertices and edges of a design that is one solid by itself.
std::optional<mesh::ControlVariables> ControlVariablesOf(const templates::Template& function,
                                                         const Eigen::VectorXd& parameters,
                                                         const EvaluatedDesign& bearing,
                                                         double spacing) {
  if (bearing.parts.size() != 1 || !bearing.parts[0].faceted || !function.HasExactSurfaces()) {
    return std::nullopt;
  }
  const auto drawn = function.AssemblyAt(parameters);
  if (!drawn.ok() || drawn->has_value()) return std::nullopt;
  const auto solids = function.Solids(parameters);
  if (!solids.ok()) return std::nullopt;
  auto variables =
      cad::FindControlVariables(solids->front(), bearing.parts[0].faceted->face_names, spacing);
  if (!variables.ok()) return std::nullopt;
  return *std::move(variables);
}

// What conducts heat must say how well.
absl::Status CheckConducts(const DesignModel& model, const EvaluatedDesign& bearing) {
  for (std::size_t p = 0; p < model.analysis.materials.size(); ++p) {
    const Material& material = model.analysis.materials[p];
    if (material.conductivity > 0) continue;
    return PreconditionFailed("NO_CONDUCTIVITY",
                              absl::StrCat(material.name, ", of part '", bearing.parts[p].name,
                                           "', has no thermal_conductivity: heat needs one"),
                              material.name);
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<DesignModel> MakeDesignModel(const templates::Template& function,
                                            const Eigen::VectorXd& parameters,
                                            const EvaluatedDesign& design, const Joining& joining) {
  const EvaluatedDesign bearing = LoadBearing(design);
  DesignModel model;
  for (const EvaluatedPart& part : bearing.parts) {
    MORTISE_ASSIGN_OR_RETURN(Material material, MaterialOf(function.head(), part));
    model.parts.push_back({parametric::PartSurface(part), part.volume, material.density});
    model.analysis.materials.push_back(std::move(material));
  }
  model.cost = CostOf(design, function.head().items);
  if (joining.is_wanted) {
    MORTISE_ASSIGN_OR_RETURN(
        model.surface, SurfaceOf(function, parameters, design, bearing, joining.element_size));
    if (joining.control_variables) {
      model.control_variables = ControlVariablesOf(function, parameters, bearing,
                                                   fields::ControlSpacing(model.surface.vertices));
    }
  }
  MORTISE_RETURN_IF_ERROR(AddConditions(bearing, model));
  if (model.heat) {
    MORTISE_RETURN_IF_ERROR(CheckConducts(model, bearing));
    model.heat->materials = model.analysis.materials;
  }
  return model;
}

std::vector<MetricDescription> MetricsOf(const templates::Template& function) {
  std::vector<MetricDescription> metrics = OfferedMetrics();
  for (MetricDescription& metric : metrics) {
    if (metric.source == MetricSource::kPrices) metric.unit = CurrencyOf(function.head().items);
  }
  return metrics;
}

absl::Status WithLeftOutParts(const absl::Status& failure, const EvaluatedDesign& design) {
  if (DetailOf(failure).reason != "RIGID_MOTION") return failure;
  const std::string message(failure.message());
  std::vector<std::string> left_out;
  for (const EvaluatedPart& connecting : design.parts) {
    if (!connecting.connecting) continue;
    for (const EvaluatedPart& part : design.parts) {
      if (part.connecting || message.find(absl::StrCat("'", part.name, "'")) == message.npos ||
          !Touch(part, connecting)) {
        continue;
      }
      left_out.push_back(absl::StrCat("'", connecting.name, "'"));
      break;
    }
  }
  if (left_out.empty()) return failure;
  const std::size_t more = left_out.size() - std::min(left_out.size(), kNamesTold);
  left_out.resize(left_out.size() - more);
  return PreconditionFailed(
      "RIGID_MOTION",
      absl::StrCat(
          message, "; ", absl::StrJoin(left_out, ", "),
          more == 0 ? "" : absl::StrCat(" and ", more, " more"),
          " only connect, and what only connects is left out: let what bears be principal"),
      "supports");
}

}  // namespace mortise::simulator
