// Validates lists of features and evaluates them.
#include "common/templates/features/feature_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/design/parameter_values.h"
#include "common/design/solid_head_checks.h"
#include "common/templates/features/feature_checks.h"
#include "common/templates/features/feature_regeneration.h"
#include "common/templates/features/sketch_curves.h"

namespace mortise::cad {
namespace {

constexpr int kRandomPoints = 32;
constexpr std::size_t kMaxFindings = 100;

// " (at length = 0.2, width = 0.1)", without what is not known.
std::string At(const CadTemplate& definition, const Eigen::VectorXd& q) {
  std::vector<parametric::Parameter> parameters;
  Eigen::VectorXd known(q.size());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    if (!std::isfinite(q(i))) continue;
    known(static_cast<Eigen::Index>(parameters.size())) = q(i);
    parameters.push_back(definition.parameters[static_cast<std::size_t>(i)]);
  }
  if (parameters.empty()) return "";
  const auto count = static_cast<Eigen::Index>(parameters.size());
  return absl::StrCat(" (at ", parametric::ToText(parameters, known.head(count)), ")");
}

// Indices of the features of which something is wrong.
std::set<std::size_t> FeaturesAtFault(const std::vector<FieldViolation>& findings) {
  constexpr std::string_view kFeatures = "features[";
  std::set<std::size_t> at_fault;
  for (const FieldViolation& finding : findings) {
    const std::size_t close = finding.field.find(']');
    std::size_t index = 0;
    if (finding.field.starts_with(kFeatures) && close != std::string::npos &&
        absl::SimpleAtoi(finding.field.substr(kFeatures.size(), close - kFeatures.size()),
                         &index)) {
      at_fault.insert(index);
    }
  }
  return at_fault;
}

bool AreKnown(const std::vector<NumberUse>& uses, const Numbers& numbers) {
  return std::all_of(uses.begin(), uses.end(), [&](const NumberUse& use) {
    return use.formula->empty() ? use.optional : numbers.Knows(*use.formula);
  });
}

// What is wrong with sketches and extents whose numbers are each usable, given what is wrong with
// numbers. `uses` are those of each feature.
void CheckShapes(const CadTemplate& definition, const std::vector<std::vector<NumberUse>>& uses,
                 const Numbers& numbers, std::vector<FieldViolation>& findings) {
  const std::set<std::size_t> at_fault = FeaturesAtFault(findings);
  for (std::size_t i = 0; i < definition.features.size(); ++i) {
    const auto& kind = definition.features[i].kind;
    if (!std::holds_alternative<Sketch>(kind) && !std::holds_alternative<Extrude>(kind)) continue;
    if (!numbers.IsPresent(i)) continue;
    const std::string place = absl::StrCat("features[", i, "].");
    if (at_fault.contains(i) || !AreKnown(uses[i], numbers)) continue;
    if (const auto* sketch = std::get_if<Sketch>(&kind)) {
      std::vector<FieldViolation> inside;
      ResolveSketch(*sketch, numbers, inside);
      for (FieldViolation& finding : inside) {
        findings.push_back({place + "sketch." + finding.field, std::move(finding.message)});
      }
    } else if (const auto* extrude = std::get_if<Extrude>(&kind)) {
      const double from = numbers(extrude->from), to = numbers(extrude->to);
      if (to <= from) {
        findings.push_back({place + "extrude.to",
                            absl::StrCat("is ", to, " m, not greater than `from`, ", from, " m")});
      }
    }
  }
}

// Parameters of which a range, name or default is at fault: nobody knows what values they have.
std::vector<Eigen::Index> ParametersAtFault(const CadTemplate& definition,
                                            const std::vector<FieldViolation>& findings) {
  std::vector<Eigen::Index> at_fault;
  for (std::size_t i = 0; i < definition.parameters.size(); ++i) {
    const std::string field = absl::StrCat("parameters[", i, "]");
    const bool is_at_fault =
        std::any_of(findings.begin(), findings.end(), [&](const FieldViolation& finding) {
          return finding.field == field || finding.field == field + ".name" ||
                 finding.field == field + ".maximum" || finding.field == field + ".default_value";
        });
    if (is_at_fault) at_fault.push_back(static_cast<Eigen::Index>(i));
  }
  return at_fault;
}

// Adds what is wrong at some parameters to what is wrong at all of them.
void CheckNumbers(const CadTemplate& definition, const FeatureNumbers& numbers,
                  std::vector<FieldViolation>& findings) {
  const std::vector<Eigen::Index> unknown = ParametersAtFault(definition, findings);
  std::vector<std::vector<NumberUse>> uses;
  for (const Feature& feature : definition.features) uses.push_back(NumbersOf(feature));
  std::set<std::string> seen;
  for (Eigen::VectorXd q : parametric::TrialPoints(definition.parameters, kRandomPoints)) {
    for (const Eigen::Index i : unknown) q(i) = std::numeric_limits<double>::quiet_NaN();
    std::vector<FieldViolation> here;
    const Numbers values = numbers.Evaluate(q, here);
    CheckShapes(definition, uses, values, here);
    for (FieldViolation& finding : here) {
      if (findings.size() >= kMaxFindings) return;
      if (!seen.insert(finding.field).second) continue;
      findings.push_back({finding.field, finding.message + At(definition, q)});
    }
  }
}

// Whether the template is small enough to be tried at many parameters.
bool CanBeTried(const CadTemplate& definition) {
  return definition.parameters.size() <= parametric::kMaxSolidParameters &&
         definition.definitions.size() <= kMaxDefinitions &&
         definition.features.size() <= kMaxFeatures;
}

std::vector<FieldViolation> Validate(const CadTemplate& definition, const FeatureNumbers& numbers,
                                     std::vector<FieldViolation> of_expressions) {
  std::vector<FieldViolation> findings = CheckFeatures(definition);
  findings.insert(findings.end(), of_expressions.begin(), of_expressions.end());
  if (CanBeTried(definition)) CheckNumbers(definition, numbers, findings);
  if (findings.size() > kMaxFindings) findings.resize(kMaxFindings);
  return findings;
}

void AddCounts(const Feature& feature, const Numbers& numbers, parametric::Structure& structure) {
  const auto count_of = [&](const Formula& formula) { return static_cast<int>(numbers(formula)); };
  if (const auto* rows = std::get_if<LinearPattern>(&feature.kind)) {
    structure.counts.push_back({feature.name, {count_of(rows->count)}});
    if (!rows->second_count.empty()) {
      structure.counts.back().numbers.push_back(count_of(rows->second_count));
    }
  } else if (const auto* ring = std::get_if<CircularPattern>(&feature.kind)) {
    structure.counts.push_back({feature.name, {count_of(ring->count)}});
  } else if (const auto* sketch = std::get_if<Sketch>(&feature.kind)) {
    for (const SketchProfile& profile : sketch->profiles) {
      const auto* polygon = std::get_if<SketchPolygon>(&profile.shape);
      if (polygon == nullptr) continue;
      structure.counts.push_back(
          {absl::StrCat(feature.name, ".", profile.name), {count_of(polygon->sides)}});
    }
  }
}

}  // namespace

