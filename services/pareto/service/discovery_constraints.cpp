// Checks of constraints, and what is said of them.
#include "services/pareto/service/discovery_constraints.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "mortise/v1/pareto.pb.h"
#include "services/pareto/service/number_text.h"

namespace mortise::pareto {
namespace {

constexpr int kMaxConstraints = 32;
constexpr double kBand = 1e-3;   // about a single value, over its size
constexpr double kLeast = 1e-6;  // between two limits, over their size

std::string WithUnit(const std::string& number, const std::string& unit) {
  return unit.empty() ? number : absl::StrCat(number, " ", unit);
}

// A minimum and a maximum that evaluations can be told to lie between.
absl::Status CheckDistance(double minimum, double maximum, const std::string& field) {
  if (minimum > maximum) return InvalidField(field, "lies below the minimum");
  const double size = std::max(std::abs(minimum), std::abs(maximum));
  if (size == 0) {
    return InvalidField(field,
                        "is the minimum, 0: designs meet a single value by chance only, and 0 has "
                        "no size that a band about it could be a part of. Give a minimum below "
                        "and a maximum above it");
  }
  if (minimum == maximum || maximum - minimum >= kLeast * size) return absl::OkStatus();
  return InvalidField(
      field,
      absl::StrCat(TextBeside(maximum, minimum), " is so little above the minimum ",
                   TextBeside(minimum, maximum),
                   " that designs lie between by chance only. Leave at least ", kLeast * size,
                   " between them, a millionth of their size; or give one "
                   "value for both, for a band of a thousandth about it"));
}

}  // namespace

void Constraint::WidenSingleValue() {
  if (!minimum || !maximum || *minimum != *maximum) return;
  single_value = *minimum;
  const double half = 0.5 * kBand * std::abs(*single_value);
  minimum = *single_value - half;
  maximum = *single_value + half;
}

void Constraint::AppendTo(double value, std::vector<double>& rows) const {
  if (maximum) rows.push_back(value - *maximum);
  if (minimum) rows.push_back(*minimum - value);
}

double Constraint::ValueOf(double row) const { return maximum ? row + *maximum : *minimum - row; }

std::vector<std::string> Constraint::Missed(const Eigen::Ref<const Eigen::VectorXd>& rows) const {
  std::vector<std::string> missed;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto miss = [&](double value, const char* side, double limit) {
    missed.push_back(absl::StrCat(metric, " is ", WithUnit(TextBeside(value, limit), unit),
                                  ", not at ", side, " ", TextBeside(limit, value)));
  };
  Eigen::Index row = 0;
  // By however little: rounded, the value might be its limit.
  if (maximum) {
    const double over = rows[row++];
    const double least = std::nextafter(*maximum, kInfinity);
    if (over > 0) miss(std::max(over + *maximum, least), "most", *maximum);
  }
  if (minimum) {
    const double most = std::nextafter(*minimum, -kInfinity);
    if (rows[row] > 0) miss(std::min(*minimum - rows[row], most), "least", *minimum);
  }
  return missed;
}

absl::Status CheckConstraints(const v1::DiscoverySpecification& specification) {
  if (specification.constraints_size() > kMaxConstraints) {
    return InvalidField("specification.constraints",
                        absl::StrCat("at most ", kMaxConstraints, " are possible, not ",
                                     specification.constraints_size()));
  }
  std::set<std::string> names;
  for (int k = 0; k < specification.constraints_size(); ++k) {
    const auto& constraint = specification.constraints(k);
    const std::string field = absl::StrCat("specification.constraints[", k, "]");
    if (!names.insert(constraint.metric()).second) {
      return InvalidField(absl::StrCat(field, ".metric"), "is given twice");
    }
    if (!constraint.has_minimum() && !constraint.has_maximum()) {
      return InvalidField(absl::StrCat(field, ".maximum"), "a minimum or a maximum is needed");
    }
    if (!std::isfinite(constraint.minimum())) {
      return InvalidField(absl::StrCat(field, ".minimum"), "must be a finite number");
    }
    if (!std::isfinite(constraint.maximum())) {
      return InvalidField(absl::StrCat(field, ".maximum"), "must be a finite number");
    }
    if (constraint.has_minimum() && constraint.has_maximum()) {
      MORTISE_RETURN_IF_ERROR(CheckDistance(constraint.minimum(), constraint.maximum(),
                                            absl::StrCat(field, ".maximum")));
    }
  }
  return absl::OkStatus();
}

std::string MissedByNearest(const std::vector<Constraint>& constraints, const Archive& archive) {
  std::size_t nearest = archive.size();
  for (std::size_t entry = 0; entry < archive.size(); ++entry) {
    if (!archive[entry].evaluated) continue;
    if (nearest == archive.size() || archive.Violation(entry) < archive.Violation(nearest)) {
      nearest = entry;
    }
  }
  const Eigen::VectorXd& rows = archive[nearest].constraints;
  std::vector<std::string> missed;
  Eigen::Index row = 0;
  for (const Constraint& constraint : constraints) {
    for (std::string& one : constraint.Missed(rows.segment(row, constraint.rows()))) {
      missed.push_back(std::move(one));
    }
    row += constraint.rows();
  }
  return absl::StrJoin(missed, "; ");
}

std::vector<std::string> BandRemarks(const std::vector<Constraint>& constraints) {
  std::vector<std::string> remarks;
  for (const Constraint& constraint : constraints) {
    if (!constraint.single_value) continue;
    remarks.push_back(absl::StrCat(
        "'", constraint.metric, "' was to be ",
        WithUnit(absl::StrCat(*constraint.single_value), constraint.unit),
        ", which designs are by chance only: those from ",
        TextBeside(*constraint.minimum, *constraint.maximum), " to ",
        TextBeside(*constraint.maximum, *constraint.minimum), ", a thousandth of it, were taken"));
  }
  return remarks;
}

}  // namespace mortise::pareto
