// Functions of named faces, points and parts that custom metrics can use: area('rim'),
// distance('jaw', 'grip'), mean_von_mises('top').
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace mortise::parametric {

// What a function is computed from.
enum class MetricFunctionSource {
  kShape,  // the outside of all parts joined
  kLoads,  // a mesh and a solution under the loads
  kHeat,   // a mesh and its temperatures
};

// What the first place of a function may be.
enum class MetricPlaceKind {
  kFaceOrPoint,
  kFace,
  kPart,
  kAny,  // a face, a point or a part
};

struct MetricFunction {
  std::string name;
  std::string unit;  // SI
  MetricFunctionSource source = MetricFunctionSource::kShape;
  int places = 1;                                        // how many names of places it takes
  MetricPlaceKind kind = MetricPlaceKind::kFaceOrPoint;  // of the first of them
  std::string description = {};
};

// Returns all of them, in the order of the manual.
const std::vector<MetricFunction>& MetricFunctions();

// Returns the function of this name; nullptr if there is none.
const MetricFunction* FindMetricFunction(std::string_view name);

// A function of places: area('rim').
struct MetricCall {
  const MetricFunction* function = nullptr;
  std::vector<std::string> places;  // names of points, conditions, faces or parts
  // Under loads: the load case; empty for the one where the value is largest, whatever its sign.
  std::string load_case = {};

  friend bool operator==(const MetricCall&, const MetricCall&) = default;
};

// As it is written.
std::string ToText(const MetricCall& call);

}  // namespace mortise::parametric
