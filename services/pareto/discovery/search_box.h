// The unit box of the parameters that can vary, which is all that a search sees of a design space.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/pareto/archive/evaluation.h"
#include "services/pareto/front/front.h"

namespace mortise::pareto {

class SearchBox {
 public:
  // Leaves out the parameters with a single value that can be set; where there are no others, the
  // first one is kept, so that there is a box.
  explicit SearchBox(const DesignSpace& space);

  // Returns the whole design space, of D parameters.
  const DesignSpace& space() const { return space_; }
  // Returns the part of it that can vary.
  const DesignSpace& box() const { return box_; }
  // Returns the number of parameters that can vary.
  Eigen::Index size() const { return box_.size(); }

  // Returns the design x in R^D at `u`, the nearest that can be set.
  Eigen::VectorXd DesignAt(const Eigen::VectorXd& u) const;

  // Returns the unit coordinates of a design x in R^D.
  Eigen::VectorXd UnitOf(const Eigen::VectorXd& x) const;

  // Returns the derivatives by u, n x size(), of those by x, n x D; empty where there are none.
  Eigen::MatrixXd UnitJacobian(const Eigen::MatrixXd& jacobian) const;

  // Gives a piece, whose origin and directions are those of the parameters that can vary, all D.
  void AddHeldParameters(FrontPiece& piece) const;

 private:
  DesignSpace space_;
  std::vector<Eigen::Index> varying_;
  DesignSpace box_;
};

}  // namespace mortise::pareto
