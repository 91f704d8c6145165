#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "common/base/random.h"
#include "common/maps/refinement_tree.h"

namespace mortise::maps {
namespace {

absl::Status Broken(const std::string& what) { return absl::InternalError(what); }

std::string Text(const Eigen::VectorXd& point) {
  std::string text = "(";
  for (Eigen::Index d = 0; d < point.size(); ++d) absl::StrAppend(&text, d ? ", " : "", point[d]);
  return text + ")";
}

absl::Status CheckPoint(const RefinementTree& tree, int element, const Eigen::VectorXd& point,
                        double tolerance) {
  const PointWeights weights = tree.Weights(point);
  if (std::abs(weights.weights.sum() - 1) > tolerance) {
    return Broken(
        absl::StrCat("basis functions sum to ", weights.weights.sum(), " at ", Text(point)));
  }
  Eigen::VectorXd reproduced = Eigen::VectorXd::Zero(tree.dimension());
  for (std::size_t n = 0; n < weights.samples.size(); ++n) {
    const int sample = weights.samples[n];
    const double weight = weights.weights[static_cast<Eigen::Index>(n)];
    reproduced += weight * tree.SamplePosition(sample);
    const std::vector<int>& local = tree.ElementSamples(element);
    if (std::abs(weight) > tolerance && !std::binary_search(local.begin(), local.end(), sample)) {
      return Broken(absl::StrCat("sample ", sample, " acts on element ", element,
                                 ", which it does not touch, at ", Text(point)));
    }
  }
  if ((reproduced - point).cwiseAbs().maxCoeff() > tolerance) {
    return Broken(absl::StrCat("x is not reproduced at ", Text(point)));
  }
  return absl::OkStatus();
}

// Remark 1 (no active B-spline is larger than twice an element that it overlaps) and, by Remark 9
// and locality, the local point in every element of the support.
absl::Status CheckSpline(const RefinementTree& tree, const BSpline& spline) {
  const RationalPoint local = spline.LocalPoint();
  for (const int element : tree.elements().Overlapping(tree.splines().SupportOf(spline))) {
    const LatticeBox& box = tree.LatticeBoxOf(element);
    for (int d = 0; d < tree.dimension(); ++d) {
      if (SpacingOf(spline.level) > box.high[d] - box.low[d]) {
        return Broken(absl::StrCat("a B-spline of level ", spline.level,
                                   " is too large for element ", element, " (Remark 1)"));
      }
      if (tree.basis() != Basis::kLinear) continue;
      if (local.numerator[d] < box.low[d] * local.denominator ||
          local.numerator[d] > box.high[d] * local.denominator) {
        return Broken(absl::StrCat("a B-spline of level ", spline.level,
                                   " has no local point on element ", element));
      }
    }
  }
  return absl::OkStatus();
}

// Remark 6: α and y are those that the refined parents give. Counted anew here, in whole parts.
absl::Status CheckParents(const RefinementTree& tree, const BSpline& spline) {
  if (spline.level == 0) return absl::OkStatus();
  constexpr std::int64_t kParts[2][5] = {{1, 2, 1}, {1, 4, 6, 4, 1}};
  const int reach = ReachOf(tree.basis());
  const std::int32_t half = SpacingOf(spline.level);
  LatticeBox places;
  LatticePoint step{};
  step.fill(half);
  for (int d = 0; d < tree.dimension(); ++d) {
    places.low[d] = spline.centre[d] - reach * half;
    places.high[d] = spline.centre[d] + reach * half;
  }
  BSpline sum;
  ForEachGridPoint(tree.dimension(), places, step, [&](const LatticePoint& centre) {
    const int parent = tree.splines().Find(spline.level - 1, centre);
    if (parent < 0 || tree.splines().At(parent).active) return;
    std::int64_t part = 1;
    for (int d = 0; d < tree.dimension(); ++d) {
      part *= kParts[reach - 1][(spline.centre[d] - centre[d]) / half + reach];
    }
    sum.weight += part;
    for (int d = 0; d < tree.dimension(); ++d) sum.moment[d] += part * centre[d];
  });
  if (sum.weight == spline.weight && sum.moment == spline.moment) return absl::OkStatus();
  return Broken(absl::StrCat("a B-spline of level ", spline.level,
                             " is not the sum over its refined parents (Remark 6)"));
}

absl::Status CheckSplines(const RefinementTree& tree) {
  const SplineSet& splines = tree.splines();
  for (int number = 0; number < splines.count(); ++number) {
    const BSpline& spline = splines.At(number);
    if (!spline.active) {
      // Remark 2 and 7: what was refined had no active ancestors, so that α = 1 and y = c.
      if (spline.weight != splines.whole_weight()) {
        return Broken("a B-spline was refined although it had active ancestors (Remark 2)");
      }
      continue;
    }
    if (absl::Status status = CheckSpline(tree, spline); !status.ok()) return status;
    if (absl::Status status = CheckParents(tree, spline); !status.ok()) return status;
    if (tree.basis() != Basis::kLinear) continue;
    for (const SampleWeight& part : tree.Allocation(spline)) {
      if (part.sample < 0) return Broken("a corner of a common cuboid is not a sample");
    }
  }
  return absl::OkStatus();
}

absl::Status CheckSamples(const RefinementTree& tree, double tolerance) {
  for (int sample = 0; sample < tree.sample_count(); ++sample) {
    const PointWeights weights = tree.Weights(tree.SamplePosition(sample));
    for (std::size_t n = 0; n < weights.samples.size(); ++n) {
      const double expected = weights.samples[n] == sample ? 1 : 0;
      if (std::abs(weights.weights[static_cast<Eigen::Index>(n)] - expected) > tolerance) {
        return Broken(absl::StrCat("the map does not take the value of sample ", sample, " there"));
      }
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status CheckInvariants(const RefinementTree& tree, int points, double tolerance) {
  if (absl::Status status = CheckSplines(tree); !status.ok()) return status;
  if (tree.basis() != Basis::kLinear) return absl::OkStatus();
  if (absl::Status status = CheckSamples(tree, tolerance); !status.ok()) return status;
  Random random(static_cast<std::uint64_t>(tree.sample_count()));
  for (const int element : tree.Elements()) {
    const ElementBox box = tree.BoxOf(element);
    for (int n = 0; n < points; ++n) {
      Eigen::VectorXd point(tree.dimension());
      for (int d = 0; d < tree.dimension(); ++d) {
        point[d] = box.low[d] + random.Uniform() * (box.high[d] - box.low[d]);
      }
      if (absl::Status status = CheckPoint(tree, element, point, tolerance); !status.ok()) {
        return status;
      }
    }
  }
  return absl::OkStatus();
}

}  // namespace mortise::maps
