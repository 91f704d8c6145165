#include "common/maps/coefficients.h"

#include <algorithm>
#include <unordered_map>

#include "common/maps/element_models.h"

namespace mortise::maps {
namespace {

// Coefficients of cubic B-splines. What the whole map's expansion in B-splines of level j has as
// coefficient at a centre is asked of the local models, λ. An active B-spline of that level adds
// what its active ancestors do not bring there already: q = λ - T (truncation, Giannelli, Jüttler,
// Speleers 2012; quasi-interpolation with it, Speleers, Manni 2016). A polynomial that all λ
// reproduce, the map does.
class CubicCoefficients {
 public:
  CubicCoefficients(const RefinementTree& tree, const Eigen::MatrixXd& values,
                    const std::vector<std::uint8_t>& cut_off)
      : tree_(tree), cut_off_(cut_off), models_(tree, values, cut_off), outputs_(values.rows()) {}

  Eigen::MatrixXd Compute() {
    const SplineSet& splines = tree_.splines();
    wanted_ = Eigen::MatrixXd::Zero(outputs_, splines.count());
    for (int number = 0; number < splines.count(); ++number) {
      if (splines.At(number).active) wanted_.col(number) = Wanted(splines.At(number));
    }
    Eigen::MatrixXd coefficients = wanted_;
    for (int number = 0; number < splines.count(); ++number) {
      const BSpline& spline = splines.At(number);
      // α = 1: there are no active ancestors (Remark 7).
      if (!spline.active || spline.weight == splines.whole_weight()) continue;
      coefficients.col(number) -= FromAncestors(spline.level, spline.centre);
    }
    return coefficients;
  }

 private:
  std::vector<int> WithValues(std::vector<int> elements) const {
    elements.erase(std::remove_if(elements.begin(), elements.end(),
                                  [&](int element) { return cut_off_[element] != 0; }),
                   elements.end());
    return elements;
  }

  // λ: the mean over the elements around the centre, which is taken into the box for that. Where
  // those are cut off, over the others of the support.
  Eigen::VectorXd Wanted(const BSpline& spline) {
    RationalPoint inside;
    for (int d = 0; d < tree_.dimension(); ++d) {
      inside.numerator[d] = std::clamp(spline.centre[d], 0, kBoxEdge);
    }
    std::vector<int> around = WithValues(tree_.elements().Containing(inside));
    if (around.empty()) {
      around = WithValues(tree_.elements().Overlapping(tree_.splines().SupportOf(spline)));
    }
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(outputs_);
    if (around.empty()) return sum;
    for (const int element : around) {
      sum += models_.Coefficient(element, spline.level, spline.centre);
    }
    return sum / static_cast<double>(around.size());
  }

  // T: what active B-splines of coarser levels bring to the centre of this level.
  Eigen::VectorXd FromAncestors(int level, const LatticePoint& centre) {
    if (level == 0) return Eigen::VectorXd::Zero(outputs_);
    const auto known = from_ancestors_.find({level, centre});
    if (known != from_ancestors_.end()) return known->second;
    const std::int32_t half = SpacingOf(level), spacing = SpacingOf(level - 1);
    LatticeBox parents;
    LatticePoint step{};
    step.fill(spacing);
    for (int d = 0; d < tree_.dimension(); ++d) {
      // The first multiple of the parents' spacing within two halves: masks are (1, 4, 6, 4, 1)/8.
      const std::int32_t first = centre[d] - 2 * half;
      parents.low[d] = std::max(first + (first % spacing == 0 ? 0 : half), -spacing);
      parents.high[d] = std::min(centre[d] + 2 * half, kBoxEdge + spacing);
    }
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(outputs_);
    ForEachGridPoint(tree_.dimension(), parents, step, [&](const LatticePoint& parent) {
      constexpr double kMask[] = {1.0 / 8, 1.0 / 2, 6.0 / 8, 1.0 / 2, 1.0 / 8};
      double part = 1;
      for (int d = 0; d < tree_.dimension(); ++d) part *= kMask[(centre[d] - parent[d]) / half + 2];
      const int number = tree_.splines().Find(level - 1, parent);
      if (number < 0) {
        sum += part * FromAncestors(level - 1, parent);
      } else if (tree_.splines().At(number).active) {
        sum += part * wanted_.col(number);
      }
      // One that was refined had no active ancestors (Remark 2), and brings nothing itself.
    });
    from_ancestors_.emplace(LeveledPoint{level, centre}, sum);
    return sum;
  }

  const RefinementTree& tree_;
  const std::vector<std::uint8_t>& cut_off_;
  ElementModels models_;
  Eigen::Index outputs_;
  Eigen::MatrixXd wanted_;
  std::unordered_map<LeveledPoint, Eigen::VectorXd, LatticeHash> from_ancestors_;
};

Eigen::MatrixXd LinearCoefficients(const RefinementTree& tree, const Eigen::MatrixXd& values) {
  const SplineSet& splines = tree.splines();
  Eigen::MatrixXd coefficients = Eigen::MatrixXd::Zero(values.rows(), splines.count());
  for (int number = 0; number < splines.count(); ++number) {
    if (!splines.At(number).active) continue;
    for (const SampleWeight& part : tree.Allocation(splines.At(number))) {
      coefficients.col(number) += part.weight * values.col(part.sample);
    }
  }
  return coefficients;
}

}  // namespace

Eigen::MatrixXd ComputeCoefficients(const RefinementTree& tree, const Eigen::MatrixXd& values,
                                    const std::vector<std::uint8_t>& cut_off) {
  return tree.basis() == Basis::kLinear ? LinearCoefficients(tree, values)
                                        : CubicCoefficients(tree, values, cut_off).Compute();
}

}  // namespace mortise::maps
