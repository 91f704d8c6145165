// An expert's design as it comes from CAD: parts in a hierarchy of groups, with the annotations
// that automatic parametrisation needs (thesis §3.2.2). The input of §3.4.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/design/template_definition.h"
#include "common/design/template_validation.h"
#include "common/mesh/shapes/drawn_shape.h"

namespace mortise::parametric {

// m; assemblies, and designs of them, lie within this along every axis.
inline constexpr double kFurthestFromOrigin = 10e3;

// m; parts are at least as large along every axis.
inline constexpr double kSmallestPart = 1e-6;

// rad; joints turn no further, either way: sixteen turns.
inline constexpr double kFurthestTurn = 100;

// rad; the largest angle that a ball turns by, half a turn as people write it.
inline constexpr double kHalfTurn = 3.1416;

// The bounding box of a part, in metres, in the design's coordinates.
struct BoundingBox {
  Eigen::Vector3d minimum = Eigen::Vector3d::Zero();
  Eigen::Vector3d maximum = Eigen::Vector3d::Zero();

  Eigen::Vector3d center() const { return (minimum + maximum) / 2; }
  Eigen::Vector3d size() const { return maximum - minimum; }
};

// What sizes a part may take along one axis of the design, m. Equal where the size is fixed.
struct SizeLimits {
  double minimum = 0;
  double maximum = 0;
};

// A plane of a part, besides the six of its bounding box, that others may align with.
struct ProminentPlane {
  std::string name;
  Axis axis = Axis::kX;  // its normal
  double position = 0;   // m, along the axis
};

struct AssemblyPart {
  std::string name;  // distinct within the assembly
  std::string item;  // items/{id}
  int group = 0;     // index into Assembly::groups
  // Purely structural: screws, hinges, brackets. Placed by connections, not by the designer.
  bool connecting = false;
  BoundingBox box;
  std::array<SizeLimits, 3> limits;  // by axis of the design
  // The axis of the design along which each of the item's three lies: length, width, thickness.
  std::array<Axis, 3> item_axes = {Axis::kX, Axis::kY, Axis::kZ};
  std::vector<ProminentPlane> prominent_planes;
  // What it looks like, stretched into its box along the design's axes; none for what its item's
  // kind says, round or a box.
  std::shared_ptr<const mesh::DrawnShape> shape;
  std::optional<Eigen::Vector3d> color;  // linear red, green and blue, 0 to 1
};

// A subassembly. Group 0 is the root.
struct AssemblyGroup {
  std::string name;
  int parent = -1;  // index into Assembly::groups; -1 for the root
};

enum class JointKind { kPrismatic, kHinge, kBall };

// A rest configuration of a joint, as motion away from the pose in which the design is drawn: a
// displacement in metres (prismatic), or a rotation vector in radians (hinge, ball).
struct RestPose {
  std::string name;
  Eigen::Vector3d motion = Eigen::Vector3d::Zero();
};

// Moves a group, and all below it, against the rest of the design.
struct Joint {
  std::string name;
  JointKind kind = JointKind::kHinge;
  int group = 0;                                     // what moves; not the root
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // m, a point that stays (hinge, ball)
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();   // unit vector (prismatic, hinge)
  double lower = 0;  // limits of the motion along or about the axis, m or rad; of a ball, of its
                     // angle, 0 to kHalfTurn
  double upper = 0;
  std::vector<RestPose>
      rest_poses;  // within the limits; the drawn pose is always one and not listed
};

struct Assembly {
  std::string name;
  std::vector<AssemblyGroup> groups;
  std::vector<AssemblyPart> parts;
  std::vector<Joint> joints;
};

// Everything that is wrong with an assembly, each finding with its place: "parts[3].group". Empty
// if parametrisation can begin. O(parts log parts).
std::vector<FieldViolation> ValidateAssembly(const Assembly& assembly);

// How many groups lie above this one; 0 for the root. The assembly must be valid.
int GroupDepth(const Assembly& assembly, int group);

// The lowest group that contains both.
int LowestCommonGroup(const Assembly& assembly, int a, int b);

// Whether `group` is `ancestor` or lies below it.
bool IsWithin(const Assembly& assembly, int group, int ancestor);

// The diagonal of the box around all parts, m: what tolerances scale with.
double AssemblyDiagonal(const Assembly& assembly);

// Within which parts align, touch and are alike, m: a millionth of the diagonal.
double ToleranceOf(const Assembly& assembly);

}  // namespace mortise::parametric
