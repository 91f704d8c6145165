#include "services/pareto/sources/surrogate_search.h"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <type_traits>
#include <utility>

#include "services/pareto/archive/stochastic_sampling.h"

namespace mortise::pareto {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kMargin = 0.1;         // of the reference, beyond what the front may span
constexpr double kUnimportance = 0.05;  // of other metrics where one is looked for by itself
constexpr double kOptimism = 5;         // deviations that a metric may be better than believed
constexpr double kNothing = -700;       // logarithm of an improvement that is as good as none
constexpr double kSameDesign = 1e-5;    // as near in every coordinate: no need to evaluate it again
constexpr double kChangedParameters = 3;   // of a candidate with some parameters moved, on average
constexpr double kMinMove = 7;             // as an exponent: 2^-7 of a parameter's range
constexpr double kAscentTolerance = 1e-3;  // of what is ascended, absolute

// A function of designs to be made large, with its slope.
using Ascended = std::function<double(const VectorXd& u, VectorXd& gradient)>;

double Objective(unsigned count, const double* u, double* gradient, void* data) {
  const VectorXd at = VectorXd::Map(u, static_cast<Index>(count));
  VectorXd slope;
  const double value = (*static_cast<const Ascended*>(data))(at, slope);
  if (gradient != nullptr) std::ranges::copy(slope, gradient);
  return value;
}

// Uphill within the box.
VectorXd Ascend(Ascended ascended, const VectorXd& from, int steps) {
  const std::unique_ptr<std::remove_pointer_t<nlopt_opt>, decltype(&nlopt_destroy)> optimizer(
      nlopt_create(NLOPT_LD_LBFGS, static_cast<unsigned>(from.size())), &nlopt_destroy);
  nlopt_set_max_objective(optimizer.get(), Objective, &ascended);
  nlopt_set_lower_bounds1(optimizer.get(), 0);
  nlopt_set_upper_bounds1(optimizer.get(), 1);
  nlopt_set_ftol_abs(optimizer.get(), kAscentTolerance);
  nlopt_set_maxeval(optimizer.get(), steps);
  VectorXd u = from;
  double value = 0;
  nlopt_optimize(optimizer.get(), u.data(), &value);
  return u.allFinite() ? VectorXd(u.cwiseMax(0.0).cwiseMin(1.0)) : from;
}

double LogOf(double expected) {
  return expected > 0 ? std::max(std::log(expected), kNothing) : kNothing;
}

// The means (or deviations) of all metrics of a belief.
VectorXd MeansOf(const SurrogateModel::Belief& belief) {
  VectorXd means(static_cast<Index>(belief.metrics.size()));
  for (Index k = 0; k < means.size(); ++k) {
    means[k] = belief.metrics[static_cast<std::size_t>(k)].mean;
  }
  return means;
}

VectorXd DeviationsOf(const SurrogateModel::Belief& belief) {
  VectorXd deviations(static_cast<Index>(belief.metrics.size()));
  for (Index k = 0; k < deviations.size(); ++k) {
    deviations[k] = belief.metrics[static_cast<std::size_t>(k)].deviation;
  }
  return deviations;
}

// The logarithm of what is maximised, with its slope.
double LogAcquisition(const SurrogateModel::Belief& belief,
                      const ExpectedHypervolumeImprovement& improvement, VectorXd& gradient) {
  const auto value = improvement.WithGradient(MeansOf(belief), DeviationsOf(belief));
  gradient = belief.log_feasibility_gradient;
  for (Index k = 0; value.expected > 0 && k < value.mean_gradient.size(); ++k) {
    const auto& metric = belief.metrics[static_cast<std::size_t>(k)];
    gradient += value.mean_gradient[k] / value.expected * metric.mean_gradient +
                value.deviation_gradient[k] / value.expected * metric.deviation_gradient;
  }
  if (!gradient.allFinite()) gradient.setZero();
  return LogOf(value.expected) + belief.log_feasibility;
}

// The same of many designs.
VectorXd LogAcquisitions(const SurrogateModel::Beliefs& beliefs,
                         const ExpectedHypervolumeImprovement& improvement) {
  const auto d = static_cast<Index>(beliefs.metrics.size());
  VectorXd values = beliefs.log_feasibilities;
  VectorXd means(d), deviations(d);
  for (Index j = 0; j < values.size(); ++j) {
    for (Index k = 0; k < d; ++k) {
      means[k] = beliefs.metrics[static_cast<std::size_t>(k)].means[j];
      deviations[k] = beliefs.metrics[static_cast<std::size_t>(k)].deviations[j];
    }
    values[j] += LogOf(improvement.Expected(means, deviations));
  }
  return values;
}

// A proposal, and what becomes of it.
class Proposed : public PointSource {
 public:
  Proposed(VectorXd u, const SurrogateModel& model, SurrogateTally& tally)
      : learnt_(model.learnt()), tally_(tally) {
    const SurrogateModel::Belief belief = model.At(u);
    means_ = MeansOf(belief);
    deviations_ = (DeviationsOf(belief).array().square() + model.Noise().array().square()).sqrt();
    u_ = std::move(u);
  }

