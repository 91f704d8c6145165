#include "services/composer/snapping/plane.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/model/element.h"
#include "common/assembly/model/rest_pose.h"

namespace mortise::composer {
namespace {

using parametric::Element;
using parametric::ParametricAssembly;

// The six planes of a box come first in Element::planes.
constexpr std::size_t kFaces = 6;

void AddFaces(const std::vector<PrincipalPart>& parts, std::vector<DesignPlane>& planes) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (const Axis axis : parametric::kAxes) {
      const int at = static_cast<int>(axis);
      for (const bool upper : {false, true}) {
        DesignPlane& plane = planes.emplace_back();
        plane.part = static_cast<int>(i);
        plane.owner = parts[i].name;
        plane.name = absl::StrCat(AxisName(axis), upper ? " maximum" : " minimum");
        plane.axis = axis;
        plane.side = upper ? PlaneSide::kMaximum : PlaneSide::kMinimum;
        plane.is_broad = IsBroadAcross(parts[i].box, axis);
        plane.position = FaceOf(parts[i], axis, upper);
        plane.now = upper ? parts[i].box.maximum[at] : parts[i].box.minimum[at];
        plane.extent = parts[i].box.size()[at];
      }
    }
  }
}

void AddProminent(const Design& design, std::vector<DesignPlane>& planes) {
  const std::vector<Element>& elements = design.assembly->elements();
  for (std::size_t e = 0; e < elements.size(); ++e) {
    if (elements[e].connecting) continue;
    for (std::size_t k = kFaces; k < elements[e].planes.size(); ++k) {
      const parametric::ElementPlane& its = elements[e].planes[k];
      DesignPlane& plane = planes.emplace_back();
      plane.owner = elements[e].name;
      plane.name = its.name;
      plane.axis = its.axis;
      plane.position = parametric::PositionOf(elements, static_cast<int>(e), its);
      plane.now = plane.position.At(design.q) + design.shift[static_cast<int>(its.axis)];
    }
  }
}

void AddPosed(const Design& design, std::vector<DesignPlane>& planes) {
  const ParametricAssembly& assembly = *design.assembly;
  for (const parametric::Pose& pose : parametric::PosesOf(assembly.assembly())) {
    if (pose.joint < 0) continue;
    for (parametric::PosedPosition& its :
         parametric::PositionsIn(pose, assembly.assembly(), assembly.elements())) {
      const Element& element = assembly.elements()[static_cast<std::size_t>(its.element)];
      if (element.connecting || its.is_center || !(its.is_minimum || its.is_maximum) ||
          !parametric::MovesIn(pose, assembly.assembly(), element)) {
        continue;
      }
      DesignPlane& plane = planes.emplace_back();
      plane.owner = element.name;
      plane.name = absl::StrCat(AxisName(its.axis), its.is_maximum ? " maximum" : " minimum",
                                " in '", pose.name, "'");
      plane.axis = its.axis;
      plane.side = its.is_maximum ? PlaneSide::kMaximum : PlaneSide::kMinimum;
      plane.now = its.position.At(design.q) + design.shift[static_cast<int>(its.axis)];
      plane.position = std::move(its.position);
    }
  }
}

}  // namespace

std::vector<DesignPlane> PlanesOf(const Design& design, const std::vector<PrincipalPart>& parts) {
  std::vector<DesignPlane> planes;
  AddFaces(parts, planes);
  AddProminent(design, planes);
  AddPosed(design, planes);
  return planes;
}

std::string Describe(const DesignPlane& plane) {
  return absl::StrCat("'", plane.owner, "' ", plane.name);
}

}  // namespace mortise::composer
