#include "common/maps/element_models.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

namespace mortise::maps {
namespace {

// Along one direction k(z, z') = p (1 + t + t²/4 + 0.003 t³) + g exp(-(z - z')² / 2 w²) with t = z
// z'; over all directions their product. The first is nearly the polynomial of least degree, and as
// exact as that where a function is smooth. The others have no polynomial to overshoot with.
struct Kernel {
  double polynomial;  // p
  double gaussian;    // g
  double width;       // w, in edges of the element
};
constexpr std::array kKernels = {Kernel{1, 1e-4, 1.5}, Kernel{0, 1, 1.5}, Kernel{0, 1, 0.75}};
constexpr double kSquare = 0.25, kCube = 0.003;

// k of one place and many.
Eigen::ArrayXd Values(const Kernel& kernel, double z, const Eigen::ArrayXd& others) {
  const Eigen::ArrayXd t = z * others;
  const Eigen::ArrayXd squares = (others - z).square() / (kernel.width * kernel.width);
  return kernel.polynomial * (1 + t + kSquare * t.square() + kCube * t.cube()) +
         kernel.gaussian * (-squares / 2).exp();
}

// Its second derivative by the one place.
Eigen::ArrayXd Bends(const Kernel& kernel, double z, const Eigen::ArrayXd& others) {
  const double inverse = 1 / (kernel.width * kernel.width);
  const Eigen::ArrayXd squares = (others - z).square() * inverse;
  return kernel.polynomial * (2 * kSquare * others.square() + 6 * kCube * z * others.cube()) +
         kernel.gaussian * inverse * (squares - 1) * (-squares / 2).exp();
}

// What is added to the diagonal, so that close samples do not make weights large.
constexpr double kNugget = 1e-9;
// Samples closer to each other, in edges of the element, are not both used: what bends strongly
// over a small neighbour would be continued over all of the element.
constexpr double kLeastDistance = 0.2;
// The most samples of a model: the element's corners, then the nearest.
constexpr std::size_t kMostSamples = 200;

}  // namespace

ElementModels::ElementModels(const RefinementTree& tree, const Eigen::MatrixXd& values,
                             const std::vector<std::uint8_t>& cut_off)
    : tree_(tree), values_(values), cut_off_(cut_off), models_(tree.elements().node_count()) {}

Eigen::VectorXd ElementModels::LocalPlace(int element, const LatticePoint& point) const {
  const LatticeBox& box = tree_.LatticeBoxOf(element);
  Eigen::VectorXd place(tree_.dimension());
  for (int d = 0; d < tree_.dimension(); ++d) {
    place[d] = static_cast<double>(point[d] - box.low[d]) / (box.high[d] - box.low[d]) - 0.5;
  }
  return place;
}

bool ElementModels::IsOnFace(int element) const {
  const LatticeBox& box = tree_.LatticeBoxOf(element);
  for (int d = 0; d < tree_.dimension(); ++d) {
    if (box.low[d] == 0 || box.high[d] == kBoxEdge) return true;
  }
  return false;
}

std::vector<int> ElementModels::SamplesAround(int element) const {
  std::set<int> near;
  for (const int neighbour : tree_.elements().Touching(tree_.LatticeBoxOf(element))) {
    near.insert(neighbour);
    if (!IsOnFace(element)) continue;
    const std::vector<int> next = tree_.Neighbours(neighbour);
    near.insert(next.begin(), next.end());
  }
  std::set<int> found;
  for (const int other : near) {
    if (cut_off_[other]) continue;
    found.insert(tree_.ElementSamples(other).begin(), tree_.ElementSamples(other).end());
  }
  std::vector<std::pair<double, int>> nearest;
  for (const int sample : found) {
    const Eigen::VectorXd place = LocalPlace(element, tree_.SampleLattice(sample));
    const bool corner = (place.cwiseAbs().array() == 0.5).all();
    nearest.emplace_back(corner ? 0.0 : place.squaredNorm(), sample);
  }
  std::sort(nearest.begin(), nearest.end());
  return Thinned(element, nearest);
}

// The nearest ones that are not too close to each other, at most kMostSamples.
std::vector<int> ElementModels::Thinned(int element,
                                        const std::vector<std::pair<double, int>>& nearest) const {
  std::vector<int> samples;
  std::vector<Eigen::VectorXd> places;
  for (const auto& [distance, sample] : nearest) {
    const Eigen::VectorXd place = LocalPlace(element, tree_.SampleLattice(sample));
    const bool close = std::any_of(places.begin(), places.end(), [&](const Eigen::VectorXd& other) {
      return (place - other).cwiseAbs().maxCoeff() < kLeastDistance;
    });
    if (close) continue;
    places.push_back(place);
    samples.push_back(sample);
    if (samples.size() == kMostSamples) break;
  }
  return samples;
}

const ElementModels::Model& ElementModels::ModelOf(int element) {
  Model& model = models_[element];
  if (!model.samples.empty()) return model;
  model.samples = SamplesAround(element);
  model.places.resize(tree_.dimension(), static_cast<Eigen::Index>(model.samples.size()));
  for (Eigen::Index n = 0; n < model.places.cols(); ++n) {
    model.places.col(n) = LocalPlace(element, tree_.SampleLattice(model.samples[n]));
  }
  Fit(model);
  return model;
}

void ElementModels::Fit(Model& model) const {
  const Eigen::Index count = model.places.cols(), outputs = values_.rows();
  Eigen::MatrixXd terms = Eigen::MatrixXd::Ones(count, 1 + tree_.dimension());
  terms.rightCols(tree_.dimension()) = model.places.transpose();
  Eigen::MatrixXd values(count, outputs);
  for (Eigen::Index n = 0; n < count; ++n) {
    values.row(n) = values_.col(model.samples[n]).transpose();
  }
  const Eigen::MatrixXd linear = terms.householderQr().solve(values);
  const Eigen::MatrixXd rest = values - terms * linear;
  model.linear = linear.transpose();
  model.weights.resize(outputs, count);
  model.kernel_of.assign(outputs, 0);
  model.trust.setZero(outputs);
  // Samples on the element count most.
  const Eigen::ArrayXd nearness =
      (1 + model.places.colwise().squaredNorm().transpose().array()).inverse();
  Eigen::VectorXd least =
      Eigen::VectorXd::Constant(outputs, std::numeric_limits<double>::infinity());
  for (std::size_t number = 0; number < kKernels.size(); ++number) {
    Eigen::MatrixXd kernel = Eigen::MatrixXd::Ones(count, count);
    for (Eigen::Index d = 0; d < model.places.rows(); ++d) {
      const Eigen::ArrayXd along = model.places.row(d).transpose();
      for (Eigen::Index n = 0; n < count; ++n) {
        kernel.col(n).array() *= Values(kKernels[number], along[n], along);
      }
    }
    kernel.diagonal().array() += kNugget;
    const Eigen::MatrixXd inverse = kernel.ldlt().solve(Eigen::MatrixXd::Identity(count, count));
    const Eigen::MatrixXd weights = inverse * rest;
    for (Eigen::Index o = 0; o < outputs; ++o) {
      // What each sample differs by from the model of the others (Rippa 1999).
      const Eigen::ArrayXd errors = weights.col(o).array() / inverse.diagonal().array();
      const double error = (errors * nearness).matrix().norm();
      if (!(error < least[o])) continue;
      least[o] = error;
      model.weights.row(o) = weights.col(o).transpose();
      model.kernel_of[o] = static_cast<int>(number);
      const double bent = (rest.col(o).array() * nearness).matrix().norm();
      model.trust[o] = bent > 0 ? std::clamp(2 - 2 * error / bent, 0.0, 1.0) : 1.0;
    }
  }
}

// The corners of the element, also continued beyond it.
Eigen::VectorXd ElementModels::MultiLinear(int element, const Eigen::VectorXd& place) const {
  const LatticeBox& box = tree_.LatticeBoxOf(element);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(values_.rows());
  LatticePoint step{};
  for (int d = 0; d < tree_.dimension(); ++d) step[d] = box.high[d] - box.low[d];
  ForEachGridPoint(tree_.dimension(), box, step, [&](const LatticePoint& corner) {
    double weight = 1;
    for (int d = 0; d < tree_.dimension(); ++d) {
      weight *= corner[d] == box.high[d] ? place[d] + 0.5 : 0.5 - place[d];
    }
    sum += weight * values_.col(tree_.elements().FindSample(corner));
  });
  return sum;
}

Eigen::VectorXd ElementModels::Coefficient(int element, int level, const LatticePoint& centre) {
  const Model& model = ModelOf(element);
  const int dimension = tree_.dimension();
  const LatticeBox& box = tree_.LatticeBoxOf(element);
  const Eigen::VectorXd place = LocalPlace(element, centre);
  const Eigen::VectorXd flat = MultiLinear(element, place);
  Eigen::VectorXd result = model.linear.col(0) + model.linear.rightCols(dimension) * place;
  for (int number = 0; number < static_cast<int>(kKernels.size()); ++number) {
    const auto& used = model.kernel_of;
    if (std::find(used.begin(), used.end(), number) == used.end()) continue;
    Eigen::ArrayXd factors = Eigen::ArrayXd::Ones(model.places.cols());
    for (int d = 0; d < dimension; ++d) {
      const double spacing = static_cast<double>(SpacingOf(level)) / (box.high[d] - box.low[d]);
      const Eigen::ArrayXd along = model.places.row(d).transpose();
      factors *= Values(kKernels[number], place[d], along) -
                 spacing * spacing / 6 * Bends(kKernels[number], place[d], along);
    }
    for (Eigen::Index o = 0; o < result.size(); ++o) {
      if (used[o] == number) result[o] += model.weights.row(o).dot(factors.matrix());
    }
  }
  return flat + model.trust.cwiseProduct(result - flat);
}

}  // namespace mortise::maps
