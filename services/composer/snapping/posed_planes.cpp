#include "services/composer/snapping/posed_planes.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/model/element.h"
#include "common/assembly/model/rest_pose.h"

namespace mortise::composer {
namespace {

using parametric::BoundingBox;
using parametric::Element;
using parametric::LinearForm;
using parametric::ParametricAssembly;
using parametric::Pose;
using parametric::PosedPosition;

constexpr double kSame = 1e-6;  // of a distance, its change over the feasible set

std::set<std::string> PartNames(const ParametricAssembly& assembly, const Element& element) {
  std::set<std::string> names;
  for (const int part : element.parts) {
    names.insert(assembly.assembly().parts[static_cast<std::size_t>(part)].name);
  }
  return names;
}

class PosedPlanes {
 public:
  PosedPlanes(const Design& original, const Design& component)
      : original_(*original.assembly), component_(*component.assembly), now_(InSpace(component)) {
    std::map<std::set<std::string>, int> elements;
    for (std::size_t e = 0; e < component_.elements().size(); ++e) {
      elements.emplace(PartNames(component_, component_.elements()[e]), static_cast<int>(e));
    }
    for (std::size_t e = 0; e < original_.elements().size(); ++e) {
      const auto found = elements.find(PartNames(original_, original_.elements()[e]));
      if (found != elements.end()) in_component_.emplace(static_cast<int>(e), found->second);
    }
  }

  std::vector<DesignPlane> Find() const {
    std::vector<DesignPlane> planes;
    for (const Pose& pose : parametric::PosesOf(original_.assembly())) {
      if (pose.joint < 0 || !MovesAll(pose)) continue;
      AddPlanes(pose, planes);
    }
    return planes;
  }

 private:
  // Whether the pose moves all of the component.
  bool MovesAll(const Pose& pose) const {
    std::set<std::string> moved;
    for (const parametric::AssemblyPart& part : original_.assembly().parts) {
      if (parametric::IsWithin(original_.assembly(), part.group, pose.moved_group)) {
        moved.insert(part.name);
      }
    }
    for (const parametric::AssemblyPart& part : component_.assembly().parts) {
      if (!part.connecting && !moved.contains(part.name)) return false;
    }
    return true;
  }

  void AddPlanes(const Pose& pose, std::vector<DesignPlane>& planes) const {
    const std::vector<PosedPosition> positions =
        parametric::PositionsIn(pose, original_.assembly(), original_.elements());
    const std::map<int, BoundingBox> boxes = BoxesIn(positions);
    const std::array<std::optional<LinearForm>, 3> center = CenterOf(pose.joint);
    for (const PosedPosition& its : positions) {
      if (its.is_center || !(its.is_minimum || its.is_maximum)) continue;
      const auto element = in_component_.find(its.element);
      if (element == in_component_.end()) continue;
      const Element& own = component_.elements()[static_cast<std::size_t>(element->second)];
      if (own.connecting || !Bounds(its, boxes) || !IsMoved(its)) continue;
      std::optional<LinearForm> position = InComponent(its.position, pose.joint, center);
      if (!position) continue;
      const BoundingBox& box = boxes.at(its.element);
      DesignPlane& plane = planes.emplace_back();
      plane.owner = own.name;
      plane.name = absl::StrCat(AxisName(its.axis), its.is_maximum ? " maximum" : " minimum",
                                " in '", pose.name, "'");
      plane.axis = its.axis;
      plane.side = its.is_maximum ? PlaneSide::kMaximum : PlaneSide::kMinimum;
      plane.is_broad = IsBroadAcross(box, its.axis);
      plane.now = position->At(now_);
      plane.extent = box.size()[static_cast<int>(its.axis)];
      plane.position = *std::move(position);
      plane.in_original = PlaneInOriginal{pose.moved_group, box, its.drawn};
    }
  }

