// mortise-pareto as a real process, beside an evaluator in this test that serves ZDT1 over gRPC:
// discovery from start to front, kill -9 in the middle, cancelling, and bad input.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/evaluator.grpc.pb.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "mortise/v1/pareto.grpc.pb.h"
#include "tests/bench/pareto/benchmark_problems.h"
#include "tests/integration/services/service_under_test.h"

namespace mortise::pareto {
namespace {

using std::chrono::steady_clock;

constexpr int kDimensions = 5;

// Serves ZDT1 with its second metric negated as "gain", to be made large, a third, "stress" =
// 10 (0.7 - x0), "cost" = 5 (1 - x1), and "weight", which is nine times the first. Can be held up
// after a number of evaluations, and answer in ways that it should not.
class Zdt1Evaluator : public v1::EvaluatorService::Service {
 public:
  grpc::Status DescribeDesignSpace(grpc::ServerContext*,
                                   const v1::DescribeDesignSpaceRequest* request,
                                   v1::DesignSpace* response) override {
    if (request->subject() != "templates/zdt1" && request->subject() != "evaluators/mixed")
      return {grpc::StatusCode::NOT_FOUND, "no such template"};
    response->set_subject(request->subject());
    response->set_revision(3);
    for (int i = 0; i < kDimensions; ++i) {
      auto& parameter = *response->add_parameters();
      parameter.set_name("x" + std::to_string(i));
      parameter.set_maximum(1);
    }
    if (request->subject() == "evaluators/mixed") {
      // Only the second material and two ribs leave all of the front.
      auto& material = *response->mutable_parameters(3);
      for (const char* name : {"oak", "birch", "steel"}) material.add_choices(name);
      material.set_maximum(2);
      material.set_step(1);
      auto& ribs = *response->mutable_parameters(4);
      ribs.set_minimum(1);
      ribs.set_maximum(3);
      ribs.set_default_value(1);
      ribs.set_step(1);
    }
    for (const char* name : {"mass", "gain", "stress", "cost", "weight"}) {
      auto& metric = *response->add_metrics();
      metric.set_name(name);
      metric.set_unit("kg");
    }
    return grpc::Status::OK;
  }

  grpc::Status EvaluateBatch(grpc::ServerContext* context, const v1::EvaluateBatchRequest* request,
                             grpc::ServerWriter<v1::EvaluationResult>* writer) override {
    for (int k = 0; k < request->points_size(); ++k) {
      if (!Admit(*context)) return {grpc::StatusCode::CANCELLED, "cancelled"};
      if (lost_) return {grpc::StatusCode::INTERNAL, "the solver's licence has run out"};
      const auto& parameters = request->points(k).parameters();
      Eigen::VectorXd x = Eigen::VectorXd::Map(parameters.data(), parameters.size());
      if (request->subject() == "evaluators/mixed") {
        whole_ = whole_ && x.tail(2) == x.tail(2).array().round().matrix();
        x[3] = 0.3 * std::abs(x[3] - 1);
        x[4] = 0.2 * std::abs(x[4] - 2);
      }
      v1::EvaluationResult result;
      result.set_index(misnumbers_ ? 1000 : k);
      if (const absl::Status fault = FaultOf(x); !fault.ok()) {
        *result.mutable_error() = rpc::ToProto(fault);
      } else {
        const Evaluation evaluation = problem_.evaluate(x, false);
        for (const std::string& name : request->metrics()) {
          if (name == left_out_) continue;
          auto& metric = *result.add_metrics();
          metric.set_name(name);
          metric.set_unit("kg");
          metric.set_value(name == "mass"     ? evaluation.metrics[0] + drift_
                           : name == "weight" ? 9 * evaluation.metrics[0]
                           : name == "gain"   ? -evaluation.metrics[1]
                           : name == "cost"   ? 5 * (1 - x[1])
                                              : 10 * (0.7 - x[0]));
          if (name == useless_) metric.set_value(std::numeric_limits<double>::quiet_NaN());
        }
      }
      Note(x);
      writer->Write(result);
    }
    return grpc::Status::OK;
  }

  // Lets `count` evaluations pass, then holds the next ones until Release.
  void HoldAfter(int count) {
    const std::lock_guard lock(mutex_);
    limit_ = evaluations_ + count;
  }
  void Release() {
    const std::lock_guard lock(mutex_);
    limit_ = std::numeric_limits<int>::max();
    changed_.notify_all();
  }
  void WaitUntilHeld() {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::seconds(60), [&] { return evaluations_ >= limit_; });
  }
  // Every design with a first parameter of at least `least` fails so from now on, but those whose
  // second is above `conflict`: they cannot be built at all.
  void FailFrom(double least, const absl::Status& fault, double conflict = 0.9) {
    const std::lock_guard lock(mutex_);
    conflicts_from_ = conflict;
    fails_from_ = least;
    fault_ = fault;
  }
  // Whether choices and whole numbers were whole.
  bool whole() const { return whole_; }
  // The designs evaluated since the last call.
  std::vector<Eigen::VectorXd> TakeEvaluated() {
    const std::lock_guard lock(mutex_);
    return std::exchange(evaluated_, {});
  }

  std::atomic<bool> lost_ = false;        // every call fails
  std::atomic<bool> misnumbers_ = false;  // answers are of designs that were not asked for
  std::atomic<double> drift_ = 0;         // of "mass"
  std::string left_out_;                  // a metric; set before it is asked
  std::string useless_;                   // a metric that is NaN; set before it is asked

  int evaluations() {
    const std::lock_guard lock(mutex_);
    return evaluations_;
  }

 private:
  absl::Status FaultOf(const Eigen::VectorXd& x) {
    const std::lock_guard lock(mutex_);
    if (x[1] > conflicts_from_) return InvalidField("points", "cannot be built");
    return x[0] >= fails_from_ ? fault_ : absl::OkStatus();
  }

  void Note(const Eigen::VectorXd& x) {
    const std::lock_guard lock(mutex_);
    evaluated_.push_back(x);
  }

  bool Admit(grpc::ServerContext& context) {
    std::unique_lock lock(mutex_);
    while (evaluations_ >= limit_) {
      if (context.IsCancelled()) return false;
      changed_.wait_for(lock, std::chrono::milliseconds(50));
    }
    ++evaluations_;
    changed_.notify_all();
    return true;
  }