absl::StatusOr<std::vector<int>> FacesOf(const RegeneratedModel& model,
                                         std::string_view reference) {
  MORTISE_ASSIGN_OR_RETURN(const FaceName wanted, ParseFaceReference(reference));
  std::vector<int> faces;
  for (std::size_t i = 0; i < model.origins.size(); ++i) {
    for (const FaceName& origin : model.origins[i]) {
      if (!Matches(wanted, origin)) continue;
      faces.push_back(static_cast<int>(i));
      break;
    }
  }
  return faces;
}

std::vector<FieldViolation> ValidateCadTemplate(const CadTemplate& definition) {
  std::vector<FieldViolation> of_expressions;
  const FeatureNumbers numbers(definition, of_expressions);
  return Validate(definition, numbers, std::move(of_expressions));
}

absl::StatusOr<FeatureModel> FeatureModel::Create(CadTemplate definition) {
  std::vector<FieldViolation> of_expressions;
  FeatureNumbers numbers(definition, of_expressions);
  MORTISE_RETURN_IF_ERROR(
      parametric::ToStatus(Validate(definition, numbers, std::move(of_expressions))));
  return FeatureModel(
      std::make_shared<const State>(State{std::move(definition), std::move(numbers)}));
}

Eigen::VectorXd FeatureModel::Defaults() const {
  return parametric::Defaults(state_->definition.parameters);
}

absl::StatusOr<Numbers> FeatureModel::NumbersAt(const Eigen::Ref<const Eigen::VectorXd>& q) const {
  std::vector<FieldViolation> findings = parametric::CheckRanges(state_->definition.parameters, q);
  MORTISE_RETURN_IF_ERROR(parametric::ToStatus(findings));
  Numbers numbers = state_->numbers.Evaluate(q, findings);
  MORTISE_RETURN_IF_ERROR(parametric::ToStatus(findings));
  return numbers;
}

absl::StatusOr<parametric::Structure> FeatureModel::StructureAt(
    const Eigen::Ref<const Eigen::VectorXd>& q) const {
  MORTISE_ASSIGN_OR_RETURN(const Numbers numbers, NumbersAt(q));
  parametric::Structure structure;
  const std::vector<Feature>& features = state_->definition.features;
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (numbers.IsPresent(i)) {
      AddCounts(features[i], numbers, structure);
    } else {
      structure.absent_features.push_back(features[i].name);
    }
  }
  return structure;
}

absl::StatusOr<RegeneratedModel> FeatureModel::Regenerate(
    const Eigen::Ref<const Eigen::VectorXd>& q) const {
  MORTISE_ASSIGN_OR_RETURN(const Numbers numbers, NumbersAt(q));
  auto model = RegenerateFeatures(state_->definition, numbers, false);
  if (model.ok()) return model;
  // Again, feature by feature: slower, but tells exactly which one is at fault.
  return RegenerateFeatures(state_->definition, numbers, true);
}

}  // namespace mortise::cad
