#include "common/expressions/metric_expressions.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "common/base/errors.h"
#include "common/expressions/identifier.h"
#include "common/expressions/metric_text.h"

namespace mortise::parametric {
namespace {

constexpr std::size_t kMaxDescriptionLength = 1000;  // bytes
constexpr const char* kNameRule =
    "must be 1 to 63 lower-case letters, digits and underscores, beginning with a letter, and no "
    "word of the expression language";

// Nothing where nobody says, or it is no unit.
std::optional<Dimension> DimensionOf(const std::string& unit) {
  if (unit.empty()) return std::nullopt;
  auto parsed = ParseUnit(unit);
  if (!parsed.ok()) return std::nullopt;
  return std::move(parsed->dimension);
}

// The names that occur in a text, each once.
std::vector<std::string> WordsOf(const std::string& text) {
  const auto is_letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
  };
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  std::vector<std::string> words;
  for (std::size_t i = 0; i < text.size();) {
    std::size_t end = i + 1;
    if (text[i] == '\'') {  // the value of a choice
      i = std::min(text.find('\'', end), text.size() - 1) + 1;
      continue;
    }
    const bool is_number = is_digit(text[i]) || text[i] == '.';
    if (is_letter(text[i]) || is_number) {
      while (end < text.size() && (is_letter(text[end]) || is_digit(text[end]))) ++end;
    }
    if (is_letter(text[i])) words.push_back(text.substr(i, end - i));
    i = end;
  }
  std::sort(words.begin(), words.end());
  words.erase(std::unique(words.begin(), words.end()), words.end());
  return words;
}

// The metrics that every design has, but those whose names a template has given to its own: it was
// stored before there was such a metric, and its name goes on meaning its own.
std::vector<NamedUnit> WithoutOwn(std::vector<NamedUnit> metrics,
                                  const std::vector<MetricDefinition>& own) {
  std::erase_if(metrics, [&own](const NamedUnit& metric) {
    return std::ranges::find(own, metric.name, &MetricDefinition::name) != own.end();
  });
  return metrics;
}

void CheckNoWords(const MetricDefinitions& definitions, const std::string& field,
                  std::vector<FieldViolation>& findings) {
  for (std::size_t i = 0; i < definitions.expressions.size(); ++i) {
    if (!IsReserved(definitions.expressions[i].name)) continue;
    findings.push_back({absl::StrCat(field, ".expressions[", i, "].name"), kNameRule});
  }
}

}  // namespace

MetricExpressions::MetricExpressions(const MetricDefinitions& definitions,
                                     const MetricDefinitions& earlier,
                                     const std::vector<NamedUnit>& parameters,
                                     const std::vector<NamedUnit>& metrics,
                                     const std::string& field,
                                     std::vector<FieldViolation>& findings) {
  const std::vector<NamedUnit> others = WithoutOwn(metrics, earlier.expressions);
  const Known known{parameters, others};
  // Not of the earlier ones: the language has grown, and what is a word today was a name when the
  // template was stored.
  CheckNoWords(definitions, field, findings);
  Add(earlier, "the template's " + field, known, findings);
  Add(definitions, field, known, findings);
  if (!findings.empty()) return;
  for (std::size_t i = 0; i < definitions_.size(); ++i) Parse(i, known, findings);
  if (!findings.empty()) return;
  std::vector<int> states(definitions_.size(), 0);
  std::vector<std::size_t> path;
  for (std::size_t i = 0; i < definitions_.size(); ++i) {
    if (!Visit(i, states, path, findings)) return;
  }
  for (std::size_t i = 0; i < definitions_.size(); ++i) CheckUnit(i, findings);
}

