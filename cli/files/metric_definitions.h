// Custom metrics, as flags give them.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "cli/client/command_flags.h"
#include "mortise/v1/metric.pb.h"

namespace mortise::cli {

struct MetricDefinitionFlags {
  std::vector<std::string> define;  // "pull [N] = '30 N m' / distance('jaw', 'grip')"
  std::vector<std::string> point;   // "grip = length - 0.02, 0, 0"
};

// INVALID_ARGUMENT naming "--define" or "--point" for one of another form. A metric without a unit
// in brackets has none, "1".
absl::StatusOr<v1::MetricDefinitions> ParseMetricDefinitions(const MetricDefinitionFlags& flags);

// Declares --define and --point. `more` is said of --define besides.
void AddMetricDefinitionFlags(CommandFlags& flags, MetricDefinitionFlags& options,
                              const std::string& more = "");

// Says that the flags gave what is below `field` ("metric_definitions") of a request, for requests
// that may have it from elsewhere.
void AddSources(const MetricDefinitionFlags& flags, const std::string& field,
                FieldSources& sources);

}  // namespace mortise::cli
