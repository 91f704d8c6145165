#include "services/retrieval/descriptors/d2_descriptor.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "services/retrieval/descriptors/canonical_surface.h"
#include "services/retrieval/descriptors/surface_samples.h"

namespace mortise::retrieval {
namespace {

constexpr double kBinsInWidth = 20;    // bins to a kernel's σ
constexpr double kWidthsBeyond = 5;    // farther beyond the last kernel's mean nothing is seen
constexpr double kCoincident = 1e-12;  // closer points, in the box [-1, 1]³, count as one

double BinWidth(const D2Settings& settings) { return settings.width / kBinsInWidth; }

// The kernels at the bins' places, N × bins. The last two bins stand for all that is farther.
Eigen::MatrixXd MakeKernels(const D2Settings& settings) {
  const double farthest = settings.range + kWidthsBeyond * settings.width;
  const auto bins = static_cast<Eigen::Index>(std::ceil(farthest / BinWidth(settings))) + 2;
  Eigen::MatrixXd kernels(settings.kernels, bins);
  for (Eigen::Index bin = 0; bin < bins; ++bin) {
    for (Eigen::Index k = 0; k < settings.kernels; ++k) {
      const double mean = settings.range * double(k) / double(settings.kernels - 1);
      const double offset = (double(bin) * BinWidth(settings) - mean) / settings.width;
      kernels(k, bin) = bin + 2 < bins ? std::exp(-offset * offset / 2) : 0;
    }
  }
  return kernels;
}

// Coordinates by axis, so that distances to one point are computed several at a time.
struct PointColumns {
  explicit PointColumns(const Eigen::Matrix3Xd& points)
      : x(points.row(0)), y(points.row(1)), z(points.row(2)) {}

  // The distances of point i to those before it, to the beginning of `distances`.
  void DistancesBefore(Eigen::Index i, Eigen::ArrayXd& distances) const {
    distances.head(i) =
        ((x.head(i) - x[i]).square() + (y.head(i) - y[i]).square() + (z.head(i) - z[i]).square())
            .sqrt();
  }

  Eigen::ArrayXd x, y, z;
};

struct PairSums {
  double weight = 0;    // of all pairs
  double distance = 0;  // weighted
};

PairSums SumPairs(const PointColumns& points, const Eigen::VectorXd& weights) {
  PairSums sums;
  Eigen::ArrayXd distances(weights.size());
  double before = 0;
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    points.DistancesBefore(i, distances);
    sums.weight += weights[i] * before;
    sums.distance += weights[i] * weights.head(i).dot(distances.head(i).matrix());
    before += weights[i];
  }
  return sums;
}

// In which bins distances lie, found for several at once: in single precision, which moves a
// distance by less than 1/10,000 of a bin.
class BinPlaces {
 public:
  BinPlaces(double bins_a_unit, Eigen::Index bins, Eigen::Index most)
      : bins_a_unit_(bins_a_unit), last_(static_cast<float>(bins - 2)), bin_(most), beyond_(most) {}

  // Looks up the first `count` of `distances`.
  void Find(const Eigen::ArrayXd& distances, Eigen::Index count) {
    beyond_.head(count) = (distances.head(count) * bins_a_unit_).cast<float>().min(last_);
    bin_.head(count) = beyond_.head(count).cast<int>();
    beyond_.head(count) -= bin_.head(count).cast<float>();
  }

  // The bin below the j-th of them, and by which share of a bin it is farther.
  int bin(Eigen::Index j) const { return bin_[j]; }
  double beyond(Eigen::Index j) const { return beyond_[j]; }
  double bins_a_unit() const { return bins_a_unit_; }

