// Numbers with names that tell how good a design is, and what each is computed from.
#pragma once

#include <string>

namespace mortise::simulator {

// A number with a name.
struct Metric {
  std::string name;
  std::string unit;  // SI; of a cost the currency, ISO 4217
  double value = 0;
};

// An amount in a currency.
struct Cost {
  double amount = 0;
  std::string currency;  // ISO 4217
};

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
  std::string name;
  std::string unit;
  std::string description;
  MetricSource source = MetricSource::kParts;
};

}  // namespace mortise::simulator
