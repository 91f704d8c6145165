#include "services/pareto/models/difference_model.h"

#include <gtest/gtest.h>

#include "common/base/random.h"

namespace mortise::pareto {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Two quadratics of four parameters.
struct Quadratics {
  MatrixXd slope, curvature[2];

  Quadratics() : slope(2, 4) {
    Random random(5);
    for (double& value : slope.reshaped()) value = random.Uniform() - 0.5;
    for (MatrixXd& H : curvature) {
      H.resize(4, 4);
      for (double& value : H.reshaped()) value = random.Uniform() - 0.5;
      H = (H + H.transpose()).eval();
    }
  }

  VectorXd operator()(const VectorXd& u) const {
    VectorXd metrics = slope * u;
    for (int i = 0; i < 2; ++i) metrics[i] += 0.5 * u.dot(curvature[i] * u);
    return metrics;
  }
};

QuadraticModel ModelAt(const VectorXd& u, const Quadratics& f) {
  QuadraticModel model;
  model.centre = u;
  model.value = f(u);
  model.jacobian = MatrixXd::Constant(2, 4, 7);
  model.hessians.assign(2, MatrixXd::Constant(4, 4, 7));
  return model;
}

TEST(DifferenceModel, IsExactForQuadratics) {
  const Quadratics f;
  // In the middle, at both bounds, and nearer to one than a step.
  const VectorXd u = Eigen::Vector4d(0.4, 0, 1, 0.99);
  DifferenceModel differences(ModelAt(u, f), {0, 1, 2, 3}, 0.05);
  int evaluations = 0;
  while (const auto point = differences.Ask()) {
    EXPECT_GE(point->minCoeff(), 0);
    EXPECT_LE(point->maxCoeff(), 1);
    ++evaluations;
    EXPECT_FALSE(differences.Finished());
    differences.Tell(f(*point));
  }
  EXPECT_TRUE(differences.Finished());
  EXPECT_EQ(evaluations, DifferenceModel::Evaluations(4));
  EXPECT_EQ(evaluations, differences.evaluations());
  const QuadraticModel measured = differences.Measured();
  for (int i = 0; i < 2; ++i) {
    const VectorXd slope = f.slope.row(i).transpose() + f.curvature[i] * u;
    EXPECT_LT((measured.jacobian.row(i).transpose() - slope).norm(), 1e-10);
    EXPECT_LT((measured.hessians[static_cast<std::size_t>(i)] - f.curvature[i]).norm(), 1e-8);
  }
}

TEST(DifferenceModel, LeavesOtherCoordinatesAndWhatFailedAsTheyWere) {
  const Quadratics f;
  const VectorXd u = VectorXd::Constant(4, 0.5);
  DifferenceModel differences(ModelAt(u, f), {1, 3}, 0.05);
  while (const auto point = differences.Ask()) {
    if ((*point)[3] > 0.5) {
      differences.Tell(std::nullopt);
    } else {
      differences.Tell(f(*point));
    }
  }
  const QuadraticModel measured = differences.Measured();
  const VectorXd slope = f.slope.row(0).transpose() + f.curvature[0] * u;
  EXPECT_NEAR(measured.jacobian(0, 1), slope[1], 1e-10);
  EXPECT_NEAR(measured.hessians[0](1, 1), f.curvature[0](1, 1), 1e-8);
  for (const int untouched : {0, 2, 3}) EXPECT_EQ(measured.jacobian(0, untouched), 7);
  EXPECT_EQ(measured.hessians[0](1, 3), 7);
  EXPECT_EQ(measured.hessians[0](0, 1), 7);
}

}  // namespace
}  // namespace mortise::pareto
