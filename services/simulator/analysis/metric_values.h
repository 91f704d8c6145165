// Reads what an offered metric is on a design that was solved.
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "common/design/geometry_metrics.h"
#include "common/design/metric.h"
#include "common/design/metric_registry.h"
#include "common/mesh/surface_mesh.h"
#include "services/simulator/analysis/design_analysis.h"

namespace mortise::simulator {

// Whether a metric tells how the stress is spread over the volume, for which each load case needs
// its spread.
bool IsOfSpread(BuiltInMetric metric);

// Returns all of a surface that lies between no two parts.
mesh::SurfaceMesh OutsideOf(const mesh::AssemblySurface& surface);

// `analysis` must hold what the metric's source names; under loads it is that of the load case
// where it is worst. Fails as GeometryMetrics and the model's cost do. `wind`: m/s, the air's.
absl::StatusOr<Metric> ReadMetric(const MetricDescription& metric, const DesignModel& model,
                                  const DesignAnalysis& analysis, const Eigen::Vector3d& wind,
                                  GeometryMetrics& geometry);

}  // namespace mortise::simulator
