#include "services/composer/model/design.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "common/assembly/model/element.h"
#include "common/assembly/model/rest_pose.h"
#include "common/base/errors.h"
#include "common/cad/stretch/solid_shape.h"
#include "services/composer/model/names.h"

namespace mortise::composer {
namespace {

using parametric::AssemblyPart;
using parametric::BoundingBox;
using parametric::Element;
using parametric::ParametricAssembly;
using parametric::PlacedPart;

constexpr double kSamePlace = 1e-9;      // m
constexpr double kHardlyChanged = 1e-4;  // of a size
constexpr double kLittle = 0.05;         // of the largest change of a size in proportion

// Whether a shape so stretched looks the same as stretched in proportion.
bool IsInProportion(const mesh::BoxStretch& stretch) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const mesh::LevelPlace& level : stretch.levels[static_cast<std::size_t>(axis)]) {
      if (std::abs(level.place - level.fraction * stretch.size[axis]) > kSamePlace) return false;
    }
  }
  return true;
}

// The shape as it is stretched, as if it had been drawn so. `divided` is the same, with its
// triangles cut at the levels of the stretch (ShapeOf).
absl::StatusOr<std::shared_ptr<const mesh::DrawnShape>> ShapeStretched(
    const std::shared_ptr<const mesh::DrawnShape>& shape,
    const std::shared_ptr<const mesh::DrawnShape>& divided, const mesh::BoxStretch& stretch,
    const std::string& name) {
  if (divided == nullptr) return divided;
  if (IsInProportion(stretch)) return shape;
  if (!divided->brep.empty()) {
    MORTISE_ASSIGN_OR_RETURN(const cad::Solid solid, cad::SolidOfShape(*divided, stretch, name));
    MORTISE_ASSIGN_OR_RETURN(mesh::DrawnShape made,
                             cad::ShapeOfSolid(solid, Eigen::Matrix3d::Identity(),
                                               Eigen::Vector3d::Zero(), stretch.size));
    return std::make_shared<const mesh::DrawnShape>(std::move(made));
  }
  mesh::DrawnShape made = *divided;
  made.name.clear();
  made.size = stretch.size;
  made.volume = mesh::VolumeIn(*divided, stretch);
  made.deflection = mesh::DeflectionIn(*divided, stretch);
  const mesh::SurfaceMesh surface = mesh::SurfaceIn(*divided, stretch);
  made.fractions = stretch.size.cwiseInverse().asDiagonal() * surface.vertices;
  made.missed_volumes.resize(0);
  made.turn.setIdentity();
  mesh::DeriveFaces(made);
  return std::make_shared<const mesh::DrawnShape>(std::move(made));
}

// Prominent planes go where the part's stretch takes them; beyond the box they keep their distance
// from its middle in proportion.
void MovePlanes(const AssemblyPart& drawn, const PlacedPart& placed, AssemblyPart& made) {
  for (parametric::ProminentPlane& plane : made.prominent_planes) {
    const int axis = static_cast<int>(plane.axis);
    const double fraction = (plane.position - drawn.box.center()[axis]) / drawn.box.size()[axis];
    const double place = std::abs(fraction) <= 0.5 ? placed.stretch.PlaceOf(axis, fraction)
                                                   : fraction * placed.box.size()[axis];
    plane.position = placed.box.center()[axis] + place;
  }
}

// Sizes keep their limits to within rounding.
void KeepLimits(AssemblyPart& part) {
  for (int axis = 0; axis < 3; ++axis) {
    const parametric::SizeLimits& limits = part.limits[static_cast<std::size_t>(axis)];
    const double size = part.box.size()[axis];
    const double kept = std::clamp(size, limits.minimum, limits.maximum);
    if (kept == size || std::abs(kept - size) > 1e-7) continue;
    const double center = part.box.center()[axis];
    part.box.minimum[axis] = center - kept / 2;
    part.box.maximum[axis] = center + kept / 2;
  }
}

}  // namespace

absl::StatusOr<Design> AsDrawn(parametric::Assembly assembly,
                               const std::vector<const ParametricAssembly*>& known) {
  MORTISE_ASSIGN_OR_RETURN(ParametricAssembly made, ParametricAssembly::Create(
                                                        std::move(assembly), [] { return false; },
                                                        known, parametric::LoosePolicy::kHold));
  auto shared = std::make_shared<const ParametricAssembly>(std::move(made));
  Eigen::VectorXd drawn = shared->drawn();
  return Design{std::move(shared), std::move(drawn)};
}

std::vector<PlacedPart> PartsOf(const Design& design) {
  std::vector<PlacedPart> parts = design.assembly->PartsAt(design.q);
  for (PlacedPart& part : parts) {
    part.box.minimum += design.shift;
    part.box.maximum += design.shift;
  }
  return parts;
}

