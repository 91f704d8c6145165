// What is said of a corner of a smooth surface from what is known round it.
#include "common/fem/stress/surface_fan.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <utility>

#include "tests/unit/common/fem/problems/structured_mesh.h"

namespace mortise::simulator {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Samples = std::vector<Vector6d>;

// A box of uneven elements; with a `bulge` its faces are curved.
mesh::TetrahedralMesh Box(bool quadratic, double bulge = 0) {
  mesh::MappedBox box;
  box.ticks = {mesh::Ticks(4), mesh::Ticks(3, 2), mesh::Ticks(3)};
  box.place = [bulge](const Vector3d& p) {
    const double out = 1 + bulge * (1 - (p - Vector3d::Constant(0.5)).squaredNorm());
    return Vector3d(out * (p.x() - 0.5), 0.8 * out * (p.y() - 0.5), 0.6 * out * (p.z() - 0.5));
  };
  return mesh::MeshMappedBox(box, quadratic);
}

// Of a mesh, what fans are made from, and the fan at each slot.
struct Body {
  explicit Body(mesh::TetrahedralMesh of)
      : mesh(std::move(of)), nodes(mesh), surface(mesh, nodes) {}

  std::optional<SurfaceFan> FanAt(int slot) const {
    return SurfaceFan::Around(mesh, surface, slot);
  }

  Vector3d PlaceOf(const FaceNode& sample) const {
    return FacePositions(mesh, surface, sample.face).col(sample.place);
  }

  // What `stress` is at the fan's samples.
  template <class Stress>
  Samples At(const SurfaceFan& fan, const Stress& stress) const {
    Samples samples;
    for (const FaceNode& sample : fan.samples()) samples.push_back(stress(PlaceOf(sample)));
    return samples;
  }

