#include "common/base/logging.h"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

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

}  // namespace

void ConfigureLogging(std::string_view service, LogLevel level) {
  auto logger = std::make_shared<spdlog::logger>(std::string(service),
                                                 std::make_shared<spdlog::sinks::stderr_sink_mt>());
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
