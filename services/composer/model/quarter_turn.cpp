#include "services/composer/model/quarter_turn.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "common/assembly/model/element.h"
#include "common/base/errors.h"
#include "common/mesh/shapes/drawn_shape.h"

namespace mortise::composer {
namespace {

using parametric::BoundingBox;
using parametric::Element;
using parametric::ParametricAssembly;

constexpr double kFeasible = 1e-9;  // m, by which relationships may be missed

// One quarter turn about an axis: the next axis becomes the one after it.
Eigen::Matrix3d QuarterTurn(Axis axis) {
  const int about = static_cast<int>(axis);
  const int next = (about + 1) % 3, last = (about + 2) % 3;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
  turn(about, about) = 1;
  turn(last, next) = 1;
  turn(next, last) = -1;
  return turn;
}

// Exact; zeros have no sign.
Eigen::Vector3d Turned(const Eigen::Vector3d& v, const Eigen::Matrix3d& turn) {
  return (turn * v).array() + 0.0;
}

Axis Turned(Axis axis, const Eigen::Matrix3d& turn) {
  Eigen::Index becomes = 0;
  turn.col(static_cast<int>(axis)).cwiseAbs().maxCoeff(&becomes);
  return static_cast<Axis>(becomes);
}

void Turn(parametric::AssemblyPart& part, const Eigen::Matrix3d& turn) {
  part.box = composer::Turned(part.box, turn);
  const std::array<parametric::SizeLimits, 3> limits = part.limits;
  for (const Axis axis : parametric::kAxes) {
    part.limits[static_cast<std::size_t>(Turned(axis, turn))] =
        limits[static_cast<std::size_t>(axis)];
  }
  for (Axis& axis : part.item_axes) axis = Turned(axis, turn);
  for (parametric::ProminentPlane& plane : part.prominent_planes) {
    const int axis = static_cast<int>(plane.axis);
    const Eigen::Vector3d there = Turned(plane.position * Eigen::Vector3d::Unit(axis), turn);
    plane.axis = Turned(plane.axis, turn);
    plane.position = there[static_cast<int>(plane.axis)];
  }
}

void Turn(parametric::Joint& joint, const Eigen::Matrix3d& turn) {
  joint.center = Turned(joint.center, turn);
  joint.axis = Turned(joint.axis, turn);
  for (parametric::RestPose& pose : joint.rest_poses) pose.motion = Turned(pose.motion, turn);
}

// The shape turned by one quarter turn. Only turns after which x and z point forwards are at hand;
// about x that is the turn backwards, and about y it takes the two others.
mesh::DrawnShape TurnedOnce(const mesh::DrawnShape& shape, Axis axis) {
  const auto about_z = [](const mesh::DrawnShape& each) { return mesh::Turned(each, 1, 2); };
  const auto about_x = [](const mesh::DrawnShape& each) {
    return mesh::Turned(mesh::Turned(mesh::Turned(each, 0, 1), 0, 1), 0, 1);
  };
  if (axis == Axis::kZ) return about_z(shape);
  if (axis == Axis::kX) return about_x(shape);
  return about_z(about_x(about_z(about_z(about_z(shape)))));
}

// Of each element of a design, the names of its parts as drawn.
std::set<std::string> PartNames(const ParametricAssembly& assembly, const Element& element) {
  std::set<std::string> names;
  for (const int part : element.parts) {
    names.insert(assembly.assembly().parts[static_cast<std::size_t>(part)].name);
  }
  return names;
}

// The parameters of the design turned about a point, in space: those of the element and joint of
// the same names. What there is nothing like stays as it is drawn.
Eigen::VectorXd TurnedParameters(const Design& design, const ParametricAssembly& turned,
                                 const Eigen::Matrix3d& turn, const Eigen::Vector3d& about) {
  const ParametricAssembly& before = *design.assembly;
  const Eigen::VectorXd q = InSpace(design);
  std::map<std::set<std::string>, int> elements;
  for (const Element& element : before.elements()) {
    elements.emplace(PartNames(before, element), static_cast<int>(elements.size()));
  }
  const auto place = [&](const Eigen::Vector3d& at) {
    return Eigen::Vector3d(Turned(at - about, turn) + about);
  };
  Eigen::VectorXd made = turned.drawn();
  for (std::size_t e = 0; e < turned.elements().size(); ++e) {
    const auto found = elements.find(PartNames(turned, turned.elements()[e]));
    if (found == elements.end()) continue;
    const int center = parametric::CenterVariable(static_cast<int>(e), Axis::kX);
    const int size = parametric::SizeVariable(static_cast<int>(e), Axis::kX);
    made.segment<3>(center) =
        place(q.segment<3>(parametric::CenterVariable(found->second, Axis::kX)));
    made.segment<3>(size) =
        turn.cwiseAbs() * q.segment<3>(parametric::SizeVariable(found->second, Axis::kX));
  }
  for (std::size_t j = 0; j < turned.assembly().joints.size(); ++j) {
    const auto joint = static_cast<int>(j);
    made.segment<3>(parametric::JointVariable(turned.elements().size(), joint, Axis::kX)) =
        place(q.segment<3>(parametric::JointVariable(before.elements().size(), joint, Axis::kX)));
  }
  return made;
}

Eigen::Vector3d FootOf(const Design& design) {
  const BoundingBox box = BoundsOf(design);
  return {box.center().x(), box.center().y(), box.minimum.z()};
}

}  // namespace

Eigen::Matrix3d TurnOf(const std::vector<Axis>& quarter_turns) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  for (const Axis axis : quarter_turns) turn = QuarterTurn(axis) * turn;
  return turn;
}

