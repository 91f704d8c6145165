// Duals, tangents of the front, and the models they are taken from.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "common/base/random.h"
#include "services/pareto/archive/stochastic_sampling.h"
#include "services/pareto/models/first_order_expansion.h"
#include "services/pareto/models/quadratic_model.h"

namespace mortise::pareto {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST(ExpansionTest, RecoversDualsOfTwoQuadratics) {
  // f_i = |u - c_i|^2_Ai / 2 at the point where 0.3 grad f1 + 0.7 grad f2 = 0.
  const MatrixXd A1 = Eigen::Vector3d(1, 2, 4).asDiagonal();
  const MatrixXd A2 = Eigen::Vector3d(3, 1, 1).asDiagonal();
  const VectorXd c1 = Eigen::Vector3d(0.2, 0.3, 0.4), c2 = Eigen::Vector3d(0.8, 0.6, 0.5);
  const auto optimum = [&](double a) -> VectorXd {
    const MatrixXd H = a * A1 + (1 - a) * A2;
    return H.ldlt().solve(a * A1 * c1 + (1 - a) * A2 * c2);
  };
  const VectorXd u = optimum(0.3);
  MatrixXd J(2, 3);
  J << (A1 * (u - c1)).transpose(), (A2 * (u - c2)).transpose();
  const KktPoint kkt = RecoverDuals(J, u);
  EXPECT_NEAR(kkt.alpha[0], 0.3, 1e-9);
  EXPECT_LT(kkt.residual, 1e-9);
  EXPECT_EQ(kkt.free.size(), 3u);
  // Proposition 3 against the derivative of the optimum along the front.
  const MatrixXd v = ExpansionDirections(kkt, J, 0.3 * A1 + 0.7 * A2);
  ASSERT_EQ(v.cols(), 1);
  const VectorXd tangent = (optimum(0.3 + 1e-6) - optimum(0.3 - 1e-6)).normalized();
  EXPECT_NEAR(std::abs(tangent.dot(v.col(0))), 1, 1e-6);
}

TEST(ExpansionTest, HoldsActiveBoundsWithNonNegativeMultipliers) {
  MatrixXd J(2, 3);
  J << 1, 0.5, -1, -2, 0.5, -1;  // u1 trades off; u2 wants down, u3 wants up
  const KktPoint kkt = RecoverDuals(J, Eigen::Vector3d(0.4, 0, 1));
  ASSERT_EQ(kkt.free, std::vector<Eigen::Index>{0});
  EXPECT_NEAR(kkt.alpha[0], 2.0 / 3, 1e-9);
  EXPECT_GT(kkt.beta[1], 0);
  EXPECT_GT(kkt.beta[2], 0);
  const MatrixXd v = ExpansionDirections(kkt, J, MatrixXd::Zero(3, 3));
  ASSERT_EQ(v.cols(), 1);
  EXPECT_EQ(v(1, 0), 0);
  EXPECT_EQ(v(2, 0), 0);
}

TEST(ExpansionTest, FollowsAnActiveConstraintWithItsMultiplier) {
  // The squared distances to (1, 0, 0) and (0, 1, 0) under u1 + u2 + u3 <= 0.4: the Pareto set is
  // the segment between the projections onto the plane.
  const VectorXd u = Eigen::Vector3d(0.3, 0.3, -0.2);
  const VectorXd a = Eigen::Vector3d(1, 0, 0), b = Eigen::Vector3d(0, 1, 0);
  MatrixXd J(2, 3);
  J << 2 * (u - a).transpose(), 2 * (u - b).transpose();
  const KktPoint kkt = RecoverDuals(J, VectorXd::Constant(3, 0.5), Eigen::RowVector3d(1, 1, 1));
  EXPECT_NEAR(kkt.alpha[0], 0.5, 1e-9);
  EXPECT_LT(kkt.residual, 1e-9);
  EXPECT_NEAR(kkt.mu[0], 0.4, 1e-9);  // alpha J + mu n = 0
  const MatrixXd v = ExpansionDirections(kkt, J, 2 * MatrixXd::Identity(3, 3));
  ASSERT_EQ(v.cols(), 1);
  EXPECT_NEAR(std::abs(v.col(0).dot((b - a).normalized())), 1, 1e-9);
}

TEST(ExpansionTest, ReleasesAConstraintThatOnlyPullsBack) {
  MatrixXd J(2, 2);
  J << 1, 0, -0.5, 0.2;
  const KktPoint kkt = RecoverDuals(J, VectorXd::Constant(2, 0.5), Eigen::RowVector2d(0, 1));
  EXPECT_EQ(kkt.mu[0], 0);
  EXPECT_EQ(kkt.tangent.cols(), 2);
  EXPECT_GT(RecoverDuals(J, VectorXd::Constant(2, 0.5), Eigen::RowVector2d(0, -1)).mu[0], 0.1);
}

TEST(ExpansionTest, FreesTheBoundAlongWhichACornerContinues) {
  MatrixXd J(2, 2);
  J << 1, 1, -3, 1;
  const KktPoint kkt = RecoverDuals(J, Eigen::Vector2d(0, 0));
  EXPECT_EQ(kkt.free, std::vector<Eigen::Index>{0});
}

TEST(ExpansionTest, SaysSoWhereTheMetricsAgree) {
  MatrixXd J(2, 2);
  J << 1, 1, 2, 3;
  EXPECT_TRUE(RecoverDuals(J, Eigen::Vector2d(0, 0)).free.empty());
  EXPECT_GT(RecoverDuals(J, Eigen::Vector2d(0.5, 0.5)).residual, 0.5);
}

TEST(QuadraticModelTest, RecoversAQuadraticFromItsValues) {
  constexpr Eigen::Index D = 3;
  Random random(6);
  MatrixXd H(D, D);
  H << 2, 0.5, 0, 0.5, 1, -0.3, 0, -0.3, 3;
  const VectorXd g = Eigen::Vector3d(1, -2, 0.5);
  const VectorXd c = VectorXd::Constant(D, 0.5);
  Archive archive;
  const auto add = [&](const VectorXd& u) {
    const VectorXd s = u - c;
    return archive.Add({u, true, VectorXd::Constant(1, g.dot(s) + 0.5 * s.dot(H * s)), {}, {}});
  };
  const std::size_t centre = add(c);
  for (int i = 0; i < 60; ++i) add(c + 0.1 * random.UnitVector(D) * (0.5 + random.Uniform()));
  const QuadraticModel model = FitQuadraticModel(archive, centre, 0.2, MatrixXd());
  EXPECT_LT((model.jacobian.row(0).transpose() - g).norm(), 0.02);
  EXPECT_LT((model.hessians[0] - H).norm(), 0.4);
}

TEST(StochasticSamplingTest, LatinHypercubesFillEveryStratum) {
  Random random(1);
  const auto points = LatinHypercube(16, 4, random);
  for (Eigen::Index i = 0; i < 4; ++i) {
    std::vector<int> strata(16, 0);
    for (const VectorXd& point : points) ++strata[static_cast<std::size_t>(point[i] * 16)];
    EXPECT_EQ(strata, std::vector<int>(16, 1));
  }
}

TEST(StochasticSamplingTest, PerturbationsHaveBothSignsAndStayInTheBox) {
  Random random(1);
  int up = 0;
  for (int i = 0; i < 400; ++i) {
    const VectorXd u = PerturbedSample(VectorXd::Constant(2, 0.5), 10, random);
    EXPECT_GE(u.minCoeff(), 0);
    EXPECT_LE(u.maxCoeff(), 1);
    up += u[0] > 0.5 ? 1 : 0;
  }
  EXPECT_GT(up, 150);
  EXPECT_LT(up, 250);
}

}  // namespace
}  // namespace mortise::pareto
