// Numbers with names that tell how good a design is.
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

}  // namespace mortise::simulator