 private:
  double bins_a_unit_;
  float last_;
  Eigen::ArrayXi bin_;
  Eigen::ArrayXf beyond_;
};

// The weight in each bin. Neighbours in the loop go to different tables, as they often hit the same
// bin and would wait for each other. A table has two numbers a bin: the weight of
// what lies from there to the next bin, and that weight times how far beyond the bin it lies.
Eigen::VectorXd BinPairs(const PointColumns& points, const Eigen::VectorXd& weights,
                         BinPlaces& places, Eigen::Index bins) {
  constexpr Eigen::Index kTables = 4;
  Eigen::Matrix2Xd tables = Eigen::Matrix2Xd::Zero(2, bins * kTables);
  Eigen::ArrayXd distances(weights.size());
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    points.DistancesBefore(i, distances);
    places.Find(distances, i);
    for (Eigen::Index j = 0; j < i; ++j) {
      const double weight = weights[i] * weights[j];
      double* const cell = &tables(0, places.bin(j) * kTables + (j & (kTables - 1)));
      cell[0] += weight;
      cell[1] += weight * places.beyond(j);
    }
  }
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(bins);
  for (Eigen::Index place = 0; place < tables.cols(); ++place) {
    const Eigen::Index bin = place / kTables;
    sums[bin] += tables(0, place) - tables(1, place);
    if (bin + 1 < bins) sums[bin + 1] += tables(1, place);
  }
  return sums;
}

// What the derivative of the bins is made of, of one field of velocities.
struct PairRates {
  double weight = 0;     // of the sum of weights
  double distance = 0;   // of the weighted sum of distances
  Eigen::VectorXd bins;  // with the mean distance held
};

class BoundD2 : public BoundDescriptor {
 public:
  BoundD2(CanonicalSurface surface, SurfaceSamples samples, double bin_width,
          std::shared_ptr<const Eigen::MatrixXd> kernels)
      : surface_(std::move(surface)),
        samples_(std::move(samples)),
        bin_width_(bin_width),
        kernels_(std::move(kernels)) {}

  absl::StatusOr<Eigen::VectorXd> Describe(const Eigen::Matrix3Xd& vertices) const override {
    MORTISE_ASSIGN_OR_RETURN(const DescriptorDerivatives result, Differentiate(vertices, {}));
    return result.value;
  }

  absl::StatusOr<DescriptorDerivatives> Differentiate(
      const Eigen::Matrix3Xd& vertices,
      std::span<const Eigen::Matrix3Xd> velocities) const override;

 private:
  std::vector<PairRates> RatesOf(const PointColumns& points, const Eigen::VectorXd& weights,
                                 const std::vector<PointVelocities>& moving, BinPlaces& places,
                                 Eigen::VectorXd& stretching) const;

  CanonicalSurface surface_;
  SurfaceSamples samples_;
  double bin_width_;
  std::shared_ptr<const Eigen::MatrixXd> kernels_;
};

absl::StatusOr<DescriptorDerivatives> BoundD2::Differentiate(
    const Eigen::Matrix3Xd& vertices, std::span<const Eigen::Matrix3Xd> velocities) const {
  MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3Xd placed, ToReferenceBox(surface_, vertices));
  const WeightedPoints sampled = samples_.At(placed);
  const PointColumns points(sampled.positions);
  const PairSums sums = SumPairs(points, sampled.weights);
  if (!(sums.distance > 0)) return InvalidField("vertices", "the surface has no area");
  const double mean = sums.distance / sums.weight;
  BinPlaces places(1 / (mean * bin_width_), kernels_->cols(), points.x.size());
  const Eigen::VectorXd bins =
      BinPairs(points, sampled.weights, places, kernels_->cols()) / sums.weight;
  DescriptorDerivatives result;
  result.value = *kernels_ * bins;
  result.jacobian.resize(kernels_->rows(), static_cast<Eigen::Index>(velocities.size()));
  if (velocities.empty()) return result;

  std::vector<PointVelocities> moving;
  for (std::size_t k = 0; k < velocities.size(); ++k) {
    MORTISE_ASSIGN_OR_RETURN(
        const Eigen::Matrix3Xd velocity,
        VelocitiesInReferenceBox(surface_, velocities[k], static_cast<Eigen::Index>(k)));
    moving.push_back(samples_.Differentiate(placed, velocity));
  }
  Eigen::VectorXd stretching;
  const std::vector<PairRates> rates =
      RatesOf(PointColumns(sampled.positions), sampled.weights, moving, places, stretching);
  for (std::size_t k = 0; k < rates.size(); ++k) {
    const double mean_rate = (rates[k].distance - mean * rates[k].weight) / sums.weight;
    const Eigen::VectorXd bins_rate =
        (rates[k].bins - mean_rate / mean * stretching) / sums.weight -
        rates[k].weight / sums.weight * bins;
    result.jacobian.col(static_cast<Eigen::Index>(k)) = *kernels_ * bins_rate;
  }
  return result;
}