  std::optional<VectorXd> Ask(Archive& /*archive*/) override {
    under_way_ = under_way_ || u_;
    return std::exchange(u_, std::nullopt);
  }

  void Tell(Archive& archive, std::size_t entry) override {
    under_way_ = false;
    tally_.AddProposal();
    if (!archive[entry].evaluated) return;
    const VectorXd values = learnt_.Of(archive[entry].metrics);
    for (Index k = 0; k < values.size(); ++k) {
      tally_.AddPrediction(means_[k], deviations_[k], values[k]);
    }
  }

  bool Finished() const override { return !u_ && !under_way_; }

 private:
  std::optional<VectorXd> u_;
  bool under_way_ = false;
  LearntMetrics learnt_;
  VectorXd means_, deviations_;
  SurrogateTally& tally_;
};

class Nothing : public PointSource {
 public:
  std::optional<VectorXd> Ask(Archive& /*archive*/) override { return std::nullopt; }
  void Tell(Archive& /*archive*/, std::size_t /*entry*/) override {}
  bool Finished() const override { return true; }
};

bool IsKnown(const VectorXd& u, const Archive& archive, const std::vector<VectorXd>& under_way) {
  const auto same = [&](const VectorXd& other) {
    return (u - other).lpNorm<Eigen::Infinity>() < kSameDesign;
  };
  for (std::size_t entry = 0; entry < archive.size(); ++entry) {
    if (same(archive[entry].u)) return true;
  }
  return std::ranges::any_of(under_way, same);
}

}  // namespace

// A trade-off moved a little, a design between two or beyond, or some parameters moved.
VectorXd SurrogateSearch::Candidate(const Archive& archive) {
  const auto& front = archive.non_dominated();
  const VectorXd& one = archive[front[random_.Index(front.size())]].u;
  const VectorXd& other = archive[front[random_.Index(front.size())]].u;
  const std::size_t way = random_.Index(3);
  if (way == 0) return PerturbedSample(one, kMinMove, random_);
  VectorXd u = one;
  if (way == 1) {
    u += (2 * random_.Uniform() - 0.5) * (other - one);
    return u.cwiseMax(0.0).cwiseMin(1.0);
  }
  const double scale = std::exp2(-kMinMove * random_.Uniform());
  const double share = kChangedParameters / static_cast<double>(u.size());
  for (double& value : u) {
    if (random_.Uniform() < share) value += scale * (2 * random_.Uniform() - 1);
  }
  return u.cwiseMax(0.0).cwiseMin(1.0);
}

// Those that fill the space come first.
MatrixXd SurrogateSearch::Candidates(const Archive& archive) {
  const Index count = options_.candidates;
  MatrixXd candidates(box_.size(), count);
  Index k = 0;
  for (const VectorXd& u : LatinHypercube(count / 4, box_.size(), random_)) candidates.col(k++) = u;
  while (k < count) candidates.col(k++) = Candidate(archive);
  return candidates;
}

