#include "common/assembly/model/rest_pose.h"

#include <Eigen/Geometry>
#include <cmath>

#include "absl/strings/str_cat.h"

namespace mortise::parametric {
namespace {

// A rotation that misses right angles by no more than the digits of an angle typed by hand is meant
// to be one of right angles.
constexpr double kTyped = 1e-4;  // rad
constexpr double kRounding = 1e-12;

Eigen::Matrix3d RotationOf(const Joint& joint, const Eigen::Vector3d& motion) {
  const double angle = motion.norm();
  if (joint.kind == JointKind::kPrismatic || angle == 0) return Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(angle, motion / angle).toRotationMatrix();
  const Eigen::Array33d rounded = rotation.array().round();
  const Eigen::Array33d missed = (rotation.array() - rounded).abs();
  if (missed.maxCoeff() <= kTyped) return rounded;
  // About an axis of the design it takes that axis to itself, but for rounding.
  return (missed <= kRounding).select(rounded, rotation.array());
}

// The centre of an element in a pose: R (p - c) + c + t.
std::array<LinearForm, 3> PosedCenter(const Pose& pose, const Assembly& assembly,
                                      std::size_t elements, int element) {
  std::array<LinearForm, 3> center;
  const Joint& joint = assembly.joints[static_cast<std::size_t>(pose.joint)];
  const Eigen::Matrix3d rotation = RotationOf(joint, pose.motion);
  for (const Axis row : kAxes) {
    const int i = static_cast<int>(row);
    LinearForm& form = center[static_cast<std::size_t>(i)];
    if (joint.kind == JointKind::kPrismatic) {
      form = LinearForm::Variable(CenterVariable(element, row));
      form.constant = pose.motion[i];
      continue;
    }
    form = LinearForm::Variable(JointVariable(elements, pose.joint, row));
    for (const Axis column : kAxes) {
      const double entry = rotation(i, static_cast<int>(column));
      if (entry == 0) continue;
      form = form + entry * (LinearForm::Variable(CenterVariable(element, column)) -
                             LinearForm::Variable(JointVariable(elements, pose.joint, column)));
    }
  }
  return center;
}

class Positions {
 public:
  Positions(const Pose& pose, const Assembly& assembly, const std::vector<Element>& elements)
      : pose_(pose),
        assembly_(assembly),
        elements_(elements),
        drawn_(DrawnParameters(assembly, elements)) {}

  std::vector<PosedPosition> PlanesAndCenters() {
    for (std::size_t e = 0; e < elements_.size(); ++e) {
      const int element = static_cast<int>(e);
      AddCenter(element);
      AddPlanes(element, elements_[e].planes);
    }
    return std::move(positions_);
  }

  std::vector<PosedPosition> Levels() {
    for (std::size_t e = 0; e < elements_.size(); ++e) {
      AddPlanes(static_cast<int>(e), elements_[e].levels);
    }
    return std::move(positions_);
  }

 private:
  const Element& At(int element) const { return elements_[static_cast<std::size_t>(element)]; }

  void Add(int element, Axis axis, LinearForm position, const std::string& what, bool is_center,
           double side) {
    PosedPosition posed;
    posed.element = element;
    posed.axis = axis;
    posed.is_center = is_center;
    posed.is_minimum = !is_center && side == -0.5;
    posed.is_maximum = !is_center && side == 0.5;
    posed.drawn = position.At(drawn_);
    posed.position = std::move(position);
    posed.label = absl::StrCat("'", At(element).name, "' ", what,
                               pose_.name.empty() ? "" : absl::StrCat(" in '", pose_.name, "'"));
    positions_.push_back(std::move(posed));
  }

  bool Moves(int element) const { return MovesIn(pose_, assembly_, At(element)); }

  std::array<LinearForm, 3> CenterOf(int element) const {
    if (Moves(element)) return PosedCenter(pose_, assembly_, elements_.size(), element);
    std::array<LinearForm, 3> center;
    for (const Axis axis : kAxes) {
      center[static_cast<std::size_t>(axis)] = LinearForm::Variable(CenterVariable(element, axis));
    }
    return center;
  }

