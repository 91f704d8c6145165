// Designs of a map, as people write them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "mortise/v1/interpolator.pb.h"

namespace mortise::cli {

// Returns the design "width=0.4,height=72cm" as numbers in SI units, in the order of the map's
// parameters; the values as ParseQuantity reads them, of a choice by name or number. All that
// varies must be said: a map has no defaults. What the map keeps fixed may be said with the value
// that it has. INVALID_ARGUMENT naming `source` ("--at") for what is said twice, or not, for names
// that the map does not know and other values of what is fixed.
absl::StatusOr<std::vector<double>> ParseMapPoint(const v1::DesignMap& map, const std::string& text,
                                                  const std::string& source);

// Returns the designs of a table of comma-separated values, one after the other: a row each, under
// the names of the parameters. Columns of the map's metrics and their errors, "mass [kg]" and "mass
// error [kg]", as pages of maps save them, are passed over. INVALID_ARGUMENT naming each place in
// `origin` that is at fault: "points.csv: line 3, column 2".
absl::StatusOr<std::vector<double>> ParseMapPoints(const v1::DesignMap& map, std::string_view table,
                                                   const std::string& origin);

// Returns "width=0.4", a value of one parameter of the map, as ParseMapPoint reads it.
// INVALID_ARGUMENT naming `source`.
absl::StatusOr<v1::ParameterValue> ParseMapValue(const v1::DesignMap& map, const std::string& text,
                                                 const std::string& source);

// Returns a value of a parameter for people: the name of a choice, or the number.
std::string ParameterText(const v1::MapParameter& parameter, double value);

// Returns what a parameter may be in the map: "0.2 to 1.5 m", or the names of its choices.
std::string RangeText(const v1::MapParameter& parameter);

}  // namespace mortise::cli
