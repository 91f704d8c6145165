#include "services/interpolator/service/map_optimum.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/names/offered_names.h"
#include "common/base/string_views.h"
#include "common/evaluation/parameter_number.h"
#include "common/expressions/expression.h"
#include "services/interpolator/optimization/map_optimization.h"

namespace mortise::interpolator {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kMaxLimits = 32;
constexpr int kMaxStarts = 200;     // in one structure
constexpr int kMaxSearches = 2000;  // of all structures, some seconds
constexpr int kDefaultStarts = 16;

// The numbers that an objective speaks of: the map's P parameters, those that are fixed, its
// metrics.
std::vector<std::string> NamesOf(const v1::DesignMap& map) {
  std::vector<std::string> names;
  for (const v1::MapParameter& parameter : map.parameters()) names.push_back(parameter.name());
  for (const v1::ParameterValue& fixed : map.fixed()) names.push_back(fixed.name());
  for (const v1::MapMetric& metric : map.metrics()) names.push_back(metric.name());
  return names;
}

absl::StatusOr<parametric::Expression> ReadObjective(const v1::DesignMap& map,
                                                     const v1::OptimizeMapRequest& asked) {
  auto objective = parametric::Expression::Parse(asked.objective(), NamesOf(map));
  if (!objective.ok()) return InvalidField("objective", StandardView(objective.status().message()));
  return objective;
}

absl::StatusOr<std::vector<MetricLimit>> ReadLimits(const v1::DesignMap& map,
                                                    const v1::OptimizeMapRequest& asked) {
  if (asked.limits_size() > kMaxLimits) {
    return InvalidField("limits", absl::StrCat("are more than ", kMaxLimits));
  }
  std::vector<MetricLimit> limits;
  std::set<std::string> names;
  for (int i = 0; i < asked.limits_size(); ++i) {
    const v1::OptimizeMapRequest::Limit& limit = asked.limits(i);
    const std::string field = absl::StrCat("limits[", i, "]");
    const auto metric = std::ranges::find(map.metrics(), limit.metric(), &v1::MapMetric::name);
    if (metric == map.metrics().end()) {
      return InvalidField(
          field + ".metric",
          absl::StrCat("the map has no metric '", limit.metric(), "'",
                       NamesOffered(limit.metric(), map.metrics(), &v1::MapMetric::name)));
    }
    if (!names.insert(limit.metric()).second) {
      return InvalidField(field + ".metric", "is limited twice");
    }
    if (!limit.has_minimum() && !limit.has_maximum()) {
      return InvalidField(field, "must have a minimum or a maximum");
    }
    if (limit.has_minimum() && limit.has_maximum() && limit.minimum() > limit.maximum()) {
      return InvalidField(field + ".maximum", "lies below the minimum");
    }
    MetricLimit read;
    read.metric = metric - map.metrics().begin();
    if (limit.has_minimum()) read.minimum = limit.minimum();
    if (limit.has_maximum()) read.maximum = limit.maximum();
    limits.push_back(read);
  }
  return limits;
}

// What parameters of the map are held at: one for each, none where it varies.
absl::StatusOr<std::vector<std::optional<double>>> ReadFixed(const v1::DesignMap& map,
                                                             const v1::OptimizeMapRequest& asked) {
  std::vector<std::optional<double>> held(static_cast<std::size_t>(map.parameters_size()));
  for (int i = 0; i < asked.fixed_size(); ++i) {
    const v1::ParameterValue& fixed = asked.fixed(i);
    const std::string field = absl::StrCat("fixed[", i, "]");
    const auto at = std::ranges::find(map.parameters(), fixed.name(), &v1::MapParameter::name);
    if (at == map.parameters().end()) {
      return InvalidField(field + ".name",
                          absl::StrCat("'", fixed.name(), "' does not vary over the map"));
    }
    std::optional<double>& value = held[static_cast<std::size_t>(at - map.parameters().begin())];
    if (value) return InvalidField(field + ".name", "is fixed twice");
    MORTISE_ASSIGN_OR_RETURN(const double number,
                             evaluation::NumberOf(fixed, at->choices(), field));
    if (number < at->minimum() || number > at->maximum()) {
      return InvalidField(field + ".value",
                          absl::StrCat("'", fixed.name(), "' goes from ", at->minimum(), " to ",
                                       at->maximum(), " on the map"));
    }
    value = number;
  }
  return held;
}

// A structure with the bounds of its parameters and of what is fixed.
struct StructureBounds {
  VectorXd lower;
  VectorXd upper;
};

// None where what is held excludes the structure.
std::optional<StructureBounds> BoundsOf(const v1::DesignMap& map, int structure,
                                        const std::vector<std::optional<double>>& held) {
  const Index varying = map.parameters_size();
  StructureBounds bounds{VectorXd(varying + map.fixed_size()),
                         VectorXd(varying + map.fixed_size())};
  int whole = 0;
  for (Index p = 0; p < varying; ++p) {
    const v1::MapParameter& parameter = map.parameters(static_cast<int>(p));
    const std::optional<double>& value = held[static_cast<std::size_t>(p)];
    if (parameter.whole()) {
      const double own = map.structures(structure).values(whole++).value();
      if (value && *value != own) return std::nullopt;
      bounds.lower(p) = bounds.upper(p) = own;
    } else {
      bounds.lower(p) = value.value_or(parameter.minimum());
      bounds.upper(p) = value.value_or(parameter.maximum());
    }
  }
  for (int f = 0; f < map.fixed_size(); ++f) {
    bounds.lower(varying + f) = bounds.upper(varying + f) = map.fixed(f).value();
  }
  return bounds;
}

// The map of one structure over its parameters and what is fixed, which nothing depends on.
class StructureFunction {
 public:
  StructureFunction(const v1::DesignMap& map, const maps::InterpolationMap& structure,
                    const std::function<bool()>& is_given_up)
      : map_(map), structure_(structure), is_given_up_(is_given_up) {}