void MetricExpressions::Add(const MetricDefinitions& definitions, const std::string& field,
                            const Known& known, std::vector<FieldViolation>& findings) {
  for (const auto& [size, name] : {std::pair{definitions.expressions.size(), "expressions"},
                                   std::pair{definitions.points.size(), "points"}}) {
    if (size <= kMost) continue;
    findings.push_back(
        {absl::StrCat(field, ".", name), absl::StrCat("has ", size, "; at most ", kMost)});
    return;
  }
  for (std::size_t i = 0; i < definitions.expressions.size(); ++i) {
    const MetricDefinition& metric = definitions.expressions[i];
    const std::string place = absl::StrCat(field, ".expressions[", i, "]");
    const auto is_taken = [&metric](const auto& other) { return other.name == metric.name; };
    if (!IsMeasureName(metric.name)) {
      findings.push_back({place + ".name", kNameRule});
    } else if (std::any_of(known.parameters.begin(), known.parameters.end(), is_taken)) {
      findings.push_back({place + ".name", absl::StrCat("'", metric.name, "' is a parameter")});
    } else if (std::any_of(known.metrics.begin(), known.metrics.end(), is_taken) ||
               Find(metric.name) >= 0) {
      findings.push_back(
          {place + ".name", absl::StrCat("'", metric.name, "' is a metric already")});
    }
    if (metric.description.size() > kMaxDescriptionLength) {
      findings.push_back({place + ".description",
                          absl::StrCat("is longer than ", kMaxDescriptionLength, " bytes")});
    }
    definitions_.push_back(metric);
    Parsed& parsed = parsed_.emplace_back();
    parsed.field = place;
    const auto unit = ParseUnit(metric.unit);
    if (unit.ok() && unit->factor == 1) {
      parsed.dimension = unit->dimension;
    } else {
      findings.push_back({place + ".unit", unit.ok() ? absl::StrCat("must be an SI unit; '",
                                                                    metric.unit, "' is none")
                                                     : std::string(unit.status().message())});
    }
  }
  for (std::size_t i = 0; i < definitions.points.size(); ++i) {
    AddPoint(definitions.points[i], absl::StrCat(field, ".points[", i, "]"), known, findings);
  }
}

void MetricExpressions::AddPoint(const PointDefinition& definition, const std::string& field,
                                 const Known& known, std::vector<FieldViolation>& findings) {
  const auto is_taken = [&](const Point& other) { return other.name == definition.name; };
  if (!IsIdentifier(definition.name)) {
    findings.push_back(
        {field + ".name", "must be a letter or underscore, then letters, digits and underscores"});
  } else if (std::any_of(points_.begin(), points_.end(), is_taken)) {
    findings.push_back({field + ".name", absl::StrCat("'", definition.name, "' occurs twice")});
  }
  std::vector<ExpressionName> names;
  for (const NamedUnit& parameter : known.parameters) {
    names.push_back({parameter.name, DimensionOf(parameter.unit), parameter.choices});
  }
  Point& point = points_.emplace_back(Point{definition.name, field, {}});
  const std::array<const std::string*, 3> texts{&definition.x, &definition.y, &definition.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (texts[axis]->empty()) continue;
    auto parsed = Expression::Parse(*texts[axis], names);
    if (parsed.ok()) {
      point.coordinates[axis] = *std::move(parsed);
    } else {
      findings.push_back({absl::StrCat(field, ".", std::string(1, "xyz"[axis])),
                          absl::StrCat("'", definition.name, "': ", parsed.status().message())});
    }
  }
}

std::optional<MetricExpressions::Variable> MetricExpressions::FindVariable(
    const std::string& name, const Known& known) const {
  using Kind = Variable::Kind;
  for (std::size_t i = 0; i < known.parameters.size(); ++i) {
    const NamedUnit& parameter = known.parameters[i];
    if (parameter.name != name) continue;
    return Variable{.kind = Kind::kParameter,
                    .index = static_cast<int>(i),
                    .name = name,
                    .dimension = DimensionOf(parameter.unit),
                    .choices = parameter.choices};
  }
  for (const NamedUnit& metric : known.metrics) {
    if (metric.name != name) continue;
    return Variable{.kind = Kind::kMetric, .name = name, .dimension = DimensionOf(metric.unit)};
  }
  const int expression = Find(name);
  if (expression < 0) return std::nullopt;
  return Variable{.kind = Kind::kExpression,
                  .index = expression,
                  .name = name,
                  .dimension = parsed_[static_cast<std::size_t>(expression)].dimension};
}

void MetricExpressions::Parse(std::size_t index, const Known& known,
                              std::vector<FieldViolation>& findings) {
  Parsed& parsed = parsed_[index];
  const MetricDefinition& definition = definitions_[index];
  const auto fail = [&](const std::string& message) {
    findings.push_back(
        {parsed.field + ".expression", absl::StrCat("'", definition.name, "': ", message)});
  };
  const auto read = ReadMetricText(definition.expression);
  if (!read.ok()) return fail(std::string(read.status().message()));
  parsed.masked = read->text;
  for (const QuotedTerm& term : read->terms) {
    const bool is_call = term.call.function != nullptr;
    parsed.variables.push_back(
        {.kind = is_call ? Variable::Kind::kCall : Variable::Kind::kQuantity,
         .name = term.name,
         .call = term.call,
         .value = term.quantity.value,
         .dimension = is_call ? DimensionOf(term.call.function->unit) : term.quantity.dimension});
  }
  for (const std::string& word : WordsOf(parsed.masked)) {
    if (std::optional<Variable> variable = FindVariable(word, known)) {
      parsed.variables.push_back(*std::move(variable));
    }
  }
  std::vector<ExpressionName> names;
  for (const Variable& variable : parsed.variables) {
    names.push_back({variable.name, variable.dimension, variable.choices});
  }
  auto expression = Expression::Parse(parsed.masked, names);
  if (!expression.ok()) {
    return fail(
        absl::StrReplaceAll(expression.status().message(),
                            {{"there is no parameter", "there is no parameter or metric"}}));
  }
  parsed.expression = *std::move(expression);
}

