// A cage template as plain structs: a surface, and the cage that deforms it, whose vertices are
// expressions of parameters (thesis §7.6.2). They mirror mortise/v1/cage_template.proto, where
// every field is described; cage_template_codec.h reads them from files, cage_model.h evaluates
// them.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/design/boundary_condition.h"
#include "common/design/template_definition.h"

namespace mortise::parametric {

// A point or vector as expressions of parameters and definitions, each 0 if empty.
struct CagePoint {
  std::string x, y, z;
};

struct CageDefinition {
  std::string name;
  std::string value;  // expression
};

// Triangles that go by one name.
struct CageFace {
  std::string name;
  Eigen::Matrix3Xi triangles;  // 3 × T, columns of vertex indices
};

struct CageSurface {
  Eigen::Matrix3Xd vertices;  // 3 × V, m
  std::vector<CageFace> faces;
};

struct Cage {
  std::vector<CagePoint> vertices;  // C
  Eigen::Matrix3Xi triangles;
};

// A support, load or heat.
struct CageCondition : ConditionDefinition {
  std::string name;
  std::string present = {};  // expression, a condition; always if empty
};

struct CageTemplate {
  std::string name;  // templates/{id}
  std::string title;
  std::string description;
  std::string material;  // materials/{id}
  std::vector<Parameter> parameters;
  std::vector<CageDefinition> definitions;
  CageSurface surface;  // as it is at the defaults
  Cage cage;
  std::vector<CageCondition> conditions;
  std::string reference_temperature;  // expression, K; empty if there is no thermal stress
};

}  // namespace mortise::parametric
