#include "services/composer/model/drag_space.h"

#include <utility>

#include "services/composer/model/design.h"

namespace mortise::composer {
namespace {

Eigen::VectorXd ScalesOf(const parametric::ParametricAssembly& assembly) {
  return ChangeScales(assembly, parametric::AssemblyDiagonal(assembly.assembly()));
}

std::size_t BytesOf(const Eigen::MatrixXd& matrix) {
  return static_cast<std::size_t>(matrix.size()) * sizeof(double);
}

}  // namespace

DragSpace::DragSpace(std::shared_ptr<const parametric::ParametricAssembly> assembly)
    : assembly_(std::move(assembly)),
      weights_(ScalesOf(*assembly_).cwiseAbs2().cwiseInverse()),
      free_(*assembly_->FreeInSpace().Rescaled(ScalesOf(*assembly_))) {}

Eigen::VectorXd DragSpace::CoordinatesOf(const Eigen::VectorXd& in_space) const {
  return free_.basis().transpose() * weights_.cwiseProduct(in_space - free_.drawn());
}

std::size_t DragSpace::MemoryUse() const {
  // A relationship with its terms and its description, among all and among those that are kept.
  constexpr std::size_t kRelationship = 2 * (sizeof(parametric::Relationship) + 256);
  return sizeof(*this) + BytesOf(free_.basis()) + BytesOf(free_.normals()) +
         assembly_->relationships().size() * kRelationship +
         static_cast<std::size_t>(4 * weights_.size()) * sizeof(double);
}

}  // namespace mortise::composer
