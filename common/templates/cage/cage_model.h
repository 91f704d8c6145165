// Cage templates that can be evaluated: F(q) of a surface in a cage (thesis §7.6.2) is the surface
// with its vertices moved by mean-value coordinates, its named faces, and the supports and loads on
// them.
//
//   MORTISE_ASSIGN_OR_RETURN(CageModel boat, CageModel::Create(definition));
//   MORTISE_ASSIGN_OR_RETURN(CageDesign design, boat.Evaluate(boat.Defaults()));
//   MORTISE_ASSIGN_OR_RETURN(Dual volume, boat.Volume(boat.Defaults()));   // m³ and its gradient
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/design/face_condition.h"
#include "common/design/template_validation.h"
#include "common/expressions/expression.h"
#include "common/mesh/surface_mesh.h"
#include "common/templates/cage/cage_template.h"

namespace mortise::parametric {

// The shape at given parameters.
struct CageDesign {
  mesh::SurfaceMesh surface;                    // closed, outward, does not cross itself
  Eigen::VectorXi triangle_face;                // T, index into face_names
  std::vector<std::string> face_names;          // in the template's order
  std::vector<FaceCondition> conditions;        // that act, in the template's order
  std::vector<std::string> absent_conditions;   // names of those that do not, likewise
  std::optional<double> reference_temperature;  // K; no thermal stress without it
};

// Returns everything that is wrong with a template, at once: names, ranges, sizes, references,
// expressions; a surface or, at the defaults, a cage that is not closed, not oriented outwards or
// crosses itself; then, at the defaults, at every corner of the parameter box (the ends of single
// parameters where there are more than 6) and at 32 random points, always the same, whatever
// Evaluate would refuse. At most 100 findings, the first at each place. Surfaces may have 5,000
// vertices and 10,000 triangles, cages 250 and 500.
std::vector<FieldViolation> ValidateCageTemplate(const CageTemplate& definition);

// A cage template, checked. Its coordinates are computed once, where the cage is at the defaults,
// so that the surface at q is a linear map of the cage at q. Immutable, cheap to copy; may be used
// from any number of threads.
class CageModel {
 public:
  // Makes a model. INVALID_ARGUMENT naming all that ValidateCageTemplate finds.
  static absl::StatusOr<CageModel> Create(CageTemplate definition);

  const CageTemplate& definition() const;
  Eigen::VectorXd Defaults() const;

  // Returns the coordinates of the surface's vertices in the cage, C × V: surface = cage ·
  // coordinates.
  const Eigen::MatrixXd& coordinates() const;

  // Returns the design at `q`, one entry a parameter in the template's order. INVALID_ARGUMENT
  // naming each parameter out of its range ("parameters[1]"); each number that cannot be computed
  // ("cage.vertices[3].x"); or, with the parameters and the place, "surface" where it crosses
  // itself, collapses or turns inside out.
  absl::StatusOr<CageDesign> Evaluate(const Eigen::VectorXd& q) const;

  // Returns the derivatives of the surface's vertices with respect to the parameters, 3V × n: row
  // 3v + axis is the gradient of that coordinate of vertex v, m per unit of each parameter. Exact;
  // at kinks of expressions as in expression.h. INVALID_ARGUMENT as Evaluate, but the shape is not
  // looked at.
  absl::StatusOr<Eigen::MatrixXd> Jacobian(const Eigen::VectorXd& q) const;

  // Returns the volume within the surface, m³, and its exact gradient. INVALID_ARGUMENT as
  // Jacobian.
  absl::StatusOr<Dual> Volume(const Eigen::VectorXd& q) const;

 private:
  struct State;
  explicit CageModel(std::shared_ptr<const State> state);
  friend std::vector<FieldViolation> ValidateCageTemplate(const CageTemplate& definition);

  // Compiles the template, and checks all but how the shape fares at other parameters; null if
  // there are findings.
  static std::shared_ptr<const State> Compile(CageTemplate definition,
                                              std::vector<FieldViolation>& findings);

  // Returns what Evaluate refuses of points all over the parameter box.
  std::vector<FieldViolation> TryPoints() const;

  std::shared_ptr<const State> state_;
};

}  // namespace mortise::parametric
