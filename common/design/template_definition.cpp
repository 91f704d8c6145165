// Look-ups among the plain structs of templates and designs.
#include "common/design/template_definition.h"

#include <algorithm>

#include "common/design/evaluated_design.h"

namespace mortise::parametric {
namespace {

template <typename Named>
const Named* FindByName(const std::vector<Named>& entries, const std::string& name) {
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [&name](const Named& entry) { return entry.name == name; });
  return found == entries.end() ? nullptr : &*found;
}

}  // namespace

const char* AxisName(Axis axis) {
  switch (axis) {
    case Axis::kX:
      return "x";
    case Axis::kY:
      return "y";
    case Axis::kZ:
      break;
  }
  return "z";
}

const Item* FindItem(const std::vector<Item>& items, const std::string& name) {
  return FindByName(items, name);
}

const Material* FindMaterial(const std::vector<Material>& materials, const std::string& name) {
  return FindByName(materials, name);
}

int FindPart(const EvaluatedDesign& design, const std::string& name) {
  const EvaluatedPart* part = FindByName(design.parts, name);
  return part == nullptr ? -1 : static_cast<int>(part - design.parts.data());
}

Eigen::Vector3d FromPrismAxes(Axis axis, double u, double v, double along) {
  switch (axis) {
    case Axis::kX:
      return {along, u, v};
    case Axis::kY:
      return {v, along, u};
    case Axis::kZ:
      break;
  }
  return {u, v, along};
}

}  // namespace mortise::parametric