  mesh::TetrahedralMesh mesh;
  PartNodes nodes;
  PartSurface surface;
};

// A stress that is one number at each place, linear in it and quadratic as far as `curved`.
Vector6d StressAt(const Vector3d& x, double curved) {
  Vector6d stress;
  stress << 3, -2, 5, 1, 4, -1;
  Eigen::Matrix<double, 6, 3> by_place;
  by_place << 1, 2, -3, 0, 4, 1, -2, 1, 1, 5, -1, 2, 3, 3, 0, -4, 1, 2;
  return stress + by_place * x + curved * by_place * x.cwiseAbs2();
}

Vector6d LinearAt(const Vector3d& x) { return StressAt(x, 0); }
Vector6d CurvedAt(const Vector3d& x) { return StressAt(x, 1); }

Vector6d Turned(const Vector6d& stress, const Matrix3d& turn) {
  const Matrix3d tensor = turn * StressTensor(stress) * turn.transpose();
  Vector6d turned;
  turned << tensor(0, 0), tensor(1, 1), tensor(2, 2), tensor(0, 1), tensor(1, 2), tensor(0, 2);
  return turned;
}

TEST(SurfaceFan, IsExactForLinearStressesOnAPlane) {
  const Body body(Box(true));
  int fans = 0;
  for (int slot = 0; slot < body.nodes.size(); ++slot) {
    const auto fan = body.FanAt(slot);
    if (!fan) continue;
    ++fans;
    const Vector6d exact = LinearAt(body.mesh.nodes.col(body.nodes.node(slot)));
    EXPECT_LT((fan->Stress(body.At(*fan, LinearAt)) - exact).norm(), 1e-12 * exact.norm());
  }
  EXPECT_EQ(fans, 2 * (3 * 2 + 3 * 2 + 2 * 2)) << "the corners within the six faces";
}

TEST(SurfaceFan, IsThereOnlyWhereFacesSurroundACornerSmoothly) {
  const Body body(Box(true));
  std::vector<bool> is_corner(static_cast<std::size_t>(body.mesh.nodes.cols()), false);
  for (const int node : body.mesh.tetrahedra.topRows(4).reshaped()) is_corner[node] = true;
  const Eigen::Array3d half(0.5, 0.4, 0.3);
  for (int slot = 0; slot < body.nodes.size(); ++slot) {
    const int node = body.nodes.node(slot);
    const Eigen::Array3d at = body.mesh.nodes.col(node).array().abs();
    const auto sides = (half - at < 1e-9).count();
    EXPECT_EQ(body.FanAt(slot).has_value(), sides == 1 && is_corner[node]) << at.transpose();
  }
  const Body linear(Box(false));
  for (int slot = 0; slot < linear.nodes.size(); ++slot) EXPECT_FALSE(linear.FanAt(slot));
  // Nothing surrounds the corners of a single element.
  mesh::TetrahedralMesh single;
  single.nodes = body.mesh.nodes;
  single.tetrahedra = body.mesh.tetrahedra.leftCols(1);
  single.part = Eigen::VectorXi::Zero(1);
  const Body alone(single);
  for (int slot = 0; slot < alone.nodes.size(); ++slot) EXPECT_FALSE(alone.FanAt(slot));
}

// A side that begins along the normal of the surface has no direction along it.
TEST(SurfaceFan, IsNoneWhereASideLeavesTheSurface) {
  mesh::MappedBox box;
  for (auto& ticks : box.ticks) ticks = mesh::Ticks(3);
  box.place = [](const Vector3d& p) -> Vector3d { return 3 * p; };
  mesh::TetrahedralMesh mesh = mesh::MeshMappedBox(box, true);
  const auto node_at = [&mesh](const Vector3d& place) {
    Eigen::Index nearest = 0;
    (mesh.nodes.colwise() - place).colwise().norm().minCoeff(&nearest);
    return static_cast<int>(nearest);
  };
  const int corner = node_at({1, 1, 3}), far = node_at({2, 1, 3}), middle = node_at({1.5, 1, 3});
  const auto fan_at = [&mesh](int node) {
    const PartNodes nodes(mesh);
    const PartSurface surface(mesh, nodes);
    int slot = 0;
    while (nodes.node(slot) != node) ++slot;
    return SurfaceFan::Around(mesh, surface, slot).has_value();
  };
  EXPECT_TRUE(fan_at(corner));
  for (const double aside : {0.0, 1e-9}) {
    mesh.nodes.col(middle) = Vector3d(1 + aside, 1, 3.05);
    mesh.nodes.col(far) = Vector3d(2, 1, 3.2);
    EXPECT_FALSE(fan_at(corner)) << aside;
    EXPECT_TRUE(fan_at(node_at({1, 2, 3}))) << aside;
  }
}

TEST(SurfaceFan, DirectionsSayWhatEachSampleCounts) {
  const Body body(Box(true, 0.2));
  Vector6d direction;
  direction << 1, -2, 0.5, 3, -1, 2;
  for (int slot = 0; slot < body.nodes.size(); ++slot) {
    const auto fan = body.FanAt(slot);
    if (!fan) continue;
    const Samples samples = body.At(*fan, CurvedAt);
    const std::vector<Vector6d> directions = fan->Directions(direction);
    ASSERT_EQ(directions.size(), samples.size());
    double sum = 0;
    for (std::size_t s = 0; s < samples.size(); ++s) sum += directions[s].dot(samples[s]);
    EXPECT_NEAR(sum, direction.dot(fan->Stress(samples)), 1e-11);
  }
}

TEST(SurfaceFan, TurnsWithItsBody) {
  const Body body(Box(true, 0.2));
  const Matrix3d turn =
      Eigen::AngleAxisd(0.7, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  mesh::TetrahedralMesh mesh = body.mesh;
  mesh.nodes = turn * mesh.nodes;
  const Body turned(mesh);
  for (int slot = 0; slot < body.nodes.size(); ++slot) {
    const auto fan = body.FanAt(slot), of_turned = turned.FanAt(slot);
    ASSERT_EQ(fan.has_value(), of_turned.has_value());
    if (!fan) continue;
    const Vector6d there = of_turned->Stress(turned.At(*of_turned, [&](const Vector3d& x) {
      return Turned(CurvedAt(turn.transpose() * x), turn);
    }));
    EXPECT_LT((there - Turned(fan->Stress(body.At(*fan, CurvedAt)), turn)).norm(), 1e-11);
  }
}

TEST(SurfaceFan, DoesNotDependOnTheOrderOfElements) {
  const Body body(Box(true, 0.2));
  mesh::TetrahedralMesh mesh = body.mesh;
  std::vector<int> order(static_cast<std::size_t>(mesh.tetrahedra.cols()));
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(3));
  for (std::size_t e = 0; e < order.size(); ++e) {
    mesh.tetrahedra.col(static_cast<Eigen::Index>(e)) = body.mesh.tetrahedra.col(order[e]);
  }
  const Body shuffled(mesh);
  const auto by_node = [](const Body& of) {
    std::map<int, Vector6d> stress;
    for (int slot = 0; slot < of.nodes.size(); ++slot) {
      const auto fan = of.FanAt(slot);
      if (fan) stress[of.nodes.node(slot)] = fan->Stress(of.At(*fan, CurvedAt));
    }
    return stress;
  };
  const auto expected = by_node(body), got = by_node(shuffled);
  ASSERT_EQ(got.size(), expected.size());
  for (const auto& [node, stress] : expected) EXPECT_LT((got.at(node) - stress).norm(), 1e-11);
}

// The nodes move along `velocity` while the stresses at the samples stay as they are.
TEST(SurfaceFan, DerivativesAreThoseOfItsStress) {
  const Body body(Box(true, 0.2));
  Vector6d direction;
  direction << 1, -2, 0.5, 3, -1, 2;
  std::mt19937 bits(5);
  std::uniform_real_distribution<double> spread(-1, 1);
  Eigen::Matrix3Xd velocity(3, body.mesh.nodes.cols());
  for (double& value : velocity.reshaped()) value = spread(bits);
  constexpr double kStep = 1e-5;
  const auto moved = [&](double by) {
    mesh::TetrahedralMesh mesh = body.mesh;
    mesh.nodes += by * velocity;
    return Body(mesh);
  };
  const Body ahead = moved(kStep), behind = moved(-kStep);
  for (int slot = 0; slot < body.nodes.size(); ++slot) {
    const auto fan = body.FanAt(slot), fan_ahead = ahead.FanAt(slot),
               fan_behind = behind.FanAt(slot);
    if (!fan || !fan_ahead || !fan_behind) continue;
    const Samples samples = body.At(*fan, CurvedAt);
    Eigen::Matrix3Xd by_position = Eigen::Matrix3Xd::Zero(3, body.mesh.nodes.cols());
    fan->AddDerivative(direction, samples, by_position);
    const double expected =
        direction.dot(fan_ahead->Stress(samples) - fan_behind->Stress(samples)) / (2 * kStep);
    EXPECT_NEAR(by_position.cwiseProduct(velocity).sum(), expected,
                1e-5 * (1 + std::abs(expected)));
  }
}

}  // namespace
}  // namespace mortise::simulator
