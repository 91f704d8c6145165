// F(q): evaluates a template at parameter values (thesis §3.3, equation 3.1; §8.4.2).
//
//   MORTISE_ASSIGN_OR_RETURN(TemplateFunction table, TemplateFunction::Create(bundle));
//   MORTISE_ASSIGN_OR_RETURN(Eigen::VectorXd q, table.CompleteParameters({{"length", 1.6}}));
//   MORTISE_ASSIGN_OR_RETURN(EvaluatedDesign design, table.Evaluate(q));
//
// Pegs: where `face` of a connection's part meets the other part is the contact patch. A row stands
// on it along the longer side of its bounding rectangle (in the axes of the face), centred across:
// the first and last peg at `end_distance` from the ends, the others evenly between them, no two
// further apart than `spacing`. Where the first and last would be nearer than two diameters, one
// peg stands in the middle. With `row_spacing` there are several rows, which stand across the patch
// by the same rule, the outer ones at `side_distance` from its sides.
//
// Parts, connections and conditions that are absent at q are not evaluated: they cost nothing, and
// nothing about them is a fault. A part that is repeated is evaluated once and moved, unless its
// body names the number of the copy.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/design/evaluated_design.h"
#include "common/design/template_definition.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::parametric {

struct CompiledTemplate;  // parsed expressions and resolved names

// Volume and mass of a design and how they change with the parameters.
struct MassProperties {
  double volume = 0;                // m³
  double mass = 0;                  // kg
  Eigen::VectorXd volume_gradient;  // m³ per unit of each parameter
  Eigen::VectorXd mass_gradient;    // kg per unit of each parameter
};

// A template compiled for evaluation. Immutable, cheap to copy, safe to share between threads.
class TemplateFunction {
 public:
  // Compiles the expressions and looks up items and materials. INVALID_ARGUMENT naming the first
  // field at fault ("parts[2].box.x.to"), with all of them in the message. Shapes are only known
  // once evaluated; ValidateTemplate tries them.
  static absl::StatusOr<TemplateFunction> Create(const TemplateBundle& bundle);

  const TemplateBundle& bundle() const;
  const std::vector<Parameter>& parameters() const;

  // Returns the default of every parameter.
  Eigen::VectorXd Defaults() const;

  // Returns the parameter vector with `values` where given and defaults elsewhere. INVALID_ARGUMENT
  // naming "parameters[i]" for an unknown or repeated name, a value that is not finite or out of
  // range (by more than 1e-9 of the range).
  absl::StatusOr<Eigen::VectorXd> CompleteParameters(const std::vector<NamedValue>& values) const;

  // Returns `q` rounded to each parameter's step, what a workshop can set, and kept within the
  // range.
  Eigen::VectorXd RoundToSteps(const Eigen::VectorXd& q) const;

  // Returns F(q). INVALID_ARGUMENT naming "parameters[i].value" for a wrong count, a value out
  // of range or not finite, and the template's field where an expression fails, an extent is empty,
  // an outline is not a counter-clockwise simple polygon, a count is no whole number from 1 to
  // 1000, a connection's parts do not touch, or it or a condition is present where its part is
  // absent; "parts" or "connections" where a design would have no part, more than 2000 or 10,000
  // pegs.
  absl::StatusOr<EvaluatedDesign> Evaluate(const Eigen::VectorXd& q) const;

  // Returns the volume and mass at `q` with exact gradients, what is present and counted held;
  // fails as Evaluate does for wrong values and expressions. It does not look at shapes and
  // contacts, and is several times faster.
  absl::StatusOr<MassProperties> EvaluateMass(const Eigen::VectorXd& q) const;

 private:
  explicit TemplateFunction(std::shared_ptr<const CompiledTemplate> compiled);
  std::shared_ptr<const CompiledTemplate> compiled_;
};

// Returns the surface of one part: closed, conforming, outward.
mesh::SurfaceMesh PartSurface(const EvaluatedPart& part);

}  // namespace mortise::parametric
