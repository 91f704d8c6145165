// Whole numbers out of the JSON records that decide what is cut. nlohmann's own conversion wraps
// what does not fit and cuts off fractions; here that is damage.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

namespace mortise::hwbridge {

// Throws std::out_of_range, for the parser of the record to catch beside nlohmann's exceptions.
template <typename Integer>
Integer WholeNumber(const nlohmann::ordered_json& json) {
  const bool fits =
      json.is_number_unsigned()
          ? std::in_range<Integer>(json.get<std::uint64_t>())
          : json.is_number_integer() && std::in_range<Integer>(json.get<std::int64_t>());
  if (!fits) throw std::out_of_range("the number " + json.dump() + " cannot be");
  return json.get<Integer>();
}

}  // namespace mortise::hwbridge
