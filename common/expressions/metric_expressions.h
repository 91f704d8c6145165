// Custom metrics (thesis §6.7, §7.6.2: the force needed for a torque, the mean distance of a
// lamp's beams to a focus): expressions over parameters, other metrics, and functions of named
// faces and points.
//
// Expressions are those of expression.h. What stands in quotes is, as the argument of a function,
// the name of a place (metric_function.h), and by itself a number with its unit, '30 N m'. A plain
// number has no unit: "length - 0.03" is a fault, "length - '30 mm'" is not. Beside == and !=, what
// stands in quotes and is no number is the name of a value: "if(armrests == 'both', mass, 0)", with
// '0 kg' for the 0.
//
// Whether an expression has the unit it claims is found by trying: where everything that is
// measured in metres is doubled, something in m² must be four times as much, whatever the values.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/base/field_violations.h"
#include "common/expressions/expression.h"
#include "common/expressions/metric_function.h"
#include "common/expressions/unit.h"

namespace mortise::parametric {

struct MetricDefinition {
  std::string name;
  std::string unit;
  std::string expression;
  std::string description = {};
};

struct PointDefinition {
  std::string name;
  std::string x, y, z;  // expressions of the parameters, m; 0 where empty
};

struct MetricDefinitions {
  std::vector<MetricDefinition> expressions;
  std::vector<PointDefinition> points;
  bool IsEmpty() const { return expressions.empty() && points.empty(); }
};

// A parameter, or a metric that is computed otherwise.
struct NamedUnit {
  std::string name;
  std::string unit;                       // empty where nobody knows: then it is not checked
  std::vector<std::string> choices = {};  // names of the values of a parameter that is a choice
};

// Can be used from any number of threads.
class MetricExpressions {
 public:
  static constexpr std::size_t kMost = 50;  // expressions, and points, of a template or a request

  // No metrics and no points.
  MetricExpressions() = default;

  // Parses; what is wrong is added to `findings` with its place below `field`
  // ("metric_definitions.expressions[2].expression"), and then nothing else may be called: names
  // that are none or taken, unknown names, functions and units, metrics that depend on themselves,
  // units that do not agree. `earlier` are those that a template has already, checked.
  MetricExpressions(const MetricDefinitions& definitions, const MetricDefinitions& earlier,
                    const std::vector<NamedUnit>& parameters, const std::vector<NamedUnit>& metrics,
                    const std::string& field, std::vector<FieldViolation>& findings);

  // Returns the earlier ones, then the others, in the order in which they were given.
  const std::vector<MetricDefinition>& metrics() const { return definitions_; }

  // Index into metrics(); -1 if it is none of these.
  int Find(const std::string& name) const;

  // What must be known to compute some metrics.
  struct Needs {
    std::vector<std::string> metrics;  // of those computed otherwise, distinct
    std::vector<MetricCall> calls;     // distinct
  };
  // `names` may be those of metrics that are computed otherwise.
  Needs NeedsOf(std::span<const std::string> names) const;

  // Returns the value of the metric of this index, with its gradient where those of `known` have
  // one. `known`: the metrics and calls of `needs`, in their order. INVALID_ARGUMENT naming the
  // expression that has no finite value; where one of `known` failed that it needs, that failure
  // with the expression's name.
  absl::StatusOr<Dual> At(int index, const Eigen::VectorXd& q, bool with_gradient,
                          const Needs& needs, std::span<const absl::StatusOr<Dual>> metrics,
                          std::span<const absl::StatusOr<Dual>> calls) const;

  // A point, and how its coordinates change with each parameter.
  struct PlacedPoint {
    Eigen::Vector3d position;   // m
    Eigen::Matrix3Xd velocity;  // 3 × parameters, m per unit of the parameter
  };
  // Whether there is a point of this name.
  bool HasPoint(const std::string& name) const;
  // Returns the point of this name at `q`; nothing if there is none. INVALID_ARGUMENT naming a
  // coordinate that cannot be computed.
  absl::StatusOr<std::optional<PlacedPoint>> PointAt(const std::string& name,
                                                     const Eigen::VectorXd& q) const;

 private:
  // A name in an expression, and what it stands for.
  struct Variable {
    enum class Kind { kParameter, kMetric, kExpression, kCall, kQuantity };
    Kind kind = Kind::kParameter;
    int index = 0;                            // of the parameter or expression
    std::string name = {};                    // in the expression; of the metric
    MetricCall call = {};                     // of a call
    double value = 0;                         // of a quantity
    std::optional<Dimension> dimension = {};  // nothing where nobody knows
    std::vector<std::string> choices = {};    // of a parameter that is a choice
  };
  struct Parsed {
    std::string field;
    std::string masked;  // the text without quotes
    std::vector<Variable> variables;
    std::optional<Expression> expression;
    std::optional<Dimension> dimension;
  };
  struct Point {
    std::string name;
    std::string field;
    std::array<std::optional<Expression>, 3> coordinates;
  };
  // Everything that has a name already.
  struct Known {
    const std::vector<NamedUnit>& parameters;
    const std::vector<NamedUnit>& metrics;
  };

  void Add(const MetricDefinitions& definitions, const std::string& field, const Known& known,
           std::vector<FieldViolation>& findings);
  void AddPoint(const PointDefinition& point, const std::string& field, const Known& known,
                std::vector<FieldViolation>& findings);
  void Parse(std::size_t index, const Known& known, std::vector<FieldViolation>& findings);
  std::optional<Variable> FindVariable(const std::string& name, const Known& known) const;
  bool Visit(std::size_t index, std::vector<int>& states, std::vector<std::size_t>& path,
             std::vector<FieldViolation>& findings);
  void CheckUnit(std::size_t index, std::vector<FieldViolation>& findings) const;
  std::vector<std::size_t> Behind(std::span<const std::string> names) const;
  absl::StatusOr<Dual> Compute(std::size_t index, const std::vector<absl::StatusOr<Dual>>& values,
                               bool with_gradient, Eigen::Index parameters) const;

  std::vector<MetricDefinition> definitions_;
  std::vector<Parsed> parsed_;
  std::vector<std::size_t> order_;  // of expressions, each after those that it needs
  std::vector<Point> points_;
};

}  // namespace mortise::parametric