BoundingBox BoundsOf(const Design& design) {
  const std::vector<PlacedPart> parts = PartsOf(design);
  BoundingBox bounds = parts.front().box;
  for (const PlacedPart& part : parts) {
    bounds.minimum = bounds.minimum.cwiseMin(part.box.minimum);
    bounds.maximum = bounds.maximum.cwiseMax(part.box.maximum);
  }
  return bounds;
}

BoundingBox ElementBox(const Design& design, int element) {
  BoundingBox box = parametric::BoxOf(design.q, element);
  box.minimum += design.shift;
  box.maximum += design.shift;
  return box;
}

absl::StatusOr<Redrawn> Redraw(const Design& design) {
  const parametric::Assembly& drawn = design.assembly->assembly();
  const std::vector<Element>& elements = design.assembly->elements();
  Redrawn made;
  made.assembly.name = drawn.name;
  made.assembly.groups = drawn.groups;
  std::set<std::string> taken;
  std::vector<int> seen(elements.size(), 0);
  for (const PlacedPart& placed : PartsOf(design)) {
    const Element& element = elements[static_cast<std::size_t>(placed.element)];
    const auto index = static_cast<std::size_t>(seen[static_cast<std::size_t>(placed.element)]++);
    const AssemblyPart& original = drawn.parts[static_cast<std::size_t>(
        index < element.parts.size() ? element.parts[index] : element.parts.front())];
    AssemblyPart& part = made.assembly.parts.emplace_back(original);
    part.name = TakeName(placed.name, taken);
    part.box = placed.box;
    MovePlanes(original, placed, part);
    KeepLimits(part);
    MORTISE_ASSIGN_OR_RETURN(
        part.shape, ShapeStretched(original.shape, element.shape, placed.stretch, part.name));
    made.drawn_as.push_back(original.name);
  }
  made.assembly.joints = drawn.joints;
  for (std::size_t j = 0; j < drawn.joints.size(); ++j) {
    made.assembly.joints[j].center = design.q.segment<3>(parametric::JointVariable(
                                         elements.size(), static_cast<int>(j), Axis::kX)) +
                                     design.shift;
  }
  return made;
}

absl::StatusOr<parametric::Assembly> DrawnAt(const Design& design) {
  MORTISE_ASSIGN_OR_RETURN(Redrawn redrawn, Redraw(design));
  return std::move(redrawn.assembly);
}

absl::StatusOr<Design> Settled(Design design) {
  MORTISE_ASSIGN_OR_RETURN(
      parametric::Adjustment placed,
      design.assembly->Adjust(design.q, {}, parametric::DemandPolicy::kNearest));
  design.q = std::move(placed.q);
  return design;
}

Eigen::VectorXd ChangeScales(const ParametricAssembly& assembly, double of_places) {
  Eigen::VectorXd scales = Eigen::VectorXd::Constant(assembly.drawn().size(), of_places);
  for (std::size_t e = 0; e < assembly.elements().size(); ++e) {
    const int size = parametric::SizeVariable(static_cast<int>(e), Axis::kX);
    scales.segment<3>(size) = assembly.drawn().segment<3>(size);
  }
  return scales;
}

std::vector<int> SizesToKeep(const ParametricAssembly& assembly, const Eigen::VectorXd& before,
                             const Eigen::VectorXd& after) {
  std::vector<std::pair<int, double>> changes;  // in proportion
  double largest = 0;
  for (std::size_t e = 0; e < assembly.elements().size(); ++e) {
    if (assembly.elements()[e].connecting) continue;
    for (const Axis axis : parametric::kAxes) {
      const int size = parametric::SizeVariable(static_cast<int>(e), axis);
      changes.emplace_back(size, std::abs(after[size] - before[size]) / before[size]);
      largest = std::max(largest, changes.back().second);
    }
  }
  std::vector<int> kept;
  for (const auto& [size, change] : changes) {
    if (change > 0 && change <= std::max(kHardlyChanged, kLittle * largest)) kept.push_back(size);
  }
  return kept;
}

Eigen::VectorXd InSpace(const Design& design) {
  return design.q + design.assembly->Translations() * design.shift;
}

Design FromSpace(std::shared_ptr<const ParametricAssembly> assembly,
                 const Eigen::VectorXd& in_space) {
  Design design;
  for (int axis = 0; axis < 3; ++axis) {
    design.shift[axis] = assembly->standing()[static_cast<std::size_t>(axis)].At(in_space);
  }
  design.q = in_space - assembly->Translations() * design.shift;
  design.assembly = std::move(assembly);
  return design;
}

}  // namespace mortise::composer
