// Lists, parses and evaluates the numbers of features.
#include "common/templates/features/feature_numbers.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/design/parameter_values.h"

namespace mortise::cad {
namespace {

using parametric::Expression;

constexpr double kSmallest = 1e-6;  // m
constexpr double kLargest = 1e3;    // m
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// Collects the numbers of one feature.
class Lister {
 public:
  explicit Lister(std::vector<NumberUse>& uses) : uses_(uses) {}

  void operator()(const Sketch& sketch) {
    Optional("sketch.plane.origin", sketch.plane.origin, Need::kPosition);
    if (sketch.plane.normal) Optional("sketch.plane.normal", *sketch.plane.normal, Need::kAny);
    if (sketch.plane.x_axis) Optional("sketch.plane.x_axis", *sketch.plane.x_axis, Need::kAny);
    for (std::size_t i = 0; i < sketch.profiles.size(); ++i) {
      prefix_ = absl::StrCat("sketch.profiles[", i, "].");
      std::visit(*this, sketch.profiles[i].shape);
    }
    prefix_.clear();
  }
  void operator()(const SketchPath& path) {
    Optional("path.start", path.start, Need::kPosition);
    for (std::size_t i = 0; i < path.segments.size(); ++i) {
      const SketchSegment& segment = path.segments[i];
      const std::string place = absl::StrCat("path.segments[", i, "].");
      Optional(place + "to", segment.to, Need::kPosition);
      if (segment.through) Optional(place + "through", *segment.through, Need::kPosition);
      Optional(place + "round", segment.round, Need::kLength);
    }
  }
  void operator()(const SketchCircle& circle) {
    Optional("circle.center", circle.center, Need::kPosition);
    Required("circle.radius", circle.radius, Need::kLength);
  }
  void operator()(const SketchRectangle& rectangle) {
    Optional("rectangle.center", rectangle.center, Need::kPosition);
    Required("rectangle.width", rectangle.width, Need::kLength);
    Required("rectangle.height", rectangle.height, Need::kLength);
    Optional("rectangle.round", rectangle.round, Need::kLength);
  }
  void operator()(const SketchPolygon& polygon) {
    Optional("polygon.center", polygon.center, Need::kPosition);
    Required("polygon.radius", polygon.radius, Need::kLength);
    Required("polygon.sides", polygon.sides, Need::kSides);
    Optional("polygon.angle", polygon.angle, Need::kAny);
  }
  void operator()(const Extrude& extrude) {
    Optional("extrude.from", extrude.from, Need::kPosition);
    Required("extrude.to", extrude.to, Need::kPosition);
  }
  void operator()(const Revolve& revolve) {
    Optional("revolve.axis_point", revolve.axis_point, Need::kPosition);
    Optional("revolve.axis_direction", revolve.axis_direction, Need::kAny);
    Optional("revolve.angle", revolve.angle, Need::kTurn);
  }
  void operator()(const Sweep&) {}
  void operator()(const Boolean&) {}
  void operator()(const Fillet& fillet) { Required("fillet.radius", fillet.radius, Need::kLength); }
  void operator()(const Chamfer& chamfer) {
    Required("chamfer.distance", chamfer.distance, Need::kLength);
  }
  void operator()(const Draft& draft) { Required("draft.angle", draft.angle, Need::kDraftAngle); }
  void operator()(const Shell& shell) {
    Required("shell.thickness", shell.thickness, Need::kLength);
  }
  void operator()(const Hole& hole) {
    Optional("hole.position", hole.position, Need::kPosition);
    Required("hole.diameter", hole.diameter, Need::kLength);
    Optional("hole.depth", hole.depth, Need::kLength);
    Optional("hole.counterbore_diameter", hole.counterbore_diameter, Need::kLength);
    Optional("hole.counterbore_depth", hole.counterbore_depth, Need::kLength);
    Optional("hole.countersink_diameter", hole.countersink_diameter, Need::kLength);
    Optional("hole.countersink_angle", hole.countersink_angle, Need::kConeAngle);
  }
  void operator()(const LinearPattern& pattern) {
    Optional("linear_pattern.step", pattern.step, Need::kPosition);
    Required("linear_pattern.count", pattern.count, Need::kCount);
    Optional("linear_pattern.second_step", pattern.second_step, Need::kPosition);
    Optional("linear_pattern.second_count", pattern.second_count, Need::kCount);
  }
  void operator()(const CircularPattern& pattern) {
    Optional("circular_pattern.axis_point", pattern.axis_point, Need::kPosition);
    if (pattern.axis_direction) {
      Optional("circular_pattern.axis_direction", *pattern.axis_direction, Need::kAny);
    }
    Required("circular_pattern.count", pattern.count, Need::kCount);
    Optional("circular_pattern.angle", pattern.angle, Need::kAny);
  }
  void operator()(const Condition& condition) {
    const auto components = parametric::ComponentsOf(condition.kind);
    for (std::size_t k = 0; k < components.size(); ++k) {
      const Need need = components[k].positive ? Need::kPositive : Need::kAny;
      uses_.push_back(
          {components[k].field, &condition.components[k], need, components[k].coordinate});
    }
  }

