// Figure 4-7: rejection against adaptive sampling by Metropolis and Hastings, on z = x² + y².
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/base/random.h"
#include "common/render/chart.h"
#include "services/retrieval/cover/cover_error.h"
#include "services/retrieval/cover/differences.h"
#include "services/retrieval/cover/manifold_cover.h"
#include "services/retrieval/cover/tangent_fit.h"
#include "services/retrieval/cover/tangent_frame.h"
#include "tests/bench/services/retrieval/evaluation/figures.h"
#include "tests/unit/services/retrieval/cover/known_manifolds.h"

namespace mortise::retrieval {
namespace {

using Eigen::VectorXd;

constexpr double kDelta = 0.15;
constexpr int kBurnIn = 500, kThinning = 5;  // states of the chain
constexpr double kProposal = 0.4;            // standard deviation where the measure is average
constexpr int kErrorSamples = 4000;

// What one scheme came to.
struct Scheme {
  std::string name;
  std::vector<Primitive> primitives;
};

// The area that a unit of the parameters has at q.
double AreaElement(const Manifold& manifold, const VectorXd& q) {
  const auto derivatives = manifold.DerivativesAt(q);
  return std::sqrt((derivatives->first.transpose() * derivatives->first).determinant());
}

// The largest curvature along a parameter, as (4.4) takes it.
double Curvature(const Manifold& manifold, const VectorXd& q) {
  const auto derivatives = manifold.DerivativesAt(q);
  double largest = 0;
  for (Eigen::Index k = 0; k < derivatives->first.cols(); ++k) {
    const VectorXd first = derivatives->first.col(k), second = derivatives->second.col(k);
    const double square = first.squaredNorm();
    largest =
        std::max(largest, (second * square - first * second.dot(first)).norm() / (square * square));
  }
  return largest;
}

// Adaptive sampling as the thesis has it: from where the chain stands a proposal is drawn by a
// Gaussian whose variance is proportional to the measure there, and accepted so that samples are as
// dense as `density` says.
class AdaptiveChain {
 public:
  using Measure = std::function<double(const VectorXd&)>;

  AdaptiveChain(Measure measure, Measure density, std::uint64_t seed)
      : measure_(std::move(measure)), density_(std::move(density)), random_(seed) {
    double sum = 0;
    constexpr int kProbes = 400;
    for (int i = 0; i < kProbes; ++i) sum += measure_(Anywhere());
    mean_ = sum / kProbes;
  }

  std::vector<VectorXd> Draw(int count) {
    VectorXd at = Anywhere();
    std::vector<VectorXd> drawn;
    for (int step = 0; static_cast<int>(drawn.size()) < count; ++step) {
      Move(&at);
      if (step >= kBurnIn && step % kThinning == 0) drawn.push_back(at);
    }
    return drawn;
  }

 private:
  VectorXd Anywhere() {
    return Eigen::Vector2d(2 * random_.Uniform() - 1, 2 * random_.Uniform() - 1);
  }

  double Variance(const VectorXd& at) const { return kProposal * kProposal * measure_(at) / mean_; }

  // The logarithm of the density of proposing `to` from `from`, but for a constant.
  double Proposal(const VectorXd& from, const VectorXd& to) const {
    const double variance = Variance(from);
    return -(to - from).squaredNorm() / (2 * variance) - std::log(variance);
  }

  void Move(VectorXd* at) {
    const double deviation = std::sqrt(Variance(*at));
    const VectorXd next = *at + deviation * Eigen::Vector2d(random_.Normal(), random_.Normal());
    const double chance = random_.Uniform();
    if (next.cwiseAbs().maxCoeff() > 1) return;
    const double ratio =
        std::log(density_(next) / density_(*at)) + Proposal(next, *at) - Proposal(*at, next);
    if (std::log(chance) < ratio) *at = next;
  }

