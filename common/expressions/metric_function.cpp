#include "common/expressions/metric_function.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace mortise::parametric {
namespace {

using Source = MetricFunctionSource;
using Kind = MetricPlaceKind;

// Three functions whose names end in _x, _y and _z.
void AddAlongAxes(const MetricFunction& function, std::vector<MetricFunction>& functions) {
  for (const char* axis : {"_x", "_y", "_z"}) {
    MetricFunction& along = functions.emplace_back(function);
    along.name += axis;
  }
}

}  // namespace

const std::vector<MetricFunction>& MetricFunctions() {
  static const std::vector<MetricFunction> functions = [] {
    std::vector<MetricFunction> all;
    all.push_back({"area", "m^2", Source::kShape, 1, Kind::kFace, "Area of a face."});
    AddAlongAxes({"centroid", "m", Source::kShape, 1, Kind::kFaceOrPoint,
                  "Coordinate of a face's centroid, or of a point."},
                 all);
    all.push_back({"distance", "m", Source::kShape, 2, Kind::kFaceOrPoint,
                   "Between two points or centroids of faces."});
    all.push_back({"mean_displacement", "m", Source::kLoads, 1, Kind::kFaceOrPoint,
                   "Length of the displacement, mean over a face, or at a point."});
    AddAlongAxes({"mean_displacement", "m", Source::kLoads, 1, Kind::kFaceOrPoint,
                  "Displacement along an axis, mean over a face, or at a point."},
                 all);
    all.push_back({"max_displacement", "m", Source::kLoads, 1, Kind::kFaceOrPoint,
                   "Largest length of the displacement on a face, or at a point."});
    AddAlongAxes({"max_displacement", "m", Source::kLoads, 1, Kind::kFaceOrPoint,
                  "Displacement along an axis where it is largest on a face, with its sign."},
                 all);
    all.push_back(
        {"mean_von_mises", "Pa", Source::kLoads, 1, Kind::kAny,
         "Von Mises stress, mean over the volume of a part or over a face, or at a point."});
    all.push_back({"max_von_mises", "Pa", Source::kLoads, 1, Kind::kAny,
                   "Largest von Mises stress at any node of a part or a face, or at a point."});
    all.push_back({"rms_von_mises", "Pa", Source::kLoads, 1, Kind::kPart,
                   "Root of the mean of the squared von Mises stress over the volume of a part."});
    all.push_back({"von_mises_p99", "Pa", Source::kLoads, 1, Kind::kPart,
                   "Von Mises stress that 99 % of a part's volume is below."});
    all.push_back({"von_mises_integral", "N m", Source::kLoads, 1, Kind::kPart,
                   "Integral of the von Mises stress over the volume of a part."});
    AddAlongAxes({"reaction", "N", Source::kLoads, 1, Kind::kFace,
                  "Force that a supported face gets from its support."},
                 all);
    AddAlongAxes({"moment", "N m", Source::kLoads, 2, Kind::kFace,
                  "Moment of a supported face's reaction about a second place."},
                 all);
    all.push_back({"mean_temperature", "K", Source::kHeat, 1, Kind::kFaceOrPoint,
                   "Temperature, mean over a face, or at a point."});
    all.push_back({"max_temperature", "K", Source::kHeat, 1, Kind::kFaceOrPoint,
                   "Highest temperature on a face."});
    all.push_back({"min_temperature", "K", Source::kHeat, 1, Kind::kFaceOrPoint,
                   "Lowest temperature on a face."});
    all.push_back({"heat_dissipation", "W", Source::kHeat, 1, Kind::kFace,
                   "Heat that leaves through a face, by convection or where it is kept at a "
                   "temperature."});
    return all;
  }();
  return functions;
}

const MetricFunction* FindMetricFunction(std::string_view name) {
  const auto& all = MetricFunctions();
  const auto found = std::find_if(all.begin(), all.end(), [name](const MetricFunction& function) {
    return function.name == name;
  });
  return found == all.end() ? nullptr : &*found;
}

std::string ToText(const MetricCall& call) {
  std::vector<std::string> arguments = call.places;
  if (!call.load_case.empty()) arguments.push_back(call.load_case);
  return absl::StrCat(call.function->name, "('", absl::StrJoin(arguments, "', '"), "')");
}

}  // namespace mortise::parametric