 private:
  void Required(const std::string& field, const Formula& formula, Need need) {
    uses_.push_back({prefix_ + field, &formula, need, false});
  }
  void Optional(const std::string& field, const Formula& formula, Need need) {
    uses_.push_back({prefix_ + field, &formula, need, true});
  }
  void Optional(const std::string& field, const Formula2& formula, Need need) {
    Optional(field + ".x", formula.x, need);
    Optional(field + ".y", formula.y, need);
  }
  void Optional(const std::string& field, const Formula3& formula, Need need) {
    Optional(field + ".x", formula.x, need);
    Optional(field + ".y", formula.y, need);
    Optional(field + ".z", formula.z, need);
  }

  std::vector<NumberUse>& uses_;
  std::string prefix_;
};

bool BeginsName(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool BelongsToWord(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

// Which of `names` stand in the text of an expression.
std::vector<Eigen::Index> NamesIn(const std::string& text,
                                  const std::vector<parametric::ExpressionName>& names) {
  std::set<std::string> words;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = at;
    while (end < text.size() && BelongsToWord(text[end])) ++end;
    if (BeginsName(text[at])) words.insert(text.substr(at, end - at));
    at = std::max(end, at + 1);
  }
  std::vector<Eigen::Index> found;
  for (const std::string& word : words) {
    const auto name =
        std::find_if(names.begin(), names.end(),
                     [&](const parametric::ExpressionName& entry) { return entry.name == word; });
    if (name != names.end()) found.push_back(name - names.begin());
  }
  return found;
}

bool AreKnown(const std::vector<Eigen::Index>& names, const Eigen::VectorXd& values) {
  return std::all_of(names.begin(), names.end(),
                     [&](Eigen::Index name) { return std::isfinite(values(name)); });
}

bool IsWhole(double value, double least, double most) {
  return value == std::floor(value) && value >= least && value <= most;
}

// What is wrong with a finite value; null if nothing.
const char* Fault(double value, Need need) {
  switch (need) {
    case Need::kAny:
      return nullptr;
    case Need::kPosition:
      return std::abs(value) <= kLargest ? nullptr : "is farther than 1 km from the origin";
    case Need::kLength:
      if (value < kSmallest) return "must be greater than 0, at least 1 µm";
      return value <= kLargest ? nullptr : "is greater than 1 km";
    case Need::kCount:
      static_assert(kMaxInstances == 200);
      return IsWhole(value, 1, kMaxInstances) ? nullptr : "must be a whole number from 1 to 200";
    case Need::kSides:
      return IsWhole(value, 3, 64) ? nullptr : "must be a whole number from 3 to 64";
    case Need::kTurn:
      // A full turn written as 2 * pi may come out a little more.
      return value > 1e-6 && value <= 2 * std::numbers::pi + 1e-9
                 ? nullptr
                 : "must be greater than 0, at most a full turn";
    case Need::kDraftAngle:
      return value > 1e-6 && value < 1.2 ? nullptr : "must be greater than 0, less than 1.2 rad";
    case Need::kConeAngle:
      return value >= 0.1 && value <= 3 ? nullptr : "must be 0.1 to 3 rad";
    case Need::kPositive:
      return value > 0 ? nullptr : "must be greater than 0";
  }
  return nullptr;
}

}  // namespace

std::vector<NumberUse> NumbersOf(const Feature& feature) {
  std::vector<NumberUse> uses;
  std::visit(Lister(uses), feature.kind);
  return uses;
}

double Numbers::operator()(const Formula& formula) const {
  return formula.empty() ? 0 : values_.at(formula);
}

Eigen::Vector2d Numbers::operator()(const Formula2& formula) const {
  return {(*this)(formula.x), (*this)(formula.y)};
}

Eigen::Vector3d Numbers::operator()(const Formula3& formula) const {
  return {(*this)(formula.x), (*this)(formula.y), (*this)(formula.z)};
}

FeatureNumbers::FeatureNumbers(const CadTemplate& definition, std::vector<FieldViolation>& findings)
    : parameter_count_(static_cast<Eigen::Index>(definition.parameters.size())) {
  Names names = parametric::ExpressionNames(definition.parameters);
  for (std::size_t i = 0; i < definition.definitions.size(); ++i) {
    auto parsed = Parse(definition.definitions[i].value, names);
    if (!parsed.ok()) {
      findings.push_back(
          {absl::StrCat("definitions[", i, "].value"), std::string(parsed.status().message())});
    }
    // The names still count, or every use of this one would be a finding too.
    definitions_.push_back(parsed.ok() ? std::optional(*std::move(parsed)) : std::nullopt);
    names.push_back({definition.definitions[i].name});
  }
  AddPresent(definition, names, findings);
  for (std::size_t i = 0; i < definition.features.size(); ++i) {
    for (const NumberUse& use : NumbersOf(definition.features[i])) {
      std::string field = absl::StrCat("features[", i, "].", use.field);
      if (use.formula->empty()) {
        if (!use.optional) findings.push_back({field, "is missing"});
        continue;
      }
      if (!expressions_.contains(*use.formula)) {
        auto parsed = Parse(*use.formula, names);
        if (!parsed.ok()) {
          findings.push_back({field, std::string(parsed.status().message())});
          continue;
        }
        expressions_.emplace(*use.formula, *std::move(parsed));
      }
      const bool is_condition = std::holds_alternative<Condition>(definition.features[i].kind);
      uses_.push_back({i, std::move(field), *use.formula, use.need,
                       is_condition ? definition.features[i].name : ""});
    }
  }
  AddReferenceTemperature(definition, names, findings);
}

absl::StatusOr<FeatureNumbers::Parsed> FeatureNumbers::Parse(const std::string& text,
                                                             const Names& names) {
  MORTISE_ASSIGN_OR_RETURN(Expression expression, Expression::Parse(text, names));
  return Parsed{std::move(expression), NamesIn(text, names)};
}

void FeatureNumbers::AddPresent(const CadTemplate& definition, const Names& names,
                                std::vector<FieldViolation>& findings) {
  for (std::size_t i = 0; i < definition.features.size(); ++i) {
    std::optional<Parsed>& present = present_.emplace_back();
    const Formula& text = definition.features[i].present;
    if (text.empty()) continue;
    auto condition = Expression::ParseCondition(text, names);
    if (condition.ok()) {
      present = Parsed{*std::move(condition), NamesIn(text, names)};
    } else {
      findings.push_back(
          {absl::StrCat("features[", i, "].present"), std::string(condition.status().message())});
    }
  }
}

std::vector<bool> FeatureNumbers::PresentAt(const Eigen::VectorXd& values,
                                            std::vector<FieldViolation>& findings) const {
  std::vector<bool> present(present_.size() + 1, true);
  for (std::size_t i = 0; i < present_.size(); ++i) {
    if (!present_[i]) continue;
    present[i] = false;
    if (!AreKnown(present_[i]->names, values)) continue;
    const auto holds = present_[i]->expression.Holds(values);
    if (holds.ok()) {
      present[i] = *holds;
    } else {
      findings.push_back(
          {absl::StrCat("features[", i, "].present"), std::string(holds.status().message())});
    }
  }
  return present;
}

void FeatureNumbers::AddReferenceTemperature(const CadTemplate& definition, const Names& names,
                                             std::vector<FieldViolation>& findings) {
  constexpr char kField[] = "reference_temperature";
  const Formula& formula = definition.reference_temperature;
  if (formula.empty()) return;
  if (!expressions_.contains(formula)) {
    auto parsed = Parse(formula, names);
    if (!parsed.ok()) {
      findings.push_back({kField, std::string(parsed.status().message())});
      return;
    }
    expressions_.emplace(formula, *std::move(parsed));
  }
  uses_.push_back({definition.features.size(), kField, formula, Need::kPositive, ""});
}

Numbers FeatureNumbers::Evaluate(const Eigen::Ref<const Eigen::VectorXd>& q,
                                 std::vector<FieldViolation>& findings) const {
  Numbers numbers;
  Eigen::VectorXd values(q.size() + static_cast<Eigen::Index>(definitions_.size()));
  values.head(q.size()) = q;
  for (std::size_t i = 0; i < definitions_.size(); ++i) {
    const Eigen::Index index = q.size() + static_cast<Eigen::Index>(i);
    values(index) = kUnknown;
    if (!definitions_[i] || !AreKnown(definitions_[i]->names, values)) continue;
    const auto value = definitions_[i]->expression.Value(values.head(index));
    if (value.ok()) {
      values(index) = *value;
    } else {
      findings.push_back(
          {absl::StrCat("definitions[", i, "].value"), std::string(value.status().message())});
    }
  }
  numbers.present_ = PresentAt(values, findings);
  for (const Use& use : uses_) {
    if (!numbers.present_[use.feature]) continue;
    const auto known = numbers.values_.find(use.text);
    const std::string owner = use.condition.empty() ? "" : absl::StrCat("'", use.condition, "': ");
    double value = 0;
    if (known != numbers.values_.end()) {
      value = known->second;
    } else {
      const Parsed& parsed = expressions_.at(use.text);
      if (!AreKnown(parsed.names, values)) continue;
      const auto result = parsed.expression.Value(values);
      if (!result.ok()) {
        findings.push_back({use.field, owner + std::string(result.status().message())});
        continue;
      }
      value = *result;
      numbers.values_.emplace(use.text, value);
    }
    if (const char* fault = Fault(value, use.need)) {
      findings.push_back(
          {use.field, absl::StrCat(owner, "'", use.text, "' is ", value, ": ", fault)});
    }
  }
  return numbers;
}

}  // namespace mortise::cad