  absl::StatusOr<PointMetrics> operator()(const VectorXd& parameters, bool gradients) const {
    if (is_given_up_()) return absl::CancelledError("given up");
    const Index varying = map_.parameters_size(), numbers = structure_.dimension();
    VectorXd place(numbers);
    Index row = 0;
    for (Index p = 0; p < varying; ++p) {
      const v1::MapParameter& parameter = map_.parameters(static_cast<int>(p));
      if (!parameter.whole())
        place(row++) = (parameters(p) - parameter.minimum()) / Range(parameter);
    }
    PointMetrics values;
    values.metrics.resize(structure_.outputs());
    VectorXd slopes(gradients ? structure_.outputs() * numbers : 0);
    if (!structure_.EvaluateOne(place.data(), values.metrics.data(), nullptr,
                                gradients ? slopes.data() : nullptr)) {
      return absl::OutOfRangeError("the map has no values there");
    }
    if (gradients) values.gradients = Gradients(slopes, parameters.size());
    return values;
  }

 private:
  static double Range(const v1::MapParameter& parameter) {
    return parameter.maximum() - parameter.minimum();
  }

  // From the numbers' unit box to all parameters in SI units.
  Eigen::MatrixXd Gradients(const VectorXd& slopes, Index parameters) const {
    Eigen::MatrixXd gradients = Eigen::MatrixXd::Zero(structure_.outputs(), parameters);
    Index row = 0;
    for (Index p = 0; p < map_.parameters_size(); ++p) {
      const v1::MapParameter& parameter = map_.parameters(static_cast<int>(p));
      if (parameter.whole()) continue;
      for (Index m = 0; m < structure_.outputs(); ++m) {
        gradients(m, p) = slopes(m * structure_.dimension() + row) / Range(parameter);
      }
      ++row;
    }
    return gradients;
  }