  // Whether the face bounds the component in the pose.
  bool Bounds(const PosedPosition& its, const std::map<int, BoundingBox>& boxes) const {
    const int axis = static_cast<int>(its.axis);
    return std::none_of(boxes.begin(), boxes.end(), [&](const auto& box) {
      if (!in_component_.contains(box.first)) return false;
      if (original_.elements()[static_cast<std::size_t>(box.first)].connecting) return false;
      return its.is_maximum ? box.second.maximum[axis] > its.drawn + original_.tolerance()
                            : box.second.minimum[axis] < its.drawn - original_.tolerance();
    });
  }

  // Whether the face lies elsewhere than as drawn.
  static bool IsMoved(const PosedPosition& its) {
    const LinearForm drawn =
        parametric::PositionOf(its.element, {"", its.axis, its.is_maximum ? 0.5 : -0.5, false});
    const LinearForm moved = its.position - drawn;
    return !moved.terms.empty() || moved.constant != 0;
  }

  // The boxes of elements that their faces bound.
  static std::map<int, BoundingBox> BoxesIn(const std::vector<PosedPosition>& positions) {
    std::map<int, BoundingBox> boxes;
    for (const PosedPosition& its : positions) {
      const int axis = static_cast<int>(its.axis);
      if (its.is_minimum) boxes[its.element].minimum[axis] = its.drawn;
      if (its.is_maximum) boxes[its.element].maximum[axis] = its.drawn;
    }
    return boxes;
  }

  // The centre of a joint by the faces of the component from which it keeps its distance.
  std::array<std::optional<LinearForm>, 3> CenterOf(int joint) const {
    std::array<std::optional<LinearForm>, 3> center;
    for (const Axis axis : parametric::kAxes) {
      const LinearForm its =
          LinearForm::Variable(parametric::JointVariable(original_.elements().size(), joint, axis));
      for (const auto& [outer, inner] : in_component_) {
        if (original_.elements()[static_cast<std::size_t>(outer)].connecting) continue;
        for (const double side : {-0.5, 0.5}) {
          const parametric::ElementPlane face{"", axis, side, false};
          const LinearForm apart = its - parametric::PositionOf(outer, face);
          if (!IsConstant(apart)) continue;
          LinearForm form = parametric::PositionOf(inner, face);
          form.constant += apart.At(original_.drawn());
          center[static_cast<std::size_t>(axis)] = std::move(form);
          break;
        }
        if (center[static_cast<std::size_t>(axis)]) break;
      }
    }
    return center;
  }

  bool IsConstant(const LinearForm& form) const {
    const Eigen::MatrixXd& basis = original_.feasible_set().basis();
    Eigen::RowVectorXd change = Eigen::RowVectorXd::Zero(basis.cols());
    for (const parametric::LinearTerm& term : form.terms) {
      change += term.coefficient * basis.row(term.variable);
    }
    return change.norm() <= kSame;
  }

  // A form of the original's parameters as one of the component's.
  std::optional<LinearForm> InComponent(
      const LinearForm& form, int joint,
      const std::array<std::optional<LinearForm>, 3>& center) const {
    const int first_center =
        parametric::JointVariable(original_.elements().size(), joint, Axis::kX);
    LinearForm made;
    made.constant = form.constant;
    for (const parametric::LinearTerm& term : form.terms) {
      if (term.coefficient == 0) continue;
      const int of_joint = term.variable - first_center;
      if (of_joint >= 0 && of_joint < 3) {
        const std::optional<LinearForm>& its = center[static_cast<std::size_t>(of_joint)];
        if (!its) return std::nullopt;
        made = parametric::Combine(1, made, term.coefficient, *its);
        continue;
      }
      const auto element = in_component_.find(term.variable / 6);
      if (term.variable >= first_center || element == in_component_.end()) return std::nullopt;
      made = parametric::Combine(1, made, term.coefficient,
                                 LinearForm::Variable(6 * element->second + term.variable % 6));
    }
    return made;
  }

  const ParametricAssembly& original_;
  const ParametricAssembly& component_;
  const Eigen::VectorXd now_;
  std::map<int, int> in_component_;  // by element of the original, the same of the component
};

}  // namespace

std::vector<DesignPlane> PlanesInPosesOf(const Design& original, const Design& component) {
  return PosedPlanes(original, component).Find();
}

}  // namespace mortise::composer
