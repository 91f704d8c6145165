// The compiled form of a template: parsed expressions and resolved references. For what
// evaluates them, here and in assemblies.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/design/condition_expressions.h"
#include "common/design/template_definition.h"
#include "common/expressions/expression.h"

namespace mortise::parametric {

// An expression and where the template says it.
struct PlacedExpression {
  Expression expression;
  std::string field;  // "parts[2].box.x.to"
};

// A part as a prism whose numbers are expressions. Corner i of the outline is
// (u[u_of_corner[i]], v[v_of_corner[i]]), so that a box evaluates its six expressions once each.
struct CompiledPart {
  Axis axis = Axis::kZ;
  std::vector<PlacedExpression> u;
  std::vector<PlacedExpression> v;
  std::vector<int> u_of_corner;
  std::vector<int> v_of_corner;
  PlacedExpression from;
  PlacedExpression to;
  std::vector<std::string> face_names;
  std::string field;     // "parts[2]"
  std::string material;  // materials/{id}
  double density = 0;    // kg/m³
  Process process = Process::kNone;
};

// A connection with its parts and face as indices, and its peg's size.
struct CompiledConnection {
  std::size_t part = 0;
  std::size_t face = 0;
  std::size_t other_part = 0;
  double diameter = 0;  // m
  double length = 0;    // m
  std::string field;    // "connections[1]"
};

struct CompiledTemplate {
  TemplateBundle bundle;
  std::vector<CompiledPart> parts;
  std::vector<CompiledConnection> connections;
  ConditionExpressions conditions;
};

// Compiles a template after checking it (template_checks.h); INVALID_ARGUMENT with the findings.
absl::StatusOr<CompiledTemplate> CompileTemplate(const TemplateBundle& bundle);

// Returns the names of the parameters, in order.
std::vector<std::string> ParameterNames(const TemplateDefinition& definition);

// Returns the names of a part's faces: of each outline edge, then of the faces at `from` and `to`.
std::vector<std::string> FaceNames(const PartTemplate& part);

// Returns what cuts a part of this item from its stock; kNone where nothing does.
Process CuttingProcess(const Item& item);

}  // namespace mortise::parametric