  const BenchmarkProblem problem_ = *MakeBenchmarkProblem("ZDT1", kDimensions);
  std::mutex mutex_;
  std::condition_variable changed_;
  std::atomic<bool> whole_ = true;
  std::vector<Eigen::VectorXd> evaluated_;
  int evaluations_ = 0;
  int limit_ = std::numeric_limits<int>::max();
  double conflicts_from_ = 0.9;
  double fails_from_ = 2;
  absl::Status fault_;
};

class ParetoServiceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&evaluator_);
    server_ = builder.BuildAndStart();
    pareto_ = std::make_unique<testing::ServiceUnderTest>(
        "mortise-pareto",
        std::vector<std::string>{"--peer=simulator=127.0.0.1:" + std::to_string(port)});
    Connect();
  }

  void TearDown() override {
    evaluator_.Release();
    pareto_.reset();
    server_->Shutdown(std::chrono::system_clock::now());
  }

  void Connect() {
    fronts_ = v1::ParetoService::NewStub(pareto_->channel());
    operations_ = v1::OperationService::NewStub(pareto_->channel());
  }

  static v1::DiscoverFrontRequest Request(int evaluations) {
    v1::DiscoverFrontRequest request;
    request.set_request_id(NewIdentifier());
    auto& specification = *request.mutable_specification();
    specification.set_subject("templates/zdt1");
    specification.set_evaluations(evaluations);
    specification.set_seed(11);
    specification.set_surrogate(v1::DiscoverySpecification::SURROGATE_NEVER);
    specification.add_objectives()->set_metric("mass");
    auto& gain = *specification.add_objectives();
    gain.set_metric("gain");
    gain.set_maximize(true);
    return request;
  }

  v1::Operation Discover(const v1::DiscoverFrontRequest& request) {
    grpc::ClientContext context;
    v1::Operation operation;
    const grpc::Status status = fronts_->DiscoverFront(&context, request, &operation);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return operation;
  }

  v1::Operation Wait(const std::string& name) {
    v1::Operation operation;
    const auto end = steady_clock::now() + std::chrono::seconds(100);
    while (steady_clock::now() < end) {
      grpc::ClientContext context;
      v1::WaitOperationRequest request;
      request.set_name(name);
      request.set_timeout_seconds(20);
      const grpc::Status status = operations_->WaitOperation(&context, request, &operation);
      EXPECT_TRUE(status.ok()) << status.error_message();
      if (!status.ok() || operation.state() >= v1::Operation::SUCCEEDED) break;
    }
    return operation;
  }

  v1::Front FrontOf(const v1::Operation& operation) {
    v1::Front summary, front;
    EXPECT_TRUE(operation.result().UnpackTo(&summary)) << operation.ShortDebugString();
    EXPECT_EQ(summary.points_size(), 0);
    grpc::ClientContext context;
    v1::GetFrontRequest request;
    request.set_name(summary.name());
    const grpc::Status status = fronts_->GetFront(&context, request, &front);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return front;
  }

  std::string Export(const std::string& name, v1::ExportFrontRequest::Format format) {
    grpc::ClientContext context;
    v1::ExportFrontRequest request;
    request.set_name(name);
    request.set_format(format);
    const auto reader = fronts_->ExportFront(&context, request);
    std::string bytes;
    v1::Chunk chunk;
    while (reader->Read(&chunk)) bytes += chunk.data();
    EXPECT_TRUE(reader->Finish().ok());
    return bytes;
  }

  grpc::StatusCode Refusal(const std::function<void(v1::DiscoverySpecification&)>& change) {
    v1::DiscoverFrontRequest request = Request(50);
    change(*request.mutable_specification());
    grpc::ClientContext context;
    v1::Operation operation;
    return fronts_->DiscoverFront(&context, request, &operation).error_code();
  }

  grpc::Status Asked(const v1::PickPointRequest& request, v1::PickPointResponse& response) {
    grpc::ClientContext context;
    return fronts_->PickPoint(&context, request, &response);
  }

  Zdt1Evaluator evaluator_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<testing::ServiceUnderTest> pareto_;
  std::unique_ptr<v1::ParetoService::Stub> fronts_;
  std::unique_ptr<v1::OperationService::Stub> operations_;
};

TEST_F(ParetoServiceTest, DiscoversPicksListsAndExports) {
  const v1::Operation operation = Wait(Discover(Request(200)).name());
  ASSERT_EQ(operation.state(), v1::Operation::SUCCEEDED) << operation.ShortDebugString();
  EXPECT_EQ(operation.progress().total(), 200);
  for (const char* told : {"hypervolume 0.", " cells covered", " pieces followed"})
    EXPECT_NE(operation.progress().message().find(told), std::string::npos)
        << operation.progress().message();
  const v1::Front front = FrontOf(operation);
  EXPECT_EQ(front.evaluations(), 200);
  EXPECT_EQ(evaluator_.evaluations(), 200);
  EXPECT_EQ(front.specification().revision(), 3);
  EXPECT_EQ(front.stop_reason(), "BUDGET");
  EXPECT_GT(front.points_size(), 20);
  EXPECT_GT(front.hypervolume(), 0.5);
  EXPECT_EQ(front.metric_names(1), "gain");
  for (const auto& point : front.points()) EXPECT_LE(point.metrics(1), 0);  // not negated

  v1::PickPointRequest pick;
  pick.set_name(front.name());
  pick.mutable_metric()->set_name("mass");
  pick.mutable_metric()->set_value(0.25);
  v1::PickPointResponse picked;
  ASSERT_TRUE(Asked(pick, picked).ok());
  EXPECT_NEAR(picked.metrics(0).value(), 0.25, 0.1);
  EXPECT_EQ(picked.parameters_size(), kDimensions);
  EXPECT_EQ(front.points(picked.index()).metrics(0), picked.metrics(0).value());

  v1::ListFrontsResponse listed;
  grpc::ClientContext list_context;
  ASSERT_TRUE(fronts_->ListFronts(&list_context, {}, &listed).ok());
  ASSERT_EQ(listed.fronts_size(), 1);
  EXPECT_EQ(listed.fronts(0).name(), front.name());
  EXPECT_EQ(listed.fronts(0).points_size(), 0);

  const std::string csv = Export(front.name(), v1::ExportFrontRequest::CSV);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), front.points_size() + 1);
  EXPECT_EQ(csv.rfind("x0,x1,x2,x3,x4,mass (kg),gain (kg),piece", 0), 0u);
  EXPECT_NE(Export(front.name(), v1::ExportFrontRequest::SVG).find("<svg"), std::string::npos);
  EXPECT_EQ(Export(front.name(), v1::ExportFrontRequest::JSON).front(), '{');
  EXPECT_EQ(Export(front.name(), v1::ExportFrontRequest::PNG).substr(1, 3), "PNG");
}

