// Evaluators that customers register: their tasks, what their workers report, and how they fail.
#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <map>
#include <thread>

#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "google/rpc/status.pb.h"
#include "mortise/v1/evaluator.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/simulator/simulator_process.h"

namespace mortise::simulator {
namespace {

using ::testing::HasSubstr;
using Results = std::map<int, v1::EvaluationResult>;

// Two parameters; of the three metrics one offers its gradient.
constexpr char kBeam[] = R"(
  name: 'evaluators/beam' title: 'Beam' version: '1' space {
    parameters { name: 'length' unit: 'm' minimum: 1 maximum: 3 default_value: 2 }
    parameters { name: 'height' unit: 'm' minimum: 0.1 maximum: 0.4 default_value: 0.2 }
    metrics { name: 'mass' unit: 'kg' offers_gradient: true }
    metrics { name: 'deflection' unit: 'm' }
    metrics { name: 'cost' unit: 'EUR' } })";

class EvaluatorTest : public SimulatorProcessTest {
 protected:
  using Service = v1::EvaluatorService::Stub;

  static v1::Evaluator Beam() {
    v1::Evaluator beam;
    EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(kBeam, &beam));
    return beam;
  }

  std::unique_ptr<Service> Evaluators() const {
    return v1::EvaluatorService::NewStub(service_.channel());
  }

  absl::StatusOr<v1::Evaluator> Create(const v1::Evaluator& evaluator) {
    v1::CreateEvaluatorRequest request;
    request.set_request_id("create-" + std::to_string(++requests_));
    *request.mutable_evaluator() = evaluator;
    return testing::Call(*Evaluators(), &Service::CreateEvaluator, request);
  }

  absl::Status Delete(const std::string& name) {
    v1::DeleteEvaluatorRequest request;
    request.set_request_id("delete-" + std::to_string(++requests_));
    request.set_name(name);
    return testing::Call(*Evaluators(), &Service::DeleteEvaluator, request).status();
  }

  static v1::EvaluateBatchRequest Batch(int points, const std::vector<std::string>& metrics,
                                        const std::string& subject = "evaluators/beam") {
    v1::EvaluateBatchRequest request;
    request.set_subject(subject);
    for (const std::string& metric : metrics) request.add_metrics(metric);
    for (int i = 0; i < points; ++i) {
      v1::DesignPoint& point = *request.add_points();
      point.add_parameters(1 + 2.0 * i / points);
      point.add_parameters(0.2);
    }
    return request;
  }

  absl::StatusOr<Results> Evaluate(const v1::EvaluateBatchRequest& request) {
    const auto stub = Evaluators();
    const auto context = Context();
    const auto reader = stub->EvaluateBatch(context.get(), request);
    Results results;
    v1::EvaluationResult result;
    while (reader->Read(&result)) EXPECT_TRUE(results.emplace(result.index(), result).second);
    const grpc::Status status = reader->Finish();
    if (!status.ok()) return rpc::FromGrpc(status);
    return results;
  }

  absl::StatusOr<v1::LeaseTasksResponse> Lease(const std::string& evaluator, int limit = 1,
                                               double lease = 60) {
    v1::LeaseTasksRequest request;
    request.set_evaluator(evaluator);
    request.set_worker("solver");
    request.set_limit(limit);
    request.set_lease_seconds(lease);
    request.set_wait_seconds(50);
    return testing::Call(*Simulator(), &v1::SimulatorService::Stub::LeaseTasks, request);
  }

  v1::Task LeaseOne(double lease = 60) {
    const auto leased = Lease("evaluators/beam", 1, lease);
    EXPECT_TRUE(leased.ok()) << leased.status();
    EXPECT_EQ(leased.ok() ? leased->tasks_size() : 0, 1);
    return leased.ok() && leased->tasks_size() > 0 ? leased->tasks(0) : v1::Task();
  }

  absl::Status Report(const v1::Task& task, const v1::EvaluationResult& result) {
    v1::ReportTaskRequest request;
    request.mutable_task()->set_name(task.name());
    request.mutable_task()->set_attempt(task.attempt());
    *request.mutable_result() = result;
    return testing::Call(*Simulator(), &v1::SimulatorService::Stub::ReportTask, request).status();
  }

  // The metrics asked for, each ten times the length, without units.
  static v1::EvaluationResult Answer(const v1::Task& task) {
    v1::EvaluationResult result;
    for (const std::string& name : task.metrics()) {
      v1::Metric& metric = *result.add_metrics();
      metric.set_name(name);
      metric.set_value(10 * task.point().parameters(0));
    }
    return result;
  }