  void AddCenter(int element) {
    const std::array<LinearForm, 3> center = CenterOf(element);
    for (const Axis axis : kAxes) {
      Add(element, axis, center[static_cast<std::size_t>(axis)],
          absl::StrCat(AxisName(axis), " centre"), true, 0);
    }
  }

  void AddPlanes(int element, const std::vector<ElementPlane>& planes) {
    if (!Moves(element)) {
      for (const ElementPlane& plane : planes) {
        Add(element, plane.axis, PositionOf(elements_, element, plane), plane.name, false,
            plane.fraction);
      }
      return;
    }
    const Joint& joint = assembly_.joints[static_cast<std::size_t>(pose_.joint)];
    const Eigen::Matrix3d rotation = RotationOf(joint, pose_.motion);
    const Eigen::Matrix3d of_box = AxesIn(pose_, assembly_, At(element));
    const std::array<LinearForm, 3> center = CenterOf(element);
    for (const ElementPlane& plane : planes) {
      const Eigen::Matrix3d& turned = std::abs(plane.fraction) == 0.5 ? of_box : rotation;
      for (const Axis axis : kAxes) {
        const double entry = turned(static_cast<int>(axis), static_cast<int>(plane.axis));
        if (std::abs(entry) != 1) continue;
        const LinearForm from_center = PositionOf(elements_, element, plane) -
                                       LinearForm::Variable(CenterVariable(element, plane.axis));
        Add(element, axis, Combine(1, center[static_cast<std::size_t>(axis)], entry, from_center),
            plane.name, false, entry * plane.fraction);
      }
    }
  }

