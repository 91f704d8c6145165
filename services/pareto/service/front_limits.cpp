#include "services/pareto/service/front_limits.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/names/offered_names.h"
#include "services/pareto/service/number_text.h"

namespace mortise::pareto {
namespace {

using Values = Eigen::VectorXd;

constexpr double kBand = 0.01;  // about a single value, over what the front reaches

// Of the metric or parameter that is limited, in the order of the points.
Values ValuesOf(const FrontExploration& exploration, const FrontLimit& limit) {
  const FrontPoints& points = exploration.points();
  return (limit.of_metric ? points.metrics : points.parameters).row(limit.index);
}

std::string NameOf(const v1::Front& front, const FrontLimit& limit) {
  const auto& names = limit.of_metric ? front.metric_names() : front.parameter_names();
  return absl::StrCat("'", names.at(static_cast<int>(limit.index)), "'");
}

// With a space before it; nothing of a parameter, whose unit a front does not know.
std::string UnitOf(const v1::Front& front, const FrontLimit& limit) {
  if (!limit.of_metric) return "";
  const std::string& unit = front.metric_units(static_cast<int>(limit.index));
  return unit.empty() ? "" : absl::StrCat(" ", unit);
}

int IndexOf(const std::string& name, const google::protobuf::RepeatedPtrField<std::string>& names) {
  const auto at = std::ranges::find(names, name);
  return at == names.end() ? -1 : static_cast<int>(at - names.begin());
}

// What a limit may be of.
std::vector<std::string> NamesOf(const v1::Front& front) {
  std::vector<std::string> names(front.metric_names().begin(), front.metric_names().end());
  names.insert(names.end(), front.parameter_names().begin(), front.parameter_names().end());
  return names;
}

absl::StatusOr<FrontLimit> ToLimit(const v1::Front& front, const v1::FrontLimit& message,
                                   const std::string& field) {
  FrontLimit limit;
  limit.index = IndexOf(message.name(), front.metric_names());
  limit.of_metric = limit.index >= 0;
  if (!limit.of_metric) limit.index = IndexOf(message.name(), front.parameter_names());
  if (limit.index < 0) {
    return InvalidField(absl::StrCat(field, ".name"),
                        absl::StrCat("the front has no metric or parameter '", message.name(), "'",
                                     NamesOffered(message.name(), NamesOf(front))));
  }
  if (message.has_minimum()) limit.minimum = message.minimum();
  if (message.has_maximum()) limit.maximum = message.maximum();
  if (!std::isfinite(limit.minimum.value_or(0))) {
    return InvalidField(absl::StrCat(field, ".minimum"), "must be a finite number");
  }
  if (!std::isfinite(limit.maximum.value_or(0))) {
    return InvalidField(absl::StrCat(field, ".maximum"), "must be a finite number");
  }
  if (limit.minimum && limit.maximum && *limit.minimum > *limit.maximum) {
    return InvalidField(absl::StrCat(field, ".maximum"), "must not be below the minimum");
  }
  return limit;
}

// Makes a band of a single value, and says so, unless several points have it.
void WidenSingleValue(const v1::Front& front, const Values& values, FrontLimit& limit,
                      std::vector<std::string>& remarks) {
  if (!limit.minimum || !limit.maximum || *limit.minimum != *limit.maximum) return;
  const double value = *limit.minimum;
  if (values.size() == 0 || (values.array() == value).count() > 1) return;
  const double range = values.maxCoeff() - values.minCoeff();
  if (!(range > 0)) return;
  limit.minimum = value - 0.5 * kBand * range;
  limit.maximum = value + 0.5 * kBand * range;
  remarks.push_back(absl::StrCat(NameOf(front, limit), " was to be ", value, UnitOf(front, limit),
                                 ", which points are by chance only: those from ",
                                 TextBeside(*limit.minimum, *limit.maximum), " to ",
                                 TextBeside(*limit.maximum, *limit.minimum),
                                 " were taken, a hundredth of what the front reaches"));
}

// "no point meets the limits of 'mass': the nearest has 18.0003 kg, above 18"; empty if one does.
std::string Nearest(const v1::Front& front, const Values& values, const FrontLimit& limit) {
  double nearest_below = -std::numeric_limits<double>::infinity();
  double nearest_above = std::numeric_limits<double>::infinity();
  for (const double value : values) {
    const bool is_below = limit.minimum && value < *limit.minimum;
    const bool is_above = limit.maximum && value > *limit.maximum;
    if (!is_below && !is_above) return "";
    if (is_below) nearest_below = std::max(nearest_below, value);
    if (is_above) nearest_above = std::min(nearest_above, value);
  }
  std::string text;
  const auto add = [&](double nearest, const char* side, double bound) {
    absl::StrAppend(&text, text.empty() ? "" : ", and ", TextBeside(nearest, bound),
                    UnitOf(front, limit), ", ", side, " ", TextBeside(bound, nearest));
  };
  if (std::isfinite(nearest_below)) add(nearest_below, "below", *limit.minimum);
  if (std::isfinite(nearest_above)) add(nearest_above, "above", *limit.maximum);
  return absl::StrCat("no point meets the limits of ", NameOf(front, limit), ": the nearest has ",
                      text);
}

}  // namespace

absl::StatusOr<FrontLimits> ReadLimits(const v1::Front& front, const FrontExploration& exploration,
                                       const v1::RestrictFrontRequest& request) {
  FrontLimits read;
  for (int i = 0; i < request.limits_size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(FrontLimit limit,
                             ToLimit(front, request.limits(i), absl::StrCat("limits[", i, "]")));
    WidenSingleValue(front, ValuesOf(exploration, limit), limit, read.remarks);
    read.limits.push_back(limit);
  }
  return read;
}

std::vector<std::string> WhyNothingRemains(const v1::Front& front,
                                           const FrontExploration& exploration,
                                           const std::vector<FrontLimit>& limits) {
  if (exploration.size() == 0) return {"the front has no points"};
  std::vector<std::string> reasons;
  for (const FrontLimit& limit : limits) {
    std::string nearest = Nearest(front, ValuesOf(exploration, limit), limit);
    if (!nearest.empty()) reasons.push_back(std::move(nearest));
  }
  if (reasons.empty()) {
    reasons.push_back("each limit by itself leaves points, but none meets all of them");
  }
  return reasons;
}

}  // namespace mortise::pareto
