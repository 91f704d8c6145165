#include "services/composer/connecting/original_fit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "common/assembly/model/element.h"
#include "common/base/errors.h"

namespace mortise::composer {
namespace {

using parametric::BoundingBox;
using parametric::Element;
using parametric::ParametricAssembly;

// m, by which changes are measured: of what the component has, and of all else.
constexpr double kOfComponent = 1e-3;
constexpr double kOfRest = 1;

void Enclose(const BoundingBox& box, std::optional<BoundingBox>& around) {
  if (!around) around = box;
  around->minimum = around->minimum.cwiseMin(box.minimum);
  around->maximum = around->maximum.cwiseMax(box.maximum);
}

// By part of the original: the box around it and its copies as the component has them now.
std::map<std::string, BoundingBox> BoxesOf(const std::vector<PrincipalPart>& component) {
  std::map<std::string, BoundingBox> boxes;
  for (const PrincipalPart& part : component) {
    std::optional<BoundingBox> around;
    const auto known = boxes.find(part.drawn_as);
    if (known != boxes.end()) around = known->second;
    Enclose(part.box, around);
    boxes[part.drawn_as] = *around;
  }
  return boxes;
}

// What of an element of the original the component has: as drawn, and as it is now.
struct Shared {
  std::optional<BoundingBox> drawn, now;
};

Shared SharedOf(const ParametricAssembly& original, const Element& element,
                const std::map<std::string, BoundingBox>& component) {
  Shared shared;
  for (const int index : element.parts) {
    const parametric::AssemblyPart& part =
        original.assembly().parts[static_cast<std::size_t>(index)];
    const auto found = component.find(part.name);
    if (found == component.end()) continue;
    Enclose(part.box, shared.drawn);
    Enclose(found->second, shared.now);
  }
  return shared;
}

}  // namespace

absl::StatusOr<std::vector<PrincipalPart>> FitOriginal(const Design& original,
                                                       const Design& component) {
  const ParametricAssembly& assembly = *original.assembly;
  const std::map<std::string, BoundingBox> boxes = BoxesOf(PrincipalPartsOf(component));
  Eigen::VectorXd wish = assembly.drawn();
  Eigen::VectorXd scales = Eigen::VectorXd::Constant(wish.size(), kOfRest);
  Eigen::Vector3d moved = Eigen::Vector3d::Zero();
  int elements = 0;
  std::vector<Shared> shared;
  for (const Element& element : assembly.elements()) {
    shared.push_back(element.connecting ? Shared{} : SharedOf(assembly, element, boxes));
    if (!shared.back().now) continue;
    moved += shared.back().now->center() - shared.back().drawn->center();
    ++elements;
  }
  if (elements > 0) wish += assembly.Translations() * (moved / elements);
  for (std::size_t e = 0; e < shared.size(); ++e) {
    if (!shared[e].now) continue;
    const BoundingBox& drawn = assembly.elements()[e].box;
    for (const Axis axis : parametric::kAxes) {
      const int a = static_cast<int>(axis);
      const double beyond = std::max(std::abs(shared[e].drawn->minimum[a] - drawn.minimum[a]),
                                     std::abs(shared[e].drawn->maximum[a] - drawn.maximum[a]));
      if (beyond > assembly.tolerance()) continue;  // the component has some of the row
      const int center = parametric::CenterVariable(static_cast<int>(e), axis);
      const int size = parametric::SizeVariable(static_cast<int>(e), axis);
      wish[center] = shared[e].now->center()[a];
      wish[size] = shared[e].now->size()[a];
      scales[center] = scales[size] = kOfComponent;
    }
  }
  MORTISE_ASSIGN_OR_RETURN(const parametric::FeasibleSet nearness,
                           assembly.FreeInSpace().Rescaled(scales));
  MORTISE_ASSIGN_OR_RETURN(const Eigen::VectorXd fitted, nearness.Nearest(wish));
  return PrincipalPartsOf(FromSpace(original.assembly, fitted));
}

}  // namespace mortise::composer