  const Pose& pose_;
  const Assembly& assembly_;
  const std::vector<Element>& elements_;
  const Eigen::VectorXd drawn_;
  std::vector<PosedPosition> positions_;
};

}  // namespace

std::vector<RestPose> RestPosesOf(const Joint& joint) {
  if (!joint.rest_poses.empty() || joint.kind == JointKind::kBall) return joint.rest_poses;
  std::vector<RestPose> ends;
  if (joint.lower != 0) ends.push_back({"lower limit", joint.lower * joint.axis});
  if (joint.upper != 0) ends.push_back({"upper limit", joint.upper * joint.axis});
  return ends;
}

std::vector<Pose> PosesOf(const Assembly& assembly) {
  std::vector<Pose> poses = {Pose{}};
  for (std::size_t j = 0; j < assembly.joints.size(); ++j) {
    const Joint& joint = assembly.joints[j];
    for (const RestPose& rest : RestPosesOf(joint)) {
      poses.push_back({.name = absl::StrCat(joint.name, ": ", rest.name),
                       .moved_group = joint.group,
                       .joint = static_cast<int>(j),
                       .motion = rest.motion});
    }
  }
  return poses;
}

Eigen::VectorXd DrawnParameters(const Assembly& assembly, const std::vector<Element>& elements) {
  const auto joints = static_cast<Eigen::Index>(assembly.joints.size());
  const Eigen::VectorXd of_elements = DrawnParameters(elements);
  Eigen::VectorXd q(of_elements.size() + 3 * joints);
  q.head(of_elements.size()) = of_elements;
  for (Eigen::Index j = 0; j < joints; ++j) {
    q.segment<3>(of_elements.size() + 3 * j) = assembly.joints[static_cast<std::size_t>(j)].center;
  }
  return q;
}

Eigen::Isometry3d MotionIn(const Pose& pose, const Assembly& assembly, std::size_t elements,
                           const Eigen::VectorXd& q) {
  if (pose.joint < 0) return Eigen::Isometry3d::Identity();
  const Joint& joint = assembly.joints[static_cast<std::size_t>(pose.joint)];
  if (joint.kind == JointKind::kPrismatic) {
    return Eigen::Isometry3d(Eigen::Translation3d(pose.motion));
  }
  const Eigen::Vector3d center = q.segment<3>(JointVariable(elements, pose.joint, Axis::kX));
  return Eigen::Translation3d(center) * Eigen::Isometry3d(RotationOf(joint, pose.motion)) *
         Eigen::Translation3d(-center);
}

bool MovesIn(const Pose& pose, const Assembly& assembly, const Element& element) {
  return pose.joint >= 0 && IsWithin(assembly, element.group, pose.moved_group);
}

Eigen::Matrix3d AxesIn(const Pose& pose, const Assembly& assembly, const Element& element) {
  if (!MovesIn(pose, assembly, element)) return Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d rotation =
      RotationOf(assembly.joints[static_cast<std::size_t>(pose.joint)], pose.motion);
  const bool turns_in_place =
      element.round_about &&
      rotation(static_cast<int>(*element.round_about), static_cast<int>(*element.round_about)) == 1;
  return turns_in_place ? Eigen::Matrix3d::Identity() : rotation;
}

OrientedBox BoxIn(const Pose& pose, const Assembly& assembly, const std::vector<Element>& elements,
                  int element, const Eigen::VectorXd& q) {
  OrientedBox box;
  box.center = q.segment<3>(CenterVariable(element, Axis::kX));
  box.half_size = q.segment<3>(SizeVariable(element, Axis::kX)) / 2;
  if (!MovesIn(pose, assembly, elements[static_cast<std::size_t>(element)])) return box;
  const Eigen::Isometry3d motion = MotionIn(pose, assembly, elements.size(), q);
  box.center = motion * box.center;
  box.axes = AxesIn(pose, assembly, elements[static_cast<std::size_t>(element)]);
  return box;
}

LinearForm PlaceIn(const Pose& pose, const Assembly& assembly, const std::vector<Element>& elements,
                   int element, const Eigen::Vector3d& fractions,
                   const Eigen::Vector3d& direction) {
  const Element& placed = elements[static_cast<std::size_t>(element)];
  const bool moves = MovesIn(pose, assembly, placed);
  const Eigen::Matrix3d axes = AxesIn(pose, assembly, placed);
  std::array<LinearForm, 3> center;
  if (moves) center = PosedCenter(pose, assembly, elements.size(), element);
  LinearForm place;
  for (const Axis axis : kAxes) {
    const auto index = static_cast<std::size_t>(axis);
    const int i = static_cast<int>(axis);
    if (!moves) center[index] = LinearForm::Variable(CenterVariable(element, axis));
    place = Combine(1, place, direction[i], center[index]);
    place = Combine(1, place, fractions[i] * axes.col(i).dot(direction),
                    LinearForm::Variable(SizeVariable(element, axis)));
  }
  return place;
}

LinearForm ReachIn(const Pose& pose, const Assembly& assembly, const std::vector<Element>& elements,
                   int element, const Eigen::Vector3d& direction) {
  const Eigen::Matrix3d axes = AxesIn(pose, assembly, elements[static_cast<std::size_t>(element)]);
  const Eigen::Vector3d furthest =
      ((axes.transpose() * direction).array() < 0).select(Eigen::Vector3d::Constant(-0.5), 0.5);
  return PlaceIn(pose, assembly, elements, element, furthest, direction);
}

std::vector<PosedPosition> PositionsIn(const Pose& pose, const Assembly& assembly,
                                       const std::vector<Element>& elements) {
  return Positions(pose, assembly, elements).PlanesAndCenters();
}

int GroupIn(const Pose& pose, const Assembly& assembly, const std::vector<Element>& elements,
            const Element& a, const Element& b, const LinearForm& form) {
  int common = LowestCommonGroup(assembly, a.group, b.group);
  for (const LinearTerm& term : form.terms) {
    const auto element = static_cast<std::size_t>(term.variable / 6);
    if (element >= elements.size()) continue;  // a joint's
    common = LowestCommonGroup(assembly, common, elements[element].group);
  }
  if (pose.joint < 0) return common;
  const int home = assembly.groups[static_cast<std::size_t>(pose.moved_group)].parent;
  return LowestCommonGroup(assembly, common, home);
}

std::vector<PosedPosition> LevelsIn(const Pose& pose, const Assembly& assembly,
                                    const std::vector<Element>& elements) {
  return Positions(pose, assembly, elements).Levels();
}

}  // namespace mortise::parametric
