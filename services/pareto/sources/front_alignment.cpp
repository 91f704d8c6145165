#include "services/pareto/sources/front_alignment.h"

#include <Eigen/QR>
#include <algorithm>
#include <functional>

namespace mortise::pareto {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kMinShare = 0.1;
constexpr std::size_t kLatest = 4;       // one of so many trade-offs
constexpr double kSameDirection = 1e-6;  // relative, of slopes

}  // namespace

FrontTrend::FrontTrend(const Archive& archive, const Scaling& scaling) {
  const std::vector<std::size_t>& front = archive.non_dominated();
  const Index n = std::ssize(front), size = archive[front.front()].u.size();
  const Index others = scaling.ideal.size() - 1;
  MatrixXd designs(n, size), metrics(n, others);
  for (Index k = 0; k < n; ++k) {
    const ArchiveEntry& entry = archive[front[static_cast<std::size_t>(k)]];
    designs.row(k) = entry.u.transpose();
    metrics.row(k) = scaling.Apply(entry.metrics).head(others).transpose();
  }
  designs.rowwise() -= Eigen::RowVectorXd(designs.colwise().mean());
  metrics.rowwise() -= Eigen::RowVectorXd(metrics.colwise().mean());
  slopes_ = metrics.colPivHouseholderQr().solve(designs).transpose();
  const VectorXd variance = designs.colwise().squaredNorm().transpose();
  explained_ = (metrics * slopes_.transpose()).colwise().squaredNorm().transpose();
  explained_ = (variance.array() > 0).select(explained_.cwiseQuotient(variance), 0);
}

MatrixXd FrontTrend::Directions(double share) const {
  MatrixXd slopes = slopes_;
  for (Index i = 0; i < slopes.rows(); ++i) {
    if (!(explained_[i] > share)) slopes.row(i).setZero();
  }
  Eigen::ColPivHouseholderQR<MatrixXd> basis(slopes);
  basis.setThreshold(kSameDirection);
  const Index most = std::min(slopes.rows(), slopes.cols());
  const MatrixXd q = basis.householderQ() * MatrixXd::Identity(slopes.rows(), most);
  return q.leftCols(basis.rank());
}

std::vector<VectorXd> AlignedDesigns(const Archive& archive, const Scaling& scaling,
                                     std::size_t count, Random& random) {
  std::vector<VectorXd> designs;
  const std::vector<std::size_t>& front = archive.non_dominated();
  if (std::ssize(front) < 2 * scaling.ideal.size() || scaling.ideal.size() < 2) return designs;
  std::vector<std::size_t> latest = front;
  std::ranges::sort(latest, std::greater());
  const FrontTrend trend(archive, scaling);
  for (std::size_t k = 0; k < count; ++k) {
    const VectorXd& source = archive[latest[random.Index(1 + latest.size() / kLatest)]].u;
    VectorXd position = archive[front[random.Index(front.size())]].u;
    const VectorXd& other = archive[front[random.Index(front.size())]].u;
    if (random.Uniform() < 0.5) position += (2 * random.Uniform() - 0.5) * (other - position);
    const double share = kMinShare + (1 - kMinShare) * random.Uniform();
    const MatrixXd directions = trend.Directions(share);
    const VectorXd u = source + directions * (directions.transpose() * (position - source));
    designs.push_back(u.cwiseMax(0.0).cwiseMin(1.0));
  }
  return designs;
}

}  // namespace mortise::pareto