  const v1::DesignMap& map_;
  const maps::InterpolationMap& structure_;
  const std::function<bool()>& is_given_up_;
};

// A metric that is the same everywhere ranges over what it is.
VectorXd RangesOf(const v1::DesignMap& map) {
  VectorXd ranges(map.metrics_size());
  for (int m = 0; m < map.metrics_size(); ++m) {
    const double range = map.metrics(m).maximum() - map.metrics(m).minimum();
    const double size = std::abs(map.metrics(m).maximum());
    ranges(m) = range > 0 ? range : size > 0 ? size : 1;
  }
  return ranges;
}

absl::StatusOr<int> ReadStarts(const v1::OptimizeMapRequest& asked, int structures) {
  const int starts = asked.starts() == 0 ? kDefaultStarts : asked.starts();
  if (starts < 1 || starts > kMaxStarts) {
    return InvalidField("starts", absl::StrCat("must be 1 to ", kMaxStarts));
  }
  if (starts * structures > kMaxSearches) {
    return InvalidField(
        "starts",
        absl::StrCat("with ", structures, " structures, at most ", kMaxSearches / structures,
                     " are possible: fix whole numbers and choices for more"));
  }
  return starts;
}

bool IsBetter(const MapOptimum& a, const MapOptimum& b, bool maximize) {
  if (a.violation != b.violation) return a.violation < b.violation;
  return maximize ? a.objective > b.objective : a.objective < b.objective;
}

v1::OptimizeMapResponse ToResponse(const LoadedMap& map, std::size_t structure,
                                   const MapOptimum& optimum) {
  const v1::DesignMap& record = map.record;
  v1::OptimizeMapResponse response;
  VectorXd place(map.structures[structure].dimension());
  Index row = 0;
  for (int p = 0; p < record.parameters_size(); ++p) {
    const v1::MapParameter& parameter = record.parameters(p);
    response.add_parameters(optimum.parameters(p));
    if (parameter.whole()) continue;
    place(row++) =
        (optimum.parameters(p) - parameter.minimum()) / (parameter.maximum() - parameter.minimum());
  }
  VectorXd values(record.metrics_size()), errors(record.metrics_size());
  map.structures[structure].EvaluateOne(place.data(), values.data(), errors.data(), nullptr);
  for (int p = 0; p < record.parameters_size() + record.fixed_size(); ++p) {
    v1::ParameterValue& value = *response.add_design();
    const int fixed = p - record.parameters_size();
    value.set_name(fixed < 0 ? record.parameters(p).name() : record.fixed(fixed).name());
    value.set_value(optimum.parameters(p));
  }
  for (int m = 0; m < record.metrics_size(); ++m) {
    response.add_metrics(record.metrics(m).name());
    response.add_units(record.metrics(m).unit());
    response.add_values(values(m));
    response.add_errors(errors(m));
  }
  response.set_objective(optimum.objective);
  response.set_violation(optimum.violation);
  response.set_starts(optimum.starts);
  response.set_starts_that_agree(optimum.starts_that_agree);
  return response;
}

}  // namespace

absl::StatusOr<v1::OptimizeMapResponse> FindOptimum(const LoadedMap& map,
                                                    const v1::OptimizeMapRequest& asked,
                                                    const std::function<bool()>& is_given_up) {
  const v1::DesignMap& record = map.record;
  MORTISE_ASSIGN_OR_RETURN(const parametric::Expression objective, ReadObjective(record, asked));
  MORTISE_ASSIGN_OR_RETURN(const std::vector<MetricLimit> limits, ReadLimits(record, asked));
  MORTISE_ASSIGN_OR_RETURN(const auto held, ReadFixed(record, asked));
  std::vector<std::pair<std::size_t, StructureBounds>> structures;
  for (std::size_t s = 0; s < map.structures.size(); ++s) {
    auto bounds = BoundsOf(record, static_cast<int>(s), held);
    if (bounds) structures.emplace_back(s, *std::move(bounds));
  }
  if (structures.empty()) return InvalidField("fixed", "no structure of the map has these values");
  MORTISE_ASSIGN_OR_RETURN(const int starts,
                           ReadStarts(asked, static_cast<int>(structures.size())));
  std::optional<MapOptimum> best;
  std::size_t best_structure = 0;
  absl::Status reason;
  for (const auto& [structure, bounds] : structures) {
    auto optimum = Optimize({.lower = bounds.lower,
                             .upper = bounds.upper,
                             .ranges = RangesOf(record),
                             .objective = objective,
                             .maximize = asked.maximize(),
                             .limits = limits,
                             .starts = starts,
                             .seed = static_cast<std::uint64_t>(asked.seed())},
                            StructureFunction(record, map.structures[structure], is_given_up));
    if (absl::IsInvalidArgument(optimum.status())) {
      reason = InvalidField("objective", StandardView(optimum.status().message()));
    } else if (absl::IsOutOfRange(optimum.status())) {
      reason = PreconditionFailed("MAP_UNCOVERED", StandardView(optimum.status().message()));
    } else if (!optimum.ok()) {
      return optimum.status();
    } else if (!best || IsBetter(*optimum, *best, asked.maximize())) {
      best = *std::move(optimum);
      best_structure = structure;
    }
  }
  if (!best) return reason;
  return ToResponse(map, best_structure, *best);
}

}  // namespace mortise::interpolator