TEST_F(ParetoServiceTest, TellsHowWellItsSurrogateForetold) {
  v1::DiscoverFrontRequest request = Request(40);
  request.mutable_specification()->set_surrogate(v1::DiscoverySpecification::SURROGATE_AUTOMATIC);
  const v1::Operation operation = Wait(Discover(request).name());
  EXPECT_NE(operation.progress().message().find("surrogate off by"), std::string::npos)
      << operation.progress().message();
  const v1::Front front = FrontOf(operation);
  EXPECT_EQ(front.evaluations(), 40);
  EXPECT_GT(front.surrogate_quality().proposals(), 15);
  EXPECT_GT(front.surrogate_quality().predictions(), front.surrogate_quality().proposals());
  EXPECT_GT(front.surrogate_quality().within_two_deviations(), 0.5);
  EXPECT_GT(front.surrogate_quality().median_error(), 0);

  request.set_request_id(NewIdentifier());
  request.mutable_specification()->set_surrogate(v1::DiscoverySpecification::SURROGATE_NEVER);
  EXPECT_FALSE(FrontOf(Wait(Discover(request).name())).has_surrogate_quality());
  EXPECT_EQ(Refusal([](auto& specification) {
              specification.set_surrogate(static_cast<v1::DiscoverySpecification::Surrogate>(9));
            }),
            grpc::StatusCode::INVALID_ARGUMENT);
}

TEST_F(ParetoServiceTest, ExploresAFront) {
  const v1::Front front = FrontOf(Wait(Discover(Request(200)).name()));
  const int middle = front.points_size() / 2;
  v1::PickPointRequest pick;
  pick.set_name(front.name());
  pick.set_index(middle);
  v1::PickPointResponse here;
  ASSERT_TRUE(Asked(pick, here).ok());
  EXPECT_EQ(here.index(), middle);
  EXPECT_EQ(here.neighbours_size(), 2);
  EXPECT_EQ(here.path_size(), 0);
  ASSERT_EQ(here.improvements_size(), 2);
  // ZDT1's front is traded by its first parameter alone: gain = sqrt(mass) - 1 there.
  const v1::FrontImprovement& lighter = here.improvements(0);
  EXPECT_EQ(lighter.metric(), "mass");
  EXPECT_EQ(lighter.metrics(0).value(), -1);
  EXPECT_EQ(lighter.parameters(0).name(), "x0");
  EXPECT_GT(lighter.parameters(0).share(), 0.9);
  EXPECT_NEAR(lighter.parameters(0).value(), -1, 0.1);
  const double slope = 0.5 / std::sqrt(here.metrics(0).value());
  EXPECT_NEAR(lighter.metrics(1).value(), -slope, 0.2 * slope);

  pick.set_improve("gain");
  pick.set_steps(3);
  v1::PickPointResponse walked;
  ASSERT_TRUE(Asked(pick, walked).ok());
  EXPECT_EQ(walked.path_size(), 3);
  EXPECT_EQ(walked.path(2), walked.index());
  EXPECT_GT(walked.metrics(1).value(), here.metrics(1).value()) << "gain is maximised";

  v1::RestrictFrontRequest light_ones;
  light_ones.set_name(front.name());
  v1::FrontLimit& limit = *light_ones.add_limits();
  limit.set_name("mass");
  limit.set_maximum(0.5);
  v1::RestrictFrontResponse rest;
  grpc::ClientContext context;
  ASSERT_TRUE(fronts_->RestrictFront(&context, light_ones, &rest).ok());
  int light = 0;
  for (const v1::FrontPoint& point : front.points()) light += point.metrics(0) <= 0.5;
  EXPECT_EQ(rest.points_size(), light);
  EXPECT_LE(rest.metrics(0).maximum(), 0.5);
  EXPECT_EQ(rest.metrics(0).unit(), "kg");
  EXPECT_EQ(rest.parameters_size(), kDimensions);
  ASSERT_EQ(rest.conflicts_size(), 1);
  EXPECT_LT(rest.conflicts(0).correlation(), -0.8);
}

TEST_F(ParetoServiceTest, DiscoversFrontsOfFourMetrics) {
  v1::DiscoverFrontRequest request = Request(300);
  for (const char* metric : {"stress", "cost"})
    request.mutable_specification()->add_objectives()->set_metric(metric);
  const v1::Operation operation = Wait(Discover(request).name());
  ASSERT_EQ(operation.state(), v1::Operation::SUCCEEDED) << operation.ShortDebugString();
  const v1::Front front = FrontOf(operation);
  EXPECT_EQ(front.metric_names_size(), 4);
  ASSERT_GT(front.points_size(), 20);
  double cheapest = 5;
  for (const v1::FrontPoint& point : front.points()) {
    ASSERT_EQ(point.metrics_size(), 4);
    ASSERT_EQ(point.embedding_size(), 3);
    cheapest = std::min(cheapest, point.metrics(3));
  }
  EXPECT_LT(cheapest, 0.7);  // 0.5 is possible
  EXPECT_LE(front.cells_covered(), 75);

  v1::PickPointRequest pick;
  pick.set_name(front.name());
  for (int i = 0; i < 3; ++i) pick.add_embedding(0.5);
  v1::PickPointResponse picked;
  ASSERT_TRUE(Asked(pick, picked).ok());
  EXPECT_EQ(picked.metrics_size(), 4);
  EXPECT_EQ(picked.neighbours_size(), 8);
  pick.add_embedding(0.5);
  EXPECT_EQ(Asked(pick, picked).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Export(front.name(), v1::ExportFrontRequest::PNG).substr(1, 3), "PNG");
  EXPECT_NE(Export(front.name(), v1::ExportFrontRequest::SVG).find("best stress"),
            std::string::npos);
}

