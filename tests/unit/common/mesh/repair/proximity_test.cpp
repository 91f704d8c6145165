// Which surfaces touch: against boxes, whose distance is known.
#include "common/mesh/repair/proximity.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "common/base/errors.h"

namespace mortise::mesh {
namespace {

SurfaceMesh Box(const Eigen::Vector3d& minimum, const Eigen::Vector3d& maximum) {
  SurfaceMesh box;
  box.vertices.resize(3, 8);
  for (int corner = 0; corner < 8; ++corner) {
    for (int axis = 0; axis < 3; ++axis) {
      box.vertices(axis, corner) = ((corner >> axis) & 1) != 0 ? maximum[axis] : minimum[axis];
    }
  }
  box.triangles.resize(3, 12);
  box.triangles << 0, 0, 1, 1, 0, 0, 2, 2, 0, 0, 4, 4,  //
      4, 6, 3, 7, 1, 5, 6, 7, 2, 3, 5, 7,               //
      6, 2, 7, 5, 5, 4, 7, 3, 3, 1, 7, 6;
  return box;
}

SurfaceMesh Moved(SurfaceMesh mesh, const Eigen::Isometry3d& motion) {
  mesh.vertices = (motion * mesh.vertices).eval();
  return mesh;
}

TEST(Proximity, FindsFacesEdgesAndCornersThatTouch) {
  const SurfaceMesh cube = Box({0, 0, 0}, {1, 1, 1});
  const SurfaceMesh beside = Box({1, 0.2, 0.2}, {2, 0.8, 0.8});
  const SurfaceMesh at_edge = Box({-1, -1, 0}, {0, 0, 1});
  const SurfaceMesh at_corner = Box({1, 1, 1}, {2, 2, 2});
  const SurfaceMesh apart = Box({5, 5, 5}, {6, 6, 6});
  const auto found = FindProximities({cube, beside, at_edge, at_corner, apart}, 0);
  ASSERT_TRUE(found.ok()) << found.status();
  ASSERT_EQ(found->size(), 3U);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ((*found)[i].first, 0);
    EXPECT_EQ((*found)[i].second, i + 1);
    EXPECT_EQ((*found)[i].distance, 0);
  }
}

TEST(Proximity, WhatLiesInsideTouches) {
  const SurfaceMesh block = Box({0, 0, 0}, {1, 1, 1});
  const SurfaceMesh screw = Box({0.4, 0.4, 0.4}, {0.6, 0.6, 0.6});
  for (const auto& surfaces : {std::vector{block, screw}, std::vector{screw, block}}) {
    const auto found = FindProximities(surfaces, 1e-6);
    ASSERT_TRUE(found.ok()) << found.status();
    ASSERT_EQ(found->size(), 1U);
    EXPECT_EQ(found->front().distance, 0);
  }
  // In the box around an L, but outside the L.
  SurfaceMesh l;
  l.vertices.resize(3, 12);
  for (int i = 0; i < 6; ++i) {
    const double u[] = {0, 2, 2, 1, 1, 0};
    const double v[] = {0, 0, 1, 1, 2, 2};
    l.vertices.col(i) = Eigen::Vector3d(u[i], v[i], 0);
    l.vertices.col(i + 6) = Eigen::Vector3d(u[i], v[i], 1);
  }
  const int base[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}};
  l.triangles.resize(3, 20);
  for (int t = 0; t < 4; ++t) {
    l.triangles.col(t) << base[t][0], base[t][2], base[t][1];
    l.triangles.col(t + 4) << base[t][0] + 6, base[t][1] + 6, base[t][2] + 6;
  }
  for (int i = 0; i < 6; ++i) {
    const int next = (i + 1) % 6;
    l.triangles.col(8 + 2 * i) << i, next, next + 6;
    l.triangles.col(9 + 2 * i) << i, next + 6, i + 6;
  }
  const auto found = FindProximities(
      {l, Box({1.4, 1.4, 0.4}, {1.6, 1.6, 0.6}), Box({.4, .4, .4}, {.6, .6, .6})}, 1e-6);
  ASSERT_TRUE(found.ok()) << found.status();
  ASSERT_EQ(found->size(), 1U);
  EXPECT_EQ(found->front().second, 2);
}

