#include "tests/bench/gateway/bench_load.h"

#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <thread>

#include "common/base/elapsed_time.h"
#include "mortise/v1/catalog.grpc.pb.h"

namespace mortise::gateway {
namespace {

using Clock = std::chrono::steady_clock;

void Authorize(grpc::ClientContext& context, const std::string& token) {
  if (!token.empty()) context.AddMetadata("authorization", "Bearer " + token);
}

// One call in flight; `done` gets its latency.
struct PendingCall {
  grpc::ClientContext context;
  v1::GetItemRequest request;
  v1::Item item;
  Clock::time_point begin = Clock::now();
};

void Call(v1::CatalogService::Stub& stub, const std::string& token,
          std::function<void(double, bool)> done) {
  auto call = std::make_shared<PendingCall>();
  Authorize(call->context, token);
  call->request.set_name("items/board");
  stub.async()->GetItem(&call->context, &call->request, &call->item,
                        [call, done = std::move(done)](const grpc::Status& status) {
                          done(SecondsSince(call->begin), status.ok());
                        });
}

class Outstanding {
 public:
  void Begin() { ++count_; }
  void End() {
    std::lock_guard lock(mutex_);
    if (--count_ == 0) changed_.notify_all();
  }
  void Wait() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return count_ == 0; });
  }

 private:
  std::atomic<int> count_{0};
  std::mutex mutex_;
  std::condition_variable changed_;
};

}  // namespace

BenchTarget MakeTarget(const std::string& address, int clients, const std::string& authority,
                       const std::string& token) {
  BenchTarget target;
  target.token = token;
  for (int i = 0; i < clients; ++i) {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    std::shared_ptr<grpc::ChannelCredentials> credentials = grpc::InsecureChannelCredentials();
    if (!authority.empty()) {
      grpc::SslCredentialsOptions options;
      options.pem_root_certs = authority;
      credentials = grpc::SslCredentials(options);
      arguments.SetSslTargetNameOverride("localhost");
    }
    target.channels.push_back(grpc::CreateCustomChannel(address, credentials, arguments));
    target.channels.back()->WaitForConnected(std::chrono::system_clock::now() +
                                             std::chrono::seconds(10));
  }
  return target;
}

double MeasureCallRate(const BenchTarget& target, double seconds) {
  std::atomic<int64_t> answered{0};
  std::atomic<int64_t> failed{0};
  std::atomic<bool> stopping{false};
  Outstanding outstanding;
  std::vector<std::unique_ptr<v1::CatalogService::Stub>> stubs;
  for (const auto& channel : target.channels) {
    stubs.push_back(v1::CatalogService::NewStub(channel));
  }
  std::function<void(std::size_t)> next = [&](std::size_t client) {
    Call(*stubs[client], target.token, [&, client](double, bool ok) {
      ++(ok ? answered : failed);
      if (stopping) return outstanding.End();
      next(client);
    });
  };
  for (std::size_t client = 0; client < stubs.size(); ++client) {
    outstanding.Begin();
    next(client);
  }
  // Warm up, then count.
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  const int64_t before = answered;
  const auto begin = Clock::now();
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  const double rate = static_cast<double>(answered - before) / SecondsSince(begin);
  stopping = true;
  outstanding.Wait();
  if (failed > 0) std::printf("  (%lld calls failed)\n", static_cast<long long>(failed.load()));
  return rate;
}

double MeasureP99(const BenchTarget& target, double rate, double seconds) {
  std::vector<std::unique_ptr<v1::CatalogService::Stub>> stubs;
  for (const auto& channel : target.channels) {
    stubs.push_back(v1::CatalogService::NewStub(channel));
  }
  std::mutex mutex;
  std::vector<double> latencies;
  Outstanding outstanding;
  const auto begin = Clock::now();
  const auto calls = static_cast<int64_t>(rate * seconds);
  for (int64_t i = 0; i < calls; ++i) {
    const auto due = begin + std::chrono::duration_cast<Clock::duration>(
                                 std::chrono::duration<double>(static_cast<double>(i) / rate));
    std::this_thread::sleep_until(due);
    outstanding.Begin();
    Call(*stubs[static_cast<std::size_t>(i) % stubs.size()], target.token,
         [&](double latency, bool) {
           {
             std::lock_guard lock(mutex);
             latencies.push_back(latency);
           }
           outstanding.End();
         });
  }
  outstanding.Wait();
  std::sort(latencies.begin(), latencies.end());
  return latencies[latencies.size() * 99 / 100];
}

double MeasureStreamRate(const BenchTarget& target, int64_t bytes,
                         const std::function<void()>& sample) {
  const auto stub = v1::CatalogService::NewStub(target.channels.front());
  grpc::ClientContext context;
  Authorize(context, target.token);
  v1::ExportDesignRequest request;
  request.set_revision(bytes);
  const auto begin = Clock::now();
  const auto reader = stub->ExportDesign(&context, request);
  v1::Chunk chunk;
  int64_t read = 0;
  int chunks = 0;
  while (reader->Read(&chunk)) {
    read += static_cast<int64_t>(chunk.data().size());
    if (++chunks % 8 == 0) sample();
  }
  if (!reader->Finish().ok() || read < bytes) return 0;
  return static_cast<double>(read) / SecondsSince(begin);
}

}  // namespace mortise::gateway
