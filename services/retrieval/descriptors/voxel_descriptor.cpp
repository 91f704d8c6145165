#include "services/retrieval/descriptors/voxel_descriptor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/base/errors.h"
#include "services/retrieval/descriptors/canonical_surface.h"
#include "services/retrieval/descriptors/surface_samples.h"

namespace mortise::retrieval {
namespace {

constexpr Eigen::Index kNodes = 64;  // along each axis, from -1 to 1
constexpr double kNodesAUnit = (kNodes - 1) / 2.0;

Eigen::MatrixXd MakeKernels(const VoxelSettings& settings) {
  Eigen::MatrixXd kernels(settings.kernels, kNodes);
  for (Eigen::Index node = 0; node < kNodes; ++node) {
    for (Eigen::Index k = 0; k < settings.kernels; ++k) {
      const double mean = 2.0 * double(k) / double(settings.kernels - 1) - 1;
      const double offset = (double(node) / kNodesAUnit - 1 - mean) / settings.width;
      kernels(k, node) = std::exp(-offset * offset / 2);
    }
  }
  return kernels;
}

// Weights on the nodes of a grid, x fastest, then y.
class Grid {
 public:
  Grid() : nodes_(Eigen::VectorXd::Zero(kNodes * kNodes * kNodes)) {}

  // Adds `weight` at a point of [-1, 1]³, and `flow`, weight that moves on from there by so much:
  // the derivative of what a moving weight adds.
  void Add(const Eigen::Vector3d& point, double weight, const Eigen::Vector3d& flow) {
    std::array<std::array<double, 2>, 3> shares;
    Eigen::Index first = 0;
    for (int axis = 2; axis >= 0; --axis) {
      const double place =
          std::min(std::max((point[axis] + 1) * kNodesAUnit, 0.0), double(kNodes - 1));
      const auto node = std::min(static_cast<Eigen::Index>(place), kNodes - 2);
      first = first * kNodes + node;
      const double beyond = place - double(node);
      shares[std::size_t(axis)] = {1 - beyond, beyond};
    }
    const Eigen::Vector3d moved = flow * kNodesAUnit;
    for (std::size_t z = 0; z < 2; ++z) {
      for (std::size_t y = 0; y < 2; ++y) {
        const double yz = shares[1][y] * shares[2][z];
        const double across = (y ? moved.y() : -moved.y()) * shares[2][z] +
                              (z ? moved.z() : -moved.z()) * shares[1][y];
        double* const node =
            &nodes_[first + Eigen::Index(z) * kNodes * kNodes + Eigen::Index(y) * kNodes];
        const double along = moved.x() * yz;
        node[0] += shares[0][0] * (weight * yz + across) - along;
        node[1] += shares[0][1] * (weight * yz + across) + along;
      }
    }
  }

  // What kernels (kernels × nodes of an axis) along all three axes see, x fastest.
  Eigen::VectorXd SeenBy(const Eigen::MatrixXd& kernels) const {
    const Eigen::Index k = kernels.rows();
    const Eigen::MatrixXd by_x = kernels * nodes_.reshaped(kNodes, kNodes * kNodes);
    Eigen::MatrixXd by_y(k * k, kNodes);
    for (Eigen::Index z = 0; z < kNodes; ++z) {
      by_y.col(z) = (by_x.middleCols(z * kNodes, kNodes) * kernels.transpose()).reshaped();
    }
    return (by_y * kernels.transpose()).reshaped();
  }

 private:
  Eigen::VectorXd nodes_;
};

// The farthest of the surface's corners from a point.
struct FarthestVertex {
  int vertex = -1;
  double distance = 0;
};

FarthestVertex FarthestFrom(const Eigen::Vector3d& centre, const CanonicalSurface& surface,
                            const Eigen::Matrix3Xd& vertices) {
  FarthestVertex farthest;
  for (const int corner : surface.triangles.reshaped()) {
    const double distance = (vertices.col(corner) - centre).norm();
    if (distance > farthest.distance) farthest = {corner, distance};
  }
  return farthest;
}

class BoundVoxel : public BoundDescriptor {
 public:
  BoundVoxel(CanonicalSurface surface, SurfaceSamples samples,
             std::shared_ptr<const Eigen::MatrixXd> kernels)
      : surface_(std::move(surface)), samples_(std::move(samples)), kernels_(std::move(kernels)) {}

  absl::StatusOr<Eigen::VectorXd> Describe(const Eigen::Matrix3Xd& vertices) const override {
    MORTISE_ASSIGN_OR_RETURN(const DescriptorDerivatives result, Differentiate(vertices, {}));
    return result.value;
  }

