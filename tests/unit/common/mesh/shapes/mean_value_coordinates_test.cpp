// Mean-value coordinates: affine maps, values on the cage, the integral that defines them, and what
// must not change them.
#include "common/mesh/shapes/mean_value_coordinates.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "common/base/errors.h"
#include "tests/unit/common/mesh/box_assembly.h"

namespace mortise::mesh {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;

SurfaceMesh Octahedron() {
  SurfaceMesh mesh;
  mesh.vertices.resize(3, 6);
  mesh.vertices << 1, -1, 0, 0, 0, 0, 0, 0, 1, -1, 0, 0, 0, 0, 0, 0, 1, -1;
  mesh.triangles.resize(3, 8);
  mesh.triangles << 0, 2, 1, 3, 2, 1, 3, 0,  //
      2, 1, 3, 0, 0, 2, 1, 3,                //
      4, 4, 4, 4, 5, 5, 5, 5;
  return mesh;
}

// A box with a dent in its top, so deep that the cage is not convex, at no round coordinates.
SurfaceMesh DentedBox() {
  SurfaceMesh mesh = BoxSurface({-1, -0.7, -0.4}, {0.9, 0.8, 0.6});
  const auto dent = static_cast<int>(mesh.vertices.cols());
  mesh.vertices.conservativeResize(3, dent + 1);
  mesh.vertices.col(dent) = Vector3d(0.1, 0.05, -0.1);
  std::vector<Eigen::Vector3i> triangles;
  for (const auto& triangle : mesh.triangles.colwise()) {
    bool top = true;
    for (int k = 0; k < 3; ++k) top = top && mesh.vertices(2, triangle(k)) == 0.6;
    if (!top) triangles.push_back(triangle);
    for (int k = 0; k < 3 && top; ++k) {
      const int a = triangle(k), b = triangle((k + 1) % 3);
      const Vector3d edge = mesh.vertices.col(b) - mesh.vertices.col(a);
      // The diagonal goes; the sides of the top are joined with the dent.
      if (edge.x() == 0 || edge.y() == 0) triangles.emplace_back(a, b, dent);
    }
  }
  mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    mesh.triangles.col(static_cast<Eigen::Index>(t)) = triangles[t];
  }
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Vector3d(1, 2, -0.5).normalized()).toRotationMatrix();
  mesh.vertices = (turn * mesh.vertices).colwise() + Vector3d(0.3, -0.2, 0.9);
  return mesh;
}

