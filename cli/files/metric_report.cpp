#include "cli/files/metric_report.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "absl/strings/str_format.h"
#include "cli/client/requests.h"
#include "common/design/metric_registry.h"

namespace mortise::cli {
namespace {

using simulator::BuiltInMetric;
using simulator::DescriptionOf;

// Of what a value is computed from: sums of that many terms are rounded by as much.
constexpr double kRounding = 1e-11;
constexpr double kLargeError = 0.1;

constexpr std::array<BuiltInMetric, 4> kAfloat = {
    BuiltInMetric::kDisplacedVolume, BuiltInMetric::kDraught, BuiltInMetric::kFreeboard,
    BuiltInMetric::kMetacentricHeight};
constexpr std::array<BuiltInMetric, 3> kCenterOfMass = {
    BuiltInMetric::kCenterOfMassX, BuiltInMetric::kCenterOfMassY, BuiltInMetric::kCenterOfMassZ};
constexpr std::array<BuiltInMetric, 6> kInertia = {
    BuiltInMetric::kInertiaXx, BuiltInMetric::kInertiaYy, BuiltInMetric::kInertiaZz,
    BuiltInMetric::kInertiaXy, BuiltInMetric::kInertiaYz, BuiltInMetric::kInertiaXz};
constexpr std::array<BuiltInMetric, 4> kForcesOfAir = {
    BuiltInMetric::kAirflowDrag, BuiltInMetric::kAirflowForceX, BuiltInMetric::kAirflowForceY,
    BuiltInMetric::kAirflowForceZ};

// 0 where it is not there.
double ValueOf(BuiltInMetric metric, const Metrics& all) {
  const std::string& name = DescriptionOf(metric).name;
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const v1::Metric& known) { return known.name() == name; });
  return found == all.end() ? 0 : found->value();
}

template <std::size_t N>
bool Contains(const std::array<BuiltInMetric, N>& kind, const std::string& name) {
  return std::any_of(kind.begin(), kind.end(),
                     [&](BuiltInMetric metric) { return DescriptionOf(metric).name == name; });
}

// What the others of its kind are like; 0 where a metric stands by itself.
double ScaleOf(const std::string& name, const Metrics& all) {
  double scale = 0;
  const auto extend = [&](const auto& kind) {
    if (!Contains(kind, name)) return;
    for (const BuiltInMetric metric : kind) {
      scale = std::max(scale, std::abs(ValueOf(metric, all)));
    }
  };
  extend(kCenterOfMass);
  extend(kInertia);
  extend(kForcesOfAir);
  if (!Contains(kCenterOfMass, name)) return scale;
  return std::max(scale, std::cbrt(ValueOf(BuiltInMetric::kVolume, all)));
}

}  // namespace

std::string MetricReport(const v1::Metric& metric, const Metrics& all) {
  if (metric.name() == DescriptionOf(BuiltInMetric::kRelativeError).name) {
    return absl::StrFormat("%.2g %%", 100 * metric.value());
  }
  if (std::abs(metric.value()) >= kRounding * ScaleOf(metric.name(), all)) {
    return MetricText(metric);
  }
  v1::Metric nothing = metric;
  nothing.set_value(0);
  return MetricText(nothing);
}

bool IsBeside(const std::string& metric, const Metrics& all) {
  return Contains(kAfloat, metric) && !(ValueOf(BuiltInMetric::kMetacentricHeight, all) > 0);
}

bool IsNoteBeside(const std::string& note, const Metrics& all) {
  return IsBeside(note.substr(0, note.find(':')), all);
}

std::string AdviceOnError(const v1::Analysis& analysis) {
  double error = ValueOf(BuiltInMetric::kRelativeError, analysis.metrics());
  for (const v1::CaseResult& result : analysis.cases()) {
    error = std::max(error, ValueOf(BuiltInMetric::kRelativeError, result.metrics()));
  }
  if (!(error > kLargeError)) return "";
  const bool has_template = analysis.mesh_file().empty();
  return absl::StrFormat(
      "stresses may be off by about %.2g %% (in the energy norm, where 5 %% is good): %s",
      100 * error,
      has_template ? "--relative-error 0.05 refines the mesh where it matters, --element-size "
                     "everywhere"
                   : "take a finer mesh, or 10-node elements");
}

}  // namespace mortise::cli
