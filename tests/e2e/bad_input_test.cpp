// Every method that the gateway forwards, asked badly: each bad request is answered in time with a
// failure that is the caller's and names what is wrong, nothing is stored, and nobody falls over.
#include <gmock/gmock.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <set>
#include <thread>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/events.grpc.pb.h"
#include "mortise/v1/gateway.grpc.pb.h"
#include "tests/e2e/good_requests.h"
#include "tests/e2e/raw_call.h"
#include "tests/e2e/request_mutations.h"
#include "tests/e2e/running_house.h"

namespace mortise::e2e {
namespace {

using absl::StatusCode;
using testing::IsSupersetOf;

constexpr int kThreads = 4;

// "specification.bounds[0].maximum" -> "maximum".
std::string LastName(const std::string& path) {
  std::string name = path.substr(path.rfind('.') + 1);
  return name.substr(0, name.find('['));
}

// Why `answer` is not what `bad` deserves; empty if it is.
std::string Complaint(const BadRequest& bad, const grpc::Status& answer) {
  static const std::set<StatusCode> callers = {
      StatusCode::kInvalidArgument,   StatusCode::kNotFound,      StatusCode::kOutOfRange,
      StatusCode::kAborted,           StatusCode::kAlreadyExists, StatusCode::kResourceExhausted,
      StatusCode::kFailedPrecondition};
  if (answer.ok()) return bad.verdict == Verdict::kAnswered ? "" : "was accepted";
  const absl::Status status = rpc::FromGrpc(answer);
  const std::string answered = status.ToString(absl::StatusToStringMode::kWithEverything);
  if (callers.count(status.code()) == 0) return "has the wrong code: " + answered;
  const ErrorDetail detail = DetailOf(status);
  if (bad.verdict == Verdict::kTooLarge) {
    return status.code() == StatusCode::kResourceExhausted ? "" : "has the wrong code: " + answered;
  }
  if (detail.reason.empty()) return "has no reason: " + answered;
  const bool names_value =
      status.code() == StatusCode::kInvalidArgument || status.code() == StatusCode::kOutOfRange;
  switch (bad.verdict) {
    case Verdict::kUnreadable:
      // The gateway looks for the stream that a request names before anybody reads the rest.
      if (bad.path == "stream" && status.code() == StatusCode::kNotFound) return "";
      return status.code() == StatusCode::kInvalidArgument ? "" : "has the wrong code: " + answered;
    case Verdict::kPath:
      if (!names_value) return "has the wrong code: " + answered;
      return detail.field == bad.path ? "" : "names another field: " + answered;
    case Verdict::kField:
      if (!names_value) return "has the wrong code: " + answered;
      return absl::StrContains(detail.field, LastName(bad.path))
                 ? ""
                 : "names another field: " + answered;
    case Verdict::kTooLarge:
    case Verdict::kRefused:
    case Verdict::kAnswered:
      return names_value && detail.field.empty() ? "names no field: " + answered : "";
  }
  return "";
}

class BadInputTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    house_ = std::make_unique<RunningHouse>();
    if (!house_->Serving()) return;
    channel_ = grpc::CreateChannel(house_->GrpcAddress(), grpc::InsecureChannelCredentials());
    requests_ = MakeGoodRequests(channel_);
  }
  static void TearDownTestSuite() {
    requests_.clear();
    channel_.reset();
    house_.reset();
  }

  void SetUp() override {
    ASSERT_TRUE(house_->Serving()) << house_->Log();
    processes_ = house_->Processes();
    lists_ = Lists();
  }

  // Whatever was asked, nothing has changed.
  void TearDown() override {
    if (channel_ == nullptr) return;
    EXPECT_EQ(house_->Processes(), processes_);
    EXPECT_TRUE(house_->Serving()) << house_->Log();
    const std::map<std::string, std::string> now = Lists();
    for (const auto& [method, answer] : lists_) {
      EXPECT_EQ(now.at(method), answer) << method << " tells of something new";
    }
  }

  // Of what is listed, if the method lists what belongs to one resource.
  static void KeepName(const google::protobuf::Message& good, google::protobuf::Message* all) {
    const auto* name = all->GetDescriptor()->FindFieldByName("name");
    if (name == nullptr) return;
    all->GetReflection()->SetString(all, name, good.GetReflection()->GetString(good, name));
  }