double Unit(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

// Points where formulas may fail: in the planes of triangles beside them, in line with edges, and
// ever nearer to triangles, edges and vertices, from both sides.
Eigen::Matrix3Xd TouchyPoints(const SurfaceMesh& cage) {
  std::vector<Vector3d> points;
  std::mt19937_64 random(3);
  for (const auto& triangle : cage.triangles.colwise()) {
    const Vector3d a = cage.vertices.col(triangle(0)), b = cage.vertices.col(triangle(1)),
                   c = cage.vertices.col(triangle(2));
    const Vector3d normal = (b - a).cross(c - a).normalized();
    const std::vector<Vector3d> feet = {(a + b + c) / 3,
                                        (a + b) / 2,
                                        a,
                                        a + 1.7 * (b - a),
                                        b + 0.4 * (b - a) + 0.3 * (c - a),
                                        a + Unit(random) * (b - a) - 0.6 * (c - a)};
    for (const Vector3d& foot : feet) {
      for (double height = 1; height > 1e-18; height /= 10) {
        points.push_back(foot + height * normal);
        points.push_back(foot - height * normal);
      }
      points.push_back(foot);
    }
  }
  for (int k = 0; k < 200; ++k) {
    points.push_back(3 * Vector3d(Unit(random), Unit(random), Unit(random)) -
                     Vector3d::Constant(1.5));
  }
  Eigen::Matrix3Xd columns(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t k = 0; k < points.size(); ++k) {
    columns.col(static_cast<Eigen::Index>(k)) = points[k];
  }
  return columns;
}

MatrixXd Coordinates(const SurfaceMesh& cage, const Eigen::Matrix3Xd& points) {
  auto coordinates = MeanValueCoordinates(cage, points);
  EXPECT_TRUE(coordinates.ok()) << coordinates.status();
  return coordinates.ok() ? *coordinates : MatrixXd::Zero(cage.vertices.cols(), points.cols());
}

TEST(MeanValueCoordinates, SumToOneAndReproduceAffineMapsEverywhere) {
  for (const SurfaceMesh& cage : {Octahedron(), DentedBox()}) {
    const Eigen::Matrix3Xd points = TouchyPoints(cage);
    const MatrixXd coordinates = Coordinates(cage, points);
    ASSERT_TRUE(coordinates.allFinite());
    EXPECT_LT((coordinates.colwise().sum().array() - 1).abs().maxCoeff(), 1e-12);
    EXPECT_LT(coordinates.cwiseAbs().maxCoeff(), 100);
    Eigen::Matrix3d linear;
    linear << 1.3, -0.2, 0.5, 0.1, 0.8, -0.7, 0.4, 0.6, 1.9;
    const Vector3d shift(2, -3, 1);
    const Eigen::Matrix3Xd moved = (linear * cage.vertices).colwise() + shift;
    const Eigen::Matrix3Xd wanted = (linear * points).colwise() + shift;
    EXPECT_LT((moved * coordinates - wanted).cwiseAbs().maxCoeff(),
              1e-12 * wanted.cwiseAbs().maxCoeff());
  }
}

TEST(MeanValueCoordinates, AreThoseOfTheTriangleOnTheCage) {
  const SurfaceMesh cage = DentedBox();
  const MatrixXd at_vertices = Coordinates(cage, cage.vertices);
  EXPECT_EQ(at_vertices, MatrixXd::Identity(cage.vertices.cols(), cage.vertices.cols()));
  std::mt19937_64 random(7);
  for (const auto& triangle : cage.triangles.colwise()) {
    double s = Unit(random), t = Unit(random);
    if (s + t > 1) s = 1 - s, t = 1 - t;
    for (const Vector3d& shares : {Vector3d(1 - s - t, s, t), Vector3d(1 - s, s, 0)}) {
      Vector3d point = Vector3d::Zero();
      for (int k = 0; k < 3; ++k) point += shares(k) * cage.vertices.col(triangle(k));
      Eigen::VectorXd coordinates = Coordinates(cage, point);
      for (int k = 0; k < 3; ++k) coordinates(triangle(k)) -= shares(k);
      EXPECT_LT(coordinates.cwiseAbs().maxCoeff(), 1e-12);
    }
  }
}

TEST(MeanValueCoordinates, AreEqualInTheMiddleOfAnOctahedron) {
  const MatrixXd coordinates = Coordinates(Octahedron(), Vector3d::Zero());
  EXPECT_LT((coordinates.array() - 1.0 / 6).abs().maxCoeff(), 1e-15);
}

// w_i = Σ_T ∫_T b_i(y) h / |y - x|⁴ dA, h the signed height of T's plane over x, by the midpoint
// rule.
Eigen::VectorXd ByQuadrature(const SurfaceMesh& cage, const Vector3d& x) {
  constexpr int kDivisions = 80;
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(cage.vertices.cols());
  for (const auto& triangle : cage.triangles.colwise()) {
    const Vector3d a = cage.vertices.col(triangle(0)) - x, b = cage.vertices.col(triangle(1)) - x,
                   c = cage.vertices.col(triangle(2)) - x;
    const Vector3d normal = (b - a).cross(c - a);
    const double measure = normal.dot(a) / 2 / (kDivisions * kDivisions);
    for (int i = 0; i < kDivisions; ++i) {
      for (int j = 0; j < 2 * (kDivisions - i) - 1; ++j) {
        const double third = j % 2 == 0 ? 1.0 / 3 : 2.0 / 3;
        const double s = (i + third) / kDivisions, t = (j / 2 + third) / kDivisions;
        const double r2 = ((1 - s - t) * a + s * b + t * c).squaredNorm();
        const double density = measure / (r2 * r2);
        weights(triangle(0)) += (1 - s - t) * density;
        weights(triangle(1)) += s * density;
        weights(triangle(2)) += t * density;
      }
    }
  }
  return weights / weights.sum();
}

TEST(MeanValueCoordinates, AreTheMeansThatDefineThem) {
  const SurfaceMesh cage = DentedBox();
  const Vector3d middle = cage.vertices.rowwise().mean();
  // Inside, under the dent, in the dent and well outside.
  for (const Vector3d& offset : {Vector3d(-0.3, 0.2, -0.1), Vector3d(0.1, 0.3, -0.2),
                                 Vector3d(0.25, 0.1, 0.35), Vector3d(1.9, -0.8, 0.4)}) {
    const Vector3d point = middle + offset;
    const Eigen::VectorXd coordinates = Coordinates(cage, point);
    EXPECT_LT((coordinates - ByQuadrature(cage, point)).cwiseAbs().maxCoeff(), 1e-3)
        << offset.transpose();
  }
}

TEST(MeanValueCoordinates, DoNotChangeWithPlaceSizeAndTurn) {
  const SurfaceMesh cage = DentedBox();
  SurfaceMesh moved = cage;
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(2.1, Vector3d(-1, 0.3, 0.8).normalized()).toRotationMatrix();
  const auto move = [&](const Eigen::Matrix3Xd& points) {
    return Eigen::Matrix3Xd(((0.05 * (turn * points)).colwise() + Vector3d(0.4, 5, -3)));
  };
  moved.vertices = move(cage.vertices);
  std::mt19937_64 random(11);
  Eigen::Matrix3Xd points(3, 100);
  for (double& coordinate : points.reshaped()) coordinate = 3 * Unit(random) - 1.5;
  EXPECT_LT((Coordinates(cage, points) - Coordinates(moved, move(points))).cwiseAbs().maxCoeff(),
            1e-9);
}

TEST(MeanValueCoordinates, AreContinuousAcrossThePlanesOfTriangles) {
  const SurfaceMesh cage = DentedBox();
  std::mt19937_64 random(13);
  for (const auto& triangle : cage.triangles.colwise()) {
    const Vector3d a = cage.vertices.col(triangle(0)), b = cage.vertices.col(triangle(1)),
                   c = cage.vertices.col(triangle(2));
    const Vector3d normal = (b - a).cross(c - a).normalized();
    for (int k = 0; k < 10; ++k) {
      const Vector3d foot = a + (3 * Unit(random) - 1) * (b - a) + (3 * Unit(random) - 1) * (c - a);
      for (double height = 1e-4; height > 1e-15; height /= 10) {
        const Eigen::VectorXd above = Coordinates(cage, foot + height * normal);
        const Eigen::VectorXd below = Coordinates(cage, foot - height * normal);
        EXPECT_LT((above - below).cwiseAbs().maxCoeff(), 100 * height + 2e-7)
            << foot.transpose() << ", height " << height;
      }
    }
  }
}

TEST(MeanValueCoordinates, RefuseWhatIsNoCage) {
  const Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, 2);
  const auto field_of = [&points](const SurfaceMesh& cage) {
    return DetailOf(MeanValueCoordinates(cage, points).status()).field;
  };
  EXPECT_EQ(field_of({}), "cage");
  SurfaceMesh open = Octahedron();
  open.triangles.conservativeResize(3, 7);
  EXPECT_EQ(field_of(open), "cage");
  SurfaceMesh inside_out = Octahedron();
  inside_out.triangles.row(0).swap(inside_out.triangles.row(1));
  EXPECT_EQ(field_of(inside_out), "cage");
  SurfaceMesh crossing;
  crossing.vertices.resize(3, 12);
  crossing.vertices << Octahedron().vertices,
      (Octahedron().vertices.colwise() + Vector3d(0.5, 0.1, 0.2));
  crossing.triangles.resize(3, 16);
  crossing.triangles << Octahedron().triangles, (Octahedron().triangles.array() + 6).matrix();
  EXPECT_EQ(field_of(crossing), "cage");
  SurfaceMesh not_finite = Octahedron();
  not_finite.vertices(1, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(field_of(not_finite), "cage");
  SurfaceMesh out_of_range = Octahedron();
  out_of_range.triangles(1, 2) = 6;
  EXPECT_EQ(field_of(out_of_range), "cage");
}

TEST(MeanValueCoordinates, RefusePointsThatAreNowhere) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, 3);
  points(2, 1) = std::numeric_limits<double>::infinity();
  const auto coordinates = MeanValueCoordinates(Octahedron(), points);
  EXPECT_EQ(DetailOf(coordinates.status()).field, "points[1]");
  const auto none = MeanValueCoordinates(Octahedron(), Eigen::Matrix3Xd(3, 0));
  ASSERT_TRUE(none.ok()) << none.status();
  EXPECT_EQ(none->cols(), 0);
}

}  // namespace
}  // namespace mortise::mesh
