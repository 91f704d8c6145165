// What the client makes of what an evaluator answers, and of answers that do not come.
#include "common/evaluation/evaluator_client.h"

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <deque>
#include <functional>
#include <future>
#include <mutex>
#include <string>
#include <thread>

#include "common/base/errors.h"
#include "common/evaluation/described_design_space.h"
#include "common/rpc/channel_security.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/evaluator.grpc.pb.h"

namespace mortise::evaluation {
namespace {

using Writer = grpc::ServerWriter<v1::EvaluationResult>;
using Turn =
    std::function<grpc::Status(grpc::ServerContext&, const v1::EvaluateBatchRequest&, Writer&)>;

// "sum" of a point's parameters and "first" of them, each with its gradient.
v1::EvaluationResult ResultOf(const v1::EvaluateBatchRequest& request, int index) {
  v1::EvaluationResult result;
  result.set_index(index);
  const auto& parameters = request.points(index).parameters();
  double sum = 0;
  for (const double value : parameters) sum += value;
  // The order of an answer is not that of the question.
  for (const char* name : {"first", "sum"}) {
    const bool is_sum = std::string(name) == "sum";
    auto& metric = *result.add_metrics();
    metric.set_name(name);
    metric.set_value(is_sum ? sum : parameters[0]);
    if (!request.gradients()) continue;
    auto& gradient = *result.add_gradients();
    gradient.set_metric(name);
    for (int i = 0; i < parameters.size(); ++i) gradient.add_values(is_sum || i == 0 ? 1 : 0);
  }
  return result;
}

// Answers all points, the last first.
grpc::Status AnswerAll(grpc::ServerContext&, const v1::EvaluateBatchRequest& request,
                       Writer& writer) {
  for (int i = request.points_size(); i-- > 0;) writer.Write(ResultOf(request, i));
  return grpc::Status::OK;
}

// Does what was put in its turns, one a call, and then answers.
class ScriptedEvaluator : public v1::EvaluatorService::Service {
 public:
  grpc::Status DescribeDesignSpace(grpc::ServerContext*,
                                   const v1::DescribeDesignSpaceRequest* request,
                                   v1::DesignSpace* response) override {
    if (request->subject() != "templates/table") return {grpc::StatusCode::NOT_FOUND, "none"};
    response->set_subject(request->subject());
    response->set_revision(request->revision());
    return grpc::Status::OK;
  }

  grpc::Status EvaluateBatch(grpc::ServerContext* context, const v1::EvaluateBatchRequest* request,
                             Writer* writer) override {
    Turn turn = AnswerAll;
    {
      const std::lock_guard lock(mutex_);
      requests_.push_back(*request);
      if (!turns_.empty()) {
        turn = std::move(turns_.front());
        turns_.pop_front();
      }
    }
    return turn(*context, *request, *writer);
  }

  void Then(Turn turn) {
    const std::lock_guard lock(mutex_);
    turns_.push_back(std::move(turn));
  }
  std::vector<v1::EvaluateBatchRequest> requests() {
    const std::lock_guard lock(mutex_);
    return requests_;
  }

 private:
  std::mutex mutex_;
  std::deque<Turn> turns_;
  std::vector<v1::EvaluateBatchRequest> requests_;
};

class EvaluatorClientTest : public ::testing::Test {
 protected:
  void SetUp() override {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&evaluator_);
    server_ = builder.BuildAndStart();
    channel_ = *rpc::MakeChannel("127.0.0.1:" + std::to_string(port), rpc::ChannelSecurity{});
    question_.set_subject("templates/table");
    question_.set_revision(4);
    question_.add_metrics("sum");
    question_.add_metrics("first");
    question_.mutable_mesh()->set_element_size(0.01);
  }

  void TearDown() override { server_->Shutdown(std::chrono::system_clock::now()); }

  static rpc::Origin Call(absl::Duration timeout) {
    rpc::Origin origin;
    origin.deadline = absl::Now() + timeout;
    return origin;
  }

  std::unique_ptr<EvaluatorClient> MakeClient(const EvaluatorClient::Options& options) {
    return std::make_unique<EvaluatorClient>(channel_, question_, Call, options);
  }

  absl::StatusOr<std::vector<Answer>> Evaluate(const std::vector<Eigen::VectorXd>& designs) {
    return MakeClient({})->Evaluate(designs);
  }

