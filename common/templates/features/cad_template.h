// A CAD template as plain structs: parameters and a list of features whose every number is an
// expression (thesis §6.1). They mirror mortise/v1/cad_template.proto, where every field is
// described; cad_template_codec.h reads them from files, feature_model.h makes solids of them.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/design/boundary_condition.h"
#include "common/design/template_definition.h"

namespace mortise::cad {

// An expression of the parameters and definitions, in SI units. Empty where the field may be left
// out.
using Formula = std::string;

struct Formula2 {
  Formula x, y;  // 0 if empty
};

struct Formula3 {
  Formula x, y, z;  // 0 if empty
};

struct SketchSegment {
  std::string name;
  Formula2 to;
  std::optional<Formula2> through;
  Formula round;
};

struct SketchPath {
  Formula2 start;
  std::vector<SketchSegment> segments;
  bool open = false;
};

struct SketchCircle {
  Formula2 center;
  Formula radius;
};

struct SketchRectangle {
  Formula2 center;
  Formula width, height, round;
};

struct SketchPolygon {
  Formula2 center;
  Formula radius, sides, angle;
};

struct SketchProfile {
  std::string name;
  std::string hole_of;
  std::variant<SketchPath, SketchCircle, SketchRectangle, SketchPolygon> shape;
};

struct SketchPlane {
  Formula3 origin;
  std::optional<Formula3> normal, x_axis;
  std::string face;
};

struct Sketch {
  SketchPlane plane;
  std::vector<SketchProfile> profiles;
};

// The operation by which a feature's solid changes a body.
enum class Operation { kNewBody = 1, kUnite = 2, kCut = 3, kIntersect = 4 };

struct Extrude {
  std::string sketch;
  Formula from, to;
  Operation operation = Operation::kNewBody;
  std::string body;
};

struct Revolve {
  std::string sketch;
  Formula2 axis_point, axis_direction;
  Formula angle;
  Operation operation = Operation::kNewBody;
  std::string body;
};

struct Sweep {
  std::string sketch, path;
  Operation operation = Operation::kNewBody;
  std::string body;
};

struct Boolean {
  Operation operation = Operation::kUnite;
  std::string body;
  std::vector<std::string> tools;
};

struct Fillet {
  std::vector<std::string> edges;
  Formula radius;
};

struct Chamfer {
  std::vector<std::string> edges;
  Formula distance;
};

struct Draft {
  std::vector<std::string> faces;
  std::string neutral;
  Formula angle;
};

struct Shell {
  std::vector<std::string> open_faces;
  Formula thickness;
};

struct Hole {
  std::string face;
  Formula3 position;
  Formula diameter, depth;
  Formula counterbore_diameter, counterbore_depth;
  Formula countersink_diameter, countersink_angle;
};

struct LinearPattern {
  std::string feature;
  Formula3 step;
  Formula count;
  Formula3 second_step;
  Formula second_count;
};

struct CircularPattern {
  std::string feature;
  Formula3 axis_point;
  std::optional<Formula3> axis_direction;
  Formula count, angle;
};

// A support, load or heat on faces, or a load of the whole body.
using Condition = parametric::ConditionDefinition;

struct Feature {
  std::string name;
  std::variant<Sketch, Extrude, Revolve, Sweep, Boolean, Fillet, Chamfer, Draft, Shell, Hole,
               LinearPattern, CircularPattern, Condition>
      kind;
  Formula present = {};  // a condition: whether it is made, or acts; always if empty
};

struct Definition {
  std::string name;
  Formula value;
};

struct CadTemplate {
  std::string name;  // templates/{id}
  std::string title;
  std::string description;
  std::string material;  // materials/{id}
  std::vector<parametric::Parameter> parameters;
  std::vector<Definition> definitions;
  std::vector<Feature> features;
  Formula reference_temperature;  // K; empty if there is no thermal stress
};

}  // namespace mortise::cad
