// Values and gradients of custom metrics, once they are parsed.
#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "common/base/errors.h"
#include "common/expressions/metric_expressions.h"

namespace mortise::parametric {
namespace {

absl::StatusOr<Dual> AsConstant(double value, bool with_gradient, Eigen::Index parameters) {
  return Dual{value, Eigen::VectorXd::Zero(with_gradient ? parameters : 0)};
}

}  // namespace

int MetricExpressions::Find(const std::string& name) const {
  for (std::size_t i = 0; i < definitions_.size(); ++i) {
    if (definitions_[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

std::vector<std::size_t> MetricExpressions::Behind(std::span<const std::string> names) const {
  std::vector<bool> is_needed(definitions_.size(), false);
  for (const std::string& name : names) {
    if (const int i = Find(name); i >= 0) is_needed[static_cast<std::size_t>(i)] = true;
  }
  std::vector<std::size_t> behind;
  for (auto i = order_.rbegin(); i != order_.rend(); ++i) {
    if (!is_needed[*i]) continue;
    behind.push_back(*i);
    for (const Variable& variable : parsed_[*i].variables) {
      if (variable.kind == Variable::Kind::kExpression) {
        is_needed[static_cast<std::size_t>(variable.index)] = true;
      }
    }
  }
  std::reverse(behind.begin(), behind.end());
  return behind;
}

MetricExpressions::Needs MetricExpressions::NeedsOf(std::span<const std::string> names) const {
  Needs needs;
  const auto add = [](auto& list, const auto& entry) {
    if (std::find(list.begin(), list.end(), entry) == list.end()) list.push_back(entry);
  };
  for (const std::string& name : names) {
    if (Find(name) < 0) add(needs.metrics, name);
  }
  for (const std::size_t i : Behind(names)) {
    for (const Variable& variable : parsed_[i].variables) {
      if (variable.kind == Variable::Kind::kMetric) add(needs.metrics, variable.name);
      if (variable.kind == Variable::Kind::kCall) add(needs.calls, variable.call);
    }
  }
  return needs;
}

// `values`: of the variables.
absl::StatusOr<Dual> MetricExpressions::Compute(std::size_t index,
                                                const std::vector<absl::StatusOr<Dual>>& values,
                                                bool with_gradient, Eigen::Index parameters) const {
  const Parsed& parsed = parsed_[index];
  const MetricDefinition& definition = definitions_[index];
  const std::string field = parsed.field + ".expression";
  Eigen::VectorXd at(static_cast<Eigen::Index>(values.size()));
  for (std::size_t v = 0; v < values.size(); ++v) {
    const absl::StatusOr<Dual>& value = values[v];
    if (!value.ok()) {
      return WithDetail(
          absl::Status(value.status().code(),
                       absl::StrCat("'", definition.name, "': ", value.status().message())),
          DetailOf(value.status()));
    }
    at[static_cast<Eigen::Index>(v)] = value->value;
  }
  const auto fault = [&](const absl::Status& status) {
    return InvalidField(
        field,
        absl::StrCat("'", definition.name, "': ",
                     absl::StrReplaceAll(status.message(), {{parsed.masked, definition.expression},
                                                            {" at these parameters", ""}})));
  };
  if (!with_gradient) {
    const auto value = parsed.expression->Value(at);
    if (!value.ok()) return fault(value.status());
    return Dual{*value, {}};
  }
  const auto own = parsed.expression->ValueAndGradient(at);
  if (!own.ok()) return fault(own.status());
  Dual dual{own->value, Eigen::VectorXd::Zero(parameters)};
  for (std::size_t v = 0; v < values.size(); ++v) {
    const double outer = own->gradient[static_cast<Eigen::Index>(v)];
    if (outer != 0) dual.gradient += outer * values[v]->gradient;
  }
  return dual;
}

absl::StatusOr<Dual> MetricExpressions::At(int index, const Eigen::VectorXd& q, bool with_gradient,
                                           const Needs& needs,
                                           std::span<const absl::StatusOr<Dual>> metrics,
                                           std::span<const absl::StatusOr<Dual>> calls) const {
  std::vector<std::optional<absl::StatusOr<Dual>>> known(definitions_.size());
  const std::string& name = definitions_[static_cast<std::size_t>(index)].name;
  for (const std::size_t i : Behind(std::span(&name, 1))) {
    std::vector<absl::StatusOr<Dual>> values;
    for (const Variable& variable : parsed_[i].variables) {
      switch (variable.kind) {
        case Variable::Kind::kParameter: {
          auto& value = values.emplace_back(AsConstant(q[variable.index], with_gradient, q.size()));
          if (with_gradient) value->gradient[variable.index] = 1;
          break;
        }
        case Variable::Kind::kMetric: {
          const auto at = std::find(needs.metrics.begin(), needs.metrics.end(), variable.name);
          values.push_back(metrics[static_cast<std::size_t>(at - needs.metrics.begin())]);
          break;
        }
        case Variable::Kind::kExpression:
          values.push_back(*known[static_cast<std::size_t>(variable.index)]);
          break;
        case Variable::Kind::kCall: {
          const auto at = std::find(needs.calls.begin(), needs.calls.end(), variable.call);
          values.push_back(calls[static_cast<std::size_t>(at - needs.calls.begin())]);
          break;
        }
        case Variable::Kind::kQuantity:
          values.push_back(AsConstant(variable.value, with_gradient, q.size()));
          break;
      }
    }
    known[i] = Compute(i, values, with_gradient, q.size());
  }
  return *known[static_cast<std::size_t>(index)];
}

bool MetricExpressions::HasPoint(const std::string& name) const {
  return std::any_of(points_.begin(), points_.end(),
                     [&name](const Point& point) { return point.name == name; });
}

absl::StatusOr<std::optional<MetricExpressions::PlacedPoint>> MetricExpressions::PointAt(
    const std::string& name, const Eigen::VectorXd& q) const {
  for (const Point& point : points_) {
    if (point.name != name) continue;
    PlacedPoint placed{Eigen::Vector3d::Zero(), Eigen::Matrix3Xd::Zero(3, q.size())};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!point.coordinates[axis]) continue;
      const auto coordinate = point.coordinates[axis]->ValueAndGradient(q);
      if (!coordinate.ok()) {
        return InvalidField(absl::StrCat(point.field, ".", std::string(1, "xyz"[axis])),
                            absl::StrCat("'", name, "': ", coordinate.status().message()));
      }
      placed.position[static_cast<Eigen::Index>(axis)] = coordinate->value;
      placed.velocity.row(static_cast<Eigen::Index>(axis)) = coordinate->gradient.transpose();
    }
    return placed;
  }
  return std::nullopt;
}

}  // namespace mortise::parametric