  static v1::EvaluationResult Error(absl::StatusCode code, const std::string& message) {
    v1::EvaluationResult result;
    result.mutable_error()->set_code(static_cast<int>(code));
    result.mutable_error()->set_message(message);
    return result;
  }

  // What comes of a batch of one point while `work` plays the worker.
  template <typename Work>
  absl::Status OutcomeOf(const v1::EvaluateBatchRequest& request, const Work& work) {
    absl::StatusOr<Results> results = absl::UnknownError("not run");
    std::thread client([&] { results = Evaluate(request); });
    work();
    client.join();
    if (!results.ok()) return results.status();
    return rpc::FromProto(results->at(0).error());
  }

 private:
  int requests_ = 0;
};

TEST_F(EvaluatorTest, IsDescribedEvaluatedAndItsResultsKept) {
  const auto created = Create(Beam());
  ASSERT_TRUE(created.ok()) << created.status();
  v1::DescribeDesignSpaceRequest describe;
  describe.set_subject("evaluators/beam");
  const auto space = testing::Call(*Evaluators(), &Service::DescribeDesignSpace, describe);
  ASSERT_TRUE(space.ok()) << space.status();
  EXPECT_EQ(space->subject(), "evaluators/beam");
  EXPECT_EQ(space->parameters_size(), 2);
  EXPECT_EQ(space->metrics(2).unit(), "EUR");
  const v1::EvaluateBatchRequest request = Batch(5, {"cost", "mass"});
  absl::StatusOr<Results> results = absl::UnknownError("not run");
  std::thread client([&] { results = Evaluate(request); });
  for (int done = 0; done < 5;) {
    const auto leased = Lease("evaluators/beam", 4);
    ASSERT_TRUE(leased.ok()) << leased.status();
    for (const v1::Task& task : leased->tasks()) {
      EXPECT_EQ(task.evaluator(), "evaluators/beam");
      EXPECT_TRUE(Report(task, Answer(task)).ok());
      ++done;
    }
  }
  client.join();
  ASSERT_TRUE(results.ok()) << results.status();
  for (int round = 0; round < 3; ++round) {
    for (const auto& [index, result] : *results) {
      ASSERT_EQ(result.metrics_size(), 2);
      EXPECT_EQ(result.metrics(0).name(), "cost");
      EXPECT_EQ(result.metrics(0).unit(), "EUR");
      EXPECT_EQ(result.metrics(0).value(), 10 * request.points(index).parameters(0));
      EXPECT_EQ(result.cached(), round > 0);
    }
    // Again, from memory; and after kill -9, from the store.
    if (round == 1) {
      service_.Kill();
      service_.Start();
    }
    results = Evaluate(request);
    ASSERT_TRUE(results.ok()) << results.status();
  }
}

TEST_F(EvaluatorTest, MayBeCreatedAgainAsItIsAndAnewOnceDeleted) {
  const auto first = Create(Beam());
  ASSERT_TRUE(first.ok()) << first.status();
  EXPECT_EQ(first->space().revision(), 1);
  const auto same = Create(Beam());
  ASSERT_TRUE(same.ok()) << same.status();
  EXPECT_EQ(same->SerializeAsString(), first->SerializeAsString());
  v1::Evaluator next = Beam();
  next.set_version("2");
  EXPECT_TRUE(absl::IsAlreadyExists(Create(next).status()));
  EXPECT_TRUE(OutcomeOf(Batch(1, {"mass"}), [&] {
                const v1::Task task = LeaseOne();
                EXPECT_TRUE(Report(task, Answer(task)).ok());
              }).ok());
  EXPECT_TRUE(Delete("evaluators/beam").ok());
  EXPECT_TRUE(absl::IsNotFound(Delete("evaluators/beam")));
  EXPECT_TRUE(absl::IsNotFound(Evaluate(Batch(1, {"mass"})).status()));
  const auto anew = Create(next);
  ASSERT_TRUE(anew.ok()) << anew.status();
  EXPECT_EQ(anew->space().revision(), 2);
  v1::EvaluateBatchRequest old = Batch(1, {"mass"});
  old.set_revision(1);
  EXPECT_TRUE(absl::IsNotFound(Evaluate(old).status()));
  // What version 1 found is not version 2's.
  EXPECT_TRUE(OutcomeOf(Batch(1, {"mass"}), [&] {
                const v1::Task task = LeaseOne();
                EXPECT_EQ(task.revision(), 2);
                EXPECT_TRUE(Report(task, Answer(task)).ok());
              }).ok());
  v1::ListEvaluatorsRequest list;
  const auto listed = testing::Call(*Evaluators(), &Service::ListEvaluators, list);
  ASSERT_TRUE(listed.ok()) << listed.status();
  ASSERT_EQ(listed->evaluators_size(), 1);
  EXPECT_EQ(listed->evaluators(0).version(), "2");
}

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

