#include "common/base/logging.h"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "common/base/log_rotation.h"

namespace mortise {
namespace {

thread_local std::string current_trace_id;

spdlog::level::level_enum SpdlogLevel(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return spdlog::level::debug;
    case LogLevel::kInfo:
      return spdlog::level::info;
    case LogLevel::kWarning:
      return spdlog::level::warn;
    case LogLevel::kError:
      return spdlog::level::err;
  }
  return spdlog::level::info;
}

// Standard error, in files of a limited size where that is asked for.
class StandardError final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  StandardError() : rotation_(LogRotation::FromEnvironment()) {}

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t line;
    formatter_->format(message, line);
    std::fwrite(line.data(), 1, line.size(), stderr);
    if (rotation_) rotation_->BeginNewFileIfFull();
  }
  void flush_() override { std::fflush(stderr); }

  const std::optional<LogRotation> rotation_;
};

}  // namespace

void ConfigureLogging(std::string_view service, LogLevel level) {
  auto logger =
      std::make_shared<spdlog::logger>(std::string(service), std::make_shared<StandardError>());
  logger->set_pattern(R"({"time":"%Y-%m-%dT%H:%M:%S.%fZ","level":"%l","service":"%n",%v})",
                      spdlog::pattern_time_type::utc);
  logger->set_level(SpdlogLevel(level));
  logger->flush_on(spdlog::level::debug);
  spdlog::set_default_logger(std::move(logger));
}

void Log(LogLevel level, std::string_view message, std::initializer_list<LogField> fields) {
  const spdlog::level::level_enum spdlog_level = SpdlogLevel(level);
  if (!spdlog::default_logger_raw()->should_log(spdlog_level)) return;
  nlohmann::ordered_json line;
  line["message"] = message;
  if (!current_trace_id.empty()) line["trace"] = current_trace_id;
  for (const LogField& field : fields) line[std::string(field.key)] = field.value;
  const std::string object =
      line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  spdlog::default_logger_raw()->log(spdlog_level, "{}",
                                    std::string_view(object).substr(1, object.size() - 2));
}

TraceScope::TraceScope(std::string trace_id)
    : previous_(std::exchange(current_trace_id, std::move(trace_id))) {}

TraceScope::~TraceScope() { current_trace_id = std::move(previous_); }

const std::string& CurrentTraceId() { return current_trace_id; }

}  // namespace mortise
