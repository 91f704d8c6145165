#include "gateway/forwarding/call_log.h"

#include <google/protobuf/descriptor.h>
#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <unistd.h>

#include <array>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "common/base/string_views.h"

namespace mortise::gateway {
namespace {

constexpr std::size_t kMaximalPendingBytes = 4 << 20;

constexpr std::array<const char*, 17> kCodeNames = {
    "OK",        "CANCELLED",      "UNKNOWN",           "INVALID_ARGUMENT",   "DEADLINE_EXCEEDED",
    "NOT_FOUND", "ALREADY_EXISTS", "PERMISSION_DENIED", "RESOURCE_EXHAUSTED", "FAILED_PRECONDITION",
    "ABORTED",   "OUT_OF_RANGE",   "UNIMPLEMENTED",     "INTERNAL",           "UNAVAILABLE",
    "DATA_LOSS", "UNAUTHENTICATED"};

std::size_t CodeIndex(int code) {
  return code >= 0 && code < static_cast<int>(kCodeNames.size()) ? static_cast<std::size_t>(code)
                                                                 : 2;
}

// Everything else that reaches a line consists of characters that JSON takes as they are.
void AppendQuoted(std::string& line, std::string_view text) {
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte < 0x7f && c != '"' && c != '\\') {
      line.push_back(c);
    } else {
      absl::StrAppend(&line, "\\u00", absl::Hex(byte, absl::kZeroPad2));
    }
  }
}

void WriteAll(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(STDERR_FILENO, bytes.data(), bytes.size());
    if (written <= 0) return;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace

CallLog::CallLog(const Contract& contract, prometheus::Registry& registry, bool lines)
    : lines_(lines) {
  auto& calls = prometheus::BuildCounter()
                    .Name("mortise_gateway_calls_total")
                    .Help("Calls that ended, by method and gRPC code")
                    .Register(registry);
  auto& seconds = prometheus::BuildHistogram()
                      .Name("mortise_gateway_call_seconds")
                      .Help("Duration of calls, streams to their end")
                      .Register(registry);
  const prometheus::Histogram::BucketBoundaries boundaries = {
      0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 60};
  auto add = [&](const std::string& method) {
    MethodMetrics metrics;
    for (const char* code : kCodeNames) {
      metrics.by_code.push_back(&calls.Add({{"method", method}, {"code", code}}));
    }
    metrics.seconds = &seconds.Add({{"method", method}}, boundaries);
    metrics_.push_back(std::move(metrics));
  };
  for (const MethodRoute& method : contract.methods()) add(method.full_name);
  add("unknown");
  in_flight_ = &prometheus::BuildGauge()
                    .Name("mortise_gateway_calls_in_flight")
                    .Help("Calls that have begun and not ended")
                    .Register(registry)
                    .Add({});
  dropped_ = &prometheus::BuildCounter()
                  .Name("mortise_gateway_log_lines_dropped_total")
                  .Help("Log lines lost because standard error was too slow")
                  .Register(registry)
                  .Add({});
  if (lines_) writer_ = std::thread([this] { WriteLines(); });
}

CallLog::~CallLog() {
  if (!lines_) return;
  {
    std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_one();
  writer_.join();
}

void CallLog::Begin() { in_flight_->Increment(); }

void CallLog::End(const CallRecord& record) {
  in_flight_->Decrement();
  const std::size_t method = record.method == nullptr ? metrics_.size() - 1 : record.method->index;
  metrics_[method].by_code[CodeIndex(record.code)]->Increment();
  metrics_[method].seconds->Observe(std::chrono::duration<double>(record.duration).count());
  if (lines_) Append(record);
}

void CallLog::Append(const CallRecord& record) {
  const auto micros =
      std::chrono::duration_cast<std::chrono::microseconds>(record.duration).count();
  std::string line = absl::StrCat(
      R"({"time":")", absl::FormatTime("%Y-%m-%dT%H:%M:%E6SZ", absl::Now(), absl::UTCTimeZone()),
      R"(","level":"info","service":"gateway","message":"call","trace":")",
      AbslView(record.request_id), R"(","method":")");
  AppendQuoted(line, record.method == nullptr ? record.path : record.method->full_name);
  absl::StrAppend(&line, R"(","subject":")", AbslView(record.subject), R"(","code":")",
                  kCodeNames[CodeIndex(record.code)], R"(","microseconds":")", micros, "\"}\n");
  bool wake = false;
  {
    std::lock_guard lock(mutex_);
    if (pending_.size() + line.size() > kMaximalPendingBytes) {
      dropped_->Increment();
      return;
    }
    wake = pending_.empty();
    pending_ += line;
  }
  if (wake) changed_.notify_one();
}

void CallLog::WriteLines() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return stopping_ || !pending_.empty(); });
    if (pending_.empty()) return;
    // Under load, let a few milliseconds of lines gather: one write for all of them.
    if (!stopping_) {
      changed_.wait_for(lock, std::chrono::milliseconds(5), [this] { return stopping_; });
    }
    std::string lines;
    lines.swap(pending_);
    lock.unlock();
    WriteAll(lines);
    lock.lock();
  }
}

}  // namespace mortise::gateway