  absl::StatusOr<DescriptorDerivatives> Differentiate(
      const Eigen::Matrix3Xd& vertices,
      std::span<const Eigen::Matrix3Xd> velocities) const override;

 private:
  CanonicalSurface surface_;
  SurfaceSamples samples_;
  std::shared_ptr<const Eigen::MatrixXd> kernels_;
};

absl::StatusOr<DescriptorDerivatives> BoundVoxel::Differentiate(
    const Eigen::Matrix3Xd& vertices, std::span<const Eigen::Matrix3Xd> velocities) const {
  MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3Xd placed, ToReferenceBox(surface_, vertices));
  const WeightedPoints points = samples_.At(placed);
  const Eigen::Vector3d centre = points.positions * points.weights;
  const FarthestVertex farthest = FarthestFrom(centre, surface_, placed);
  if (!(points.weights.sum() > 0) || !(farthest.distance > 0)) {
    return InvalidField("vertices", "the surface has no area");
  }
  const Eigen::Matrix3Xd local = (points.positions.colwise() - centre) / farthest.distance;
  Grid grid;
  for (Eigen::Index i = 0; i < local.cols(); ++i) {
    grid.Add(local.col(i), points.weights[i], Eigen::Vector3d::Zero());
  }
  DescriptorDerivatives result;
  result.value = grid.SeenBy(*kernels_);
  result.jacobian.resize(result.value.size(), static_cast<Eigen::Index>(velocities.size()));
  for (Eigen::Index k = 0; k < result.jacobian.cols(); ++k) {
    MORTISE_ASSIGN_OR_RETURN(
        const Eigen::Matrix3Xd velocity,
        VelocitiesInReferenceBox(surface_, velocities[static_cast<std::size_t>(k)], k));
    const PointVelocities moving = samples_.Differentiate(placed, velocity);
    const Eigen::Vector3d centre_rate =
        moving.positions * points.weights + points.positions * moving.weights;
    const Eigen::Vector3d arm = (placed.col(farthest.vertex) - centre) / farthest.distance;
    const double distance_rate = arm.dot(velocity.col(farthest.vertex) - centre_rate);
    Grid rates;
    for (Eigen::Index i = 0; i < local.cols(); ++i) {
      const Eigen::Vector3d speed =
          (moving.positions.col(i) - centre_rate - local.col(i) * distance_rate) /
          farthest.distance;
      rates.Add(local.col(i), moving.weights[i], points.weights[i] * speed);
    }
    result.jacobian.col(k) = rates.SeenBy(*kernels_);
  }
  return result;
}

}  // namespace

VoxelDescriptor::VoxelDescriptor(const VoxelSettings& settings)
    : settings_(settings),
      kernels_(std::make_shared<const Eigen::MatrixXd>(MakeKernels(settings))) {
  properties_.name = "voxel";
  properties_.version = 1;
  properties_.dimension = settings.kernels * settings.kernels * settings.kernels;
  properties_.compares_turns = true;
  properties_.natural_scale = 0.6;
  properties_.sampling_noise = 0.002;
  properties_.bound_noise = 1e-5;
  properties_.differentiates_exactly = true;
}

absl::StatusOr<std::unique_ptr<BoundDescriptor>> VoxelDescriptor::Bind(
    const mesh::SurfaceMesh& surface) const {
  MORTISE_ASSIGN_OR_RETURN(CanonicalSurface canonical, MakeCanonical(surface));
  MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3Xd vertices,
                           ToReferenceBox(canonical, surface.vertices));
  SurfaceSamples samples(vertices, canonical.triangles, settings_.points, settings_.seed);
  return std::make_unique<BoundVoxel>(std::move(canonical), std::move(samples), kernels_);
}

Eigen::MatrixXd VoxelDescriptor::QuarterTurns(const Eigen::VectorXd& vector) const {
  const Eigen::Index side = settings_.kernels;
  Eigen::MatrixXd turns(vector.size(), 4);
  turns.col(0) = vector;
  for (Eigen::Index turn = 1; turn < 4; ++turn) {
    for (Eigen::Index z = 0; z < side; ++z) {
      for (Eigen::Index y = 0; y < side; ++y) {
        for (Eigen::Index x = 0; x < side; ++x) {
          // What lies at (x, y) after a quarter turn lay at (y, -x) before.
          turns(x + side * (y + side * z), turn) =
              turns(y + side * (side - 1 - x + side * z), turn - 1);
        }
      }
    }
  }
  return turns;
}

}  // namespace mortise::retrieval
