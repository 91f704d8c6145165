// The compiled form of a template: parsed expressions and resolved references. For what
// evaluates them, here and in assemblies.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
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

// What can be of one of several items, of which the first is taken whose condition holds.
template <typename Compiled>
struct Alternatives {
  Compiled own;  // where none holds
  std::vector<std::pair<PlacedExpression, Compiled>> others = {};

  // Returns the one at `q`. INVALID_ARGUMENT naming the condition that cannot be computed.
  absl::StatusOr<const Compiled*> At(const Eigen::VectorXd& q) const;
};

// What a part is made of.
struct CompiledItem {
  std::string item;      // items/{id}
  std::string material;  // materials/{id}
  double density = 0;    // kg/m³
  Process process = Process::kNone;
};

// A peg's item and size.
struct CompiledPeg {
  std::string item;     // items/{id}
  double diameter = 0;  // m
  double length = 0;    // m
};

// Copies along a direction.
struct CompiledRepeat {
  PlacedExpression count;
  std::array<std::optional<PlacedExpression>, 3> step;  // m, along x, y and z; nothing for 0
  bool has_index = false;  // whether the body's expressions take the number of the copy
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
  std::string field;  // "parts[2]"
  std::optional<PlacedExpression> present;
  // The body's expressions take the parameters, then the numbers of the copy along those directions
  // that have an index.
  std::vector<CompiledRepeat> repeat;
  Alternatives<CompiledItem> item;

  bool HasIndex() const;
};

// A part, all of its copies or one of them, by index.
struct CompiledReference {
  std::size_t part = 0;
  std::vector<int> copy;  // its numbers, from 1; none for all copies
};

// A connection with its parts and face as indices, and its pegs.
struct CompiledConnection {
  CompiledReference part;
  std::size_t face = 0;
  CompiledReference other_part;
  std::string field;  // "connections[1]"
  std::optional<PlacedExpression> present;
  Alternatives<CompiledPeg> peg;
};

// Where a boundary condition acts; nothing for the whole body.
struct CompiledPlace {
  CompiledReference part;
  std::size_t face = 0;
};

struct CompiledTemplate {
  TemplateBundle bundle;
  std::vector<CompiledPart> parts;
  std::vector<CompiledConnection> connections;
  ConditionExpressions conditions;
  std::vector<std::optional<CompiledPlace>> places;  // of the conditions
};

// Compiles a template after checking it (template_checks.h); INVALID_ARGUMENT with the findings.
absl::StatusOr<CompiledTemplate> CompileTemplate(const TemplateBundle& bundle);

// Returns whether the condition holds at `q`; that it does where there is none. INVALID_ARGUMENT
// naming its place.
absl::StatusOr<bool> HoldsAt(const std::optional<PlacedExpression>& condition,
                             const Eigen::VectorXd& q);
absl::StatusOr<bool> HoldsAt(const PlacedExpression& condition, const Eigen::VectorXd& q);

// Returns what expressions of a template may name, in order: its parameters, then its ground.
std::vector<ExpressionName> NamesOf(const TemplateDefinition& definition);

// Returns what a part's body may name: `parameters`, then the indices of its directions.
std::vector<ExpressionName> BodyNames(const PartTemplate& part,
                                      std::vector<ExpressionName> parameters);

// Returns the names of a part's faces: of each outline edge, then of the faces at `from` and `to`.
std::vector<std::string> FaceNames(const PartTemplate& part);

// Returns what cuts a part of this item from its stock; kNone where nothing does.
Process CuttingProcess(const Item& item);

template <typename Compiled>
absl::StatusOr<const Compiled*> Alternatives<Compiled>::At(const Eigen::VectorXd& q) const {
  for (const auto& [when, other] : others) {
    const absl::StatusOr<bool> holds = HoldsAt(when, q);
    if (!holds.ok()) return holds.status();
    if (*holds) return &other;
  }
  return &own;
}

}  // namespace mortise::parametric
