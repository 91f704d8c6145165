#include "services/retrieval/descriptors/descriptor_jacobian.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/base/errors.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/services/retrieval/descriptors/furniture.h"

namespace mortise::retrieval {
namespace {

SurfaceFamily Chairs() {
  return {Eigen::Vector4d(0.3, 0.3, 0.3, 0.2), Eigen::Vector4d(0.6, 0.7, 0.6, 0.6),
          [](const Eigen::VectorXd& q) { return Chair(q); }};
}

const Eigen::Vector4d kMiddle(0.45, 0.5, 0.42, 0.4);

TEST(DescriptorJacobianTest, FindsTheVelocitiesOfALinearFamilyExactly) {
  for (const Eigen::Vector4d& q :
       {kMiddle, Eigen::Vector4d(Chairs().lower), Eigen::Vector4d(Chairs().upper)}) {
    const auto velocities = VertexVelocities(Chairs(), q);
    ASSERT_TRUE(testing::IsOk(velocities));
    ASSERT_EQ(velocities->size(), 4U);
    for (int k = 0; k < 4; ++k) {
      const Eigen::Matrix3Xd exact =
          Chair(q + Eigen::Vector4d::Unit(k)).vertices - Chair(q).vertices;
      EXPECT_LT(((*velocities)[static_cast<std::size_t>(k)] - exact).cwiseAbs().maxCoeff(), 1e-9);
    }
  }
}

TEST(DescriptorJacobianTest, TakesTheVelocitiesThatAFamilyKnows) {
  SurfaceFamily family = Chairs();
  const std::vector<Eigen::Matrix3Xd> known(
      4, Eigen::Matrix3Xd::Constant(3, Chair().vertices.cols(), 7));
  family.velocities = [&](const Eigen::VectorXd&) { return known; };
  const auto velocities = VertexVelocities(family, kMiddle);
  ASSERT_TRUE(testing::IsOk(velocities));
  EXPECT_EQ(*velocities, known);
}

TEST(DescriptorJacobianTest, IsTheDerivativeOfEachDescriptorAlongAFamily) {
  for (const std::string& name : DescriptorNames()) {
    const auto descriptor = *MakeDescriptor(name);
    const auto bound = *descriptor->Bind(Chair());
    const auto result = DescriptorJacobian(*bound, Chairs(), kMiddle);
    ASSERT_TRUE(testing::IsOk(result));
    EXPECT_EQ(result->value, *bound->Describe(Chair().vertices));
    ASSERT_EQ(result->jacobian.cols(), 4);
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector4d step = 1e-3 * Eigen::Vector4d::Unit(k);
      const Eigen::VectorXd difference = (*bound->Describe(Chair(kMiddle + step).vertices) -
                                          *bound->Describe(Chair(kMiddle - step).vertices)) /
                                         2e-3;
      EXPECT_LT((result->jacobian.col(k) - difference).norm(), 0.05 * difference.norm())
          << name << ", parameter " << k;
    }
  }
}

TEST(DescriptorJacobianTest, LosesARankWhereAllSizesGrowTogether) {
  // Descriptors ignore scale: a family that only grows stands still.
  SurfaceFamily family{Eigen::VectorXd::Constant(1, 0.5), Eigen::VectorXd::Constant(1, 2),
                       [](const Eigen::VectorXd& q) {
                         mesh::SurfaceMesh chair = Chair();
                         chair.vertices *= q[0];
                         return chair;
                       }};
  for (const std::string& name : DescriptorNames()) {
    const auto bound = *(*MakeDescriptor(name))->Bind(Chair());
    const auto result = DescriptorJacobian(*bound, family, Eigen::VectorXd::Constant(1, 1));
    ASSERT_TRUE(testing::IsOk(result));
    EXPECT_LT(result->jacobian.norm(), 1e-3) << name;
  }
}

TEST(DescriptorJacobianTest, RefusesParametersOutsideOfTheBox) {
  const auto bound = *(*MakeDescriptor("d2"))->Bind(Chair());
  const auto fault = [&](const Eigen::VectorXd& q) {
    const absl::Status status = DescriptorJacobian(*bound, Chairs(), q).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    return DetailOf(status).field;
  };
  EXPECT_EQ(fault(Eigen::Vector3d(0.4, 0.4, 0.4)), "q");
  EXPECT_EQ(fault(Eigen::Vector4d(0.45, 0.8, 0.42, 0.4)), "q[1]");
  EXPECT_EQ(fault(Eigen::Vector4d(0.45, 0.5, 0.42, NAN)), "q[3]");
}

TEST(DescriptorJacobianTest, TellsWhenTrianglesChange) {
  SurfaceFamily family = Chairs();
  family.surface = [](const Eigen::VectorXd& q) {
    return q[2] > 0.4202 ? Split(Chair(q)) : Chair(q);
  };
  const auto bound = *(*MakeDescriptor("d2"))->Bind(Chair());
  const absl::Status status = DescriptorJacobian(*bound, family, kMiddle).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(DetailOf(status).reason, "TRIANGLES_CHANGE");
  EXPECT_EQ(DetailOf(status).field, "q[2]");
}

TEST(DescriptorJacobianTest, PassesOnWhatTheFamilySays) {
  SurfaceFamily family = Chairs();
  family.surface = [](const Eigen::VectorXd&) -> absl::StatusOr<mesh::SurfaceMesh> {
    return PreconditionFailed("NOT_FEASIBLE", "the legs meet", "q");
  };
  const auto bound = *(*MakeDescriptor("d2"))->Bind(Chair());
  EXPECT_EQ(DetailOf(DescriptorJacobian(*bound, family, kMiddle).status()).reason, "NOT_FEASIBLE");
}

}  // namespace
}  // namespace mortise::retrieval
