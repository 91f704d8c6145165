#include "services/retrieval/descriptors/light_field_descriptor.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "services/retrieval/descriptors/light_field_views.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/mesh/round_solids.h"
#include "tests/unit/services/retrieval/descriptors/furniture.h"

namespace mortise::retrieval {
namespace {

using mesh::SurfaceMesh;

constexpr Eigen::Index kViewSize = 87;

Eigen::VectorXd Vector(const SurfaceMesh& surface) {
  const auto vector = LightFieldDescriptor().Describe(surface);
  EXPECT_TRUE(testing::IsOk(vector));
  return *vector;
}

TEST(LightFieldDescriptorTest, OfASphereIsThatOfFullDiscs) {
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(16 * kViewSize);
  for (Eigen::Index view = 0; view < 16; ++view) {
    const double weight = LightFieldViews()[static_cast<std::size_t>(view)].weight;
    expected[view * kViewSize] = expected[view * kViewSize + 66] = weight;
  }
  EXPECT_LT((Vector(mesh::Sphere(3, 48)) - expected).norm(), 0.02);
}

TEST(LightFieldDescriptorTest, OfACubeIsAsSymmetricAsTheCube) {
  const Eigen::VectorXd vector = Vector(Box({0, 0, 0}, {1, 1, 1}));
  const Eigen::MatrixXd turns = LightFieldDescriptor().QuarterTurns(vector);
  for (int turn = 1; turn < 4; ++turn) EXPECT_LT((turns.col(turn) - vector).norm(), 0.01);
  // A cube is seen along a diagonal as a hexagon.
  const Eigen::VectorXd fourier = vector.segment(66, 21);
  const double sixfold = fourier.segment(11, 2).norm();
  for (Eigen::Index k = 1; k <= 10; ++k) {
    EXPECT_LE(fourier.segment(2 * k - 1, 2).norm(), k == 6 ? sixfold : 0.15 * sixfold);
  }
}

TEST(LightFieldDescriptorTest, TellsAShapeFromItselfOnItsHeadAndFromItsMirrorImage) {
  SurfaceMesh on_its_head = Chair();
  on_its_head.vertices.bottomRows(2) *= -1;
  const LightFieldDescriptor descriptor;
  EXPECT_GT(descriptor.Distance(Vector(Chair()), Vector(on_its_head)), 0.2);
  const SurfaceMesh armchair = Joined({Chair(), Box({0, 0, 0.6}, {0.05, 0.5, 0.65})});
  SurfaceMesh mirrored = armchair;
  mirrored.vertices.row(0) *= -1;
  EXPECT_GT(descriptor.Distance(Vector(armchair), Vector(mirrored)), 0.02);
}

TEST(LightFieldDescriptorTest, ChangesLittleUnderSmallTurnsAndTellsLargeOnes) {
  const auto turned = [](double angle) {
    return mesh::Rotated(Chair(),
                         Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix());
  };
  const LightFieldDescriptor descriptor;
  const double eighth = descriptor.Distance(Vector(Chair()), Vector(turned(M_PI / 4)));
  EXPECT_LT(descriptor.Distance(Vector(Chair()), Vector(turned(0.01))), 0.1 * eighth);
}

TEST(LightFieldDescriptorTest, SeesASheetAsItSeesAThinBoard) {
  // Edge-on a sheet shows nothing and a thin board almost nothing; in the other views they are
  // alike.
  SurfaceMesh sheet = Box({0, 0, 0}, {1, 2, 0.5});
  sheet.vertices.row(2).setZero();
  const double apart = (Vector(sheet) - Vector(Box({0, 0, 0}, {1, 2, 1e-6}))).norm();
  EXPECT_LT(apart, 0.02);
}

TEST(LightFieldDescriptorTest, IsSmoothAlongAFamily) {
  // Second differences along a parameter are small against the first: no jumps.
  std::vector<Eigen::VectorXd> vectors;
  for (int step = 0; step <= 40; ++step) {
    vectors.push_back(Vector(Chair({0.45 + 0.002 * step, 0.5, 0.42, 0.4})));
  }
  double longest = 0, sharpest = 0;
  for (std::size_t i = 1; i + 1 < vectors.size(); ++i) {
    longest = std::max(longest, (vectors[i + 1] - vectors[i - 1]).norm() / 2);
    sharpest = std::max(sharpest, (vectors[i + 1] - 2 * vectors[i] + vectors[i - 1]).norm());
  }
  EXPECT_LT(sharpest, 0.5 * longest);
}

TEST(LightFieldDescriptorTest, DerivativesPredictWhatAParameterChanges) {
  const SurfaceMesh chair = Chair();
  const LightFieldDescriptor descriptor;
  const auto bound = descriptor.Bind(chair);
  ASSERT_TRUE(testing::IsOk(bound));
  const SurfaceMesh wider = Chair({0.46, 0.5, 0.42, 0.4});
  const std::vector<Eigen::Matrix3Xd> velocities = {
      (wider.vertices - chair.vertices) / 0.01, Eigen::Matrix3Xd::Zero(3, chair.vertices.cols()),
      Eigen::Matrix3Xd::Ones(3, chair.vertices.cols())};
  const auto result = (*bound)->Differentiate(chair.vertices, velocities);
  ASSERT_TRUE(testing::IsOk(result));
  EXPECT_EQ(result->value, Vector(chair));
  const Eigen::VectorXd change = Vector(wider) - result->value;
  EXPECT_LT((result->value + 0.01 * result->jacobian.col(0) - Vector(wider)).norm(),
            0.25 * change.norm());
  EXPECT_EQ(result->jacobian.col(1).norm(), 0);
  EXPECT_LT(result->jacobian.col(2).norm(), 1e-3);
}

}  // namespace
}  // namespace mortise::retrieval
