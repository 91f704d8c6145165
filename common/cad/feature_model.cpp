// Validates lists of features and evaluates them.
#include "common/cad/feature_model.h"

#include <cmath>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/cad/feature_checks.h"
#include "common/cad/feature_regeneration.h"
#include "common/cad/sketch_curves.h"
#include "common/parametric/parameter_values.h"

namespace mortise::cad {
namespace {

using parametric::Finding;

constexpr int kRandomPoints = 32;
constexpr std::size_t kMaxFindings = 100;

// " (at length = 0.2, width = 0.1)".
std::string At(const CadTemplate& definition, const Eigen::VectorXd& q) {
  return absl::StrCat(" (at ", parametric::ToText(definition.parameters, q), ")");
}

// What is wrong with sketches and extents whose numbers are each usable.
void CheckShapes(const CadTemplate& definition, const Numbers& numbers,
                 std::vector<Finding>& findings) {
  for (std::size_t i = 0; i < definition.features.size(); ++i) {
    const std::string place = absl::StrCat("features[", i, "].");
    const auto& kind = definition.features[i].kind;
    if (const auto* sketch = std::get_if<Sketch>(&kind)) {
      std::vector<Finding> inside;
      ResolveSketch(*sketch, numbers, inside);
      for (Finding& finding : inside) {
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

std::vector<Finding> CheckNumbers(const CadTemplate& definition, const FeatureNumbers& numbers) {
  std::vector<Finding> findings;
  std::set<std::string> seen;
  for (const Eigen::VectorXd& q : parametric::TrialPoints(definition.parameters, kRandomPoints)) {
    std::vector<Finding> here;
    const Numbers values = numbers.Evaluate(q, here);
    if (here.empty()) CheckShapes(definition, values, here);
    for (Finding& finding : here) {
      if (findings.size() == kMaxFindings) return findings;
      if (!seen.insert(finding.field).second) continue;
      findings.push_back({finding.field, finding.message + At(definition, q)});
    }
  }
  return findings;
}

std::vector<Finding> Validate(const CadTemplate& definition, const FeatureNumbers& numbers,
                              std::vector<Finding> of_expressions) {
  std::vector<Finding> findings = CheckFeatures(definition);
  findings.insert(findings.end(), of_expressions.begin(), of_expressions.end());
  if (findings.empty()) findings = CheckNumbers(definition, numbers);
  if (findings.size() > kMaxFindings) findings.resize(kMaxFindings);
  return findings;
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

std::vector<Finding> ValidateCadTemplate(const CadTemplate& definition) {
  std::vector<Finding> of_expressions;
  const FeatureNumbers numbers(definition, of_expressions);
  return Validate(definition, numbers, std::move(of_expressions));
}

absl::StatusOr<FeatureModel> FeatureModel::Create(CadTemplate definition) {
  std::vector<Finding> of_expressions;
  FeatureNumbers numbers(definition, of_expressions);
  MORTISE_RETURN_IF_ERROR(
      parametric::ToStatus(Validate(definition, numbers, std::move(of_expressions))));
  return FeatureModel(
      std::make_shared<const State>(State{std::move(definition), std::move(numbers)}));
}

Eigen::VectorXd FeatureModel::Defaults() const {
  return parametric::Defaults(state_->definition.parameters);
}

absl::StatusOr<RegeneratedModel> FeatureModel::Regenerate(
    const Eigen::Ref<const Eigen::VectorXd>& q) const {
  std::vector<Finding> findings = parametric::CheckRanges(state_->definition.parameters, q);
  MORTISE_RETURN_IF_ERROR(parametric::ToStatus(findings));
  const Numbers numbers = state_->numbers.Evaluate(q, findings);
  MORTISE_RETURN_IF_ERROR(parametric::ToStatus(findings));
  auto model = RegenerateFeatures(state_->definition, numbers, false);
  if (model.ok()) return model;
  // Again, feature by feature: slower, but tells exactly which one is at fault.
  return RegenerateFeatures(state_->definition, numbers, true);
}

}  // namespace mortise::cad
