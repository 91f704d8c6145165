// Numbers that are finite and far too large, in every request to the catalog: each is answered in
// time, well or with a failure that is the caller's, and nobody falls over or goes on computing.
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <gtest/gtest.h>

#include <atomic>
#include <set>
#include <thread>

#include "absl/strings/match.h"
#include "common/rpc/status_mapping.h"
#include "tests/e2e/good_requests.h"
#include "tests/e2e/raw_call.h"
#include "tests/e2e/request_mutations.h"
#include "tests/e2e/running_house.h"

namespace mortise::e2e {
namespace {

using absl::StatusCode;

bool IsCallers(StatusCode code) {
  static const std::set<StatusCode> callers = {StatusCode::kOk,
                                               StatusCode::kInvalidArgument,
                                               StatusCode::kNotFound,
                                               StatusCode::kOutOfRange,
                                               StatusCode::kAborted,
                                               StatusCode::kAlreadyExists,
                                               StatusCode::kResourceExhausted,
                                               StatusCode::kFailedPrecondition};
  return callers.count(code) != 0;
}

TEST(LargeNumbersTest, AreAnsweredByTheCatalog) {
  RunningHouse house;
  ASSERT_TRUE(house.Serving()) << house.Log();
  const auto channel = grpc::CreateChannel(house.GrpcAddress(), grpc::InsecureChannelCredentials());
  const std::vector<GoodRequest> requests = MakeGoodRequests(channel);
  const auto processes = house.Processes();
  constexpr int kThreads = 4;
  std::atomic<std::size_t> next = 0, asked = 0;
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i) {
    threads.emplace_back([&] {
      for (std::size_t k = next++; k < requests.size(); k = next++) {
        const std::string& method = requests[k].method;
        if (!absl::StrContains(method, "CatalogService/") &&
            !absl::StrContains(method, "AssemblyService/")) {
          continue;
        }
        for (const BadRequest& large : LargeNumbers(*requests[k].message)) {
          const RawAnswer answer = CallWithBytes(channel, method, large.bytes);
          const absl::Status status = rpc::FromGrpc(answer.status);
          ++asked;
          EXPECT_TRUE(IsCallers(status.code()))
              << method << " " << large.path << " = " << large.what << ": " << status;
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_GT(asked, 200u);
  EXPECT_EQ(house.Processes(), processes);
  EXPECT_TRUE(house.Serving()) << house.Log();
}

}  // namespace
}  // namespace mortise::e2e
