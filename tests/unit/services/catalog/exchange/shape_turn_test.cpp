// Shapes of one solid, however it is turned, are known to be of one; those of others are not.
#include "services/catalog/exchange/shape_turn.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <string>

#include "common/base/files.h"
#include "common/cad/step/step_reader.h"
#include "common/cad/stretch/solid_shape.h"

namespace mortise::catalog {
namespace {

constexpr double kRightAngle = std::numbers::pi / 2;

cad::StepAssembly Drawing(const std::string& name) {
  const std::filesystem::path sources = std::getenv("MORTISE_SOURCE_DIR");
  const auto bytes = ReadFile(sources / "collection/shapes" / (name + ".step"));
  EXPECT_TRUE(bytes.ok()) << bytes.status();
  auto read = cad::ReadStep(*bytes);
  EXPECT_TRUE(read.ok()) << read.status();
  return *std::move(read);
}

mesh::DrawnShape ShapeOf(const cad::StepAssembly& drawing, const Eigen::Matrix3d& rotation) {
  const cad::StepPart& part = drawing.parts.front();
  const Eigen::Vector3d a = rotation * part.minimum, b = rotation * part.maximum;
  const auto shape =
      cad::ShapeOfSolid(*drawing.products.front().solid, rotation, a.cwiseMin(b), a.cwiseMax(b));
  EXPECT_TRUE(shape.ok()) << shape.status();
  return *shape;
}

Eigen::Matrix3d About(const Eigen::Vector3d& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

TEST(TurnBetween, FindsHowASolidWasTurned) {
  for (const std::string name : {"angle-25x15", "bearing-607"}) {
    SCOPED_TRACE(name);
    const cad::StepAssembly drawing = Drawing(name);
    const mesh::DrawnShape shape = ShapeOf(drawing, Eigen::Matrix3d::Identity());
    const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), z = Eigen::Vector3d::UnitZ();
    for (const Eigen::Matrix3d& rotation :
         {About(x, 0), About(z, kRightAngle), About(x, 2 * kRightAngle),
          Eigen::Matrix3d(About(x, kRightAngle) * About(z, -kRightAngle))}) {
      const mesh::DrawnShape turned = ShapeOf(drawing, rotation);
      const auto found = TurnBetween(shape, turned);
      ASSERT_TRUE(found.has_value()) << rotation;
      EXPECT_NEAR(found->determinant(), 1, 1e-12);
      // Symmetric solids may be turned in several ways.
      EXPECT_LT((found->cwiseAbs() * shape.size - turned.size).norm(), 1e-6);
      EXPECT_TRUE(TurnBetween(turned, shape).has_value());
    }
    EXPECT_FALSE(TurnBetween(shape, ShapeOf(drawing, About(x, 0.3))).has_value());
  }
}

TEST(TurnBetween, IsNoneOfOtherSolids) {
  mesh::SurfaceMesh corner;
  corner.vertices.resize(3, 4);
  corner.vertices << 0, 0.3, 0, 0, 0, 0, 0.2, 0, 0, 0, 0, 0.1;
  corner.triangles.resize(3, 4);
  corner.triangles << 0, 0, 0, 1, 2, 1, 3, 2, 1, 3, 2, 3;
  const mesh::DrawnShape right = mesh::ShapeOfMesh(corner).value();
  corner.vertices.row(0) *= -1;
  corner.triangles.row(1).swap(corner.triangles.row(2));
  const mesh::DrawnShape left = mesh::ShapeOfMesh(corner).value();
  corner.vertices.row(0) *= 1.001;
  const mesh::DrawnShape longer = mesh::ShapeOfMesh(corner).value();
  EXPECT_TRUE(TurnBetween(right, right)->isIdentity());
  EXPECT_TRUE(TurnBetween(right, mesh::Turned(right, 1, 0)).has_value());
  EXPECT_FALSE(TurnBetween(right, left).has_value()) << "its mirror image";
  EXPECT_FALSE(TurnBetween(left, longer).has_value());
}

TEST(FirstAlike, TakesWhatDiffersByRoundingForOne) {
  const mesh::DrawnShape bracket = ShapeOf(Drawing("angle-25x15"), Eigen::Matrix3d::Identity());
  mesh::DrawnShape rounded = bracket, longer = bracket;
  rounded.fractions.array() += 1e-15;
  rounded.volume *= 1 + 1e-14;
  longer.size.x() *= 1.01;
  const mesh::DrawnShape turned =
      ShapeOf(Drawing("angle-25x15"), About(Eigen::Vector3d::UnitZ(), kRightAngle));
  EXPECT_EQ(FirstAlike({bracket, longer, rounded, turned, rounded, longer}),
            (std::vector<int>{0, 1, 0, 3, 0, 1}));
}

}  // namespace
}  // namespace mortise::catalog
