#include "services/fabplanner/planning/nearest_parameters.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "services/fabplanner/plan/dimension_text.h"
#include "services/fabplanner/plan/end_cuts.h"

namespace mortise::fabplanner {
namespace {

constexpr int kPoints = 9;          // over the range of a parameter
constexpr double kFewSteps = 1000;  // of a range whose parameter has no step

// The least change of a parameter: its step, or a power of ten.
double StepOf(const DesignParameter& parameter) {
  if (parameter.step > 0) return parameter.step;
  return std::pow(10, std::floor(std::log10((parameter.maximum - parameter.minimum) / kFewSteps)));
}

// The designs along one parameter that were looked at.
class Line {
 public:
  Line(const DesignParameter& parameter, std::size_t index, const PartsAt& parts_at, int* left)
      : parameter_(parameter), index_(index), parts_at_(parts_at), left_(left) {}

  // Returns the value nearest to the design's at which the part has no limit of the kind; nothing
  // if none is found.
  std::optional<double> Nearest(const std::string& part, MachineLimit::Kind kind) {
    std::optional<double> best;
    for (const int direction : {-1, 1}) {
      const std::optional<double> value = NearestTowards(direction, part, kind);
      if (!value) continue;
      if (!best || std::abs(*value - parameter_.value) < std::abs(*best - parameter_.value)) {
        best = value;
      }
    }
    return best;
  }

 private:
  // Whole steps from the parameter's minimum; the design's own value may lie between two.
  double ValueAt(double steps) const {
    return std::min(parameter_.minimum + steps * StepOf(parameter_), parameter_.maximum);
  }

  std::optional<double> NearestTowards(int direction, const std::string& part,
                                       MachineLimit::Kind kind) {
    const double step = StepOf(parameter_);
    const double all = std::floor((parameter_.maximum - parameter_.minimum) / step + 1e-9);
    const double here = (parameter_.value - parameter_.minimum) / step;
    // The whole steps next to the design's value, and the points beyond.
    double without = direction > 0 ? std::floor(here + 1e-9) : std::ceil(here - 1e-9);
    for (int i = 0; i < kPoints; ++i) {
      const int point = direction > 0 ? i : kPoints - 1 - i;
      const double steps = std::round(all * point / (kPoints - 1));
      if ((steps - without) * direction <= 0) continue;
      if (!Does(ValueAt(steps), part, kind)) {
        without = steps;
        continue;
      }
      double with = steps;
      while (std::abs(with - without) > 1.5 && parameter_.choices.empty()) {
        const double middle = std::round((with + without) / 2);
        (Does(ValueAt(middle), part, kind) ? with : without) = middle;
      }
      return ValueAt(with);
    }
    return std::nullopt;
  }

  bool Does(double value, const std::string& part, MachineLimit::Kind kind) {
    const auto [entry, is_new] = known_.try_emplace(value);
    if (is_new && *left_ > 0) {
      --*left_;
      entry->second = parts_at_(index_, value);
    }
    if (!entry->second) return false;
    for (const PlannedPart& planned : *entry->second) {
      if (planned.part != part) continue;
      // A shape that no machine makes at all is no better.
      if (planned.to_shape && planned.beyond_machines.empty()) return false;
      return std::none_of(planned.beyond_machines.begin(), planned.beyond_machines.end(),
                          [&](const MachineLimit& limit) { return limit.kind == kind; });
    }
    return false;  // a design without the part is another design
  }

  const DesignParameter& parameter_;
  std::size_t index_;
  const PartsAt& parts_at_;
  int* left_;
  std::map<double, std::optional<std::vector<PlannedPart>>> known_;
};

// "lean = 0.87 rad (49.8°)", "width = 412 mm", "armrests = none".
std::string ValueText(const DesignParameter& parameter, double value) {
  const std::string is = absl::StrCat(parameter.name, " = ");
  if (!parameter.choices.empty()) {
    const auto chosen = static_cast<std::size_t>(std::llround(value));
    return absl::StrCat(is, chosen < parameter.choices.size() ? parameter.choices[chosen] : "");
  }
  if (parameter.unit == "m") return absl::StrCat(is, Millimetres(value), " mm");
  if (parameter.unit == "rad") {
    return absl::StrCat(is, value, " rad (", DegreesText(value), ")");
  }
  return absl::StrCat(is, value, parameter.unit == "1" ? "" : " ",
                      parameter.unit == "1" ? "" : parameter.unit);
}

}  // namespace

void AddNearestParameters(const std::vector<DesignParameter>& parameters, const PartsAt& parts_at,
                          FabricationPlan* plan) {
  int left = kMostDesigns;
  std::vector<Line> lines;
  lines.reserve(parameters.size());
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    lines.emplace_back(parameters[i], i, parts_at, &left);
  }
  for (PlannedPart& part : plan->parts) {
    for (MachineLimit& limit : part.beyond_machines) {
      std::vector<std::string> texts;
      for (std::size_t i = 0; i < parameters.size(); ++i) {
        if (!(parameters[i].maximum > parameters[i].minimum)) continue;
        const std::optional<double> nearest = lines[i].Nearest(part.part, limit.kind);
        if (!nearest) continue;
        limit.nearest_parameters.emplace_back(parameters[i].name, *nearest);
        texts.push_back(ValueText(parameters[i], *nearest));
      }
      if (texts.empty()) continue;
      const std::string nearest = absl::StrJoin(texts, ", or ");
      absl::StrAppend(&limit.reason, "; it is made by machine with ", nearest);
      plan->handwork.push_back(
          absl::StrCat(part.part, ": its ", limit.place,
                       limit.place.find(';') == std::string::npos ? " is" : " are",
                       " made by machine with ", nearest));
    }
  }
}

}  // namespace mortise::fabplanner
