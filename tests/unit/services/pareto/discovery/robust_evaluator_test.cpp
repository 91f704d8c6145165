// Mean and deviation over tolerances: against closed forms, differences, and what cannot be asked.
#include "services/pareto/discovery/robust_evaluator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "common/base/errors.h"
#include "common/base/random.h"
#include "services/pareto/discovery/discovery_run.h"

namespace mortise::pareto {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Distribution = Tolerance::Distribution;

class FunctionEvaluator : public Evaluator {
 public:
  explicit FunctionEvaluator(std::function<Evaluation(const VectorXd&)> function)
      : function_(std::move(function)) {}

  absl::StatusOr<std::vector<Evaluation>> Evaluate(const std::vector<VectorXd>& designs) override {
    std::vector<Evaluation> results;
    for (const VectorXd& x : designs) {
      asked.push_back(x);
      results.push_back(function_(x));
      results.back().x = x;
    }
    return results;
  }

  std::vector<VectorXd> asked;

 private:
  std::function<Evaluation(const VectorXd&)> function_;
};

DesignSpace Box(Eigen::Index size, double lower = -1, double upper = 1) {
  return {VectorXd::Constant(size, lower), VectorXd::Constant(size, upper)};
}

Evaluation Evaluated(const VectorXd& metrics, const MatrixXd& jacobian = {}) {
  Evaluation evaluation;
  evaluation.status = EvaluationStatus::kEvaluated;
  evaluation.metrics = metrics;
  evaluation.jacobian = jacobian;
  return evaluation;
}

// f = c + g.x + x.H x / 2, twice: the second metric is minus it.
struct Quadratic {
  double c = 2;
  VectorXd g;
  MatrixXd hessian;

