// One control of a node of a design, being dragged (thesis §5.3): what a drag takes is prepared
// once, and each value is then one search for the nearest design that begins where the last one
// ended.
//
//   MORTISE_ASSIGN_OR_RETURN(NodeDrag drag,
//                            NodeDrag::Begin(space, design, "top", ControlKind::kSize, Axis::kX));
//   MORTISE_ASSIGN_OR_RETURN(const Design wider, drag.To(1.2));
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "common/assembly/polyhedra/nearest_point_search.h"
#include "common/assembly/polyhedra/polyhedron.h"
#include "services/composer/model/controlled_node.h"
#include "services/composer/model/controls.h"
#include "services/composer/model/design.h"
#include "services/composer/model/drag_space.h"

namespace mortise::composer {

class NodeDrag {
 public:
  // `design` must be of the structure of `space`. Fails as Drag for the node and the control.
  // O(degrees of freedom · relationships).
  static absl::StatusOr<NodeDrag> Begin(std::shared_ptr<const DragSpace> space, Design design,
                                        const std::string& node, ControlKind kind, Axis axis);

  // Returns what Drag returns for the design of the beginning, whatever was asked before: of a
  // first call the same to the last bit, of others to 1e-9 m. INVALID_ARGUMENT, "value", if it is
  // not finite. It takes O(n) times as many constraints as come to hold or hold no longer, of n
  // relationships that have to do with the control, and O(n) searches for the first value that is
  // out of reach.
  absl::StatusOr<Design> To(double value);

  // Returns the design of the beginning.
  const Design& beginning() const { return node_.design(); }

  // Returns the control's value in a design, m: the length of the form that was dragged.
  double ValueIn(const Design& design) const;

  // Returns how much memory it takes besides the space, bytes.
  std::size_t MemoryUse() const;

 private:
  // The size of an element, and the equality that keeps it.
  struct Size {
    int variable = 0;
    int row = 0;
  };

  explicit NodeDrag(ControlledNode node) : node_(std::move(node)) {}
  absl::Status Prepare();
  void PrepareFactor(const parametric::Polyhedron& whole, int control,
                     const std::vector<Size>& sizes, const Eigen::VectorXd& at_beginning,
                     Eigen::VectorXd rest);
  absl::StatusOr<std::optional<Eigen::VectorXd>> Nearest(double value);
  void KeepSizes(const std::vector<int>& sizes);
  absl::StatusOr<double> End(double sign);
  Eigen::VectorXd InSpaceAt(const Eigen::VectorXd& entries) const;

  ControlledNode node_;
  std::string name_;             // of the control, for people
  parametric::LinearForm form_;  // of the control
  double drawn_value_ = 0;       // m, of the form as drawn
  // Coordinates are those of the space that have to do with the control; the others stay.
  Eigen::VectorXd rest_;  // in space, where all these coordinates are 0
  // |q| × coordinates; the second, without what is 0, in place of the first if that is most of it.
  Eigen::MatrixXd moving_;
  std::optional<Eigen::SparseMatrix<double, Eigen::RowMajor>> sparse_moving_;
  Eigen::VectorXd row_;      // the form as a row over the coordinates
  Eigen::VectorXd from_;     // the coordinates at the beginning
  int control_ = 0;          // the equality that gives the form a value
  std::vector<Size> sizes_;  // that can be kept, by variable
  Eigen::VectorXd values_;   // of all equalities at the beginning
  std::optional<parametric::NearestPointSearch> search_, keeping_sizes_;
  std::array<std::optional<double>, 2> ends_;  // lower and upper, m, once one was met
};

}  // namespace mortise::composer
