// Checks of specifications, and what they ask of a subject.
#include "services/pareto/service/discovery_problem.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/base/names/offered_names.h"
#include "common/files/evaluation_settings.h"
#include "mortise/v1/evaluator.pb.h"
#include "mortise/v1/pareto.pb.h"
#include "services/pareto/archive/hypervolume.h"

namespace mortise::pareto {
namespace {

constexpr int kMinEvaluations = 10;
constexpr int kMaxEvaluations = 1'000'000;
constexpr int kMaxCells = 10'000;
constexpr int kMaxWindow = 256;
constexpr int kMaxEarlierFronts = 16;
constexpr int kMaxTolerances = 30;        // that a call of the evaluator has room for
constexpr int kToleranceEvaluations = 8;  // tolerances; with more, gradients do if they are offered

using Bound = v1::DiscoverySpecification::Bound;

absl::Status NarrowRange(const Bound& bound, const std::string& field, Eigen::Index i,
                         DesignSpace& space) {
  if (!bound.choices().empty()) {
    return InvalidField(field + ".choices",
                        absl::StrCat("'", bound.parameter(), "' is a number, not a choice"));
  }
  if (bound.minimum() < space.lower[i]) {
    return InvalidField(
        absl::StrCat(field, ".minimum"),
        absl::StrCat("lies below ", space.lower[i], ", the least value of the design space"));
  }
  if (bound.maximum() > space.upper[i]) {
    return InvalidField(
        absl::StrCat(field, ".maximum"),
        absl::StrCat("lies above ", space.upper[i], ", the greatest value of the design space"));
  }
  space.lower[i] = bound.minimum();
  space.upper[i] = bound.maximum();
  return absl::OkStatus();
}

// Which of the choices `names` a bound allows, ascending.
absl::StatusOr<std::vector<double>> AllowedChoices(const Bound& bound, const std::string& field,
                                                   const std::vector<std::string>& names) {
  const std::string listed = absl::StrJoin(names, ", ");
  const auto count = static_cast<double>(names.size());
  if (bound.choices().empty()) {
    if (bound.minimum() < bound.maximum()) {
      return InvalidField(field + ".maximum", absl::StrCat("'", bound.parameter(),
                                                           "' is a choice, without a range: fix it "
                                                           "to one of, or allow some of, ",
                                                           listed));
    }
    if (bound.minimum() == std::round(bound.minimum()) && bound.minimum() >= 0 &&
        bound.minimum() < count) {
      return std::vector<double>{bound.minimum()};
    }
    return InvalidField(field + ".minimum", absl::StrCat("must be the number of a choice, 0 to ",
                                                         count - 1, "; they are ", listed));
  }
  if (bound.minimum() != 0 || bound.maximum() != 0) {
    return InvalidField(field + (bound.minimum() != 0 ? ".minimum" : ".maximum"),
                        "must be left out where choices are named");
  }
  std::vector<double> allowed;
  for (int k = 0; k < bound.choices_size(); ++k) {
    const auto at = std::ranges::find(names, bound.choices(k));
    const std::string place = absl::StrCat(field, ".choices[", k, "]");
    if (at == names.end()) {
      return InvalidField(place, absl::StrCat("'", bound.choices(k), "' is no choice of '",
                                              bound.parameter(), "'; there are ", listed));
    }
    const auto value = static_cast<double>(at - names.begin());
    if (std::ranges::find(allowed, value) != allowed.end()) {
      return InvalidField(place, "is given twice");
    }
    allowed.push_back(value);
  }
  std::ranges::sort(allowed);
  return allowed;
}

absl::Status ApplyBounds(const v1::DiscoverySpecification& specification,
                         DiscoveryProblem& problem) {
  for (int k = 0; k < specification.bounds_size(); ++k) {
    const Bound& bound = specification.bounds(k);
    const std::string field = absl::StrCat("specification.bounds[", k, "]");
    const auto name = std::find(problem.parameter_names.begin(), problem.parameter_names.end(),
                                bound.parameter());
    if (name == problem.parameter_names.end()) {
      return InvalidField(absl::StrCat(field, ".parameter"),
                          absl::StrCat("no parameter '", bound.parameter(), "'",
                                       NamesOffered(bound.parameter(), problem.parameter_names)));
    }
    const Eigen::Index i = name - problem.parameter_names.begin();
    const std::vector<std::string>& choices = problem.choices[static_cast<std::size_t>(i)];
    if (choices.empty()) {
      MORTISE_RETURN_IF_ERROR(NarrowRange(bound, field, i, problem.space));
      continue;
    }
    MORTISE_ASSIGN_OR_RETURN(std::vector<double> allowed, AllowedChoices(bound, field, choices));
    problem.space.lower[i] = allowed.front();
    problem.space.upper[i] = allowed.back();
    std::ranges::find(problem.discrete, i, &DiscreteParameter::parameter)->values =
        std::move(allowed);
  }
  return absl::OkStatus();
}

absl::StatusOr<const v1::DesignSpace::MetricDescription*> Offered(const v1::DesignSpace& described,
                                                                  const std::string& name,
                                                                  const std::string& field) {
  const auto metric = std::find_if(described.metrics().begin(), described.metrics().end(),
                                   [&](const auto& offered) { return offered.name() == name; });
  if (metric != described.metrics().end()) return &*metric;
  return InvalidField(field, absl::StrCat("the subject has no metric '", name, "'",
                                          NamesOffered(name, described.metrics(),
                                                       &v1::DesignSpace::MetricDescription::name)));
}

absl::Status AddObjectives(const v1::DiscoverySpecification& specification,
                           const v1::DesignSpace& described, DiscoveryProblem& problem) {
  for (int k = 0; k < specification.objectives_size(); ++k) {
    const auto& asked = specification.objectives(k);
    MORTISE_ASSIGN_OR_RETURN(const auto* const metric,
                             Offered(described, asked.metric(),
                                     absl::StrCat("specification.objectives[", k, "].metric")));
    problem.objectives.push_back(
        {metric->name(), metric->unit(), asked.maximize(), metric->offers_gradient()});
  }
  return absl::OkStatus();
}

absl::Status AddConstraints(const v1::DiscoverySpecification& specification,
                            const v1::DesignSpace& described, DiscoveryProblem& problem) {
  for (int k = 0; k < specification.constraints_size(); ++k) {
    const auto& asked = specification.constraints(k);
    MORTISE_ASSIGN_OR_RETURN(const auto* const metric,
                             Offered(described, asked.metric(),
                                     absl::StrCat("specification.constraints[", k, "].metric")));
    Constraint constraint{metric->name(), metric->unit(), std::nullopt, std::nullopt,
                          metric->offers_gradient()};
    if (asked.has_minimum()) constraint.minimum = asked.minimum();
    if (asked.has_maximum()) constraint.maximum = asked.maximum();
    constraint.WidenSingleValue();
    problem.options.constraints += constraint.rows();
    problem.constraints.push_back(std::move(constraint));
  }
  return absl::OkStatus();
}

// Only numbers that can be anything between two values vary about one.
absl::Status CheckCanVary(const DiscoveryProblem& problem, Eigen::Index i,
                          const std::string& field) {
  const std::string& name = problem.parameter_names[static_cast<std::size_t>(i)];
  if (!problem.choices[static_cast<std::size_t>(i)].empty()) {
    return InvalidField(field, absl::StrCat("'", name, "' is a choice, which has no tolerance"));
  }
  const bool whole =
      problem.space.step[i] == 1 && problem.space.lower[i] == std::round(problem.space.lower[i]);
  if (whole) {
    return InvalidField(field,
                        absl::StrCat("'", name, "' is a whole number, which has no tolerance"));
  }
  return absl::OkStatus();
}

// Needs the objectives, the constraints and the whole design space.
absl::Status AddTolerances(const v1::DiscoverySpecification& specification,
                           DiscoveryProblem& problem) {
  Robustness& robustness = problem.robustness;
  robustness.range = {problem.space.lower, problem.space.upper};
  robustness.deviations = specification.deviations();
  for (int k = 0; k < specification.tolerances_size(); ++k) {
    const auto& asked = specification.tolerances(k);
    const std::string field = absl::StrCat("specification.tolerances[", k, "].parameter");
    const auto name = std::ranges::find(problem.parameter_names, asked.parameter());
    if (name == problem.parameter_names.end()) {
      return InvalidField(field, absl::StrCat("no parameter '", asked.parameter(), "'"));
    }
    MORTISE_RETURN_IF_ERROR(CheckCanVary(problem, name - problem.parameter_names.begin(), field));
    const bool normal = asked.distribution() == v1::DiscoverySpecification::Tolerance::NORMAL;
    robustness.tolerances.push_back(
        {name - problem.parameter_names.begin(), *name, asked.deviation(),
         normal ? Tolerance::Distribution::kNormal : Tolerance::Distribution::kUniform});
  }
  MORTISE_RETURN_IF_ERROR(UnderField("specification", Validate(robustness)));
  robustness.first_order =
      specification.tolerances_size() > kToleranceEvaluations && problem.AllGradients();
  return absl::OkStatus();
}

// Of designs, where the specification counts the subject's evaluations.
absl::Status SetBudget(const v1::DiscoverySpecification& specification, DiscoveryProblem& problem) {
  const int each = problem.robustness.EvaluationsPerDesign();
  problem.options.evaluations = specification.evaluations() / each;
  if (problem.options.evaluations >= kMinEvaluations) return absl::OkStatus();
  return InvalidField("specification.evaluations",
                      absl::StrCat("at least ", kMinEvaluations * each,
                                   " are needed: with these tolerances a design takes ", each));
}

absl::Status CheckTolerances(const v1::DiscoverySpecification& specification) {
  if (specification.tolerances_size() > kMaxTolerances) {
    return InvalidField("specification.tolerances",
                        absl::StrCat("at most ", kMaxTolerances, " are possible, not ",
                                     specification.tolerances_size()));
  }
  for (int k = 0; k < specification.tolerances_size(); ++k) {
    const auto& tolerance = specification.tolerances(k);
    const std::string field = absl::StrCat("specification.tolerances[", k, "]");
    if (!(tolerance.deviation() > 0 && std::isfinite(tolerance.deviation()))) {
      return InvalidField(absl::StrCat(field, ".deviation"), "must be a finite number above 0");
    }
    if (!v1::DiscoverySpecification::Tolerance::Distribution_IsValid(tolerance.distribution())) {
      return InvalidField(absl::StrCat(field, ".distribution"), "must be UNIFORM or NORMAL");
    }
  }
  return absl::OkStatus();
}

absl::Status CheckCount(std::int64_t value, std::int64_t least, std::int64_t most,
                        const std::string& field) {
  if (value >= least && value <= most) return absl::OkStatus();
  return InvalidField(absl::StrCat("specification.", field),
                      absl::StrCat("must lie between ", least, " and ", most));
}

Discovery::Surrogate SurrogateOf(v1::DiscoverySpecification::Surrogate surrogate) {
  switch (surrogate) {
    case v1::DiscoverySpecification::SURROGATE_ALWAYS:
      return Discovery::Surrogate::kAlways;
    case v1::DiscoverySpecification::SURROGATE_NEVER:
      return Discovery::Surrogate::kNever;
    default:
      return Discovery::Surrogate::kAutomatic;
  }
}

}  // namespace

Eigen::VectorXd DiscoveryProblem::Signs() const {
  Eigen::VectorXd signs(static_cast<Eigen::Index>(objectives.size()));
  for (Eigen::Index i = 0; i < signs.size(); ++i) {
    signs[i] = objectives[static_cast<std::size_t>(i)].maximize ? -1 : 1;
  }
  return signs;
}

bool DiscoveryProblem::AnyGradient() const {
  return std::ranges::any_of(objectives, &Objective::offers_gradient) ||
         std::ranges::any_of(constraints, &Constraint::offers_gradient);
}

bool DiscoveryProblem::AllGradients() const {
  return std::ranges::all_of(objectives, &Objective::offers_gradient) &&
         std::ranges::all_of(constraints, &Constraint::offers_gradient);
}

absl::Status CheckSpecification(const v1::DiscoverySpecification& specification) {
  if (specification.subject().empty()) {
    return InvalidField("specification.subject", "must name what to vary");
  }
  if (specification.revision() < 0) {
    return InvalidField("specification.revision", "must be at least 0");
  }
  if (specification.objectives_size() < 2 || specification.objectives_size() > kMaxMetrics) {
    return InvalidField(
        "specification.objectives",
        absl::StrCat("2 to ", kMaxMetrics, " are needed, not ", specification.objectives_size()));
  }
  std::set<std::string> names;
  for (int k = 0; k < specification.objectives_size(); ++k) {
    if (!names.insert(specification.objectives(k).metric()).second) {
      return InvalidField(absl::StrCat("specification.objectives[", k, "].metric"),
                          "is given twice");
    }
  }
  MORTISE_RETURN_IF_ERROR(CheckConstraints(specification));
  MORTISE_RETURN_IF_ERROR(CheckTolerances(specification));
  MORTISE_RETURN_IF_ERROR(
      UnderField("specification", parametric::CheckMeshSettings(specification.mesh())));
  MORTISE_RETURN_IF_ERROR(
      UnderField("specification", parametric::ReadAirflow(specification.airflow()).status()));
  names.clear();
  if (specification.start_from_size() > kMaxEarlierFronts) {
    return InvalidField("specification.start_from",
                        absl::StrCat("at most ", kMaxEarlierFronts, " are possible, not ",
                                     specification.start_from_size()));
  }
  for (int k = 0; k < specification.start_from_size(); ++k) {
    if (!names.insert(specification.start_from(k)).second) {
      return InvalidField(absl::StrCat("specification.start_from[", k, "]"), "is given twice");
    }
  }
  names.clear();
  for (int k = 0; k < specification.bounds_size(); ++k) {
    const auto& bound = specification.bounds(k);
    const std::string field = absl::StrCat("specification.bounds[", k, "]");
    if (!names.insert(bound.parameter()).second) {
      return InvalidField(absl::StrCat(field, ".parameter"), "is given twice");
    }
    if (bound.minimum() > bound.maximum()) {
      return InvalidField(absl::StrCat(field, ".maximum"), "lies below the minimum");
    }
  }
  MORTISE_RETURN_IF_ERROR(
      CheckCount(specification.evaluations(), kMinEvaluations, kMaxEvaluations, "evaluations"));
  MORTISE_RETURN_IF_ERROR(CheckCount(specification.cells(), 0, kMaxCells, "cells"));
  if (!v1::DiscoverySpecification::Surrogate_IsValid(specification.surrogate())) {
    return InvalidField("specification.surrogate",
                        absl::StrCat(specification.surrogate(), " is none of the known ways"));
  }
  return CheckCount(specification.window(), 0, kMaxWindow, "window");
}

absl::StatusOr<DiscoveryProblem> MakeProblem(const v1::DiscoverySpecification& specification,
                                             const v1::DesignSpace& described) {
  MORTISE_RETURN_IF_ERROR(CheckSpecification(specification));
  DiscoveryProblem problem;
  const Eigen::Index D = described.parameters_size();
  problem.space = {Eigen::VectorXd(D), Eigen::VectorXd(D), Eigen::VectorXd(D)};
  for (Eigen::Index i = 0; i < D; ++i) {
    const auto& parameter = described.parameters(static_cast<int>(i));
    problem.parameter_names.push_back(parameter.name());
    problem.space.lower[i] = parameter.minimum();
    problem.space.upper[i] = parameter.maximum();
    problem.space.step[i] = parameter.step();
    problem.choices.emplace_back(parameter.choices().begin(), parameter.choices().end());
    if (parameter.choices().empty()) continue;
    DiscreteParameter& choice = problem.discrete.emplace_back();
    choice.parameter = i;
    for (int value = 0; value < parameter.choices_size(); ++value) choice.values.push_back(value);
  }
  const absl::Status usable = Validate(problem.space);
  if (!usable.ok()) {
    return InvalidField("specification.subject",
                        absl::StrCat("its design space cannot be searched: ", usable.message()));
  }
  problem.default_design.resize(D);
  for (Eigen::Index i = 0; i < D; ++i) {
    const double value = described.parameters(static_cast<int>(i)).default_value();
    problem.default_design[i] = std::clamp(value, problem.space.lower[i], problem.space.upper[i]);
  }
  MORTISE_RETURN_IF_ERROR(AddObjectives(specification, described, problem));
  MORTISE_RETURN_IF_ERROR(AddConstraints(specification, described, problem));
  MORTISE_RETURN_IF_ERROR(AddTolerances(specification, problem));
  MORTISE_RETURN_IF_ERROR(ApplyBounds(specification, problem));
  MORTISE_RETURN_IF_ERROR(SetBudget(specification, problem));
  problem.discrete =
      WithWholeNumbers(problem.space, std::move(problem.discrete), problem.options.evaluations);
  problem.options.seed = static_cast<std::uint64_t>(specification.seed());
  problem.options.cells_per_angle = specification.cells();
  problem.options.surrogate = SurrogateOf(specification.surrogate());
  if (specification.window() > 0) problem.options.window = specification.window();
  return problem;
}

}  // namespace mortise::pareto
