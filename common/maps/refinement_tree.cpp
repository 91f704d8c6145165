#include "common/maps/refinement_tree.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::maps {
namespace {

constexpr int kMostDepth = kLatticeLevels - 2;
constexpr int kMostCubicDirections = 5;

// Visits the active B-splines that are not zero at a point, with their values and slopes.
class ActiveAt {
 public:
  ActiveAt(const RefinementTree& tree, const Eigen::VectorXd& point)
      : tree_(tree), point_(point), factors_(tree.dimension()) {}

  // visit(spline number, value, gradient)
  template <typename Visit>
  void Level(int level, const Visit& visit) {
    const int reach = ReachOf(tree_.basis());
    const std::int32_t spacing = SpacingOf(level);
    LatticeBox centres;
    LatticePoint step{};
    step.fill(spacing);
    for (int d = 0; d < tree_.dimension(); ++d) {
      const double scaled = std::ldexp(point_[d], level);
      const int cell = std::min(static_cast<int>(scaled), (1 << level) - 1);
      centres.low[d] = (cell - reach + 1) * spacing;
      centres.high[d] = (cell + reach) * spacing;
    }
    Eigen::VectorXd gradient(tree_.dimension());
    ForEachGridPoint(tree_.dimension(), centres, step, [&](const LatticePoint& centre) {
      const int number = tree_.splines().Find(level, centre);
      if (number < 0 || !tree_.splines().At(number).active) return;
      const double value = Product(level, centre, gradient);
      visit(number, value, gradient);
    });
  }

 private:
  double Product(int level, const LatticePoint& centre, Eigen::VectorXd& gradient) {
    double value = 1;
    for (int d = 0; d < tree_.dimension(); ++d) {
      const double offset = std::ldexp(point_[d] - ToUnit(centre[d]), level);
      factors_[d] =
          point_[d] < 1 ? SplineAt(tree_.basis(), offset) : SplineAtEnd(tree_.basis(), offset);
      factors_[d].slope = std::ldexp(factors_[d].slope, level);
      value *= factors_[d].value;
    }
    for (int d = 0; d < tree_.dimension(); ++d) {
      gradient[d] = factors_[d].slope;
      for (int other = 0; other < tree_.dimension(); ++other) {
        if (other != d) gradient[d] *= factors_[other].value;
      }
    }
    return value;
  }

  const RefinementTree& tree_;
  const Eigen::VectorXd& point_;
  std::vector<SplineValue> factors_;
};

}  // namespace

int DefaultDisparity(int dimension) {
  constexpr int kBounds[] = {20, 20, 11, 5, 3, 2, 2};
  return dimension < 7 ? kBounds[dimension] : 1;
}

RefinementTree::RefinementTree(int dimension, Basis basis, const RefinementOptions& options)
    : basis_(basis),
      options_(options),
      elements_(dimension),
      splines_(dimension, basis),
      finest_(1, 0) {}

absl::StatusOr<RefinementTree> RefinementTree::Create(int dimension, Basis basis,
                                                      const RefinementOptions& options) {
  const int most = basis == Basis::kLinear ? kMostDirections : kMostCubicDirections;
  if (dimension < 1 || dimension > most) {
    return InvalidField("dimension", absl::StrCat("is ", dimension, ", not 1 to ", most));
  }
  if (options.most_depth < 1 || options.most_depth > kMostDepth) {
    return InvalidField("options.most_depth", absl::StrCat("is not 1 to ", kMostDepth));
  }
  if (options.most_disparity < 0) {
    return InvalidField("options.most_disparity", "is negative");
  }
  RefinementOptions complete = options;
  if (complete.most_disparity == 0) complete.most_disparity = DefaultDisparity(dimension);
  return RefinementTree(dimension, basis, complete);
}

absl::StatusOr<RefinementTree> RefinementTree::Replay(int dimension, Basis basis,
                                                      const RefinementOptions& options,
                                                      std::span<const ElementSplit> history) {
  absl::StatusOr<RefinementTree> tree = Create(dimension, basis, options);
  if (!tree.ok()) return tree.status();
  std::vector<int> added;
  for (std::size_t n = 0; n < history.size(); ++n) {
    const auto [element, direction] = history[n];
    if (!tree->CanSplit(element, direction)) {
      return InvalidField(absl::StrCat("splits[", n, "]"),
                          absl::StrCat("does not split an element of that moment (", element,
                                       " along ", direction, ")"));
    }
    tree->SplitOnce(element, direction, added);
  }
  return tree;
}

std::vector<int> RefinementTree::Elements() const {
  std::vector<int> found;
  found.reserve(element_count());
  for (int node = 0; node < elements_.node_count(); ++node) {
    if (elements_.IsElement(node)) found.push_back(node);
  }
  return found;
}

bool RefinementTree::IsElement(int element) const {
  return element >= 0 && element < elements_.node_count() && elements_.IsElement(element);
}

ElementBox RefinementTree::BoxOf(int element) const {
  ElementBox box{Eigen::VectorXd(dimension()), Eigen::VectorXd(dimension())};
  for (int d = 0; d < dimension(); ++d) {
    box.low[d] = ToUnit(LatticeBoxOf(element).low[d]);
    box.high[d] = ToUnit(LatticeBoxOf(element).high[d]);
  }
  return box;
}

std::vector<int> RefinementTree::Neighbours(int element) const {
  std::vector<int> touching = elements_.Touching(LatticeBoxOf(element));
  touching.erase(std::remove(touching.begin(), touching.end(), element), touching.end());
  return touching;
}

