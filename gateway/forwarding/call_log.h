// One line and one measurement for each call through the gateway.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "gateway/contract/contract.h"

namespace prometheus {
class Counter;
class Gauge;
class Histogram;
class Registry;
}  // namespace prometheus

namespace mortise::gateway {

// What there is to say about a call when it has ended.
struct CallRecord {
  const MethodRoute* method = nullptr;  // null for an unknown one
  std::string_view path;
  std::string_view subject;     // empty if the caller was not let in
  std::string_view request_id;  // also the trace id
  int code = 0;                 // gRPC status code
  std::chrono::steady_clock::duration duration{};
};

// Thread safe. Writing must not slow calls down: a line is put together in place and handed to a
// thread that writes many at once. When standard error cannot keep up, lines are dropped and
// counted (mortise_gateway_log_lines_dropped_total); metrics never are.
class CallLog {
 public:
  // `registry` must outlive it. `lines` false: metrics only.
  CallLog(const Contract& contract, prometheus::Registry& registry, bool lines);
  ~CallLog();
  CallLog(const CallLog&) = delete;
  CallLog& operator=(const CallLog&) = delete;

  void Begin();
  void End(const CallRecord& record);

 private:
  struct MethodMetrics {
    std::vector<prometheus::Counter*> by_code;
    prometheus::Histogram* seconds = nullptr;
  };

  void Append(const CallRecord& record);
  void WriteLines();

  std::vector<MethodMetrics> metrics_;  // by MethodRoute::index, the last for unknown methods
  prometheus::Gauge* in_flight_ = nullptr;
  prometheus::Counter* dropped_ = nullptr;
  const bool lines_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string pending_;    // guarded by mutex_
  bool stopping_ = false;  // guarded by mutex_
  std::thread writer_;
};

}  // namespace mortise::gateway
