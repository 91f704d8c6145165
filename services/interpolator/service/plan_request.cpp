#include "services/interpolator/service/plan_request.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/base/names/offered_names.h"
#include "common/design/metric_registry.h"
#include "common/evaluation/parameter_number.h"
#include "mortise/v1/evaluator.pb.h"
#include "mortise/v1/interpolator.pb.h"
#include "services/interpolator/service/map_specification.h"

namespace mortise::interpolator {
namespace {

using Described = v1::DesignSpace::DesignParameter;
using Variation = v1::MapSpecification::Variation;

// Choices have a step of 1 as well.
bool IsWhole(const Described& parameter) {
  return parameter.step() == 1 && parameter.minimum() == std::round(parameter.minimum());
}

absl::StatusOr<Eigen::Index> IndexOf(const v1::DesignSpace& described, const std::string& name,
                                     const std::string& field) {
  for (int i = 0; i < described.parameters_size(); ++i) {
    if (described.parameters(i).name() == name) return i;
  }
  return InvalidField(field,
                      absl::StrCat("the subject has no parameter '", name, "'; it has ",
                                   absl::StrJoin(described.parameters(), ", ",
                                                 [](std::string* text, const Described& parameter) {
                                                   absl::StrAppend(text, parameter.name());
                                                 })));
}

PlannedParameter AsDescribed(const Described& described, Eigen::Index index) {
  PlannedParameter parameter{.name = described.name(),
                             .unit = described.unit(),
                             .index = index,
                             .minimum = described.minimum(),
                             .maximum = described.maximum(),
                             .whole = IsWhole(described),
                             .values = {},
                             .choices = {described.choices().begin(), described.choices().end()}};
  return parameter;
}

// Narrows the range of a number as asked.
absl::Status NarrowRange(const Variation& variation, const std::string& field,
                         PlannedParameter& parameter) {
  if (!variation.choices().empty()) {
    return InvalidField(field + ".choices",
                        absl::StrCat("'", parameter.name, "' is a number, not a choice"));
  }
  const double minimum = variation.has_minimum() ? variation.minimum() : parameter.minimum;
  const double maximum = variation.has_maximum() ? variation.maximum() : parameter.maximum;
  if (!(minimum >= parameter.minimum && minimum <= parameter.maximum)) {
    return InvalidField(field + ".minimum",
                        absl::StrCat("must lie between ", parameter.minimum, " and ",
                                     parameter.maximum, ", the range of the design space"));
  }
  if (!(maximum >= parameter.minimum && maximum <= parameter.maximum)) {
    return InvalidField(field + ".maximum",
                        absl::StrCat("must lie between ", parameter.minimum, " and ",
                                     parameter.maximum, ", the range of the design space"));
  }
  if (!(minimum < maximum)) {
    return InvalidField(field + (variation.has_maximum() ? ".maximum" : ".minimum"),
                        absl::StrCat("leaves no range of '", parameter.name, "'"));
  }
  if (parameter.whole && minimum != std::round(minimum)) {
    return InvalidField(field + ".minimum",
                        absl::StrCat("must be whole: '", parameter.name, "' is a whole number"));
  }
  parameter.minimum = minimum;
  parameter.maximum = maximum;
  return absl::OkStatus();
}

// Leaves those values of a choice that are asked for.
absl::Status TakeChoices(const Variation& variation, const std::string& field,
                         PlannedParameter& parameter) {
  if (variation.has_minimum() || variation.has_maximum()) {
    return InvalidField(field + (variation.has_minimum() ? ".minimum" : ".maximum"),
                        absl::StrCat("must be left out: '", parameter.name,
                                     "' is a choice, without a range; name its `choices`"));
  }
  for (int i = 0; i < variation.choices_size(); ++i) {
    const std::string place = absl::StrCat(field, ".choices[", i, "]");
    const auto at = std::ranges::find(parameter.choices, variation.choices(i));
    if (at == parameter.choices.end()) {
      return InvalidField(
          place, absl::StrCat("'", variation.choices(i), "' is no choice of '", parameter.name,
                              "'; there are ", absl::StrJoin(parameter.choices, ", ")));
    }
    const auto value = static_cast<double>(at - parameter.choices.begin());
    if (std::ranges::find(parameter.values, value) != parameter.values.end()) {
      return InvalidField(place, "is given twice");
    }
    parameter.values.push_back(value);
  }
  if (parameter.values.empty()) return absl::OkStatus();
  std::ranges::sort(parameter.values);
  parameter.minimum = parameter.values.front();
  parameter.maximum = parameter.values.back();
  return absl::OkStatus();
}

absl::Status AddVariations(const v1::MapSpecification& specification,
                           const v1::DesignSpace& described, MapPlan& plan) {
  for (int k = 0; k < specification.variations_size(); ++k) {
    const Variation& variation = specification.variations(k);
    const std::string field = absl::StrCat("specification.variations[", k, "]");
    MORTISE_ASSIGN_OR_RETURN(const Eigen::Index index,
                             IndexOf(described, variation.parameter(), field + ".parameter"));
    PlannedParameter parameter = AsDescribed(described.parameters(static_cast<int>(index)), index);
    MORTISE_RETURN_IF_ERROR(parameter.choices.empty() ? NarrowRange(variation, field, parameter)
                                                      : TakeChoices(variation, field, parameter));
    plan.parameters.push_back(std::move(parameter));
  }
  return absl::OkStatus();
}

absl::Status FixParameters(const v1::MapSpecification& specification,
                           const v1::DesignSpace& described, MapPlan& plan) {
  for (int k = 0; k < specification.fixed_size(); ++k) {
    const std::string field = absl::StrCat("specification.fixed[", k, "]");
    MORTISE_ASSIGN_OR_RETURN(const Eigen::Index index,
                             IndexOf(described, specification.fixed(k).name(), field + ".name"));
    const Described& parameter = described.parameters(static_cast<int>(index));
    MORTISE_ASSIGN_OR_RETURN(const double value, evaluation::NumberOf(specification.fixed(k),
                                                                      parameter.choices(), field));
    if (!(value >= parameter.minimum() && value <= parameter.maximum())) {
      return InvalidField(field + ".value", absl::StrCat("must lie between ", parameter.minimum(),
                                                         " and ", parameter.maximum()));
    }
    if (IsWhole(parameter) && value != std::round(value)) {
      return InvalidField(field + ".value", parameter.choices().empty()
                                                ? "must be whole"
                                                : "must be the number of a choice");
    }
    plan.base[index] = value;
  }
  return absl::OkStatus();
}

// Where none is named, all that are no whole ones and not fixed.
void VaryAllNumbers(const v1::MapSpecification& specification, const v1::DesignSpace& described,
                    MapPlan& plan) {
  for (int i = 0; i < described.parameters_size(); ++i) {
    const Described& parameter = described.parameters(i);
    const bool is_fixed = std::ranges::any_of(
        specification.fixed(), [&](const auto& fixed) { return fixed.name() == parameter.name(); });
    if (is_fixed || IsWhole(parameter) || !(parameter.minimum() < parameter.maximum())) continue;
    plan.parameters.push_back(AsDescribed(parameter, i));
  }
}

absl::Status CheckNumbers(const v1::MapSpecification& specification, const MapPlan& plan) {
  const std::vector<std::size_t> numbers = plan.NumberParameters();
  if (numbers.empty()) {
    return InvalidField("specification.variations",
                        "nothing would vary but whole numbers and choices, of which there is "
                        "nothing to interpolate");
  }
  const auto count = static_cast<int>(numbers.size());
  if (count <= kMaxNumbers) {
    if (specification.basis() != v1::MapSpecification::CUBIC || count <= kMaxCubicNumbers) {
      return absl::OkStatus();
    }
    return InvalidField(
        "specification.basis",
        absl::StrCat("CUBIC is for at most ", kMaxCubicNumbers, " numbers that vary, not ", count));
  }
  std::vector<std::string> names;
  for (const std::size_t i : numbers) names.push_back(plan.parameters[i].name);
  return InvalidField(
      "specification.variations",
      absl::StrCat("at most ", kMaxNumbers, " numbers can vary, not ", numbers.size(), " (",
                   absl::StrJoin(names, ", "), "): name those that are to, the others are fixed"));
}

// Sets the structures: all combinations of the values of whole parameters.
absl::Status Combine(const v1::MapSpecification& specification, MapPlan& plan) {
  const int most =
      specification.most_structures() == 0 ? kDefaultStructures : specification.most_structures();
  double count = 1;
  for (PlannedParameter& parameter : plan.parameters) {
    if (!parameter.whole) continue;
    if (parameter.values.empty()) {
      count *= std::floor(parameter.maximum - parameter.minimum) + 1;
    } else {
      count *= static_cast<double>(parameter.values.size());
    }
  }
  if (count > most) {
    return InvalidField("specification.most_structures",
                        absl::StrCat("there would be ", count, " structures, of at most ", most,
                                     ": fix whole numbers and choices, or narrow them"));
  }
  for (PlannedParameter& parameter : plan.parameters) {
    if (!parameter.whole || !parameter.values.empty()) continue;
    for (double value = parameter.minimum; value <= parameter.maximum; ++value) {
      parameter.values.push_back(value);
    }
  }
  const std::vector<std::size_t> wholes = plan.WholeParameters();
  plan.structures.resize(static_cast<Eigen::Index>(wholes.size()),
                         static_cast<Eigen::Index>(count));
  for (Eigen::Index s = 0; s < plan.structures.cols(); ++s) {
    auto rest = static_cast<std::size_t>(s);
    for (std::size_t i = wholes.size(); i-- > 0;) {
      const std::vector<double>& values = plan.parameters[wholes[i]].values;
      plan.structures(static_cast<Eigen::Index>(i), s) = values[rest % values.size()];
      rest /= values.size();
    }
  }
  return absl::OkStatus();
}

absl::Status AddMetrics(const v1::MapSpecification& specification, const v1::DesignSpace& described,
                        MapPlan& plan) {
  for (int k = 0; k < specification.metrics_size(); ++k) {
    const auto& asked = specification.metrics(k);
    const auto offered = std::ranges::find_if(
        described.metrics(), [&](const auto& metric) { return metric.name() == asked.name(); });
    if (offered == described.metrics().end()) {
      return InvalidField(absl::StrCat("specification.metrics[", k, "].name"),
                          absl::StrCat("the subject has no metric '", asked.name(), "'",
                                       NamesOffered(asked.name(), described.metrics(),
                                                    &v1::DesignSpace::MetricDescription::name)));
    }
    plan.metrics.push_back({asked.name(), offered->unit(), asked.noise_floor()});
  }
  return absl::OkStatus();
}

// What shapes are to be interpolated: whether the subject has them.
absl::Status CheckShape(const v1::MapSpecification& specification,
                        const v1::DesignSpace& described) {
  if (!specification.has_shape()) return absl::OkStatus();
  const v1::MapSpecification::ShapeChoice& shape = specification.shape();
  if (shape.geometry() > described.geometry()) {
    return InvalidField(
        "specification.shape.geometry",
        absl::StrCat("the subject offers no ", described.geometry() == v1::SURFACE
                                                   ? "tetrahedra; there is the SURFACE"
                                                   : "shapes and fields"));
  }
  for (int k = 0; k < shape.fields_size(); ++k) {
    const std::string field = absl::StrCat("specification.shape.fields[", k, "].name");
    const std::string& name = shape.fields(k).name();
    const auto offered = std::ranges::find_if(
        described.fields(), [&](const auto& each) { return each.name() == name; });
    if (offered == described.fields().end()) {
      const std::string all = absl::StrJoin(
          described.fields(), ", ",
          [](std::string* text, const auto& each) { absl::StrAppend(text, each.name()); });
      return InvalidField(field, absl::StrCat("the subject has no field '", name, "'; it has ",
                                              all.empty() ? "none" : all));
    }
    if (offered->of_elements() && shape.geometry() != v1::TETRAHEDRA) {
      return InvalidField(field, absl::StrCat("'", name,
                                              "' is of tetrahedra: it needs the geometry "
                                              "TETRAHEDRA"));
    }
  }
  return absl::OkStatus();
}

// Elements keep the coefficients of B-splines over them, 2^K or 4^K of each metric, and there are
// fewer elements than evaluations: some 800 MB at the most. What is smooth is fitted anew around
// each element when it is read, some 10 ms each.
absl::Status CheckSize(const v1::MapSpecification& specification, const MapPlan& plan) {
  constexpr double kMaxCoefficients = 1e8;
  constexpr double kMaxCubicEvaluations = 20'000;
  const bool is_cubic = specification.basis() == v1::MapSpecification::CUBIC;
  // The weights of samples, which shapes take, are as one metric more.
  const double each =
      std::pow(is_cubic ? 4.0 : 2.0, plan.NumberParameters().size()) *
      static_cast<double>(plan.metrics.size() + (specification.has_shape() ? 1 : 0));
  const double most =
      std::min(std::floor(kMaxCoefficients / each), is_cubic ? kMaxCubicEvaluations : 1e9);
  if (plan.evaluations <= most) return absl::OkStatus();
  return InvalidField(
      "specification.evaluations",
      absl::StrCat("at most ", most, " are possible with ", plan.metrics.size(), " metrics and ",
                   plan.NumberParameters().size(), " numbers, ", is_cubic ? "CUBIC" : "LINEAR"));
}

// A metric to ask for where none is wanted, as evaluators want one named: the mass of a design
// costs its shape alone.
std::string LeastMetric(const v1::DesignSpace& described) {
  const auto mass = std::ranges::find_if(
      described.metrics(), [](const auto& metric) { return metric.name() == "mass"; });
  if (mass != described.metrics().end()) return mass->name();
  return described.metrics().empty() ? std::string() : described.metrics(0).name();
}

// Of each structure: the corners of the box, and two designs to know its error by.
int LeastEvaluations(const MapPlan& plan) {
  return std::max((1 << plan.NumberParameters().size()) + 2, kMinEvaluations);
}

absl::Status SetBudget(const v1::MapSpecification& specification, MapPlan& plan) {
  plan.evaluations =
      specification.evaluations() == 0 ? kDefaultEvaluations : specification.evaluations();
  const int least = LeastEvaluations(plan);
  const auto structures = static_cast<int>(plan.structures.cols());
  if (plan.evaluations / structures >= least) return CheckSize(specification, plan);
  return InvalidField("specification.evaluations",
                      absl::StrCat("at least ", structures * least, " are needed for ",
                                   plan.NumberParameters().size(), " numbers and ", structures,
                                   structures == 1 ? " structure" : " structures"));
}

}  // namespace

absl::StatusOr<MapPlan> MakePlan(const v1::MapSpecification& specification,
                                 const v1::DesignSpace& described) {
  MapPlan plan;
  plan.base.resize(described.parameters_size());
  for (int i = 0; i < described.parameters_size(); ++i) {
    plan.names.push_back(described.parameters(i).name());
    plan.base[i] = described.parameters(i).default_value();
  }
  MORTISE_RETURN_IF_ERROR(AddMetrics(specification, described, plan));
  MORTISE_RETURN_IF_ERROR(CheckShape(specification, described));
  MORTISE_RETURN_IF_ERROR(AddVariations(specification, described, plan));
  MORTISE_RETURN_IF_ERROR(FixParameters(specification, described, plan));
  if (plan.parameters.empty()) VaryAllNumbers(specification, described, plan);
  std::ranges::sort(plan.parameters, {}, &PlannedParameter::index);
  MORTISE_RETURN_IF_ERROR(CheckNumbers(specification, plan));
  MORTISE_RETURN_IF_ERROR(Combine(specification, plan));
  MORTISE_RETURN_IF_ERROR(SetBudget(specification, plan));
  return plan;
}

v1::DescribeDesignSpaceRequest DescriptionOf(const v1::MapSpecification& specification) {
  v1::DescribeDesignSpaceRequest request;
  request.set_subject(specification.subject());
  request.set_revision(specification.revision());
  *request.mutable_metric_definitions() = specification.metric_definitions();
  return request;
}

MeshNoiseOptions NoiseWantedOf(const v1::MapSpecification& specification) {
  MeshNoiseOptions wanted;
  for (const auto& metric : specification.metrics()) {
    wanted.of_metrics.push_back(!metric.has_noise_floor());
  }
  if (!specification.has_shape()) return wanted;
  wanted.of_shape = !specification.shape().has_noise_floor();
  for (const auto& field : specification.shape().fields()) {
    if (!field.has_noise_floor()) wanted.of_fields.push_back(field.name());
  }
  return wanted;
}

bool EstimatesNoise(const v1::MapSpecification& specification, const MapPlan& plan) {
  const MeshNoiseOptions wanted = NoiseWantedOf(specification);
  const bool is_any_wanted = wanted.of_shape || !wanted.of_fields.empty() ||
                             std::ranges::find(wanted.of_metrics, true) != wanted.of_metrics.end();
  const auto structures = static_cast<int>(plan.structures.cols());
  return is_any_wanted && !specification.exact_evaluations() &&
         specification.subject().starts_with("templates/") &&
         (plan.evaluations - 1) / structures >= LeastEvaluations(plan);
}

namespace {

// Whether anything that the map has may depend on the air around a design: what nobody here knows,
// as a metric of one's own, may.
bool MayFeelAir(const v1::MapSpecification& specification) {
  const bool is_of_metrics = std::ranges::any_of(specification.metrics(), [](const auto& metric) {
    const simulator::MetricDescription* const known = simulator::FindMetric(metric.name());
    return known == nullptr || known->source == simulator::MetricSource::kAirflow;
  });
  return is_of_metrics || specification.has_airflow() ||
         std::ranges::any_of(specification.shape().fields(),
                             [](const auto& field) { return field.name().starts_with("air_"); });
}

}  // namespace

v1::MapSpecification OnOtherMeshes(const v1::MapSpecification& specification) {
  constexpr double kFiner = 0.8, kCoarser = 1.25, kLeastScale = 0.5;
  constexpr int kDefaultCells = 30'000, kMostCells = 5'000'000;
  v1::MapSpecification other = specification;
  v1::MeshSettings& mesh = *other.mutable_mesh();
  const double scale = mesh.size_scale() == 0 ? 1 : mesh.size_scale();
  mesh.set_size_scale(scale * (scale * kFiner >= kLeastScale ? kFiner : kCoarser));
  if (!MayFeelAir(specification)) return other;
  const int cells = other.airflow().cells() == 0 ? kDefaultCells : other.airflow().cells();
  const double more = cells / (kFiner * kFiner * kFiner);
  other.mutable_airflow()->set_cells(
      static_cast<int>(more <= kMostCells ? more : cells * kFiner * kFiner * kFiner));
  return other;
}

v1::EvaluateBatchRequest QuestionOf(const v1::MapSpecification& specification,
                                    const v1::DesignSpace& described) {
  v1::EvaluateBatchRequest question;
  question.set_subject(specification.subject());
  question.set_revision(specification.revision());
  for (const auto& metric : specification.metrics()) question.add_metrics(metric.name());
  if (question.metrics().empty()) question.add_metrics(LeastMetric(described));
  if (specification.has_shape()) {
    const v1::MapSpecification::ShapeChoice& shape = specification.shape();
    v1::DesignFieldsRequest& wanted = *question.mutable_design_fields();
    wanted.set_geometry(shape.geometry());
    for (const auto& field : shape.fields()) wanted.add_fields(field.name());
    *wanted.mutable_regions() = shape.regions();
    wanted.set_modes(shape.modes());
    // Finer than what is kept of them.
    wanted.set_single_precision(true);
  }
  if (specification.has_mesh()) *question.mutable_mesh() = specification.mesh();
  if (specification.has_airflow()) *question.mutable_airflow() = specification.airflow();
  *question.mutable_metric_definitions() = specification.metric_definitions();
  return question;
}

}  // namespace mortise::interpolator