  Measure measure_, density_;
  Random random_;
  double mean_ = 1;
};

absl::StatusOr<Primitive> PointAt(const Manifold& manifold, const VectorXd& q) {
  MORTISE_ASSIGN_OR_RETURN(const VectorXd value, manifold.Evaluate(q));
  return Primitive{.parameters = q,
                   .center = value,
                   .axes = Eigen::MatrixXd(value.size(), 0),
                   .radii = VectorXd(0)};
}

// The tangent that a cover would have at q.
absl::StatusOr<Primitive> TangentAt(const Manifold& manifold, const VectorXd& q) {
  MORTISE_ASSIGN_OR_RETURN(const VectorXd value, manifold.Evaluate(q));
  MORTISE_ASSIGN_OR_RETURN(const Derivatives derivatives, manifold.DerivativesAt(q));
  MORTISE_ASSIGN_OR_RETURN(const VectorXd extents, ExtentsOf(manifold.constraints()));
  const TangentFrame frame(manifold.constraints(), q, derivatives, extents, kDelta,
                           DerivativeError(manifold.noise()));
  ParallelEvaluator evaluator(manifold, 1);
  return FitTangent(evaluator, frame, frame.rank(),
                    {.parameters = q, .value = value, .delta = kDelta, .seed = 1});
}

absl::StatusOr<Scheme> Rejection(const Manifold& manifold, CoverKind kind, std::uint64_t seed) {
  MORTISE_ASSIGN_OR_RETURN(Cover cover,
                           CoverManifold(manifold, {.delta = kDelta, .seed = seed, .kind = kind}));
  return Scheme{kind == CoverKind::kPoints ? "points, by rejection" : "tangents, by rejection",
                std::move(cover.primitives)};
}

absl::StatusOr<Scheme> Adaptive(const Manifold& manifold, CoverKind kind, std::size_t count,
                                std::uint64_t seed) {
  const auto area = [&](const VectorXd& q) { return AreaElement(manifold, q); };
  const auto curvature = [&](const VectorXd& q) { return Curvature(manifold, q); };
  const bool points = kind == CoverKind::kPoints;
  // A tangent of K = 2 axes reaches as far as curvature allows, √(2δ/κ) either way.
  AdaptiveChain chain(
      points ? AdaptiveChain::Measure(area) : curvature,
      [&](const VectorXd& q) { return area(q) * (points ? 1 : curvature(q)); }, seed);
  Scheme scheme{points ? "points, adaptive by area" : "tangents, adaptive by curvature", {}};
  for (const VectorXd& q : chain.Draw(static_cast<int>(count))) {
    MORTISE_ASSIGN_OR_RETURN(Primitive primitive,
                             points ? PointAt(manifold, q) : TangentAt(manifold, q));
    scheme.primitives.push_back(std::move(primitive));
  }
  return scheme;
}

render::ChartPanel PanelOf(const Scheme& scheme, int color) {
  render::ChartPanel panel{.title = absl::StrCat(scheme.name, ": ", scheme.primitives.size()),
                           .x_name = "x",
                           .y_name = "y",
                           .x_shown = {-1, 1},
                           .y_shown = {-1, 1}};
  render::ChartSeries series{.color = render::PartColor(color), .line_width = 0};
  for (const Primitive& primitive : scheme.primitives) {
    series.x.push_back(primitive.parameters[0]);
    series.y.push_back(primitive.parameters[1]);
  }
  panel.series.push_back(std::move(series));
  return panel;
}

}  // namespace

absl::Status WriteSamplingSchemes(Study& study, ResultFolder& results) {
  const FunctionManifold manifold(testing::Paraboloid());
  const std::uint64_t seed = study.settings().seed;
  std::vector<Scheme> schemes;
  for (const CoverKind kind : {CoverKind::kPoints, CoverKind::kTangents}) {
    MORTISE_ASSIGN_OR_RETURN(Scheme rejection, Rejection(manifold, kind, seed));
    MORTISE_ASSIGN_OR_RETURN(Scheme adaptive,
                             Adaptive(manifold, kind, rejection.primitives.size(), seed));
    schemes.push_back(std::move(rejection));
    schemes.push_back(std::move(adaptive));
  }
  ResultTable table{.title = absl::StrFormat("Covers of a paraboloid, δ = %g", kDelta),
                    .columns = {"scheme", "primitives", "cost", "not covered (%)",
                                "99th percentile of the distance / δ", "largest / δ"},
                    .rows = {}};
  std::vector<render::ChartPanel> panels;
  for (const Scheme& scheme : schemes) {
    MORTISE_ASSIGN_OR_RETURN(
        const std::vector<double> errors,
        CoverageErrors(manifold, scheme.primitives, {.count = kErrorSamples, .seed = seed + 77}));
    const auto missed = std::ranges::count_if(errors, [](double each) { return each > kDelta; });
    int cost = 0;
    for (const Primitive& primitive : scheme.primitives) cost += Cost(primitive);
    table.rows.push_back({scheme.name, absl::StrCat(scheme.primitives.size()), absl::StrCat(cost),
                          TablePercent(static_cast<double>(missed) / double(errors.size())),
                          TableNumber(Quantile(errors, 0.99) / kDelta),
                          TableNumber(errors.back() / kDelta)});
    panels.push_back(PanelOf(scheme, scheme.name.ends_with("rejection") ? 0 : 1));
  }
  MORTISE_RETURN_IF_ERROR(results.Begin(
      "4-7", "Figure 4-7: rejection against adaptive sampling",
      "The paraboloid z = x² + y² over [−1, 1]², from above: where primitives have their centres. "
      "Adaptive sampling is given as many as rejection needed. The thesis shows the same in a "
      "picture: adaptive samples clump together and leave gaps."));
  MORTISE_RETURN_IF_ERROR(results.Add(
      "figure-4-7", DrawChart(panels, {.columns = 4, .panel_width = 260, .panel_height = 260})));
  return results.Add("figure-4-7", table);
}

}  // namespace mortise::retrieval
