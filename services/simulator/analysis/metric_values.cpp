#include "services/simulator/analysis/metric_values.h"

#include <algorithm>
#include <limits>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/mass_properties.h"

namespace mortise::simulator {
namespace {

// The largest share of its strength that any part is under; parts of unknown strength are left out.
double StressRatio(const DesignModel& model, const ElasticitySolution& solution) {
  double ratio = 0;
  for (std::size_t p = 0; p < model.analysis.materials.size(); ++p) {
    const double strength = model.analysis.materials[p].strength;
    if (strength > 0) ratio = std::max(ratio, solution.part_maximum_von_mises[p] / strength);
  }
  return ratio;
}

double LowestFrequency(const ModalSolution& vibration) {
  return vibration.modes[static_cast<std::size_t>(vibration.rigid_motions)].frequency;
}

absl::Status NotReadFrom(const char* source, BuiltInMetric metric) {
  return absl::InternalError(
      absl::StrCat(DescriptionOf(metric).name, " is not computed from ", source));
}

absl::StatusOr<double> ValueOfHeat(BuiltInMetric metric, const HeatSolution& heat) {
  switch (metric) {
    case BuiltInMetric::kMaxTemperature:
      return heat.maximum;
    case BuiltInMetric::kMinTemperature:
      return heat.minimum;
    case BuiltInMetric::kMeanTemperature:
      return heat.mean;
    case BuiltInMetric::kHeatDissipation:
      return DissipatedHeat(heat);
    default:
      return NotReadFrom("heat", metric);
  }
}

absl::StatusOr<double> ValueOfAirflow(BuiltInMetric metric, const AirflowSolution& airflow,
                                      const Eigen::Vector3d& wind) {
  switch (metric) {
    case BuiltInMetric::kAirflowDrag:
      return airflow.force.dot(wind.normalized());
    case BuiltInMetric::kAirflowForceX:
      return airflow.force.x();
    case BuiltInMetric::kAirflowForceY:
      return airflow.force.y();
    case BuiltInMetric::kAirflowForceZ:
      return airflow.force.z();
    case BuiltInMetric::kMaxAirPressure:
      return airflow.maximum_pressure;
    case BuiltInMetric::kMinAirPressure:
      return airflow.minimum_pressure;
    default:
      return NotReadFrom("the air", metric);
  }
}

absl::StatusOr<double> ValueUnderLoads(BuiltInMetric metric, const DesignModel& model,
                                       const SolvedCase& solved) {
  const ElasticitySolution& solution = solved.solution;
  switch (metric) {
    case BuiltInMetric::kMaxDisplacement:
      return solution.summary.maximum_displacement;
    case BuiltInMetric::kMaxVonMises:
      return solution.part_maximum_von_mises.maxCoeff();
    case BuiltInMetric::kMaxPrincipal:
      return solution.maximum_principal.maxCoeff();
    case BuiltInMetric::kCompliance:
      return solution.summary.compliance;
    case BuiltInMetric::kStrainEnergy:
      return solution.summary.strain_energy;
    case BuiltInMetric::kStressRatio:
      return StressRatio(model, solution);
    case BuiltInMetric::kMeanVonMises:
      return solved.spread->Mean();
    case BuiltInMetric::kRmsVonMises:
      return solved.spread->RootMeanSquare();
    case BuiltInMetric::kVonMisesP99:
      return solved.spread->Percentile(kShareBelowP99);
    case BuiltInMetric::kVonMisesIntegral:
      return solved.spread->Integral();
    case BuiltInMetric::kRelativeError:
      return solved.error->relative;
    default:
      return NotReadFrom("the loads", metric);
  }
}

}  // namespace

bool IsOfSpread(BuiltInMetric metric) {
  using enum BuiltInMetric;
  return metric == kMeanVonMises || metric == kRmsVonMises || metric == kVonMisesP99 ||
         metric == kVonMisesIntegral;
}

mesh::SurfaceMesh OutsideOf(const mesh::AssemblySurface& surface) {
  mesh::SurfaceMesh outside{surface.vertices, surface.triangles};
  Eigen::Index count = 0;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const mesh::AssemblyFace& face =
        surface.faces[static_cast<std::size_t>(surface.triangle_face[t])];
    const bool is_between_parts = face.front_part >= 0 && face.back_part >= 0;
    if (!is_between_parts) outside.triangles.col(count++) = surface.triangles.col(t);
  }
  outside.triangles.conservativeResize(Eigen::NoChange, count);
  return outside;
}

absl::StatusOr<Metric> ReadMetric(const MetricDescription& metric, const DesignModel& model,
                                  const DesignAnalysis& analysis, const Eigen::Vector3d& wind,
                                  GeometryMetrics& geometry) {
  Metric computed{metric.name, metric.unit, 0};
  switch (metric.source) {
    case MetricSource::kParts: {
      MORTISE_ASSIGN_OR_RETURN(computed.value, geometry.Value(metric.name));
      break;
    }
    case MetricSource::kOutside:
      computed.value = mesh::SurfaceArea(OutsideOf(model.surface));
      break;
    case MetricSource::kPrices: {
      MORTISE_RETURN_IF_ERROR(model.cost.status());
      computed.value = model.cost->amount;
      computed.unit = model.cost->currency;
      break;
    }
    case MetricSource::kModes:
      computed.value = LowestFrequency(*analysis.vibration);
      break;
    case MetricSource::kHeat: {
      MORTISE_ASSIGN_OR_RETURN(computed.value, ValueOfHeat(metric.metric, *analysis.heat));
      break;
    }
    case MetricSource::kAirflow: {
      MORTISE_ASSIGN_OR_RETURN(computed.value,
                               ValueOfAirflow(metric.metric, *analysis.airflow, wind));
      break;
    }
    case MetricSource::kLoads:
      computed.value = -std::numeric_limits<double>::infinity();
      for (const SolvedCase& solved : analysis.cases) {
        MORTISE_ASSIGN_OR_RETURN(const double value, ValueUnderLoads(metric.metric, model, solved));
        computed.value = std::max(computed.value, value);
      }
      break;
  }
  return computed;
}

}  // namespace mortise::simulator
