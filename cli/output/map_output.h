// Maps as people read them.
#pragma once

#include <string>
#include <vector>

#include "cli/client/output.h"
#include "mortise/v1/interpolator.pb.h"

namespace mortise::cli {

// Returns what came about where the map has no values, as the end of a sentence: "evaluations
// failed".
std::string WhyNoValues(const v1::DesignMap& map);

// The same where it has no shapes.
inline constexpr char kWhyNoShape[] = "shapes could not be brought into one mesh";

// Prints what a map is of, how good it is, and why designs failed.
void PrintMap(const v1::DesignMap& map, const Output& output);

// Says that the map is of an earlier revision of its subject, where it is.
void PrintStale(const v1::DesignMap& map, const Output& output);

// Prints how far the map was off designs that were evaluated for it; nothing before it was
// verified.
void PrintVerification(const v1::DesignMap& map, const Output& output);

// Prints a row for each of the points (points x parameters), with how far each value may be off,
// and below a table of the gradients, if there are any.
void PrintPoints(const v1::DesignMap& map, const std::vector<double>& points,
                 const v1::EvaluateMapResponse& answer, const Output& output);

}  // namespace mortise::cli
