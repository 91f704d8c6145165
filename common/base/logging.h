// Structured logs: one JSON object a line on standard error, each with time, level, service, trace
// id and named fields, so that one request can be followed across processes. Where the environment
// names the file that standard error goes to, it is kept from growing without end (log_rotation.h).
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

#include "absl/strings/str_cat.h"

namespace mortise {

enum class LogLevel { kDebug, kInfo, kWarning, kError };

// One named field of a log line; numbers are formatted by absl::AlphaNum.
struct LogField {
  LogField(std::string_view key_in, const absl::AlphaNum& value_in)
      : key(key_in), value(absl::StrCat(value_in)) {}
  std::string_view key;
  std::string value;
};

// Names the process in every line and drops lines below `level`. Call once, from main.
void ConfigureLogging(std::string_view service, LogLevel level);

// Writes one line. Thread safe.
void Log(LogLevel level, std::string_view message, std::initializer_list<LogField> fields = {});

// While in scope, log lines of this thread carry `trace_id`.
class TraceScope {
 public:
  explicit TraceScope(std::string trace_id);
  ~TraceScope();
  TraceScope(const TraceScope&) = delete;
  TraceScope& operator=(const TraceScope&) = delete;

 private:
  std::string previous_;
};

// Returns the trace id of this thread, empty outside any TraceScope. It is the request id given by
// the gateway, and travels in the signed identity.
const std::string& CurrentTraceId();

}  // namespace mortise