// Anywhere in space, turned anyhow, the distance is that of the boxes.
TEST(Proximity, GivesTheDistanceOfBoxes) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto point = [&] {
    return Eigen::Vector3d(uniform(random), uniform(random), uniform(random));
  };
  for (int round = 0; round < 300; ++round) {
    const Eigen::Vector3d a = 2 * point(), b = 2 * point();
    const Eigen::Vector3d a_size = point().array() + 0.1, b_size = point().array() + 0.1;
    const Eigen::Vector3d gap =
        (a - b - b_size).cwiseMax(b - a - a_size).cwiseMax(Eigen::Vector3d::Zero());
    const double tolerance = 0.4;
    const Eigen::Isometry3d motion = Eigen::Translation3d(10 * point()) *
                                     Eigen::AngleAxisd(6 * uniform(random), point().normalized());
    const auto found = FindProximities(
        {Moved(Box(a, a + a_size), motion), Moved(Box(b, b + b_size), motion)}, tolerance);
    ASSERT_TRUE(found.ok()) << found.status();
    ASSERT_EQ(found->size(), gap.norm() <= tolerance ? 1U : 0U) << gap.norm();
    if (!found->empty()) {
      EXPECT_NEAR(found->front().distance, gap.norm(), 1e-12);
    }
  }
}

TEST(Proximity, CrossedBarsAreAsFarApartAsTheirEdges) {
  const Eigen::Isometry3d turned(Eigen::AngleAxisd(std::acos(-1.0) / 4, Eigen::Vector3d::UnitX()));
  // A bar on its edge above another that crosses it, on its edge too.
  const SurfaceMesh lower = Moved(Box({-2, -0.5, -0.5}, {2, 0.5, 0.5}), turned);
  const Eigen::Isometry3d across(Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitZ()));
  const double half_diagonal = std::sqrt(0.5);
  const SurfaceMesh upper =
      Moved(lower, Eigen::Translation3d(0, 0, 2 * half_diagonal + 0.01) * across);
  const auto found = FindProximities({lower, upper}, 0.02);
  ASSERT_TRUE(found.ok()) << found.status();
  ASSERT_EQ(found->size(), 1U);
  EXPECT_NEAR(found->front().distance, 0.01, 1e-12);
  EXPECT_TRUE(FindProximities({lower, upper}, 0.009)->empty());
}

