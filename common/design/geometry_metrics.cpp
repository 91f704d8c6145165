#include "common/design/geometry_metrics.h"

#include <functional>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/measures/silhouette.h"
#include "common/mesh/measures/standing_solid.h"

namespace mortise::simulator {
namespace {

constexpr char kAxes[] = "xyz";

// "inertia_xy": the rows and columns of the tensor in the order in which they are offered.
constexpr std::pair<int, int> kInertiaEntries[] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};

std::string Axis(int axis) { return std::string(1, kAxes[axis]); }

// Of a name such as "center_of_mass_y", which begins with `stem`: the index of the axis.
std::optional<int> AxisOf(const std::string& name, const std::string& stem) {
  for (int axis = 0; axis < 3; ++axis) {
    if (name == stem + Axis(axis)) return axis;
  }
  return std::nullopt;
}

std::vector<MetricDescription> Describe() {
  std::vector<MetricDescription> metrics{{"mass", "kg", "Mass of all parts."},
                                         {"volume", "m^3", "Volume of all parts."}};
  for (int axis = 0; axis < 3; ++axis) {
    metrics.push_back({absl::StrCat("center_of_mass_", Axis(axis)), "m",
                       absl::StrCat("Where the centre of mass is along ", Axis(axis), ".")});
  }
  for (const auto& [row, column] : kInertiaEntries) {
    const std::string entry = Axis(row) + Axis(column);
    metrics.push_back(
        {absl::StrCat("inertia_", entry), "kg*m^2",
         row == column
             ? absl::StrCat("Moment of inertia about the axis along ", Axis(row),
                            " through the centre of mass.")
             : absl::StrCat("Entry ", entry, " of the inertia tensor about the centre of mass: ",
                            "minus the integral of ", Axis(row), "*", Axis(column),
                            " over the mass.")});
  }
  for (int axis = 0; axis < 3; ++axis) {
    metrics.push_back({absl::StrCat("projected_area_", Axis(axis)), "m^2",
                       absl::StrCat("Area of the silhouette seen along ", Axis(axis), ".")});
  }
  metrics.push_back({"drag", "N",
                     "Drag of a wind of 10 m/s from the front, along -x: half the density of air, "
                     "times the speed squared, times the silhouette across it."});
  metrics.push_back({"toppling_margin", "m",
                     "From below the centre of mass to the nearest edge of the polygon it stands "
                     "on; negative where it topples."});
  metrics.push_back({"toppling_angle", "rad",
                     "By how much the floor may tilt before it topples; negative where it topples "
                     "on a level one."});
  metrics.push_back({"displaced_volume", "m^3", "Fresh water that it displaces while it floats."});
  metrics.push_back({"draught", "m", "How deep it lies in fresh water, floating upright."});
  metrics.push_back({"freeboard", "m", "From the water to its highest point, floating upright."});
  metrics.push_back({"metacentric_height", "m",
                     "From the centre of mass up to the metacentre, floating upright; negative "
                     "where it would capsize."});
  return metrics;
}

}  // namespace

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
  static const std::vector<MetricDescription> metrics = Describe();
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
  if (metric == "volume") return volume_;
  // Combine keeps the mass where one body has its volume.
  if (metric == "mass") return Body().volume;
  if (const auto axis = AxisOf(metric, "center_of_mass_")) return Body().centroid[*axis];
  for (const auto& [row, column] : kInertiaEntries) {
    if (metric == absl::StrCat("inertia_", Axis(row), Axis(column))) {
      return Body().inertia(row, column);
    }
  }
  if (const auto axis = AxisOf(metric, "projected_area_")) {
    return mesh::ProjectedArea(surfaces_, Eigen::Vector3d::Unit(*axis));
  }
  if (metric == "drag") {
    return surroundings_.air_density / 2 * surroundings_.wind.squaredNorm() *
           surroundings_.drag_coefficient * mesh::ProjectedArea(surfaces_, surroundings_.wind);
  }
  if (metric == "toppling_margin") return mesh::StandOnFloor(surfaces_, Body().centroid).margin;
  if (metric == "toppling_angle") return mesh::StandOnFloor(surfaces_, Body().centroid).angle;
  static const std::map<std::string, double mesh::Floating::*> afloat{
      {"displaced_volume", &mesh::Floating::displaced_volume},
      {"draught", &mesh::Floating::draught},
      {"freeboard", &mesh::Floating::freeboard},
      {"metacentric_height", &mesh::Floating::metacentric_height}};
  const auto entry = afloat.find(metric);
  if (entry == afloat.end()) return InvalidField("metric", absl::StrCat("there is no ", metric));
  MORTISE_ASSIGN_OR_RETURN(const mesh::Floating floating, Float());
  return floating.*entry->second;
}

}  // namespace mortise::simulator