// Depth first: 1 while what it needs is looked at, 2 when all of that is known.
bool MetricExpressions::Visit(std::size_t index, std::vector<int>& states,
                              std::vector<std::size_t>& path,
                              std::vector<FieldViolation>& findings) {
  if (states[index] == 2) return true;
  path.push_back(index);
  if (states[index] == 1) {
    path.erase(path.begin(), std::find(path.begin(), path.end(), index));
    findings.push_back(
        {parsed_[index].field + ".expression",
         absl::StrCat("'", definitions_[index].name, "' depends on itself: ",
                      absl::StrJoin(path, " needs ", [this](std::string* out, std::size_t i) {
                        out->append(definitions_[i].name);
                      }))});
    return false;
  }
  states[index] = 1;
  for (const Variable& variable : parsed_[index].variables) {
    if (variable.kind == Variable::Kind::kExpression &&
        !Visit(static_cast<std::size_t>(variable.index), states, path, findings)) {
      return false;
    }
  }
  states[index] = 2;
  path.pop_back();
  order_.push_back(index);
  return true;
}

// Tries values at random, always the same, and those that other units of measurement would give.
void MetricExpressions::CheckUnit(std::size_t index, std::vector<FieldViolation>& findings) const {
  constexpr int kTrials = 64;
  constexpr int kWanted = 12;  // trials with a value
  const Parsed& parsed = parsed_[index];
  std::set<std::string> symbols;
  for (const auto& [symbol, exponent] : *parsed.dimension) symbols.insert(symbol);
  for (const Variable& variable : parsed.variables) {
    if (!variable.dimension) return;
    for (const auto& [symbol, exponent] : *variable.dimension) symbols.insert(symbol);
  }
  const auto size = static_cast<Eigen::Index>(parsed.variables.size());
  std::mt19937 bits(1);
  std::optional<Dimension> found;
  bool is_consistent = true;
  int tried = 0;
  for (int trial = 0; trial < kTrials && tried < kWanted && is_consistent; ++trial) {
    Eigen::VectorXd values(size);
    for (double& value : values) {
      value = std::pow(10, 2 * (static_cast<double>(bits()) / 4294967296.0) - 1);
    }
    const auto plain = parsed.expression->Value(values);
    if (!plain.ok() || *plain == 0) continue;
    Dimension dimension;
    bool has_value = true;
    for (const std::string& symbol : symbols) {
      Eigen::VectorXd scaled = values;
      for (Eigen::Index v = 0; v < size; ++v) {
        const Dimension& of = *parsed.variables[static_cast<std::size_t>(v)].dimension;
        if (const auto at = of.find(symbol); at != of.end()) scaled[v] *= std::exp2(at->second);
      }
      const auto other = parsed.expression->Value(scaled);
      has_value = has_value && other.ok() && *other / *plain > 0;
      if (!has_value) break;
      double exponent = std::log2(*other / *plain);
      // Units are whole powers, or halves below a root: what comes near one is it.
      if (std::abs(exponent - std::round(12 * exponent) / 12) < 1e-9) {
        exponent = std::round(12 * exponent) / 12;
      }
      if (exponent != 0) dimension[symbol] = exponent;
    }
    if (!has_value) continue;
    ++tried;
    is_consistent = !found || *found == dimension;
    found = std::move(dimension);
  }
  if (!found || (is_consistent && *found == *parsed.dimension)) return;
  const bool has_unit =
      is_consistent && std::all_of(found->begin(), found->end(), [](const auto& e) {
        return e.second == std::round(12 * e.second) / 12;
      });
  const MetricDefinition& definition = definitions_[index];
  findings.push_back({parsed.field + ".expression",
                      absl::StrCat("'", definition.name, "': ",
                                   has_unit ? absl::StrCat("has the unit ", ToText(*found),
                                                           ", not ", definition.unit)
                                            : std::string("mixes different units"),
                                   "; a number has one in quotes only, as '30 N m'")});
}

}  // namespace mortise::parametric
