// What the workers of a customer's evaluator report: results that are used, and results that are
// not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "common/base/errors.h"
#include "google/rpc/status.pb.h"
#include "mortise/v1/evaluator.grpc.pb.h"
#include "tests/integration/services/simulator/evaluator_fixture.h"

namespace mortise::simulator {
namespace {

using ::testing::HasSubstr;

TEST_F(EvaluatorTest, ResultsThatCannotBeUsedFailTheirTaskAndSayWhy) {
  ASSERT_TRUE(Create(Beam()).ok());
  struct Fault {
    std::string field;
    std::string message;  // a part of it
    std::function<void(v1::EvaluationResult&)> make;
  };
  const std::vector<Fault> faults{
      {"result.metrics", "has 1 entries; asked for were 2: mass, cost",
       [](auto& result) { result.mutable_metrics()->RemoveLast(); }},
      {"result.metrics[1].name", "must be 'cost'",
       [](auto& result) { result.mutable_metrics(1)->set_name("price"); }},
      {"result.metrics[0].unit", "must be 'kg'",
       [](auto& result) { result.mutable_metrics(0)->set_unit("g"); }},
      {"result.gradients", "asked for were 1: mass",
       [](auto& result) { result.clear_gradients(); }},
      {"result.gradients[0].values", "one for each of the 2 parameters",
       [](auto& result) { result.mutable_gradients(0)->add_values(1); }},
  };
  v1::EvaluateBatchRequest batch = Batch(1, {"mass", "cost"});
  batch.set_gradients(true);
  for (std::size_t i = 0; i < faults.size(); ++i) {
    batch.mutable_points(0)->set_parameters(0, 1 + 0.1 * i);
    const absl::Status outcome = OutcomeOf(batch, [&] {
      const v1::Task task = LeaseOne();
      v1::EvaluationResult result = Answer(task);
      v1::Gradient& gradient = *result.add_gradients();
      gradient.set_metric("mass");
      gradient.add_values(10);
      gradient.add_values(0);
      faults[i].make(result);
      const absl::Status refused = Report(task, result);
      EXPECT_TRUE(absl::IsInvalidArgument(refused)) << refused;
      EXPECT_EQ(DetailOf(refused).field, faults[i].field);
      // Saying it again changes nothing.
      EXPECT_EQ(Report(task, result), refused);
    });
    EXPECT_TRUE(absl::IsFailedPrecondition(outcome)) << outcome;
    EXPECT_EQ(DetailOf(outcome).reason, "RESULT_UNUSABLE");
    EXPECT_THAT(std::string(outcome.message()), HasSubstr(faults[i].message));
  }
}

// Whoever waits hears of it at once, from the first report: nothing is tried again.
TEST_F(EvaluatorTest, NumbersMustBeFinite) {
  ASSERT_TRUE(Create(Beam()).ok());
  struct Fault {
    std::string field;
    std::string named;
    std::function<void(v1::EvaluationResult&)> make;
  };
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::vector<Fault> faults = {
      {"result.metrics[0].value", "not a finite number: mass",
       [](auto& result) {
         result.mutable_metrics(0)->set_value(std::numeric_limits<double>::quiet_NaN());
       }},
      {"result.metrics[1].value", "not a finite number: cost",
       [](auto& result) { result.mutable_metrics(1)->set_value(kInfinity); }},
      {"result.metrics[0].value", "not a finite number: mass, cost",
       [](auto& result) {
         for (v1::Metric& metric : *result.mutable_metrics()) metric.set_value(-kInfinity);
       }},
      {"result.gradients[0].values[1]", "not a finite number: the gradient of mass",
       [](auto& result) {
         result.mutable_gradients(0)->set_values(1, std::numeric_limits<double>::quiet_NaN());
       }},
  };
  v1::EvaluateBatchRequest batch = Batch(1, {"mass", "cost"});
  batch.set_gradients(true);
  for (std::size_t i = 0; i < faults.size(); ++i) {
    batch.mutable_points(0)->set_parameters(0, 1 + 0.1 * static_cast<double>(i));
    const absl::Status outcome = OutcomeOf(batch, [&] {
      const v1::Task task = LeaseOne();
      EXPECT_EQ(task.attempt(), 1);
      v1::EvaluationResult result = Answer(task);
      v1::Gradient& gradient = *result.add_gradients();
      gradient.set_metric("mass");
      gradient.add_values(10);
      gradient.add_values(0);
      faults[i].make(result);
      const absl::Status refused = Report(task, result);
      EXPECT_TRUE(absl::IsInvalidArgument(refused)) << refused;
      EXPECT_EQ(DetailOf(refused).field, faults[i].field);
      // Saying it again changes nothing.
      EXPECT_EQ(Report(task, result), refused);
    });
    EXPECT_TRUE(absl::IsFailedPrecondition(outcome)) << outcome;
    EXPECT_EQ(DetailOf(outcome).reason, "NOT_FINITE");
    EXPECT_EQ(DetailOf(outcome).field, faults[i].field);
    EXPECT_THAT(std::string(outcome.message()), HasSubstr(faults[i].named));
  }
  // A report of a task that nobody has is refused for its numbers, too, and changes nothing.
  v1::Task none;
  none.set_name("tasks/none");
  none.set_attempt(1);
  v1::EvaluationResult result;
  result.add_metrics()->set_value(kInfinity);
  EXPECT_EQ(DetailOf(Report(none, result)).field, "result.metrics[0].value");
}

// Of three metrics one has an exact gradient. Designs beside the points are ordinary tasks, some of
// which fail.
TEST_F(EvaluatorTest, GradientsThatAreNotOfferedAreTakenByDifferences) {
  ASSERT_TRUE(Create(Beam()).ok());
  v1::EvaluateBatchRequest request = Batch(1, {"mass", "deflection", "cost"});
  request.mutable_points(0)->set_parameters(0, 2);
  *request.add_points() = request.points(0);
  request.mutable_points(1)->set_parameters(0, 1);  // a bound
  request.set_gradients(true);
  request.set_difference_step(0.05);
  absl::StatusOr<Results> results = absl::UnknownError("not run");
  std::thread client([&] { results = Evaluate(request); });
  for (int done = 0; done < 2 + 2 * 4; ++done) {
    const v1::Task task = LeaseOne();
    const double length = task.point().parameters(0), height = task.point().parameters(1);
    v1::EvaluationResult answer;
    for (const std::string& name : task.metrics()) {
      v1::Metric& metric = *answer.add_metrics();
      metric.set_name(name);
      metric.set_value(name == "deflection" ? length * length / height : 100 * length + height);
    }
    if (task.gradients()) {
      answer.add_gradients()->set_metric("mass");
      answer.mutable_gradients(0)->add_values(100);
      answer.mutable_gradients(0)->add_values(1);
    } else {
      EXPECT_EQ(task.metrics_size(), 2) << "what is exact is not computed again";
    }
    const bool fails = length == 1 && height > 0.2;
    if (fails) answer = Error(absl::StatusCode::kFailedPrecondition, "too high for its length");
    EXPECT_TRUE(Report(task, answer).ok());
  }
  client.join();
  ASSERT_TRUE(results.ok()) << results.status();
  for (const auto& [index, result] : *results) {
    ASSERT_FALSE(result.has_error()) << result.error().message();
    ASSERT_EQ(result.metrics_size(), 3);
    ASSERT_EQ(result.gradients_size(), 3);
    EXPECT_FALSE(result.gradients(0).by_differences());
    const double length = request.points(index).parameters(0);
    const v1::Gradient &deflection = result.gradients(1), &cost = result.gradients(2);
    EXPECT_EQ(deflection.metric(), "deflection");
    EXPECT_TRUE(deflection.by_differences());
    EXPECT_NEAR(deflection.values(0), 2 * length / 0.2, 1e-9);
    // d(L²/h)/dh by ±0.015, or by −0.015 alone where the other side failed.
    const double low = length * length / 0.185, high = length * length / 0.215;
    const double by_low = (length * length / 0.2 - low) / 0.015;
    EXPECT_NEAR(deflection.values(1), index == 0 ? (high - low) / 0.03 : by_low, 1e-6);
    EXPECT_EQ(cost.metric(), "cost");
    EXPECT_NEAR(cost.values(0), 100, 1e-9);
    EXPECT_NEAR(cost.values(1), 1, 1e-6);
  }
  // All of it is known now, but for what failed, which is known too.
  const auto again = Evaluate(request);
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_TRUE(again->at(0).cached());
  EXPECT_EQ(again->at(0).gradients(1).values(1), results->at(0).gradients(1).values(1));
  request.set_gradients(false);
  EXPECT_EQ(DetailOf(Evaluate(request).status()).field, "difference_step");
}

}  // namespace
}  // namespace mortise::simulator
