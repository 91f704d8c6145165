// The metrics that every design has, in one table: what each is called, its unit, what it is
// computed from, and whether its gradient is known.
//
// Whoever lists metrics, checks names or units, or says what must be solved reads this table;
// whoever computes a metric knows it by its BuiltInMetric. (Templates and requests may define
// others besides, see metric_expressions.h.)
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/design/metric.h"
#include "common/expressions/metric_expressions.h"

namespace mortise::simulator {

enum class BuiltInMetric {
  kMass,
  kVolume,
  kCenterOfMassX,
  kCenterOfMassY,
  kCenterOfMassZ,
  kInertiaXx,
  kInertiaYy,
  kInertiaZz,
  kInertiaXy,
  kInertiaYz,
  kInertiaXz,
  kProjectedAreaX,
  kProjectedAreaY,
  kProjectedAreaZ,
  kDrag,
  kTopplingMargin,
  kTopplingAngle,
  kDisplacedVolume,
  kDraught,
  kFreeboard,
  kMetacentricHeight,
  kSurfaceArea,
  kCost,
  kNaturalFrequency,
  kMaxTemperature,
  kMinTemperature,
  kMeanTemperature,
  kHeatDissipation,
  kAirflowDrag,
  kAirflowForceX,
  kAirflowForceY,
  kAirflowForceZ,
  kMaxAirPressure,
  kMinAirPressure,
  kMaxDisplacement,
  kMaxVonMises,
  kMaxPrincipal,
  kCompliance,
  kStrainEnergy,
  kStressRatio,
  kMeanVonMises,
  kRmsVonMises,
  kVonMisesP99,
  kVonMisesIntegral,
  kRelativeError,
};

// The share of the volume that is below von_mises_p99.
inline constexpr double kShareBelowP99 = 0.99;

// What a metric is computed from, and so how long it takes.
enum class MetricSource {
  kParts,    // each part by itself: microseconds to milliseconds
  kOutside,  // the outside of all parts joined
  kPrices,   // the items' prices
  kModes,    // natural vibration: a mesh and a factor
  kHeat,     // steady temperatures: a mesh and a solution
  kAirflow,  // the air around it: OpenFOAM
  kLoads,    // displacements and stresses under the loads: a mesh and a solution
};

// A metric that can be asked for.
struct MetricDescription {
  BuiltInMetric metric = BuiltInMetric::kMass;
  std::string name;
  std::string unit;  // SI; empty for the cost, which is in the currency of the items
  std::string description;
  MetricSource source = MetricSource::kParts;
  // Whether its exact gradient is known on designs that say how they move with the parameters.
  bool has_gradient = false;
};

// Returns all of them, in the order of the manual and of BuiltInMetric.
const std::vector<MetricDescription>& OfferedMetrics();

// Returns the metric of this name; nullptr if there is none.
const MetricDescription* FindMetric(std::string_view name);

// Returns what the table says of a metric.
const MetricDescription& DescriptionOf(BuiltInMetric metric);

// Returns the names and units alone, as those need them who check the expressions of other metrics.
std::vector<parametric::NamedUnit> UnitsOf(const std::vector<MetricDescription>& metrics);

// Returns a value with the metric's name and unit.
Metric MetricOf(BuiltInMetric metric, double value);

}  // namespace mortise::simulator
