#include "services/interpolator/service/map_specification.h"

#include <set>
#include <string>
#include <string_view>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/violation_lists.h"
#include "common/files/evaluation_settings.h"
#include "mortise/v1/interpolator.pb.h"

namespace mortise::interpolator {
namespace {

// All faults so far.
class Faults {
 public:
  void Add(const absl::Status& fault) { faults_ = CombineViolations(faults_, fault); }
  void AddField(std::string_view field, std::string_view message) {
    Add(InvalidField(field, message));
  }
  template <typename Number>
  void CheckRange(std::string_view field, Number value, Number least, Number most) {
    if (!(value >= least && value <= most)) {
      AddField(field, absl::StrCat("must lie between ", least, " and ", most));
    }
  }
  const absl::Status& status() const { return faults_; }

 private:
  absl::Status faults_;
};

void CheckMetrics(const v1::MapSpecification& specification, Faults& faults) {
  const int least = specification.has_shape() ? 0 : 1;
  if (specification.metrics_size() < least || specification.metrics_size() > kMaxMetrics) {
    faults.AddField("metrics", absl::StrCat(least, " to ", kMaxMetrics, " are needed, not ",
                                            specification.metrics_size()));
    return;
  }
  std::set<std::string> names;
  for (int i = 0; i < specification.metrics_size(); ++i) {
    const auto& metric = specification.metrics(i);
    const std::string field = absl::StrCat("metrics[", i, "]");
    if (metric.name().empty()) {
      faults.AddField(field + ".name", "must name a metric");
    } else if (!names.insert(metric.name()).second) {
      faults.AddField(field + ".name", "is given twice");
    }
    if (!(metric.noise_floor() >= 0)) {
      faults.AddField(field + ".noise_floor", "must be at least 0");
    }
  }
}

// Names of fields and regions.
void CheckName(const std::string& field, const std::string& name, std::set<std::string>& names,
               Faults& faults) {
  if (name.empty()) {
    faults.AddField(field, "must not be empty");
  } else if (!names.insert(name).second) {
    faults.AddField(field, absl::StrCat("'", name, "' is given twice"));
  }
}

void CheckNames(const v1::MapSpecification::ShapeChoice& shape, Faults& faults) {
  std::set<std::string> fields, regions;
  for (int i = 0; i < shape.fields_size(); ++i) {
    const std::string field = absl::StrCat("shape.fields[", i, "]");
    // Before the name: what is there is named before what is missing.
    faults.CheckRange(field + ".noise_floor", shape.fields(i).noise_floor(), 0.0, 1.0);
    CheckName(field + ".name", shape.fields(i).name(), fields, faults);
  }
  for (int i = 0; i < shape.regions_size(); ++i) {
    CheckName(absl::StrCat("shape.regions[", i, "]"), shape.regions(i), regions, faults);
  }
}

void CheckShape(const v1::MapSpecification& specification, Faults& faults) {
  if (!specification.has_shape()) return;
  const v1::MapSpecification::ShapeChoice& shape = specification.shape();
  faults.CheckRange("shape.noise_floor", shape.noise_floor(), 0.0, 1.0);
  faults.CheckRange("shape.modes", shape.modes(), 0, kMaxModes);
  if (specification.basis() == v1::MapSpecification::CUBIC) {
    faults.AddField("basis", "must be LINEAR for shapes");
  }
  faults.CheckRange("shape.fields", shape.fields_size(), 0, kMaxFields);
  faults.CheckRange("shape.regions", shape.regions_size(), 0, kMaxRegions);
  if (shape.fields_size() <= kMaxFields && shape.regions_size() <= kMaxRegions) {
    CheckNames(shape, faults);
  }
  // Last, for the same reason.
  if (shape.geometry() != v1::SURFACE && shape.geometry() != v1::TETRAHEDRA) {
    faults.AddField("shape.geometry", "must be SURFACE or TETRAHEDRA");
  }
}

void CheckParameters(const v1::MapSpecification& specification, Faults& faults) {
  // No more than there can be parameters: each that is wrong would be told.
  const auto is_too_long = [&faults](const char* field, int size) {
    if (size <= kMaxParameters) return false;
    faults.AddField(field, absl::StrCat("are ", size, ", of at most ", kMaxParameters));
    return true;
  };
  const bool variations = is_too_long("variations", specification.variations_size());
  const bool fixed = is_too_long("fixed", specification.fixed_size());
  if (variations || fixed) return;
  std::set<std::string> names;
  for (int i = 0; i < specification.variations_size(); ++i) {
    const auto& variation = specification.variations(i);
    const std::string field = absl::StrCat("variations[", i, "]");
    if (!names.insert(variation.parameter()).second) {
      faults.AddField(field + ".parameter", "is given twice");
    }
    if (variation.has_minimum() && variation.has_maximum() &&
        !(variation.minimum() < variation.maximum())) {
      faults.AddField(field + ".maximum", "must lie above the minimum");
    }
  }
  for (int i = 0; i < specification.fixed_size(); ++i) {
    if (!names.insert(specification.fixed(i).name()).second) {
      faults.AddField(absl::StrCat("fixed[", i, "].name"),
                      "is given twice: a parameter varies or is fixed, once");
    }
  }
}

void CheckNumbers(const v1::MapSpecification& specification, Faults& faults) {
  if (specification.revision() < 0) faults.AddField("revision", "must be at least 0");
  if (!v1::MapSpecification::Basis_IsValid(specification.basis())) {
    faults.AddField("basis", "must be LINEAR or CUBIC");
  }
  if (specification.evaluations() != 0) {
    faults.CheckRange("evaluations", specification.evaluations(), kMinEvaluations, kMaxEvaluations);
  }
  const double values =
      static_cast<double>(specification.evaluations()) * specification.metrics_size();
  if (values > kMaxValues) {
    faults.AddField("evaluations",
                    absl::StrCat("with ", specification.metrics_size(), " metrics, at most ",
                                 kMaxValues / specification.metrics_size(), " are possible"));
  }
  faults.CheckRange("tolerance", specification.tolerance(), 0.0, 1.0);
  faults.CheckRange("seconds", specification.seconds(), 0.0, kMaxSeconds);
  if (specification.most_structures() != 0) {
    faults.CheckRange("most_structures", specification.most_structures(), 1, kMaxStructures);
  }
}

}  // namespace

absl::Status CheckSubject(const std::string& subject) {
  const char* const collection =
      absl::StartsWith(subject, "evaluators/") ? "evaluators" : "templates";
  if (ParseResourceName(subject, collection, "subject").ok()) return absl::OkStatus();
  return InvalidField("subject", "must have the form templates/{id} or evaluators/{id}");
}

absl::Status CheckSpecification(const v1::MapSpecification& specification) {
  Faults faults;
  faults.Add(CheckSubject(specification.subject()));
  CheckMetrics(specification, faults);
  CheckShape(specification, faults);
  CheckParameters(specification, faults);
  CheckNumbers(specification, faults);
  faults.Add(parametric::CheckMeshSettings(specification.mesh()));
  faults.Add(parametric::ReadAirflow(specification.airflow()).status());
  return UnderField("specification", faults.status());
}

}  // namespace mortise::interpolator