  Evaluation operator()(const VectorXd& x) const {
    const double value = c + g.dot(x) + x.dot(hessian * x) / 2;
    MatrixXd jacobian(2, x.size());
    jacobian.row(0) = g + hessian * x;
    jacobian.row(1) = -jacobian.row(0);
    return Evaluated(Eigen::Vector2d(value, -value), jacobian);
  }
};

Evaluation Only(Evaluator& evaluator, const VectorXd& x) {
  auto results = evaluator.Evaluate({x});
  EXPECT_TRUE(results.ok()) << results.status();
  EXPECT_EQ(results->size(), 1u);
  return std::move(results->front());
}

Robustness Two(Distribution distribution, double k) {
  return {{{0, "length", 0.1, distribution}, {2, "width", 0.05, distribution}}, k, Box(3)};
}

TEST(RobustEvaluatorTest, IsExactForLinearMetrics) {
  const Quadratic linear{1, Eigen::Vector3d(3, -4, 2), MatrixXd::Zero(3, 3)};
  const VectorXd x = Eigen::Vector3d(0.2, 0.3, -0.1);
  FunctionEvaluator inner(linear);
  for (const auto& [distribution, share] :
       {std::pair{Distribution::kNormal, 1.0}, {Distribution::kUniform, 1 / std::sqrt(3.0)}}) {
    RobustEvaluator robust(inner, Two(distribution, 3));
    const double deviation = share * std::hypot(3 * 0.1, 2 * 0.05), value = linear(x).metrics[0];
    const Evaluation evaluation = Only(robust, x);
    EXPECT_NEAR(evaluation.deviations[0], deviation, 1e-14);
    EXPECT_NEAR(evaluation.metrics[0], value + 3 * deviation, 1e-14);
    // Both metrics get worse, whatever their sign.
    EXPECT_NEAR(evaluation.metrics[1], -value + 3 * deviation, 1e-14);
    EXPECT_TRUE(evaluation.jacobian.row(0).isApprox(linear.g.transpose(), 1e-12));
  }
  EXPECT_EQ(inner.asked.size(), 10u) << "two tolerances are five evaluations";
}

// E = f + tr(H S) / 2; Var = g.S g + sum_i H_ii^2 (fourth central moment - s_i^4) / 4.
TEST(RobustEvaluatorTest, HasTheMomentsOfQuadraticsAtBoundsToo) {
  Quadratic quadratic{1, Eigen::Vector3d(1, -1, 0.5), MatrixXd::Zero(3, 3)};
  quadratic.hessian.diagonal() << 7, 3, -11;
  FunctionEvaluator inner(quadratic);
  for (const VectorXd& x :
       {VectorXd(Eigen::Vector3d(0.2, 0.3, -0.1)), VectorXd(Eigen::Vector3d(-1, 0.3, 1)),
        VectorXd(Eigen::Vector3d(-0.95, 1, 0.97))}) {
    for (const auto& [distribution, second, fourth] :
         {std::tuple{Distribution::kNormal, 1.0, 3.0},
          std::tuple{Distribution::kUniform, 1.0 / 3, 1.0 / 5}}) {
      RobustEvaluator robust(inner, Two(distribution, 0));
      const Evaluation plain = quadratic(x), evaluation = Only(robust, x);
      double mean = plain.metrics[0], variance = 0;
      for (const auto& [i, deviation] : {std::pair{0, 0.1}, {2, 0.05}}) {
        const double h = quadratic.hessian(i, i), s2 = second * deviation * deviation;
        mean += h * s2 / 2;
        variance += std::pow(plain.jacobian(0, i), 2) * s2 +
                    h * h / 4 * (fourth * std::pow(deviation, 4) - s2 * s2);
      }
      EXPECT_NEAR(evaluation.metrics[0], mean, 1e-12);
      EXPECT_NEAR(evaluation.deviations[0], std::sqrt(variance), 1e-12);
    }
  }
}

TEST(RobustEvaluatorTest, EvaluatesWithinTheRangeWhateverTheSteps) {
  FunctionEvaluator inner([](const VectorXd& x) { return Evaluated(x.head(2)); });
  Robustness robustness = Two(Distribution::kNormal, 1);
  Random random(5);
  RobustEvaluator robust(inner, robustness);
  for (int trial = 0; trial < 200; ++trial) {
    VectorXd x(3);
    for (double& value : x) value = std::clamp(3 * random.Uniform() - 1.5, -1.0, 1.0);
    const Evaluation evaluation = Only(robust, x);
    EXPECT_EQ(evaluation.x, x);
    EXPECT_NEAR(evaluation.deviations[0], 0.1, 1e-12);
    EXPECT_EQ(evaluation.deviations[1], 0);
  }
  for (const VectorXd& x : inner.asked) EXPECT_LE(x.lpNorm<Eigen::Infinity>(), 1);
}

TEST(RobustEvaluatorTest, GradientsAreThoseOfDifferences) {
  const auto curved = [](const VectorXd& x) {
    MatrixXd jacobian(2, 3);
    jacobian << std::exp(x[0]) * std::cos(x[2]), 1, -std::exp(x[0]) * std::sin(x[2]),  //
        2 * x[0] * x[1], x[0] * x[0], -3 * x[2] * x[2];
    Evaluation evaluation = Evaluated(Eigen::Vector2d(std::exp(x[0]) * std::cos(x[2]) + x[1],
                                                      x[0] * x[0] * x[1] - x[2] * x[2] * x[2]),
                                      jacobian);
    evaluation.constraints = evaluation.metrics.head(1);
    evaluation.constraint_jacobian = jacobian.topRows(1);
    return evaluation;
  };
  FunctionEvaluator inner(curved);
  RobustEvaluator robust(inner, Two(Distribution::kNormal, 2.5));
  for (const VectorXd& x :
       {VectorXd(Eigen::Vector3d(0.2, 0.3, -0.1)), VectorXd(Eigen::Vector3d(-0.99, 0.3, 0.98))}) {
    const Evaluation evaluation = Only(robust, x);
    for (Eigen::Index i = 0; i < 3; ++i) {
      VectorXd more = x, less = x;
      more[i] += 1e-6;
      less[i] -= 1e-6;
      const Evaluation above = Only(robust, more), below = Only(robust, less);
      const VectorXd slope = (above.metrics - below.metrics) / 2e-6;
      EXPECT_NEAR(evaluation.jacobian(0, i), slope[0], 1e-7);
      EXPECT_NEAR(evaluation.jacobian(1, i), slope[1], 1e-7);
      EXPECT_NEAR(evaluation.constraint_jacobian(0, i), slope[0], 1e-7);
    }
  }
}

TEST(RobustEvaluatorTest, IsOneEvaluationToFirstOrder) {
  const Quadratic linear{1, Eigen::Vector3d(3, -4, 2), MatrixXd::Zero(3, 3)};
  FunctionEvaluator inner(linear);
  Robustness robustness = Two(Distribution::kNormal, 2);
  robustness.first_order = true;
  RobustEvaluator robust(inner, robustness);
  const VectorXd x = Eigen::Vector3d(1, 0, 0);
  const Evaluation evaluation = Only(robust, x);
  EXPECT_EQ(inner.asked.size(), 1u);
  EXPECT_NEAR(evaluation.metrics[0], 4 + 2 * std::hypot(0.3, 0.1), 1e-14);
  EXPECT_EQ(evaluation.jacobian.size(), 0) << "curvature would be needed";

  FunctionEvaluator without([](const VectorXd& design) { return Evaluated(design.head(2)); });
  RobustEvaluator lost(without, robustness);
  EXPECT_EQ(Only(lost, x).reason, "GRADIENT_MISSING");
}

TEST(RobustEvaluatorTest, FailsWhereATolerableDesignDoes) {
  FunctionEvaluator inner([](const VectorXd& x) {
    Evaluation evaluation = Evaluated(x.head(2));
    if (x[0] < 0.5) return evaluation;
    evaluation.status = EvaluationStatus::kFailed;
    evaluation.message = "nothing holds the seat";
    evaluation.reason = "RIGID_MOTION";
    evaluation.code = absl::StatusCode::kFailedPrecondition;
    return evaluation;
  });
  RobustEvaluator robust(inner, Two(Distribution::kNormal, 1));
  EXPECT_EQ(Only(robust, Eigen::Vector3d(0.3, 0, 0)).status, EvaluationStatus::kEvaluated);
  const Evaluation near = Only(robust, Eigen::Vector3d(0.4, 0, 0));
  EXPECT_EQ(near.status, EvaluationStatus::kFailed);
  EXPECT_EQ(near.reason, "TOLERANCE_FAILED");
  EXPECT_EQ(near.code, absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(near.message, testing::AllOf(testing::HasSubstr("length more by 0.17"),
                                           testing::HasSubstr("nothing holds the seat")));
  EXPECT_EQ(Only(robust, Eigen::Vector3d(0.6, 0, 0)).reason, "RIGID_MOTION") << "its own";

  FunctionEvaluator hole([](const VectorXd& x) {
    return Evaluated(Eigen::Vector2d(x[0], x[2] < 0 ? std::nan("") : x[2]));
  });
  RobustEvaluator beside(hole, Two(Distribution::kUniform, 1));
  EXPECT_THAT(Only(beside, Eigen::Vector3d(0, 0, 0.01)).message,
              testing::HasSubstr("width less by 0.0387"));
}

// One metric wants x small, the other falls off a cliff below 0.3: the front keeps away from it.
TEST(RobustEvaluatorTest, FrontsKeepAwayFromCliffs) {
  const auto cliff = [](const VectorXd& x) {
    const double fall = 10 / (1 + std::exp((x[0] - 0.3) / 0.004));
    return Evaluated(Eigen::Vector2d(x[0], fall + 0.2 * (1 - x[0]) + x[1] * x[1]));
  };
  const auto least = [&](double k) {
    FunctionEvaluator inner(cliff);
    Robustness robustness{{{0, "x", 0.05, Distribution::kUniform}}, k, Box(2, 0, 1)};
    if (k == 0) robustness.tolerances.clear();
    RobustEvaluator robust(inner, robustness);
    Discovery::Options options;
    options.evaluations = 150;
    const auto discovery = *Discovery::Create(Box(2, 0, 1), 2, options);
    EXPECT_TRUE(pareto::Run(*discovery, robust, {}).ok());
    // The lightest whose second metric is not on the cliff.
    double lightest = 1;
    for (const FrontPoint& point : discovery->front().points) {
      const bool deviates = k > 0 && point.deviations[1] > 0.05;
      if (point.metrics[1] < 0.3 && !deviates) lightest = std::min(lightest, point.x[0]);
    }
    return lightest;
  };
  EXPECT_LT(least(0), 0.33);
  EXPECT_GT(least(3), 0.34);
  EXPECT_LT(least(3), 0.39);
}

TEST(RobustnessTest, RefusesBadInput) {
  const auto fault = [](const std::function<void(Robustness&)>& change) {
    Robustness robustness = Two(Distribution::kUniform, 1);
    change(robustness);
    return DetailOf(Validate(robustness)).field;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(fault([](Robustness&) {}), "");
  for (const double bad : {0.0, -0.1, nan, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(fault([&](Robustness& r) { r.tolerances[1].deviation = bad; }),
              "tolerances[1].deviation");
  }
  // Three steps are wider than the range.
  EXPECT_EQ(fault([](Robustness& r) { r.tolerances[0].deviation = 0.87; }),
            "tolerances[0].deviation");
  EXPECT_EQ(fault([](Robustness& r) { r.tolerances[0].deviation = 0.86; }), "");
  EXPECT_EQ(fault([](Robustness& r) { r.tolerances[0].parameter = 3; }), "tolerances[0].parameter");
  EXPECT_EQ(fault([](Robustness& r) { r.tolerances[1].parameter = 0; }), "tolerances[1].parameter");
  for (const double bad : {-1.0, nan, 101.0}) {
    EXPECT_EQ(fault([&](Robustness& r) { r.deviations = bad; }), "deviations");
  }
  EXPECT_EQ(fault([](Robustness& r) { r.tolerances.clear(); }), "deviations");
}

TEST(RobustEvaluatorTest, SaysWhenAnswersAreMissing) {
  class Silent : public Evaluator {
    absl::StatusOr<std::vector<Evaluation>> Evaluate(const std::vector<VectorXd>&) override {
      return std::vector<Evaluation>(1);
    }
  } silent;
  RobustEvaluator robust(silent, Two(Distribution::kUniform, 1));
  EXPECT_EQ(robust.Evaluate({VectorXd::Zero(3)}).status().code(), absl::StatusCode::kInternal);
}

}  // namespace
}  // namespace mortise::pareto