  const std::vector<Eigen::VectorXd> designs_ = {Eigen::Vector2d(1, 2), Eigen::Vector2d(3, 5),
                                                 Eigen::Vector2d(7, 11)};
  v1::EvaluateBatchRequest question_;
  ScriptedEvaluator evaluator_;
  std::unique_ptr<grpc::Server> server_;
  std::shared_ptr<grpc::Channel> channel_;
};

TEST_F(EvaluatorClientTest, AnswersComeInTheOrderOfTheDesignsAndMetricsAsked) {
  const auto answers = Evaluate(designs_);
  ASSERT_TRUE(answers.ok()) << answers.status();
  ASSERT_EQ(answers->size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE((*answers)[i].status.ok());
    EXPECT_EQ((*answers)[i].values, Eigen::Vector2d(designs_[i].sum(), designs_[i][0]));
    EXPECT_EQ((*answers)[i].gradients.size(), 0);
  }
  const auto requests = evaluator_.requests();
  ASSERT_EQ(requests.size(), 1u);
  v1::EvaluateBatchRequest asked = requests[0];
  asked.clear_points();
  EXPECT_EQ(asked.SerializeAsString(), question_.SerializeAsString());
}

TEST_F(EvaluatorClientTest, ReadsGradientsAndLeavesRowsOfMetricsWithoutOneNaN) {
  question_.set_gradients(true);
  question_.add_metrics("unknown");
  const auto answers = Evaluate(designs_);
  ASSERT_TRUE(answers.ok()) << answers.status();
  const Answer& answer = answers->front();
  ASSERT_EQ(answer.gradients.rows(), 3);
  EXPECT_EQ(answer.gradients.topRows(2), (Eigen::Matrix2d() << 1, 1, 1, 0).finished());
  EXPECT_TRUE(answer.gradients.row(2).array().isNaN().all());
  EXPECT_TRUE(std::isnan(answer.values[2]));
  EXPECT_EQ(answer.values[0], 3);
}

TEST_F(EvaluatorClientTest, ADesignThatCannotBeEvaluatedKeepsItsReasonAndTheOthersTheirValues) {
  evaluator_.Then([](auto&, const auto& request, auto& writer) {
    writer.Write(ResultOf(request, 0));
    v1::EvaluationResult failed;
    failed.set_index(1);
    *failed.mutable_error() =
        rpc::ToProto(PreconditionFailed("RIGID_MOTION", "a leg is loose", "templates/table"));
    writer.Write(failed);
    writer.Write(ResultOf(request, 2));
    return grpc::Status::OK;
  });
  const auto answers = Evaluate(designs_);
  ASSERT_TRUE(answers.ok()) << answers.status();
  const absl::Status& status = (*answers)[1].status;
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(status.message(), "a leg is loose");
  EXPECT_EQ(DetailOf(status).reason, "RIGID_MOTION");
  EXPECT_EQ((*answers)[1].values.size(), 0);
  EXPECT_EQ((*answers)[2].values[0], 18);
}

TEST_F(EvaluatorClientTest, NamesTheFilesOfDesignsAndFailsThoseWithoutOne) {
  question_.mutable_design_fields()->set_geometry(v1::SURFACE);
  evaluator_.Then([](auto&, const auto& request, auto& writer) {
    for (int i = 0; i < 3; ++i) {
      v1::EvaluationResult result = ResultOf(request, i);
      if (i != 1) result.mutable_design_fields()->set_sha256("digest " + std::to_string(i));
      result.mutable_design_fields()->set_size(i == 1 ? 0 : 1000);
      writer.Write(result);
    }
    return grpc::Status::OK;
  });
  const auto answers = Evaluate(designs_);
  ASSERT_TRUE(answers.ok()) << answers.status();
  EXPECT_EQ((*answers)[0].file->sha256, "digest 0");
  EXPECT_EQ((*answers)[0].file->size, 1000);
  EXPECT_EQ((*answers)[2].file->sha256, "digest 2");
  EXPECT_EQ((*answers)[1].status.code(), absl::StatusCode::kInternal);
  EXPECT_EQ(DetailOf((*answers)[1].status).reason, "FILE_MISSING");
  EXPECT_FALSE((*answers)[1].file.has_value());
}

TEST_F(EvaluatorClientTest, AsksAgainForWhatGotLostAndForNothingElse) {
  evaluator_.Then([](auto&, const auto& request, auto& writer) {
    writer.Write(ResultOf(request, 1));
    return grpc::Status(grpc::StatusCode::UNAVAILABLE, "restarting");
  });
  evaluator_.Then([](auto&, const auto& request, auto& writer) {
    v1::EvaluationResult lost;
    lost.set_index(0);
    *lost.mutable_error() = rpc::ToProto(absl::CancelledError("the worker went away"));
    writer.Write(lost);
    writer.Write(ResultOf(request, 1));
    return grpc::Status::OK;
  });
  const auto answers = Evaluate(designs_);
  ASSERT_TRUE(answers.ok()) << answers.status();
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ((*answers)[i].values[0], designs_[i].sum());
  const auto requests = evaluator_.requests();
  ASSERT_EQ(requests.size(), 3u);
  EXPECT_EQ(requests[1].points_size(), 2);
  ASSERT_EQ(requests[2].points_size(), 1);
  EXPECT_EQ(requests[2].points(0).parameters(1), 2);
}

TEST_F(EvaluatorClientTest, AsksAgainWhereWhoServedItGoesAway) {
  evaluator_.Then([](auto&, const auto& request, auto& writer) {
    writer.Write(ResultOf(request, 0));
    return grpc::Status(grpc::StatusCode::CANCELLED, "shutting down");
  });
  const auto answers = Evaluate(designs_);
  ASSERT_TRUE(answers.ok()) << answers.status();
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ((*answers)[i].values[0], designs_[i].sum());
  ASSERT_EQ(evaluator_.requests().size(), 2u);
  EXPECT_EQ(evaluator_.requests()[1].points_size(), static_cast<int>(designs_.size()) - 1);
}

TEST_F(EvaluatorClientTest, ACallThatTakesTooLongIsMadeAgain) {
  evaluator_.Then([](grpc::ServerContext& context, const auto&, auto&) {
    while (!context.IsCancelled()) std::this_thread::yield();
    return grpc::Status(grpc::StatusCode::CANCELLED, "too late");
  });
  const auto client =
      MakeClient({.patience = absl::Minutes(1), .longest_call = absl::Milliseconds(300)});
  const auto answers = client->Evaluate({designs_[0]});
  ASSERT_TRUE(answers.ok()) << answers.status();
  EXPECT_EQ(answers->front().values[0], 3);
}

TEST_F(EvaluatorClientTest, GivesUpOnAnEvaluatorThatIsAwayOnceItsPatienceIsThrough) {
  server_->Shutdown(std::chrono::system_clock::now());
  const auto client = MakeClient({.patience = absl::ZeroDuration()});
  EXPECT_TRUE(absl::IsUnavailable(client->Evaluate(designs_).status()));
}

TEST_F(EvaluatorClientTest, RefusalsOfTheWholeCallAreNotRepeated) {
  evaluator_.Then([](auto&, const auto&, auto&) {
    return grpc::Status(grpc::StatusCode::INTERNAL, "the solver's licence has run out");
  });
  const auto answers = Evaluate(designs_);
  EXPECT_EQ(answers.status().code(), absl::StatusCode::kInternal);
  EXPECT_EQ(evaluator_.requests().size(), 1u);
}

TEST_F(EvaluatorClientTest, RefusesAnswersToWhatWasNotAsked) {
  evaluator_.Then([](auto&, const auto& request, auto& writer) {
    v1::EvaluationResult result = ResultOf(request, 0);
    result.set_index(3);
    writer.Write(result);
    return grpc::Status::OK;
  });
  EXPECT_EQ(Evaluate(designs_).status().code(), absl::StatusCode::kInternal);
  question_.set_gradients(true);
  evaluator_.Then([](auto&, const auto& request, auto& writer) {
    v1::EvaluationResult result = ResultOf(request, 0);
    result.mutable_gradients(0)->add_values(1);
    writer.Write(result);
    return grpc::Status::OK;
  });
  EXPECT_EQ(Evaluate(designs_).status().code(), absl::StatusCode::kInternal);
}

TEST_F(EvaluatorClientTest, AnInterruptionEndsCallsUnderWayAndLaterOnes) {
  std::promise<void> arrived;
  evaluator_.Then([&](grpc::ServerContext& context, const auto&, auto&) {
    arrived.set_value();
    while (!context.IsCancelled()) std::this_thread::yield();
    return grpc::Status(grpc::StatusCode::CANCELLED, "cancelled");
  });
  const auto client = MakeClient({});
  auto evaluating = std::async(std::launch::async, [&] { return client->Evaluate(designs_); });
  arrived.get_future().wait();
  client->Interrupt();
  EXPECT_TRUE(absl::IsCancelled(evaluating.get().status()));
  EXPECT_TRUE(absl::IsCancelled(client->Evaluate(designs_).status()));
  EXPECT_EQ(evaluator_.requests().size(), 1u);
}

TEST_F(EvaluatorClientTest, DescribesASubjectAndTellsThatThereIsNone) {
  v1::DescribeDesignSpaceRequest request;
  request.set_subject("templates/table");
  request.set_revision(4);
  const auto space = DescribeDesignSpace(channel_, request, Call(absl::Minutes(1)), {});
  ASSERT_TRUE(space.ok()) << space.status();
  EXPECT_EQ((*space)->revision(), 4);
  request.set_subject("templates/chair");
  EXPECT_TRUE(absl::IsNotFound(
      DescribeDesignSpace(channel_, request, Call(absl::Minutes(1)), {}).status()));
}

}  // namespace
}  // namespace mortise::evaluation