TEST_F(ParetoServiceTest, KeepsToConstraints) {
  v1::DiscoverFrontRequest request = Request(150);
  auto& stress = *request.mutable_specification()->add_constraints();
  stress.set_metric("stress");
  stress.set_maximum(3);
  auto& gain = *request.mutable_specification()->add_constraints();
  gain.set_metric("gain");
  gain.set_minimum(-4);
  gain.set_maximum(-0.2);
  const v1::Front front = FrontOf(Wait(Discover(request).name()));
  ASSERT_GT(front.points_size(), 5);
  EXPECT_GT(front.violating_evaluations(), 0);
  ASSERT_EQ(front.constraint_units_size(), 2);
  double least = 1, most_gain = -4;
  for (const v1::FrontPoint& point : front.points()) {
    ASSERT_EQ(point.constraint_metrics_size(), 2);
    EXPECT_LE(10 * (0.7 - point.parameters(0)), 3);
    EXPECT_NEAR(point.constraint_metrics(0), 10 * (0.7 - point.parameters(0)), 1e-12);
    EXPECT_NEAR(point.constraint_metrics(1), point.metrics(1), 1e-12);
    EXPECT_LE(point.metrics(1), -0.2);
    least = std::min(least, point.parameters(0));
    most_gain = std::max(most_gain, point.metrics(1));
  }
  // Up to both limits: x0 = 0.4, and gain -0.2 at x0 = 0.64.
  EXPECT_LT(least, 0.41);
  EXPECT_GT(most_gain, -0.21);

  const std::string csv = Export(front.name(), v1::ExportFrontRequest::CSV);
  EXPECT_NE(csv.find("gain (kg),stress (kg),gain (kg),piece"), std::string::npos) << csv;
}

TEST_F(ParetoServiceTest, SaysWhatContradictoryConstraintsMiss) {
  v1::DiscoverFrontRequest request = Request(40);
  auto& stress = *request.mutable_specification()->add_constraints();
  stress.set_metric("stress");
  stress.set_maximum(-4);
  const v1::Operation ended = Wait(Discover(request).name());
  ASSERT_EQ(ended.state(), v1::Operation::FAILED);
  const absl::Status error = rpc::FromProto(ended.error());
  EXPECT_TRUE(absl::IsFailedPrecondition(error));
  EXPECT_EQ(DetailOf(error).reason, "NO_FEASIBLE_DESIGN");
  EXPECT_NE(error.message().find("meets all constraints; the nearest does not because stress is "),
            std::string::npos)
      << error;
  EXPECT_NE(error.message().find("not at most -4"), std::string::npos) << error;
}