std::vector<Axis> QuarterTurnsOf(const Eigen::Matrix3d& turn) {
  std::vector<std::vector<Axis>> known = {{}};
  std::vector<Eigen::Matrix3d> turns = {Eigen::Matrix3d::Identity()};
  for (std::size_t i = 0; i < known.size(); ++i) {
    if ((turns[i] - turn).cwiseAbs().maxCoeff() < 0.5) return known[i];
    for (const Axis axis : parametric::kAxes) {
      const Eigen::Matrix3d next = QuarterTurn(axis) * turns[i];
      const bool is_known = std::any_of(turns.begin(), turns.end(), [&](const auto& other) {
        return (other - next).cwiseAbs().maxCoeff() < 0.5;
      });
      if (is_known) continue;
      std::vector<Axis> longer = known[i];
      longer.push_back(axis);
      known.push_back(std::move(longer));
      turns.push_back(next);
    }
  }
  return {};
}

BoundingBox Turned(const BoundingBox& box, const Eigen::Matrix3d& turn) {
  const Eigen::Vector3d a = Turned(box.minimum, turn);
  const Eigen::Vector3d b = Turned(box.maximum, turn);
  return {a.cwiseMin(b), a.cwiseMax(b)};
}

parametric::Assembly Turned(parametric::Assembly assembly, const Eigen::Matrix3d& turn) {
  const std::vector<Axis> quarters = QuarterTurnsOf(turn);
  if (quarters.empty()) return assembly;
  // Parts that share a shape go on sharing one.
  std::map<const mesh::DrawnShape*, std::shared_ptr<const mesh::DrawnShape>> shapes;
  const auto turned_shape = [&](const std::shared_ptr<const mesh::DrawnShape>& shape) {
    std::shared_ptr<const mesh::DrawnShape>& known = shapes[shape.get()];
    if (known == nullptr) {
      mesh::DrawnShape made = *shape;
      for (const Axis axis : quarters) made = TurnedOnce(made, axis);
      known = std::make_shared<const mesh::DrawnShape>(std::move(made));
    }
    return known;
  };
  for (parametric::AssemblyPart& part : assembly.parts) {
    Turn(part, turn);
    if (part.shape != nullptr) part.shape = turned_shape(part.shape);
  }
  for (parametric::Joint& joint : assembly.joints) Turn(joint, turn);
  return assembly;
}

absl::StatusOr<Design> Turned(const Design& design,
                              std::shared_ptr<const ParametricAssembly> turned,
                              const Eigen::Matrix3d& turn) {
  Eigen::VectorXd q = TurnedParameters(design, *turned, turn, BoundsOf(design).center());
  const parametric::FeasibleSet free = turned->FreeInSpace();
  // Where a design of the turned assembly is told apart otherwise, by the order of its axes, the
  // nearest one will do.
  if (!free.Violations(q, kFeasible).empty()) {
    MORTISE_ASSIGN_OR_RETURN(q, free.Nearest(q));
  }
  Design made = FromSpace(std::move(turned), q);
  made.shift += FootOf(design) - FootOf(made);
  return made;
}

}  // namespace mortise::composer
