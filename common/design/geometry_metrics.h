// Computes what a design is by its shape alone, without a mesh or a solution: mass and inertia,
// shadows and drag, standing and floating.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/design/metric_registry.h"
#include "common/mesh/mass_properties.h"
#include "common/mesh/measures/floating_solid.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::simulator {

// A part by itself.
struct SolidPart {
  mesh::SurfaceMesh surface;  // closed and outward
  double volume = 0;          // m³; that of the exact shape where the surface only comes near it
  double density = 0;         // kg/m³
};

// The surroundings of a design.
struct Surroundings {
  Eigen::Vector3d wind{-10, 0, 0};  // m/s, the way it blows: from the front, for what faces +x
  double drag_coefficient = 1;      // of the shadow across the wind
  double air_density = 1.225;       // kg/m³, at 15 °C and sea level
  double water_density = 1000;      // kg/m³
};

// Computes metrics by name; what several of them need is computed once. Parts do not overlap.
class GeometryMetrics {
 public:
  explicit GeometryMetrics(std::vector<SolidPart> parts, Surroundings surroundings = {});

  // Returns the metrics of MetricSource::kParts, in the order in which they are shown.
  static const std::vector<MetricDescription>& Offered();

  // Returns the value of an offered metric. FAILED_PRECONDITION, SINKS, for those of what floats
  // where it does not; INVALID_ARGUMENT for what is not offered.
  //
  // Mass, centre and inertia are of each part's surface with a density that gives it the mass of
  // its exact volume: exact for polyhedra; else centre and inertia have the error of the surface's
  // triangles, not its volume's.
  absl::StatusOr<double> Value(const std::string& metric);

 private:
  const mesh::MassProperties& Body();
  absl::StatusOr<mesh::Floating> Float();
  absl::StatusOr<double> ValueInPlace(BuiltInMetric metric);
  absl::StatusOr<double> ValueAfloat(double mesh::Floating::*value);

  std::vector<mesh::SurfaceMesh> surfaces_;
  std::vector<double> densities_;  // of the surfaces, kg/m³
  double volume_ = 0;
  Surroundings surroundings_;
  std::optional<mesh::MassProperties> body_;
  std::optional<absl::StatusOr<mesh::Floating>> floating_;
};

}  // namespace mortise::simulator