TEST_F(ParetoServiceTest, RefusesBadQuestionsAboutAFront) {
  const v1::Front front = FrontOf(Wait(Discover(Request(60)).name()));
  const auto refused = [&](auto change) {
    v1::PickPointRequest pick;
    pick.set_name(front.name());
    pick.set_index(0);
    change(pick);
    v1::PickPointResponse response;
    return Asked(pick, response).error_code();
  };
  using Pick = v1::PickPointRequest;
  EXPECT_EQ(refused([](Pick&) {}), grpc::StatusCode::OK);
  const auto invalid = grpc::StatusCode::INVALID_ARGUMENT;
  EXPECT_EQ(refused([](Pick& p) { p.clear_index(); }), invalid);
  EXPECT_EQ(refused([](Pick& p) { p.set_index(100'000); }), invalid);
  EXPECT_EQ(refused([](Pick& p) { p.add_embedding(0.5); }), invalid);
  EXPECT_EQ(refused([](Pick& p) { p.set_steps(2); }), invalid);
  EXPECT_EQ(refused([](Pick& p) { p.set_improve("beauty"); }), invalid);
  EXPECT_EQ(refused([](Pick& p) {
              p.set_improve("mass");
              p.set_steps(-1);
            }),
            invalid);
  EXPECT_EQ(refused([](Pick& p) { p.set_name("fronts/absent"); }), grpc::StatusCode::NOT_FOUND);

  const auto restricted = [&](const std::string& name, double minimum, double maximum) {
    v1::RestrictFrontRequest request;
    request.set_name(front.name());
    v1::FrontLimit& limit = *request.add_limits();
    limit.set_name(name);
    limit.set_minimum(minimum);
    limit.set_maximum(maximum);
    v1::RestrictFrontResponse response;
    grpc::ClientContext context;
    return fronts_->RestrictFront(&context, request, &response).error_code();
  };
  EXPECT_EQ(restricted("mass", 5, 6), grpc::StatusCode::OK) << "nothing may remain";
  EXPECT_EQ(restricted("beauty", 0, 1), invalid);
  EXPECT_EQ(restricted("mass", 1, 0), invalid);
  EXPECT_EQ(restricted("x0", 0, std::numeric_limits<double>::quiet_NaN()), invalid);
}

TEST_F(ParetoServiceTest, SaysWhyDesignsFailed) {
  evaluator_.FailFrom(0.6,
                      PreconditionFailed("RIGID_MOTION", "nothing holds the seat", "supports"));
  const v1::Operation operation = Wait(Discover(Request(60)).name());
  ASSERT_EQ(operation.state(), v1::Operation::SUCCEEDED) << operation.ShortDebugString();
  EXPECT_NE(operation.progress().message().find(" RIGID_MOTION"), std::string::npos)
      << operation.progress().message();
  const v1::Front front = FrontOf(operation);
  std::int64_t count = 0;
  bool named = false;
  for (const v1::EvaluationFailure& failure : front.failures()) {
    count += failure.count();
    if (failure.reason() != "RIGID_MOTION") continue;
    named = true;
    EXPECT_NE(failure.message().find("nothing holds the seat"), std::string::npos);
    ASSERT_EQ(failure.parameters_size(), kDimensions);
    EXPECT_GE(failure.parameters(0), 0.6);
  }
  EXPECT_TRUE(named);
  EXPECT_EQ(count, front.failed_evaluations());
}

TEST_F(ParetoServiceTest, GoesOnWithoutDesignsThatTakeTooMuch) {
  evaluator_.FailFrom(0.6, TooLarge("the evaluation", "the memory at hand"));
  const v1::Front front = FrontOf(Wait(Discover(Request(60)).name()));
  EXPECT_GT(front.points_size(), 0);
  EXPECT_GT(front.failed_evaluations(), 0);
  EXPECT_EQ(front.evaluations(), 60);
  EXPECT_EQ(evaluator_.evaluations(), 60);  // none was asked again
}

TEST_F(ParetoServiceTest, EndsAtOnceWhereTheSubjectLacksSomething) {
  // Half of the designs do not get so far that this would be seen.
  evaluator_.FailFrom(0, PreconditionFailed("NO_SUPPORTS", "nothing holds it", "boundary"), 0.5);
  const v1::Operation operation = Wait(Discover(Request(5000)).name());
  ASSERT_EQ(operation.state(), v1::Operation::FAILED) << operation.ShortDebugString();
  const absl::Status error = rpc::FromProto(operation.error());
  EXPECT_EQ(error.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(DetailOf(error).reason, "SUBJECT_UNUSABLE");
  EXPECT_EQ(DetailOf(error).field, "templates/zdt1");
  for (const char* part : {"templates/zdt1", "nothing holds it", "NO_SUPPORTS"})
    EXPECT_NE(error.message().find(part), std::string::npos) << error;
  EXPECT_LT(evaluator_.evaluations(), 100);
}

TEST_F(ParetoServiceTest, SpendsItsBudgetWherePartsAreLoose) {
  // In the same words for each, and for the default design; others may hold all the same.
  evaluator_.FailFrom(0, PreconditionFailed("RIGID_MOTION", "the seat is free to move", "seat"));
  const v1::Operation operation = Wait(Discover(Request(40)).name());
  ASSERT_EQ(operation.state(), v1::Operation::FAILED) << operation.ShortDebugString();
  EXPECT_EQ(DetailOf(rpc::FromProto(operation.error())).reason, "NO_FEASIBLE_DESIGN");
  EXPECT_EQ(evaluator_.evaluations(), 40);
}

TEST_F(ParetoServiceTest, GoesOnWhereTheDefaultDesignWorks) {
  // Only the default design, with x0 = 0, works; all others lack something.
  evaluator_.FailFrom(1e-9, PreconditionFailed("NO_SUPPORTS", "nothing holds it", "boundary"));
  const v1::Operation operation = Wait(Discover(Request(30)).name());
  ASSERT_EQ(operation.state(), v1::Operation::FAILED) << operation.ShortDebugString();
  EXPECT_EQ(DetailOf(rpc::FromProto(operation.error())).reason, "NO_FEASIBLE_DESIGN");
  EXPECT_EQ(evaluator_.evaluations(), 31);
}

TEST_F(ParetoServiceTest, SpendsItsBudgetOnDesignsThatFailForThemselves) {
  evaluator_.FailFrom(0, InvalidField("points", "cannot be built"));
  const v1::Operation operation = Wait(Discover(Request(40)).name());
  ASSERT_EQ(operation.state(), v1::Operation::FAILED) << operation.ShortDebugString();
  const absl::Status error = rpc::FromProto(operation.error());
  EXPECT_EQ(error.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(DetailOf(error).reason, "NO_FEASIBLE_DESIGN");
  EXPECT_NE(error.message().find("40 FIELD_INVALID, such as"), std::string::npos) << error;
  EXPECT_EQ(evaluator_.evaluations(), 40);
}

TEST_F(ParetoServiceTest, MergesFrontsOfChoicesAndWholeNumbers) {
  v1::DiscoverFrontRequest request = Request(300);
  request.mutable_specification()->set_subject("evaluators/mixed");
  const v1::Operation operation = Wait(Discover(request).name());
  EXPECT_NE(operation.progress().message().find("9 of 9 combinations tried"), std::string::npos)
      << operation.progress().message();
  const v1::Front front = FrontOf(operation);
  EXPECT_TRUE(evaluator_.whole());
  EXPECT_EQ(front.combinations().possible(), 9);
  ASSERT_EQ(front.parameter_choices_size(), kDimensions);
  EXPECT_EQ(front.parameter_choices(0).names_size(), 0);
  EXPECT_EQ(front.parameter_choices(3).names(2), "steel");
  ASSERT_GT(front.points_size(), 10);
  int birch = 0;
  for (const v1::FrontPoint& point : front.points()) {
    ASSERT_EQ(point.choices_size(), kDimensions);
    EXPECT_EQ(point.choices(0), "");
    EXPECT_EQ(point.choices(3),
              front.parameter_choices(3).names(static_cast<int>(point.parameters(3))));
    birch += point.choices(3) == "birch" && point.parameters(4) == 2;
  }
  EXPECT_GT(2 * birch, front.points_size());
  const std::string csv = Export(front.name(), v1::ExportFrontRequest::CSV);
  EXPECT_EQ(csv.rfind("x0,x1,x2,x3,x3 (choice),x4,mass (kg)", 0), 0u) << csv.substr(0, 60);
  EXPECT_NE(csv.find(",1,birch,2,"), std::string::npos);

  auto& bound = *request.mutable_specification()->add_bounds();
  request.set_request_id(NewIdentifier());
  bound.set_parameter("x3");
  bound.add_choices("steel");
  bound.add_choices("oak");
  const v1::Front allowed = FrontOf(Wait(Discover(request).name()));
  EXPECT_EQ(allowed.combinations().possible(), 6);
  for (const v1::FrontPoint& point : allowed.points()) EXPECT_NE(point.choices(3), "birch");

  // From the front before, whose choice is no longer allowed in most designs.
  request.set_request_id(NewIdentifier());
  request.mutable_specification()->add_start_from(front.name());
  request.mutable_specification()->add_start_from(allowed.name());
  const v1::Front again = FrontOf(Wait(Discover(request).name()));
  EXPECT_EQ(again.remarks_size(), 0) << again.remarks(0);
  EXPECT_GT(again.points_size(), 0);
  for (const v1::FrontPoint& point : again.points()) EXPECT_NE(point.choices(3), "birch");
}

TEST_F(ParetoServiceTest, RefusesTolerancesOfChoicesAndWholeNumbers) {
  const auto refused = [&](const std::string& parameter) {
    v1::DiscoverFrontRequest request = Request(100);
    request.mutable_specification()->set_subject("evaluators/mixed");
    auto& tolerance = *request.mutable_specification()->add_tolerances();
    tolerance.set_parameter(parameter);
    tolerance.set_deviation(0.1);
    grpc::ClientContext context;
    v1::Operation operation;
    const grpc::Status status = fronts_->DiscoverFront(&context, request, &operation);
    return DetailOf(rpc::FromGrpc(status)).field;
  };
  EXPECT_EQ(refused("x3"), "specification.tolerances[0].parameter");
  EXPECT_EQ(refused("x4"), "specification.tolerances[0].parameter");
  EXPECT_EQ(refused("x0"), "");
}

TEST_F(ParetoServiceTest, RefusesChoicesThatAreNone) {
  const auto refused = [&](const std::string& parameter, double minimum, double maximum,
                           const std::vector<std::string>& choices) {
    v1::DiscoverFrontRequest request = Request(100);
    request.mutable_specification()->set_subject("evaluators/mixed");
    auto& bound = *request.mutable_specification()->add_bounds();
    bound.set_parameter(parameter);
    bound.set_minimum(minimum);
    bound.set_maximum(maximum);
    bound.mutable_choices()->Add(choices.begin(), choices.end());
    grpc::ClientContext context;
    v1::Operation operation;
    const grpc::Status status = fronts_->DiscoverFront(&context, request, &operation);
    return DetailOf(rpc::FromGrpc(status)).field;
  };
  const std::string field = "specification.bounds[0]";
  EXPECT_EQ(refused("x3", 0, 0, {"oak", "teak"}), field + ".choices[1]");
  EXPECT_EQ(refused("x3", 0, 0, {"oak", "oak"}), field + ".choices[1]");
  EXPECT_EQ(refused("x3", 0, 1, {}), field + ".maximum") << "no range";
  EXPECT_EQ(refused("x3", 3, 3, {}), field + ".minimum");
  EXPECT_EQ(refused("x3", 0.5, 0.5, {}), field + ".minimum");
  EXPECT_EQ(refused("x3", 0, 1, {"oak"}), field + ".maximum");
  EXPECT_EQ(refused("x0", 0, 0, {"oak"}), field + ".choices") << "a number";
  EXPECT_EQ(evaluator_.evaluations(), 0);
}

TEST_F(ParetoServiceTest, SurvivesKillNineWithTheSameFront) {
  const v1::Front reference = FrontOf(Wait(Discover(Request(120)).name()));
  const int before = evaluator_.evaluations();
  evaluator_.HoldAfter(60);
  const v1::Operation started = Discover(Request(120));
  evaluator_.WaitUntilHeld();
  pareto_->Kill();
  evaluator_.Release();
  pareto_->Start();
  Connect();
  const v1::Operation operation = Wait(started.name());
  ASSERT_EQ(operation.state(), v1::Operation::SUCCEEDED) << operation.ShortDebugString();
  const v1::Front front = FrontOf(operation);
  ASSERT_EQ(front.points_size(), reference.points_size());
  for (int i = 0; i < front.points_size(); ++i)
    EXPECT_EQ(front.points(i).SerializeAsString(), reference.points(i).SerializeAsString());
  // What had been answered was not asked again, but for what was under way.
  EXPECT_LE(evaluator_.evaluations() - before, 120 + 16);
}

TEST_F(ParetoServiceTest, CancelKeepsTheBestSoFar) {
  evaluator_.HoldAfter(60);
  const v1::Operation started = Discover(Request(5000));
  evaluator_.WaitUntilHeld();
  grpc::ClientContext context;
  v1::CancelOperationRequest cancel;
  cancel.set_request_id(NewIdentifier());
  cancel.set_name(started.name());
  v1::Operation operation;
  ASSERT_TRUE(operations_->CancelOperation(&context, cancel, &operation).ok());
  operation = Wait(started.name());
  EXPECT_EQ(operation.state(), v1::Operation::CANCELLED);
  const v1::Front front = FrontOf(operation);
  EXPECT_EQ(front.stop_reason(), "CANCELLED");
  EXPECT_GT(front.points_size(), 0);
  EXPECT_LT(front.evaluations(), 100);
}

TEST_F(ParetoServiceTest, StartsFromAnEarlierFront) {
  const v1::Front before = FrontOf(Wait(Discover(Request(200)).name()));
  evaluator_.TakeEvaluated();
  v1::DiscoverFrontRequest request = Request(80);
  request.mutable_specification()->add_start_from(before.name());
  auto& bound = *request.mutable_specification()->add_bounds();
  bound.set_parameter("x0");
  bound.set_maximum(0.6);
  const v1::Front front = FrontOf(Wait(Discover(request).name()));
  EXPECT_EQ(front.specification().start_from(0), before.name());
  EXPECT_EQ(front.remarks_size(), 0) << front.remarks(0);
  EXPECT_GT(front.hypervolume(), 0.6);
  // The first ten are of that front, within the new bound; the other way round within the window.
  std::set<std::vector<double>> known;
  for (const v1::FrontPoint& point : before.points()) {
    std::vector<double> x(point.parameters().begin(), point.parameters().end());
    x[0] = std::min(x[0], 0.6);
    known.insert(x);
  }
  const std::vector<Eigen::VectorXd> evaluated = evaluator_.TakeEvaluated();
  int repeated = 0;
  for (std::size_t i = 0; i < 18; ++i)
    repeated += known.contains({evaluated[i].begin(), evaluated[i].end()}) ? 1 : 0;
  EXPECT_EQ(repeated, 10);

  // Killed in the middle it goes on to the same front.
  evaluator_.HoldAfter(40);
  request.set_request_id(NewIdentifier());
  const v1::Operation started = Discover(request);
  evaluator_.WaitUntilHeld();
  pareto_->Kill();
  evaluator_.Release();
  pareto_->Start();
  Connect();
  const v1::Front resumed = FrontOf(Wait(started.name()));
  ASSERT_EQ(resumed.points_size(), front.points_size());
  for (int i = 0; i < front.points_size(); ++i)
    EXPECT_EQ(resumed.points(i).SerializeAsString(), front.points(i).SerializeAsString());

  request.mutable_specification()->set_start_from(0, "fronts/absent");
  v1::Operation operation;
  grpc::ClientContext absent;
  request.set_request_id(NewIdentifier());
  const grpc::Status missing = fronts_->DiscoverFront(&absent, request, &operation);
  EXPECT_EQ(missing.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_NE(missing.error_message().find("fronts/absent"), std::string::npos);
  for (const std::vector<std::string>& names :
       std::vector<std::vector<std::string>>{{"absent"}, {before.name(), before.name()}}) {
    grpc::ClientContext context;
    request.mutable_specification()->mutable_start_from()->Assign(names.begin(), names.end());
    request.set_request_id(NewIdentifier());
    EXPECT_EQ(fronts_->DiscoverFront(&context, request, &operation).error_code(),
              grpc::StatusCode::INVALID_ARGUMENT);
  }
}

TEST_F(ParetoServiceTest, SaysThatAnEvaluatorChangedItsAnswers) {
  const v1::Front before = FrontOf(Wait(Discover(Request(60)).name()));
  evaluator_.drift_ = 0.01;
  v1::DiscoverFrontRequest request = Request(60);
  request.mutable_specification()->add_start_from(before.name());
  const v1::Front front = FrontOf(Wait(Discover(request).name()));
  ASSERT_EQ(front.remarks_size(), 1);
  EXPECT_NE(front.remarks(0).find("changed its answers: 'mass'"), std::string::npos)
      << front.remarks(0);
}

TEST_F(ParetoServiceTest, CountsOnTolerances) {
  v1::DiscoverFrontRequest request = Request(300);
  auto& tolerance = *request.mutable_specification()->add_tolerances();
  tolerance.set_parameter("x0");
  tolerance.set_deviation(0.03);
  request.mutable_specification()->set_deviations(2);
  const int before = evaluator_.evaluations();
  const v1::Operation operation = Wait(Discover(request).name());
  ASSERT_EQ(operation.state(), v1::Operation::SUCCEEDED) << operation.ShortDebugString();
  EXPECT_EQ(operation.progress().total(), 300);
  const v1::Front front = FrontOf(operation);
  EXPECT_EQ(front.evaluations(), 100);
  EXPECT_EQ(front.subject_evaluations(), 300);
  EXPECT_EQ(evaluator_.evaluations() - before, 300);
  ASSERT_GT(front.points_size(), 5);
  const double deviation = 0.03 / std::sqrt(3);
  for (const v1::FrontPoint& point : front.points()) {
    ASSERT_EQ(point.metric_means_size(), 2);
    EXPECT_NEAR(point.metric_means(0), point.parameters(0), 1e-9);
    EXPECT_NEAR(point.metric_deviations(0), deviation, 1e-9);
    EXPECT_NEAR(point.metrics(0), point.parameters(0) + 2 * deviation, 1e-9);
    // The gain is to be large: what is robust is less than its mean.
    EXPECT_NEAR(point.metrics(1), point.metric_means(1) - 2 * point.metric_deviations(1), 1e-9);
  }
  const std::string csv = Export(front.name(), v1::ExportFrontRequest::CSV);
  EXPECT_NE(csv.find("mean mass (kg),deviation of mass (kg)"), std::string::npos) << csv;
}

TEST_F(ParetoServiceTest, SaysThatMetricsDoNotConflict) {
  v1::DiscoverFrontRequest request = Request(60);
  request.mutable_specification()->mutable_objectives(1)->set_metric("weight");
  request.mutable_specification()->mutable_objectives(1)->set_maximize(false);
  const v1::Front front = FrontOf(Wait(Discover(request).name()));
  EXPECT_EQ(front.points_size(), 1);
  ASSERT_GT(front.remarks_size(), 0);
  EXPECT_NE(front.remarks(0).find("'mass' and 'weight'"), std::string::npos) << front.remarks(0);
}

TEST_F(ParetoServiceTest, KeepsWhatWasFoundWhenTheEvaluatorIsLost) {
  for (std::atomic<bool>* fault : {&evaluator_.lost_, &evaluator_.misnumbers_}) {
    evaluator_.HoldAfter(60);
    const v1::Operation started = Discover(Request(5000));
    evaluator_.WaitUntilHeld();
    *fault = true;
    evaluator_.Release();
    const v1::Operation operation = Wait(started.name());
    *fault = false;
    ASSERT_EQ(operation.state(), v1::Operation::FAILED) << operation.ShortDebugString();
    EXPECT_EQ(operation.error().code(), static_cast<int>(absl::StatusCode::kInternal));
    const std::string& message = operation.error().message();
    const char* const why = fault == &evaluator_.lost_ ? "licence" : "was not asked for";
    EXPECT_NE(message.find(why), std::string::npos) << message;
    const std::size_t at = message.find("fronts/");
    ASSERT_NE(at, std::string::npos) << message;
    v1::GetFrontRequest get;
    get.set_name(message.substr(at, message.find(' ', at) - at));
    grpc::ClientContext context;
    v1::Front front;
    ASSERT_TRUE(fronts_->GetFront(&context, get, &front).ok()) << get.name();
    EXPECT_EQ(front.stop_reason(), "EVALUATOR_LOST");
    EXPECT_GT(front.points_size(), 0);
    EXPECT_GE(front.evaluations(), 50);
  }
}

TEST_F(ParetoServiceTest, SaysThatAMetricIsMissing) {
  evaluator_.left_out_ = "gain";
  const v1::Operation operation = Wait(Discover(Request(40)).name());
  ASSERT_EQ(operation.state(), v1::Operation::FAILED);
  const absl::Status error = rpc::FromProto(operation.error());
  EXPECT_EQ(DetailOf(error).reason, "NO_FEASIBLE_DESIGN");
  EXPECT_NE(error.message().find(" NOT_FINITE, such as: the evaluator left out a metric"),
            std::string::npos)
      << error;
}

TEST_F(ParetoServiceTest, SaysWhichMetricIsNotFinite) {
  evaluator_.useless_ = "gain";
  const v1::Operation operation = Wait(Discover(Request(40)).name());
  ASSERT_EQ(operation.state(), v1::Operation::FAILED);
  const absl::Status error = rpc::FromProto(operation.error());
  EXPECT_EQ(DetailOf(error).reason, "NO_FEASIBLE_DESIGN");
  EXPECT_NE(error.message().find("NOT_FINITE, such as: the evaluator left out"), std::string::npos)
      << error;
  EXPECT_NE(error.message().find("not finite: gain"), std::string::npos) << error;
}

// As the simulator tells of designs for which a customer's evaluator reported NaN.
TEST_F(ParetoServiceTest, CountsDesignsThatWereNotFinite) {
  evaluator_.FailFrom(
      0.5, PreconditionFailed("NOT_FINITE", "not a finite number: gain", "result.metrics[1]"));
  const v1::Front front = FrontOf(Wait(Discover(Request(60)).name()));
  ASSERT_GT(front.failures_size(), 0);
  std::int64_t count = 0;
  for (const v1::EvaluationFailure& failure : front.failures())
    if (failure.reason() == "NOT_FINITE") {
      count += failure.count();
      EXPECT_EQ(failure.message(), "not a finite number: gain");
    }
  EXPECT_GT(count, 0);
  evaluator_.FailFrom(
      0, PreconditionFailed("NOT_FINITE", "not a finite number: gain", "result.metrics[1]"));
  const v1::Operation operation = Wait(Discover(Request(40)).name());
  const absl::Status error = rpc::FromProto(operation.error());
  EXPECT_EQ(DetailOf(error).reason, "NO_FEASIBLE_DESIGN") << error;
  EXPECT_NE(error.message().find("NOT_FINITE, such as: not a finite number: gain"),
            std::string::npos)
      << error;
}

// "stress" is 10 (0.7 - x0) and "cost" 5 (1 - x1).
TEST_F(ParetoServiceTest, ASingleValueOfAConstraintIsABandThatIsStated) {
  v1::DiscoverFrontRequest request = Request(200);
  auto& constraint = *request.mutable_specification()->add_constraints();
  constraint.set_metric("cost");
  constraint.set_minimum(2.5);
  constraint.set_maximum(2.5);
  const v1::Front front = FrontOf(Wait(Discover(request).name()));
  EXPECT_GT(front.points_size(), 10);
  for (const v1::FrontPoint& point : front.points())
    EXPECT_NEAR(point.constraint_metrics(0), 2.5, 0.00125 + 1e-12);
  ASSERT_EQ(front.remarks_size(), 1);
  EXPECT_NE(front.remarks(0).find("2.49875 to 2.50125"), std::string::npos) << front.remarks(0);

  for (const auto& [minimum, maximum] :
       std::vector<std::pair<double, double>>{{0, 0}, {2.5, 2.5000001}}) {
    EXPECT_EQ(Refusal([&, minimum = minimum, maximum = maximum](v1::DiscoverySpecification& s) {
                auto& narrow = *s.add_constraints();
                narrow.set_metric("cost");
                narrow.set_minimum(minimum);
                narrow.set_maximum(maximum);
              }),
              grpc::StatusCode::INVALID_ARGUMENT);
  }
}

// The designs at the ends, as they were evaluated, can be picked, and limits reach up to them.
TEST_F(ParetoServiceTest, FrontsReachTheBestThatWasEvaluated) {
  const v1::Front front = FrontOf(Wait(Discover(Request(200)).name()));
  double best_mass = 1e9, best_gain = -1e9;
  for (const Eigen::VectorXd& x : evaluator_.TakeEvaluated()) {
    const Evaluation evaluation = MakeBenchmarkProblem("ZDT1", kDimensions)->evaluate(x, false);
    best_mass = std::min(best_mass, evaluation.metrics[0]);
    best_gain = std::max(best_gain, -evaluation.metrics[1]);
  }
  for (const auto& [place, metric, best] :
       std::vector<std::tuple<double, int, double>>{{1, 0, best_mass}, {0, 1, best_gain}}) {
    v1::PickPointRequest pick;
    pick.set_name(front.name());
    pick.add_embedding(place);
    v1::PickPointResponse picked;
    ASSERT_TRUE(Asked(pick, picked).ok());
    EXPECT_EQ(picked.metrics(metric).value(), best);
    for (const v1::FrontImprovement& improvement : picked.improvements())
      EXPECT_NE(improvement.metric(), front.metric_names(metric)) << "nothing is better";
    v1::RestrictFrontRequest request;
    request.set_name(front.name());
    v1::FrontLimit& limit = *request.add_limits();
    limit.set_name(front.metric_names(metric));
    if (metric == 0) limit.set_maximum(best);
    if (metric == 1) limit.set_minimum(best);
    grpc::ClientContext context;
    v1::RestrictFrontResponse rest;
    ASSERT_TRUE(fronts_->RestrictFront(&context, request, &rest).ok());
    ASSERT_EQ(rest.points_size(), 1);
    EXPECT_EQ(rest.points(0), picked.index());
  }
}

TEST_F(ParetoServiceTest, RefusesBadInput) {
  using Specification = v1::DiscoverySpecification;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Refusal([](Specification& s) { s.set_evaluations(0); }),
            grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal([](Specification& s) { s.set_window(-1); }),
            grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal([](Specification& s) { s.clear_subject(); }),
            grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal([](Specification& s) { s.set_subject("templates/absent"); }),
            grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(Refusal([](Specification& s) { s.mutable_objectives(1)->set_metric("beauty"); }),
            grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal([](Specification& s) { s.mutable_objectives(1)->set_metric("mass"); }),
            grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal([](Specification& s) { s.mutable_objectives()->RemoveLast(); }),
            grpc::StatusCode::INVALID_ARGUMENT);
  const auto bounded = [](const std::string& name, double minimum, double maximum) {
    return [=](Specification& s) {
      auto& bound = *s.add_bounds();
      bound.set_parameter(name);
      bound.set_minimum(minimum);
      bound.set_maximum(maximum);
    };
  };
  EXPECT_EQ(Refusal(bounded("x0", nan, 1)), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal(bounded("x0", 0.8, 0.2)), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal(bounded("x0", -1, 1)), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal(bounded("y", 0, 1)), grpc::StatusCode::INVALID_ARGUMENT);

  const auto constrained = [](const std::string& metric, std::optional<double> minimum,
                              std::optional<double> maximum) {
    return [=](Specification& s) {
      auto& constraint = *s.add_constraints();
      constraint.set_metric(metric);
      if (minimum) constraint.set_minimum(*minimum);
      if (maximum) constraint.set_maximum(*maximum);
    };
  };
  EXPECT_EQ(Refusal(constrained("beauty", {}, 1)), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal(constrained("stress", {}, {})), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal(constrained("stress", 2, 1)), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal(constrained("stress", {}, nan)), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal([&](Specification& s) {
              constrained("stress", {}, 1)(s);
              constrained("stress", 0, {})(s);
            }),
            grpc::StatusCode::INVALID_ARGUMENT);

  const auto toleranced = [](const std::string& name, double deviation, double deviations) {
    return [=](Specification& s) {
      auto& tolerance = *s.add_tolerances();
      tolerance.set_parameter(name);
      tolerance.set_deviation(deviation);
      s.set_deviations(deviations);
    };
  };
  EXPECT_EQ(Refusal(toleranced("y", 0.01, 1)), grpc::StatusCode::INVALID_ARGUMENT);
  for (const double bad : {0.0, -0.01, nan, 0.9})
    EXPECT_EQ(Refusal(toleranced("x0", bad, 1)), grpc::StatusCode::INVALID_ARGUMENT) << bad;
  for (const double bad : {-1.0, nan, 101.0})
    EXPECT_EQ(Refusal(toleranced("x0", 0.01, bad)), grpc::StatusCode::INVALID_ARGUMENT) << bad;
  EXPECT_EQ(Refusal([](Specification& s) { s.set_deviations(3); }),
            grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal([&](Specification& s) {
              toleranced("x0", 0.01, 1)(s);
              toleranced("x0", 0.02, 1)(s);
            }),
            grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Refusal([&](Specification& s) {
              for (const char* name : {"x0", "x1", "x2"}) toleranced(name, 0.01, 1)(s);
            }),
            grpc::StatusCode::INVALID_ARGUMENT)
      << "fifty evaluations are seven designs";

  grpc::ClientContext context;
  v1::GetFrontRequest absent;
  absent.set_name("fronts/absent");
  v1::Front front;
  EXPECT_EQ(fronts_->GetFront(&context, absent, &front).error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(evaluator_.evaluations(), 0);
}

}  // namespace
}  // namespace mortise::pareto
