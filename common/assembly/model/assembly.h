// An expert's design as it comes from CAD: parts in a hierarchy of groups, with the annotations
// that automatic parametrisation needs (thesis §3.2.2). It is the input of §3.4.
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

// Assemblies, and designs made of them, lie within this distance of the origin along every axis, m.
inline constexpr double kMaxFromOrigin = 10e3;

// Parts are at least as large along every axis, m.
inline constexpr double kMinPart = 1e-6;

// Joints turn no further either way, rad: sixteen turns.
inline constexpr double kMaxTurn = 100;

// The largest angle that a ball turns by, rad: half a turn as people write it.
inline constexpr double kHalfTurn = 3.1416;

// The bounding box of a part, in metres, in the design's coordinates.
struct BoundingBox {
  Eigen::Vector3d minimum = Eigen::Vector3d::Zero();
  Eigen::Vector3d maximum = Eigen::Vector3d::Zero();

  Eigen::Vector3d center() const { return (minimum + maximum) / 2; }
  Eigen::Vector3d size() const { return maximum - minimum; }
};

// The sizes that a part may take along one axis of the design, m. The two are equal where the size
// is fixed.
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
  // True for what is purely structural: screws, hinges, brackets. Connections place it, not the
  // designer.
  bool connecting = false;
  BoundingBox box;
  std::array<SizeLimits, 3> limits;  // by axis of the design
  // The axis of the design along which each of the item's three lies: length, width, thickness.
  std::array<Axis, 3> item_axes = {Axis::kX, Axis::kY, Axis::kZ};
  std::vector<ProminentPlane> prominent_planes;
  // The part's looks, stretched into its box along the design's axes. A part without a shape is
  // round or a box, as its item's kind says.
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

// A joint moves a group, and all below it, against the rest of the design.
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

// Returns everything that is wrong with an assembly, each finding with its place: "parts[3].group".
// The list is empty if parametrisation can begin. O(parts log parts).
std::vector<FieldViolation> ValidateAssembly(const Assembly& assembly);

// Returns how many groups lie above this one; 0 for the root. The assembly must be valid.
int GroupDepth(const Assembly& assembly, int group);

// Returns the lowest group that contains both.
int LowestCommonGroup(const Assembly& assembly, int a, int b);

// Whether `group` is `ancestor` or lies below it.
bool IsWithin(const Assembly& assembly, int group, int ancestor);

// Returns the diagonal of the box around all parts, m. Tolerances scale with it.
double AssemblyDiagonal(const Assembly& assembly);

// Returns the distance within which parts align, touch and are alike, m: a millionth of the
// diagonal.
double ToleranceOf(const Assembly& assembly);

}  // namespace mortise::parametric