  // What the methods that list everything answer, and how far each event stream has come.
  static std::map<std::string, std::string> Lists() {
    std::map<std::string, std::string> answers;
    for (const GoodRequest& good : requests_) {
      const bool lists = absl::StrContains(good.method, "/List") && good.outcome == Outcome::kOk;
      if (!lists && good.method != "mortise.v1.SimulatorService/GetQueueStatus") continue;
      // The gateway hears of events a little later.
      if (good.method == "mortise.v1.EventService/ListStreams") continue;
      std::unique_ptr<google::protobuf::Message> all(good.message->New());
      const auto* page_size = all->GetDescriptor()->FindFieldByName("page_size");
      if (page_size != nullptr) all->GetReflection()->SetInt32(all.get(), page_size, 500);
      KeepName(*good.message, all.get());
      const RawAnswer answer = CallWithBytes(channel_, good.method, all->SerializeAsString());
      EXPECT_TRUE(answer.status.ok()) << good.method << ": " << answer.status.error_message();
      answers[good.method] = answer.messages.empty() ? "" : Readable(good, answer.messages[0]);
    }
    v1::EventService::Stub events(channel_);
    for (const char* stream : {"catalog", "fabplanner", "interpolator", "pareto", "simulator"}) {
      grpc::ClientContext context;
      v1::ReadEventsRequest request;
      v1::ReadEventsResponse response;
      request.set_stream(stream);
      request.set_limit(1);
      EXPECT_TRUE(events.ReadEvents(&context, request, &response).ok()) << stream;
      answers[std::string("events of ") + stream] = std::to_string(response.latest_number());
    }
    return answers;
  }

  static std::string Readable(const GoodRequest& good, const std::string& answer) {
    const auto* prototype = google::protobuf::MessageFactory::generated_factory()->GetPrototype(
        good.descriptor->output_type());
    const std::unique_ptr<google::protobuf::Message> message(prototype->New());
    EXPECT_TRUE(message->ParseFromString(answer)) << good.method;
    return message->ShortDebugString();
  }

  // Sends what `spoil` makes of every good request, some at a time.
  template <class Spoil>
  static void Sweep(const Spoil& spoil) {
    std::atomic<std::size_t> next = 0;
    std::mutex mutex;
    std::vector<std::thread> threads;
    for (int i = 0; i < kThreads; ++i) {
      threads.emplace_back([&] {
        for (std::size_t k = next++; k < requests_.size(); k = next++) {
          for (const BadRequest& bad : spoil(requests_[k])) {
            const RawAnswer answer = CallWithBytes(channel_, requests_[k].method, bad.bytes);
            const std::string complaint = Complaint(bad, answer.status);
            if (complaint.empty()) continue;
            const std::lock_guard lock(mutex);
            ADD_FAILURE() << requests_[k].method << " " << bad.path << " with " << bad.what << " "
                          << complaint.substr(0, 400);
          }
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
  }

  static std::unique_ptr<RunningHouse> house_;
  static std::shared_ptr<grpc::Channel> channel_;
  static std::vector<GoodRequest> requests_;
  std::map<std::string, pid_t> processes_;
  std::map<std::string, std::string> lists_;
};

std::unique_ptr<RunningHouse> BadInputTest::house_;
std::shared_ptr<grpc::Channel> BadInputTest::channel_;
std::vector<GoodRequest> BadInputTest::requests_;

TEST_F(BadInputTest, EveryMethodOfTheHouseIsTried) {
  v1::GatewayService::Stub gateway(channel_);
  grpc::ClientContext context;
  v1::House house;
  ASSERT_TRUE(gateway.GetHouse(&context, {}, &house).ok());
  std::vector<std::string> tried;
  for (const GoodRequest& good : requests_) tried.push_back(good.method);
  for (const v1::House::Service& service : house.services()) {
    EXPECT_THAT(tried, IsSupersetOf(service.methods())) << service.name();
    EXPECT_TRUE(service.healthy()) << service.name();
  }
}

TEST_F(BadInputTest, GoodRequestsAreGood) {
  for (const GoodRequest& good : requests_) {
    if (good.outcome == Outcome::kChanges) continue;
    const RawAnswer answer =
        CallWithBytes(channel_, good.method, good.message->SerializeAsString());
    EXPECT_EQ(answer.status.ok(), good.outcome == Outcome::kOk)
        << good.method << ": " << answer.status.error_message();
  }
}

TEST_F(BadInputTest, BytesThatAreNoMessageAreRefused) {
  Sweep([](const GoodRequest& good) {
    std::vector<BadRequest> bad = RandomBytes(*good.message, 1, 40);
    for (BadRequest& request : Truncations(*good.message, 12)) bad.push_back(std::move(request));
    return bad;
  });
}

TEST_F(BadInputTest, MessagesAboveTheLimitAreRefused) {
  Sweep([](const GoodRequest&) {
    return std::vector<BadRequest>{
        {"more than 4 MiB", "", Verdict::kTooLarge, std::string(4 * 1024 * 1024 + 1, '\0')}};
  });
}

TEST_F(BadInputTest, SpoiltFieldsAreRefusedByName) {
  Sweep([](const GoodRequest& good) {
    std::vector<BadRequest> bad = SpoiltFields(*good.message);
    if (good.outcome != Outcome::kRefused) return bad;
    // What it speaks of is missing, which may be found out first.
    for (BadRequest& request : bad) {
      if (request.verdict == Verdict::kField) request.verdict = Verdict::kRefused;
    }
    return bad;
  });
}

}  // namespace
}  // namespace mortise::e2e
