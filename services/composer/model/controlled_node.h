// Private to this folder. A node of a design whose box has controls: its elements, what bounds
// them, and what holds the whole in its place meanwhile.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/assembly/polyhedra/linear_form.h"
#include "common/assembly/relations/feasible_set.h"
#include "services/composer/model/controls.h"
#include "services/composer/model/design.h"
#include "services/composer/model/drag_space.h"

namespace mortise::composer {

class ControlledNode {
 public:
  // Finds a node of a design of the structure. INVALID_ARGUMENT, "node".
  static absl::StatusOr<ControlledNode> Find(std::shared_ptr<const DragSpace> space, Design design,
                                             const std::string& node);

  const DragSpace& space() const { return *space_; }
  const Design& design() const { return design_; }
  const Eigen::VectorXd& now() const { return now_; }  // in space
  // What holds the model in its place: forms that keep their values.
  const std::vector<parametric::Demand>& held() const { return held_; }

  // Returns the control's length as a function of the parameters in space.
  parametric::LinearForm FormOf(ControlKind kind, Axis axis) const;

  // Returns a form as a row over the coordinates of the space's set.
  Eigen::VectorXd RowOf(const parametric::LinearForm& form) const;

  // Whether some direction of the set that leaves the model in its place changes the form.
  bool IsFree(const parametric::LinearForm& form) const;

  // Returns the value of the form where it is as large, or small, as it can be.
  absl::StatusOr<double> End(const parametric::LinearForm& form, double sign) const;

 private:
  // The lower and the upper end of a box along an axis, as functions of the parameters.
  struct Ends {
    parametric::LinearForm lower, upper;
  };

  ControlledNode(std::shared_ptr<const DragSpace> space, Design design);
  Ends EndsOf(const std::vector<int>& elements, Axis axis) const;
  void HoldModel();
  void Hold(const parametric::LinearForm& form);

  std::shared_ptr<const DragSpace> space_;
  Design design_;
  Eigen::VectorXd now_;
  std::vector<int> elements_;
  std::vector<parametric::Demand> held_;
  std::vector<Eigen::VectorXd> held_rows_;  // orthonormal
};

}  // namespace mortise::composer
