#include "common/design/geometry_metrics.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/measures/silhouette.h"
#include "common/mesh/measures/standing_solid.h"

namespace mortise::simulator {

GeometryMetrics::GeometryMetrics(std::vector<SolidPart> parts, Surroundings surroundings)
    : surroundings_(std::move(surroundings)) {
  for (SolidPart& part : parts) {
    const double enclosed = mesh::ComputeMassProperties(part.surface).volume;
    surfaces_.push_back(std::move(part.surface));
    densities_.push_back(enclosed > 0 ? part.density * part.volume / enclosed : 0);
    volume_ += part.volume;
  }
}

const std::vector<MetricDescription>& GeometryMetrics::Offered() {
  static const std::vector<MetricDescription> metrics = [] {
    std::vector<MetricDescription> of_parts = OfferedMetrics();
    std::erase_if(of_parts, [](const MetricDescription& metric) {
      return metric.source != MetricSource::kParts;
    });
    return of_parts;
  }();
  return metrics;
}

const mesh::MassProperties& GeometryMetrics::Body() {
  if (!body_) {
    std::vector<mesh::MassProperties> bodies;
    for (const mesh::SurfaceMesh& surface : surfaces_) {
      bodies.push_back(mesh::ComputeMassProperties(surface));
    }
    body_ = mesh::Combine(bodies, densities_);
  }
  return *body_;
}

absl::StatusOr<mesh::Floating> GeometryMetrics::Float() {
  if (!floating_) {
    const mesh::MassProperties& body = Body();
    floating_ =
        mesh::FloatUpright(surfaces_, body.volume, body.centroid, surroundings_.water_density);
  }
  return *floating_;
}

absl::StatusOr<double> GeometryMetrics::Value(const std::string& metric) {
  const MetricDescription* const description = FindMetric(metric);
  if (description == nullptr || description->source != MetricSource::kParts) {
    return InvalidField("metric", absl::StrCat("there is no ", metric));
  }
  using enum BuiltInMetric;
  switch (description->metric) {
    case kMass:
      return Body().volume;  // Combine keeps the mass where one body has its volume.
    case kVolume:
      return volume_;
    case kCenterOfMassX:
      return Body().centroid.x();
    case kCenterOfMassY:
      return Body().centroid.y();
    case kCenterOfMassZ:
      return Body().centroid.z();
    case kInertiaXx:
      return Body().inertia(0, 0);
    case kInertiaYy:
      return Body().inertia(1, 1);
    case kInertiaZz:
      return Body().inertia(2, 2);
    case kInertiaXy:
      return Body().inertia(0, 1);
    case kInertiaYz:
      return Body().inertia(1, 2);
    case kInertiaXz:
      return Body().inertia(0, 2);
    default:
      return ValueInPlace(description->metric);
  }
}

// A metric of how the design stands in the world: its shadows, on the floor, in the water.
absl::StatusOr<double> GeometryMetrics::ValueInPlace(BuiltInMetric metric) {
  using enum BuiltInMetric;
  switch (metric) {
    case kProjectedAreaX:
      return mesh::ProjectedArea(surfaces_, Eigen::Vector3d::UnitX());
    case kProjectedAreaY:
      return mesh::ProjectedArea(surfaces_, Eigen::Vector3d::UnitY());
    case kProjectedAreaZ:
      return mesh::ProjectedArea(surfaces_, Eigen::Vector3d::UnitZ());
    case kDrag:
      return surroundings_.air_density / 2 * surroundings_.wind.squaredNorm() *
             surroundings_.drag_coefficient * mesh::ProjectedArea(surfaces_, surroundings_.wind);
    case kTopplingMargin:
      return mesh::StandOnFloor(surfaces_, Body().centroid).margin;
    case kTopplingAngle:
      return mesh::StandOnFloor(surfaces_, Body().centroid).angle;
    case kDisplacedVolume:
      return ValueAfloat(&mesh::Floating::displaced_volume);
    case kDraught:
      return ValueAfloat(&mesh::Floating::draught);
    case kFreeboard:
      return ValueAfloat(&mesh::Floating::freeboard);
    case kMetacentricHeight:
      return ValueAfloat(&mesh::Floating::metacentric_height);
    default:
      return absl::InternalError(
          absl::StrCat(DescriptionOf(metric).name, " is not computed from the parts"));
  }
}

absl::StatusOr<double> GeometryMetrics::ValueAfloat(double mesh::Floating::*value) {
  MORTISE_ASSIGN_OR_RETURN(const mesh::Floating floating, Float());
  return floating.*value;
}

}  // namespace mortise::simulator
