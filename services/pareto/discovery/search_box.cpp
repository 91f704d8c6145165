#include "services/pareto/discovery/search_box.h"

#include <utility>

namespace mortise::pareto {
namespace {

std::vector<Eigen::Index> VaryingParameters(const DesignSpace& space) {
  const Eigen::VectorXd most = space.FromUnit(Eigen::VectorXd::Ones(space.size()));
  std::vector<Eigen::Index> varying;
  for (Eigen::Index i = 0; i < space.size(); ++i) {
    if (most[i] > space.lower[i]) varying.push_back(i);
  }
  if (varying.empty()) varying.push_back(0);
  return varying;
}

DesignSpace Restrict(const DesignSpace& space, const std::vector<Eigen::Index>& parameters) {
  DesignSpace part{space.lower(parameters), space.upper(parameters)};
  if (space.step.size() > 0) part.step = space.step(parameters);
  return part;
}

}  // namespace

SearchBox::SearchBox(const DesignSpace& space)
    : space_(space), varying_(VaryingParameters(space)), box_(Restrict(space, varying_)) {}

Eigen::VectorXd SearchBox::DesignAt(const Eigen::VectorXd& u) const {
  Eigen::VectorXd x = space_.lower;
  x(varying_) = box_.FromUnit(u);
  return x;
}

Eigen::VectorXd SearchBox::UnitOf(const Eigen::VectorXd& x) const {
  return box_.ToUnit(x(varying_));
}

Eigen::MatrixXd SearchBox::UnitJacobian(const Eigen::MatrixXd& jacobian) const {
  if (jacobian.size() == 0) return {};
  const Eigen::VectorXd sides = box_.upper - box_.lower;
  return jacobian(Eigen::all, varying_) * sides.asDiagonal();
}

void SearchBox::AddHeldParameters(FrontPiece& piece) const {
  Eigen::VectorXd origin = space_.lower;
  origin(varying_) = piece.origin;
  Eigen::MatrixXd directions = Eigen::MatrixXd::Zero(space_.size(), piece.directions.cols());
  directions(varying_, Eigen::all) = piece.directions;
  piece.origin = std::move(origin);
  piece.directions = std::move(directions);
}

}  // namespace mortise::pareto