TEST_F(EvaluatorTest, WorkersThatGiveUpFailOrDieAreReplaced) {
  ASSERT_TRUE(Create(Beam()).ok());
  const absl::Status outcome = OutcomeOf(Batch(1, {"mass"}), [&] {
    // Given back by a worker that ends; tried again for a passing reason; lost with its worker.
    const v1::Task given_back = LeaseOne();
    EXPECT_TRUE(Report(given_back, Error(absl::StatusCode::kCancelled, "ends")).ok());
    const v1::Task unlucky = LeaseOne();
    EXPECT_TRUE(Report(unlucky, Error(absl::StatusCode::kUnavailable, "licence server")).ok());
    const v1::Task lost = LeaseOne(1);
    const v1::Task done = LeaseOne();
    EXPECT_EQ(done.name(), given_back.name());
    EXPECT_EQ(done.attempt(), 4);
    EXPECT_TRUE(absl::IsAborted(Report(lost, Answer(lost))));
    EXPECT_TRUE(Report(done, Answer(done)).ok());
  });
  EXPECT_TRUE(outcome.ok()) << outcome;
  v1::EvaluateBatchRequest other = Batch(1, {"cost"});
  const absl::Status failure = OutcomeOf(other, [&] {
    EXPECT_TRUE(Report(LeaseOne(), Error(absl::StatusCode::kOutOfRange, "buckles")).ok());
  });
  EXPECT_EQ(failure.message(), "buckles");
  other = Batch(1, {"deflection"});
  const absl::Status poison = OutcomeOf(other, [&] {
    for (int attempt = 1; attempt <= 3; ++attempt) EXPECT_EQ(LeaseOne(1).attempt(), attempt);
  });
  EXPECT_EQ(DetailOf(poison).reason, "QUARANTINED");
  v1::ListTasksRequest list;
  list.set_evaluator("evaluators/beam");
  list.set_state(v1::QUARANTINED);
  const auto tasks = testing::Call(*Simulator(), &v1::SimulatorService::Stub::ListTasks, list);
  ASSERT_TRUE(tasks.ok()) << tasks.status();
  ASSERT_EQ(tasks->tasks_size(), 1);
  EXPECT_EQ(tasks->tasks(0).task().point().parameters_size(), 2);
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

TEST_F(EvaluatorTest, QueuesDoNotMixAndEndWithTheirEvaluator) {
  v1::Evaluator twin = Beam();
  twin.set_name("evaluators/twin");
  ASSERT_TRUE(Create(Beam()).ok());
  ASSERT_TRUE(Create(twin).ok());
  const absl::Status cancelled = OutcomeOf(Batch(1, {"mass"}, "evaluators/twin"), [&] {
    EXPECT_TRUE(OutcomeOf(Batch(1, {"mass"}), [&] {
                  const v1::Task task = LeaseOne();
                  EXPECT_EQ(task.subject(), "evaluators/beam");
                  EXPECT_TRUE(Report(task, Answer(task)).ok());
                }).ok());
    const auto leased = Lease("evaluators/twin");
    ASSERT_TRUE(leased.ok()) << leased.status();
    ASSERT_EQ(leased->tasks_size(), 1);
    EXPECT_TRUE(Delete("evaluators/twin").ok());
    v1::RenewLeasesRequest renew;
    renew.add_tasks()->set_name(leased->tasks(0).name());
    renew.mutable_tasks(0)->set_attempt(1);
    const auto renewed =
        testing::Call(*Simulator(), &v1::SimulatorService::Stub::RenewLeases, renew);
    ASSERT_TRUE(renewed.ok()) << renewed.status();
    EXPECT_EQ(renewed->lost_size(), 1);
  });
  EXPECT_TRUE(absl::IsCancelled(cancelled)) << cancelled;
}

TEST_F(EvaluatorTest, WhoLeavesWhileABatchIsQueuedLeavesNoTasks) {
  ASSERT_TRUE(Create(Beam()).ok());
  const auto queued = [&] {
    v1::GetQueueStatusRequest request;
    request.set_evaluator("evaluators/beam");
    const auto status =
        testing::Call(*Simulator(), &v1::SimulatorService::Stub::GetQueueStatus, request);
    EXPECT_TRUE(status.ok()) << status.status();
    return status.ok() ? status->queued() : 0;
  };
  const auto stub = Evaluators();
  // Several times, as whoever leaves while a piece is on its way into the queue is rare.
  for (int i = 0; i < 10; ++i) {
    const auto context = Context();
    const auto reader = stub->EvaluateBatch(context.get(), Batch(1000, {"deflection"}));
    while (queued() == 0 && !HasFailure()) std::this_thread::yield();
    context->TryCancel();
    EXPECT_EQ(reader->Finish().error_code(), grpc::StatusCode::CANCELLED);
    while (queued() > 0 && !HasFailure()) std::this_thread::yield();
  }
}

TEST_F(EvaluatorTest, BadInputIsNamed) {
  const auto field = [&](const std::function<void(v1::Evaluator&)>& spoil) {
    v1::Evaluator evaluator = Beam();
    spoil(evaluator);
    const absl::Status refused = Create(evaluator).status();
    EXPECT_TRUE(absl::IsInvalidArgument(refused)) << refused;
    return DetailOf(refused).field;
  };
  const auto space = [](v1::Evaluator& evaluator) { return evaluator.mutable_space(); };
  EXPECT_EQ(field([](auto& e) { e.set_name("beam"); }), "evaluator.name");
  EXPECT_EQ(field([](auto& e) { e.set_version(std::string(101, '1')); }), "evaluator.version");
  EXPECT_EQ(field([&](auto& e) { space(e)->set_subject("evaluators/other"); }),
            "evaluator.space.subject");
  EXPECT_EQ(field([&](auto& e) { space(e)->set_revision(1); }), "evaluator.space.revision");
  EXPECT_EQ(field([&](auto& e) { space(e)->clear_parameters(); }), "evaluator.space.parameters");
  EXPECT_EQ(field([&](auto& e) { space(e)->clear_metrics(); }), "evaluator.space.metrics");
  EXPECT_EQ(field([&](auto& e) { space(e)->mutable_parameters(1)->set_name("length"); }),
            "evaluator.space.parameters[1].name");
  EXPECT_EQ(field([&](auto& e) { space(e)->mutable_metrics(2)->set_name("a b"); }),
            "evaluator.space.metrics[2].name");
  EXPECT_EQ(field([&](auto& e) { space(e)->mutable_parameters(0)->set_maximum(1); }),
            "evaluator.space.parameters[0].maximum");
  EXPECT_EQ(field([&](auto& e) { space(e)->mutable_parameters(0)->set_default_value(9); }),
            "evaluator.space.parameters[0].default_value");
  EXPECT_EQ(field([&](auto& e) { space(e)->mutable_parameters(0)->set_step(-1); }),
            "evaluator.space.parameters[0].step");
  const auto choice = [&](const std::vector<std::string>& names, double maximum, double step) {
    return field([&](auto& e) {
      auto& parameter = *space(e)->mutable_parameters(0);
      parameter.mutable_choices()->Add(names.begin(), names.end());
      parameter.set_minimum(0);
      parameter.set_maximum(maximum);
      parameter.set_step(step);
      parameter.set_default_value(0);
    });
  };
  EXPECT_EQ(choice({"oak"}, 0, 1), "evaluator.space.parameters[0].choices");
  EXPECT_EQ(choice({"oak", "oak"}, 1, 1), "evaluator.space.parameters[0].choices[1]");
  EXPECT_EQ(choice({"oak", ""}, 1, 1), "evaluator.space.parameters[0].choices[1]");
  EXPECT_EQ(choice({"oak, dry", "ash"}, 1, 1), "evaluator.space.parameters[0].choices[0]");
  EXPECT_EQ(choice({"oak", "ash"}, 2, 1), "evaluator.space.parameters[0].maximum");
  EXPECT_EQ(choice({"oak", "ash"}, 1, 0), "evaluator.space.parameters[0].step");
  ASSERT_TRUE(Create(Beam()).ok());
  EXPECT_EQ(DetailOf(Evaluate(Batch(1, {"mass", "beauty"})).status()).field, "metrics[1]");
  const absl::StatusOr<Results> outside = [&] {
    v1::EvaluateBatchRequest request = Batch(1, {"mass"});
    request.mutable_points(0)->set_parameters(0, 4);
    return Evaluate(request);
  }();
  ASSERT_TRUE(outside.ok()) << outside.status();
  EXPECT_THAT(outside->at(0).error().message(), HasSubstr("length must be within 1 to 3"));
  EXPECT_TRUE(absl::IsNotFound(Lease("evaluators/none").status()));
  EXPECT_EQ(DetailOf(Lease("somebodys").status()).field, "evaluator");
}

}  // namespace
}  // namespace mortise::simulator