Eigen::VectorXd RefinementTree::SamplePosition(int sample) const {
  return UnitPosition(SampleLattice(sample), dimension());
}

std::vector<int> RefinementTree::SampleElements(int sample) const {
  return elements_.Touching({SampleLattice(sample), SampleLattice(sample)});
}

int RefinementTree::Locate(const Eigen::Ref<const Eigen::VectorXd>& point) const {
  const Eigen::VectorXd inside = point.cwiseMax(0).cwiseMin(1);
  return elements_.Locate(inside.data());
}

bool RefinementTree::CanSplit(int element, int direction) const {
  return IsElement(element) && direction >= 0 && direction < dimension() &&
         DepthOf(element, direction) < options_.most_depth;
}

int RefinementTree::DirectionBefore(int element, int direction) const {
  if (DepthOf(element, direction) + 1 - elements_.LeastDepthOf(element) <=
      options_.most_disparity) {
    return direction;
  }
  int least = direction == 0 ? dimension() - 1 : 0;
  for (int d = 0; d < dimension(); ++d) {
    if (DepthOf(element, d) < DepthOf(element, least)) least = d;
  }
  return dimension() == 1 ? direction : least;
}

std::vector<LatticePoint> RefinementTree::NewSamples(int element, int direction) const {
  return elements_.NewSamples(element, direction);
}

absl::StatusOr<std::vector<int>> RefinementTree::Split(int element, int direction) {
  if (!IsElement(element)) return InvalidField("element", absl::StrCat(element, " is none"));
  if (!CanSplit(element, direction)) {
    return InvalidField("direction", absl::StrCat("is none, or has been split ",
                                                  options_.most_depth, " times already"));
  }
  std::vector<int> added, open = {element};
  while (!open.empty()) {
    const int part = open.back();
    open.pop_back();
    const int first = DirectionBefore(part, direction);
    SplitOnce(part, first, added);
    if (first != direction) {
      open.push_back(elements_.node_count() - 1);
      open.push_back(elements_.node_count() - 2);
    }
  }
  return added;
}

void RefinementTree::SplitOnce(int element, int direction, std::vector<int>& added) {
  const LatticeBox box = LatticeBoxOf(element);
  const int level = DepthOf(element, direction);
  const std::vector<int> samples = elements_.Split(element, direction);
  added.insert(added.end(), samples.begin(), samples.end());
  finest_.resize(elements_.node_count(), finest_[element]);
  history_.push_back({element, direction});
  // Step 2: those whose support is larger than the element (cubic: than twice the element). By
  // Remark 1 none is coarser than `level`. Step 3 is Allocation, which asks the present tree.
  const LatticeBox region = splines_.RefineOver(box, level);
  for (const int near : elements_.Overlapping(region)) {
    finest_[near] = std::max(finest_[near], level + 1);
  }
}

std::vector<SampleWeight> RefinementTree::Allocation(const BSpline& spline) const {
  const RationalPoint local = spline.LocalPoint();
  const LatticeBox cuboid = elements_.CommonCuboid(local);
  std::vector<SampleWeight> allocation;
  const double share =
      static_cast<double>(spline.weight) / static_cast<double>(splines_.whole_weight());
  LatticePoint corner{};
  // Multi-linear weights β of the local point in its common cuboid (6.10).
  const auto descend = [&](const auto& self, int d, double weight) -> void {
    if (d == dimension()) {
      allocation.push_back({elements_.FindSample(corner), weight});
      return;
    }
    const std::int64_t low = cuboid.low[d] * local.denominator;
    const std::int64_t high = cuboid.high[d] * local.denominator;
    const double upper = high == low ? 0.0
                                     : static_cast<double>(local.numerator[d] - low) /
                                           static_cast<double>(high - low);
    if (upper < 1) {
      corner[d] = cuboid.low[d];
      self(self, d + 1, weight * (1 - upper));
    }
    if (upper > 0) {
      corner[d] = cuboid.high[d];
      self(self, d + 1, weight * upper);
    }
  };
  descend(descend, 0, share);
  return allocation;
}

PointWeights RefinementTree::Weights(const Eigen::Ref<const Eigen::VectorXd>& point) const {
  if (basis_ != Basis::kLinear) return {};
  const Eigen::VectorXd inside = point.cwiseMax(0).cwiseMin(1);
  const int element = elements_.Locate(inside.data());
  std::map<int, std::pair<double, Eigen::VectorXd>> sums;
  ActiveAt active(*this, inside);
  for (int level = CoarsestLevel(element); level <= FinestLevel(element); ++level) {
    active.Level(level, [&](int number, double value, const Eigen::VectorXd& gradient) {
      for (const SampleWeight& part : Allocation(splines_.At(number))) {
        auto& [weight, slope] = sums[part.sample];
        if (slope.size() == 0) slope = Eigen::VectorXd::Zero(dimension());
        weight += part.weight * value;
        slope += part.weight * gradient;
      }
    });
  }
  PointWeights result;
  result.weights.resize(static_cast<Eigen::Index>(sums.size()));
  result.gradients.resize(dimension(), static_cast<Eigen::Index>(sums.size()));
  for (const auto& [sample, sum] : sums) {
    const auto n = static_cast<Eigen::Index>(result.samples.size());
    result.samples.push_back(sample);
    result.weights[n] = sum.first;
    result.gradients.col(n) = sum.second;
  }
  return result;
}

}  // namespace mortise::maps
