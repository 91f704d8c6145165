#include "services/simulator/analysis/metric_values.h"

#include <algorithm>
#include <limits>
#include <string>

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

double ValueOfHeat(const std::string& name, const HeatSolution& heat) {
  if (name == "max_temperature") return heat.maximum;
  if (name == "min_temperature") return heat.minimum;
  if (name == "mean_temperature") return heat.mean;
  return DissipatedHeat(heat);
}

double ValueOfAirflow(const std::string& name, const AirflowSolution& airflow,
                      const Eigen::Vector3d& wind) {
  if (name == "airflow_drag") return airflow.force.dot(wind.normalized());
  if (name == "airflow_force_x") return airflow.force.x();
  if (name == "airflow_force_y") return airflow.force.y();
  if (name == "airflow_force_z") return airflow.force.z();
  return name == "max_air_pressure" ? airflow.maximum_pressure : airflow.minimum_pressure;
}

double ValueUnderLoads(const std::string& name, const DesignModel& model,
                       const SolvedCase& solved) {
  const ElasticitySolution& solution = solved.solution;
  if (name == "max_displacement") return solution.summary.maximum_displacement;
  if (name == "max_von_mises") return solution.part_maximum_von_mises.maxCoeff();
  if (name == "max_principal") return solution.maximum_principal.maxCoeff();
  if (name == "relative_error") return solved.error->relative;
  if (name == "compliance") return solution.summary.compliance;
  if (name == "strain_energy") return solution.summary.strain_energy;
  return StressRatio(model, solution);
}

}  // namespace

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
    case MetricSource::kHeat:
      computed.value = ValueOfHeat(metric.name, *analysis.heat);
      break;
    case MetricSource::kAirflow:
      computed.value = ValueOfAirflow(metric.name, *analysis.airflow, wind);
      break;
    case MetricSource::kLoads:
      computed.value = -std::numeric_limits<double>::infinity();
      for (const SolvedCase& solved : analysis.cases) {
        computed.value = std::max(computed.value, ValueUnderLoads(metric.name, model, solved));
      }
      break;
  }
  return computed;
}

}  // namespace mortise::simulator