TEST(Proximity, NamesWhatIsWrong) {
  const SurfaceMesh cube = Box({0, 0, 0}, {1, 1, 1});
  const auto field = [&](const SurfaceMesh& surface, double tolerance) {
    return DetailOf(FindProximities({cube, surface}, tolerance).status()).field;
  };
  EXPECT_EQ(field(SurfaceMesh(), 0), "surfaces[1]");
  SurfaceMesh broken = cube;
  broken.triangles(0, 3) = 8;
  EXPECT_EQ(field(broken, 0), "surfaces[1]");
  broken.triangles(0, 3) = -1;
  EXPECT_EQ(field(broken, 0), "surfaces[1]");
  broken = cube;
  broken.vertices(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(field(broken, 0), "surfaces[1]");
  EXPECT_EQ(field(cube, -1), "tolerance");
  EXPECT_EQ(field(cube, std::numeric_limits<double>::infinity()), "tolerance");
  EXPECT_TRUE(FindProximities({}, 0)->empty());
}

TEST(ProbedSurface, TellsGapsContactsAndDepths) {
  const auto separation = [](const SurfaceMesh& a, const SurfaceMesh& b) {
    const double there = ProbedSurface::Separation(ProbedSurface(a), ProbedSurface(b), 0.1);
    EXPECT_EQ(there, ProbedSurface::Separation(ProbedSurface(b), ProbedSurface(a), 0.1));
    EXPECT_EQ(std::max(there, 0.0),
              ProbedSurface::Distance(ProbedSurface(a), ProbedSurface(b), 0.1));
    return there;
  };
  const SurfaceMesh cube = Box({0, 0, 0}, {1, 1, 1});
  EXPECT_NEAR(separation(cube, Box({1.05, 0.2, 0.2}, {2, 0.8, 0.8})), 0.05, 1e-12);
  EXPECT_EQ(separation(cube, Box({1.2, 0.2, 0.2}, {2, 0.8, 0.8})),
            std::numeric_limits<double>::infinity());
  EXPECT_NEAR(separation(cube, Box({1, 0.2, 0.2}, {2, 0.8, 0.8})), 0, 1e-12);
  EXPECT_NEAR(separation(cube, Box({0.9, 0.3, 0.35}, {2, 0.7, 0.72})), -0.1, 1e-12) << "a corner";
  EXPECT_LT(separation(cube, Box({-1, 0.4, 0.45}, {2, 0.6, 0.7})), -0.3)
      << "right through, without any corner inside";
  EXPECT_NEAR(separation(cube, Box({0.3, 0.3, 0.3}, {0.7, 0.7, 0.7})), -0.3, 1e-12) << "enclosed";
}

// A tube with flat sides about z, closed: a rod if `inner` is 0.
SurfaceMesh Tube(double inner, double outer, double height, int sides, double turned) {
  const bool is_rod = inner == 0;
  const int rings = is_rod ? 2 : 4;
  SurfaceMesh tube;
  tube.vertices.resize(3, rings * sides + (is_rod ? 2 : 0));
  for (int k = 0; k < sides; ++k) {
    const double angle = turned + 2 * std::acos(-1.0) * k / sides;
    const Eigen::Vector3d direction(std::cos(angle), std::sin(angle), 0);
    tube.vertices.col(k) = outer * direction;
    tube.vertices.col(sides + k) = outer * direction + height * Eigen::Vector3d::UnitZ();
    if (is_rod) continue;
    tube.vertices.col(2 * sides + k) = inner * direction + height * Eigen::Vector3d::UnitZ();
    tube.vertices.col(3 * sides + k) = inner * direction;
  }
  std::vector<Eigen::Vector3i> triangles;
  const auto add_band = [&](int from, int to) {
    for (int k = 0; k < sides; ++k) {
      const int next = (k + 1) % sides;
      triangles.emplace_back(from * sides + k, from * sides + next, to * sides + next);
      triangles.emplace_back(from * sides + k, to * sides + next, to * sides + k);
    }
  };
  add_band(0, 1);
  if (is_rod) {
    const int bottom = 2 * sides, top = bottom + 1;
    tube.vertices.col(bottom).setZero();
    tube.vertices.col(top) = height * Eigen::Vector3d::UnitZ();
    for (int k = 0; k < sides; ++k) {
      const int next = (k + 1) % sides;
      triangles.emplace_back(bottom, next, k);
      triangles.emplace_back(top, sides + k, sides + next);
    }
  } else {
    add_band(1, 2);
    add_band(2, 3);
    add_band(3, 0);
  }
  tube.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    tube.triangles.col(static_cast<Eigen::Index>(t)) = triangles[t];
  }
  return tube;
}

// What is not asked for is told sooner, and what is asked for just the same.
TEST(ProbedSurface, TellsTheSameWithinWhatIsAsked) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  constexpr double kFar = 0.05, kNear = 2e-4, kLeast = 3e-4;  // m
  int apart = 0, near = 0, shallow = 0, deep = 0;
  for (int round = 0; round < 400; ++round) {
    const SurfaceMesh tube = Tube(0.01, 0.015, 0.02, 24, uniform(random));
    const double radius = 0.01 + 1.2e-3 * (uniform(random) - 0.5);
    const Eigen::Isometry3d motion(
        Eigen::Translation3d(4e-4 * uniform(random), 0, 0.01 * (uniform(random) - 0.5)));
    const ProbedSurface a(tube);
    const ProbedSurface b(Moved(Tube(0, radius, 0.02, 20, uniform(random)), motion));
    const double all = ProbedSurface::Separation(a, b, kFar);
    const double asked = ProbedSurface::Separation(a, b, kNear, kLeast);
    if (all > 0) {
      EXPECT_EQ(asked, all <= kNear ? all : std::numeric_limits<double>::infinity());
    } else {
      EXPECT_EQ(asked, -all > kLeast ? all : 0) << round;
    }
    ++(all > kNear ? apart : all > 0 ? near : -all <= kLeast ? shallow : deep);
  }
  EXPECT_GT(apart, 10);
  EXPECT_GT(near, 10);
  EXPECT_GT(shallow, 10);
  EXPECT_GT(deep, 10);
}

TEST(Proximity, IsGivenUpWhenNobodyWaits) {
  const SurfaceMesh cube = Box({0, 0, 0}, {1, 1, 1});
  std::vector<std::size_t> told;
  const auto found = FindProximities({cube, cube, cube}, 0, [&](std::size_t done) {
    told.push_back(done);
    return done < 2;
  });
  EXPECT_TRUE(absl::IsCancelled(found.status())) << found.status();
  EXPECT_EQ(told, std::vector<std::size_t>({1, 2}));
}

}  // namespace
}  // namespace mortise::mesh