// Where the weighted sum of metrics, each as much better than believed as it may be, is least.
VectorXd SurrogateSearch::MayBeBest(const Archive& archive, const MatrixXd& candidates,
                                    const VectorXd& weights) const {
  const Ascended goodness = [&](const VectorXd& u, VectorXd& gradient) {
    const SurrogateModel::Belief belief = model_.At(u);
    gradient = belief.log_feasibility_gradient;
    double value = belief.log_feasibility;
    for (Index k = 0; k < weights.size(); ++k) {
      const auto& metric = belief.metrics[static_cast<std::size_t>(k)];
      value -= weights[k] * (metric.mean - kOptimism * metric.deviation);
      gradient -= weights[k] * (metric.mean_gradient - kOptimism * metric.deviation_gradient);
    }
    return value;
  };
  const std::vector<std::size_t>& front = archive.non_dominated();
  MatrixXd starts(candidates.rows(), std::ssize(front) + candidates.cols());
  for (std::size_t k = 0; k < front.size(); ++k) {
    starts.col(static_cast<Index>(k)) = archive[front[k]].u;
  }
  starts.rightCols(candidates.cols()) = candidates;
  const SurrogateModel::Beliefs beliefs = model_.AtAll(starts);
  VectorXd values = beliefs.log_feasibilities;
  for (Index k = 0; k < weights.size(); ++k) {
    const auto& metric = beliefs.metrics[static_cast<std::size_t>(k)];
    values -= weights[k] * (metric.means - kOptimism * metric.deviations);
  }
  Index best = 0;
  values.maxCoeff(&best);
  return Ascend(goodness, starts.col(best), options_.steps);
}

VectorXd SurrogateSearch::Reference(const Archive& archive, const MatrixXd& candidates) const {
  const Index d = model_.learnt().knees.size();
  VectorXd nadir = VectorXd::Ones(d);
  for (Index k = 0; k < d; ++k) {
    VectorXd weights = VectorXd::Constant(d, kUnimportance);
    weights[k] = 1;
    const VectorXd u = MayBeBest(archive, candidates, weights);
    nadir = nadir.cwiseMax(MeansOf(model_.At(u))).eval();
  }
  return (1 + kMargin) * nadir;
}

// The performance of the trade-offs, and that of designs under way, which are believed from here
// on.
std::vector<VectorXd> SurrogateSearch::FrontWith(const Archive& archive,
                                                 const std::vector<VectorXd>& under_way) {
  std::vector<VectorXd> front;
  for (const std::size_t entry : archive.non_dominated()) {
    front.push_back(model_.learnt().Of(archive[entry].metrics));
  }
  for (const VectorXd& u : under_way) {
    const SurrogateModel::Belief belief = model_.At(u);
    if (belief.log_feasibility > std::log(0.5)) front.push_back(MeansOf(belief));
    model_.Believe(u);
  }
  return front;
}

// Candidates and what ascents from the best of them lead to, the best first.
std::vector<VectorXd> SurrogateSearch::MostExpected(
    const ExpectedHypervolumeImprovement& improvement, const MatrixXd& candidates) const {
  const Ascended acquisition = [&](const VectorXd& u, VectorXd& gradient) {
    return LogAcquisition(model_.At(u), improvement, gradient);
  };
  const VectorXd values = LogAcquisitions(model_.AtAll(candidates), improvement);
  std::vector<std::pair<double, VectorXd>> ranked;
  for (Index j = 0; j < values.size(); ++j) ranked.emplace_back(values[j], candidates.col(j));
  const auto sort = [&] {
    std::ranges::stable_sort(ranked, std::greater(), [](const auto& entry) { return entry.first; });
  };
  sort();
  const auto ascents = std::min(ranked.size(), static_cast<std::size_t>(options_.ascents));
  for (std::size_t k = 0; k < ascents; ++k) {
    const VectorXd u = Ascend(acquisition, ranked[k].second, options_.steps);
    VectorXd gradient;
    ranked.emplace_back(acquisition(u, gradient), u);
  }
  sort();
  std::vector<VectorXd> designs;
  for (auto& [value, u] : ranked) designs.push_back(std::move(u));
  return designs;
}

std::unique_ptr<PointSource> SurrogateSearch::Next(const Archive& archive,
                                                   const std::vector<VectorXd>& under_way) {
  model_.Learn(archive);
  const SurrogateModel before = model_;
  const MatrixXd candidates = Candidates(archive);
  const VectorXd reference = Reference(archive, candidates.leftCols(candidates.cols() / 4));
  const ExpectedHypervolumeImprovement improvement(FrontWith(archive, under_way), reference);
  for (const VectorXd& u : MostExpected(improvement, candidates)) {
    const VectorXd possible = box_.ToUnit(box_.FromUnit(u));
    if (!IsKnown(possible, archive, under_way)) {
      return std::make_unique<Proposed>(possible, before, tally_);
    }
  }
  return std::make_unique<Nothing>();
}

}  // namespace mortise::pareto
