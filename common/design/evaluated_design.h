// A template at given parameters, F(q) of thesis (3.1), in numbers.
// Mirrors EvaluatedDesign of mortise/v1/design.proto.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "common/design/boundary_condition.h"
#include "common/design/structure.h"
#include "common/design/template_definition.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::parametric {

// The looks of a part that is no prism.
struct FacetedShape {
  mesh::SurfaceMesh surface;
  Eigen::VectorXi triangle_face;                     // T, index into face_names
  std::vector<std::vector<std::string>> face_names;  // of each face, all that it is called
};

// A part: a prism, which is a polygon extruded along a coordinate axis (a box is one along Z), or
// else faceted; it has no outline and extrusion then.
struct EvaluatedPart {
  std::string name;
  std::string title;
  std::string item;           // items/{id}; empty for what no item is
  std::string material = {};  // materials/{id}
  std::optional<FacetedShape> faceted = {};
  bool connecting = false;         // of an assembly: holds other parts together
  Axis length_axis = Axis::kX;     // of the design, along which the item's X lies
  Axis thickness_axis = Axis::kZ;  // of the design, along which the item's Z lies
  Axis axis = Axis::kZ;            // of the extrusion
  Eigen::Matrix2Xd outline;        // 2 × N, m, counter-clockwise in (u, v) of Prism
  double from = 0;                 // m, along the axis
  double to = 0;                   // m
  // N + 2 names: of the face on each outline edge (point i to i + 1), then those at `from` and
  // `to`.
  std::vector<std::string> face_names;
  Eigen::Vector3d minimum;                    // m, lower corner of the bounding box
  Eigen::Vector3d maximum;                    // m
  Eigen::Vector3d size;                       // m, in the item's axes: length, width, thickness
  double volume = 0;                          // m³
  double mass = 0;                            // kg
  Process process = Process::kNone;           // what cuts it from its stock
  std::optional<Eigen::Vector3d> color = {};  // linear red, green and blue; else as its material
};

// A peg.
struct EvaluatedConnector {
  std::string connection;
  std::string item;  // items/{id}
  std::string part;  // the part that carries the face
  std::string other_part;
  Eigen::Vector3d position;   // m, where the peg crosses the face
  Eigen::Vector3d direction;  // unit vector from `part` into `other_part`
  double diameter = 0;        // m
  double length = 0;          // m
  double depth_in_part = 0;   // m
  int priority = 0;
};

struct EvaluatedBoundaryCondition : ConditionNumbers {
  std::string name;
  BoundaryConditionKind kind = BoundaryConditionKind::kFixed;
  std::string part;       // empty for the whole body
  std::string face;       // likewise
  std::string load_case;  // of a load; empty where it acts in every one
};

struct NamedValue {
  std::string name;
  double value = 0;         // of a choice the number of its value
  std::string choice = {};  // of a choice the name of its value
};

struct EvaluatedDesign {
  std::string template_name;  // templates/{id}
  int64_t template_revision = 0;
  std::string template_digest;
  std::vector<NamedValue> parameters;  // all of them, in template order
  std::vector<EvaluatedPart> parts;    // in template order
  std::vector<EvaluatedConnector> connectors;
  std::vector<EvaluatedBoundaryCondition> boundary_conditions;
  double mass = 0;                                   // kg, of the parts (pegs left out)
  std::optional<double> reference_temperature = {};  // K; no thermal stress without it
  std::optional<Structure> structure = {};           // missing of what was written without it
};

// Returns the index of the part of this name; -1 if there is none.
int FindPart(const EvaluatedDesign& design, const std::string& name);

// Returns the point with coordinate `along` on `axis` and (u, v) in the plane across it.
Eigen::Vector3d FromPrismAxes(Axis axis, double u, double v, double along);

}  // namespace mortise::parametric