// `stretching` becomes the derivative of the bins if all distances grow in proportion.
std::vector<PairRates> BoundD2::RatesOf(const PointColumns& points, const Eigen::VectorXd& weights,
                                        const std::vector<PointVelocities>& moving,
                                        BinPlaces& places, Eigen::VectorXd& stretching) const {
  const Eigen::Index bins = kernels_->cols();
  stretching = Eigen::VectorXd::Zero(bins);
  std::vector<PairRates> rates(moving.size(), {0, 0, Eigen::VectorXd::Zero(bins)});
  std::vector<PointColumns> speeds;
  for (const PointVelocities& field : moving) speeds.emplace_back(field.positions);
  Eigen::ArrayXd distances(weights.size());
  for (Eigen::Index i = 1; i < weights.size(); ++i) {
    points.DistancesBefore(i, distances);
    places.Find(distances, i);
    for (Eigen::Index j = 0; j < i; ++j) {
      const double moved = weights[i] * weights[j] * distances[j] * places.bins_a_unit();
      stretching[places.bin(j)] -= moved;
      stretching[places.bin(j) + 1] += moved;
    }
    for (std::size_t k = 0; k < moving.size(); ++k) {
      const PointColumns& speed = speeds[k];
      const Eigen::ArrayXd distance_rates =
          ((points.x.head(i) - points.x[i]) * (speed.x.head(i) - speed.x[i]) +
           (points.y.head(i) - points.y[i]) * (speed.y.head(i) - speed.y[i]) +
           (points.z.head(i) - points.z[i]) * (speed.z.head(i) - speed.z[i])) /
          distances.head(i).max(kCoincident);
      const Eigen::ArrayXd weight_rates = moving[k].weights[i] * weights.head(i).array() +
                                          weights[i] * moving[k].weights.head(i).array();
      rates[k].weight += weight_rates.sum();
      rates[k].distance += (weight_rates * distances.head(i)).sum() +
                           weights[i] * (weights.head(i).array() * distance_rates).sum();
      double* const table = rates[k].bins.data();
      for (Eigen::Index j = 0; j < i; ++j) {
        const double moved = weights[i] * weights[j] * distance_rates[j] * places.bins_a_unit();
        table[places.bin(j)] += weight_rates[j] * (1 - places.beyond(j)) - moved;
        table[places.bin(j) + 1] += weight_rates[j] * places.beyond(j) + moved;
      }
    }
  }
  return rates;
}

}  // namespace

D2Descriptor::D2Descriptor(const D2Settings& settings)
    : settings_(settings),
      kernels_(std::make_shared<const Eigen::MatrixXd>(MakeKernels(settings))) {
  properties_.name = "d2";
  properties_.version = 1;
  properties_.dimension = settings.kernels;
  properties_.natural_scale = 0.4;
  properties_.sampling_noise = 0.015;
  properties_.bound_noise = 1e-5;
  properties_.differentiates_exactly = true;
  properties_.ignores_rotation = true;
  properties_.ignores_mirroring = true;
}

absl::StatusOr<std::unique_ptr<BoundDescriptor>> D2Descriptor::Bind(
    const mesh::SurfaceMesh& surface) const {
  MORTISE_ASSIGN_OR_RETURN(CanonicalSurface canonical, MakeCanonical(surface));
  MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3Xd vertices,
                           ToReferenceBox(canonical, surface.vertices));
  SurfaceSamples samples(vertices, canonical.triangles, settings_.points, settings_.seed);
  return std::make_unique<BoundD2>(std::move(canonical), std::move(samples), BinWidth(settings_),
                                   kernels_);
}

}  // namespace mortise::retrieval
