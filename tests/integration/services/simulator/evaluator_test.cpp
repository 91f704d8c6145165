// Evaluators that customers register: their life, their tasks and their workers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "common/base/errors.h"
#include "google/rpc/status.pb.h"
#include "mortise/v1/evaluator.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/simulator/evaluator_fixture.h"

namespace mortise::simulator {
namespace {

using ::testing::HasSubstr;

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
