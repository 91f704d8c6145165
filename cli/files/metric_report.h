// The metrics of an analysis as people read them. Documents (--json) have every number as it is.
#pragma once

#include <google/protobuf/repeated_field.h>

#include <string>
#include <vector>

#include "mortise/v1/simulator.pb.h"

namespace mortise::cli {

using Metrics = google::protobuf::RepeatedPtrField<v1::Metric>;

// Returns the value of a metric with its unit. Shares that are errors are in per cent; what is only
// rounding beside the others of its kind is 0: a coordinate of the centre of mass beside the
// design's size, an entry of the inertia tensor beside the largest.
std::string MetricReport(const v1::Metric& metric, const Metrics& all);

// Whether nobody has a use for a metric that he did not ask for: how deep a design lies in the
// water that does not float upright, as it sinks or would capsize.
bool IsBeside(const std::string& metric, const Metrics& all);

// Whether a note tells why there is no such metric.
bool IsNoteBeside(const std::string& note, const Metrics& all);

// Returns what an estimated error above a tenth means and what would help; empty where it is
// smaller, or not there. Meshes of one's own can only be made finer by oneself.
std::string AdviceOnError(const v1::Analysis& analysis);

}  // namespace mortise::cli
