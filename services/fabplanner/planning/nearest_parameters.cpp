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

// What all parameters share.
struct Search {
  const PartsAt* parts_at;
  int left = kMostDesigns;  // that may still be looked at
  absl::Status lost;        // why designs cannot be looked at any more
};

// The designs along one parameter that were looked at.
class Line {
 public:
  Line(const DesignParameter& parameter, std::size_t index, Search* search)
      : parameter_(parameter), index_(index), search_(search) {}

  // Returns the value nearest to the design's at which the part has no limit of the kind, and none
  // of a kind that it does not have as it is; nothing if none is found.
  std::optional<double> Nearest(const PlannedPart& part, const MachineLimit& limit) {
    std::optional<double> best;
    if (IsSharp(limit) && !DoesAtAnEnd(part, limit.kind)) return best;
    for (const int direction : {-1, 1}) {
      const std::optional<double> value = NearestTowards(direction, part, limit.kind);
      if (!value) continue;
      if (!best || std::abs(*value - parameter_.value) < std::abs(*best - parameter_.value)) {
        best = value;
      }
    }
    return best;
  }

 private:
  // A sharp corner stays one whatever its size: what takes it away does so at an end of its range.
  static bool IsSharp(const MachineLimit& limit) {
    return limit.kind == MachineLimit::Kind::kRadius && limit.value == 0;
  }

  bool DoesAtAnEnd(const PlannedPart& part, MachineLimit::Kind kind) {
    if (!parameter_.choices.empty()) return true;
    return Does(ValueAt(0), part, kind) || Does(ValueAt(AllSteps()), part, kind);
  }

  // The least value that a workshop sets: a multiple of the step, as designs are rounded to these.
  double First() const {
    if (!(parameter_.step > 0)) return parameter_.minimum;
    return std::ceil(parameter_.minimum / parameter_.step - 1e-9) * parameter_.step;
  }

  double AllSteps() const {
    return std::floor((parameter_.maximum - First()) / StepOf(parameter_) + 1e-9);
  }

  // Whole steps from the first value; the design's own may lie between two.
  double ValueAt(double steps) const {
    return std::clamp(First() + steps * StepOf(parameter_), parameter_.minimum, parameter_.maximum);
  }

  std::optional<double> NearestTowards(int direction, const PlannedPart& part,
                                       MachineLimit::Kind kind) {
    const double all = AllSteps();
    const double here = (parameter_.value - First()) / StepOf(parameter_);
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

  bool Does(double value, const PlannedPart& part, MachineLimit::Kind kind) {
    const auto [entry, is_new] = known_.try_emplace(value);
    if (is_new && search_->left > 0 && search_->lost.ok()) {
      --search_->left;
      absl::StatusOr<std::optional<std::vector<PlannedPart>>> parts =
          (*search_->parts_at)(index_, value);
      search_->lost = parts.status();
      if (parts.ok()) entry->second = *std::move(parts);
    }
    if (!entry->second) return false;
    for (const PlannedPart& planned : *entry->second) {
      if (planned.part != part.part) continue;
      // A shape that no machine makes at all is no better.
      if (planned.to_shape && planned.beyond_machines.empty()) return false;
      return std::ranges::all_of(planned.beyond_machines, [&](const MachineLimit& limit) {
        return limit.kind != kind && Has(part, limit.kind);
      });
    }
    return false;  // a design without the part is another design
  }

  static bool Has(const PlannedPart& part, MachineLimit::Kind kind) {
    return std::ranges::any_of(part.beyond_machines,
                               [&](const MachineLimit& limit) { return limit.kind == kind; });
  }

  const DesignParameter& parameter_;
  std::size_t index_;
  Search* search_;
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

absl::Status AddNearestParameters(const std::vector<DesignParameter>& parameters,
                                  const PartsAt& parts_at, FabricationPlan* plan) {
  Search search{.parts_at = &parts_at, .lost = absl::OkStatus()};
  std::vector<Line> lines;
  lines.reserve(parameters.size());
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    lines.emplace_back(parameters[i], i, &search);
  }
  for (PlannedPart& part : plan->parts) {
    for (MachineLimit& limit : part.beyond_machines) {
      std::vector<std::string> texts;
      for (std::size_t i = 0; i < parameters.size(); ++i) {
        if (!(parameters[i].maximum > parameters[i].minimum)) continue;
        const std::optional<double> nearest = lines[i].Nearest(part, limit);
        if (!search.lost.ok()) return search.lost;
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
  return absl::OkStatus();
}

}  // namespace mortise::fabplanner
