#include "services/simulator/analysis/analysis_report.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/base/units.h"
#include "common/mesh/files/vtu_writer.h"
#include "common/mesh/tetrahedra/mesher.h"
#include "common/render/axis_numbers.h"
#include "common/render/image.h"
#include "common/render/scene.h"

namespace mortise::simulator {
namespace {

// A round exaggeration not above `factor`: 1, 2 or 5 times a power of ten.
double RoundDown(double factor) {
  if (!(factor > 1)) return 1;
  const double power = std::pow(10.0, std::floor(std::log10(factor)));
  const double lead = factor / power;
  return power * (lead >= 5 ? 5 : lead >= 2 ? 2 : 1);
}

// The value below which `share` of the surface's nodes lie.
double Percentile(const Eigen::VectorXd& values, const Eigen::Matrix3Xi& triangles, double share) {
  std::vector<double> sorted(triangles.size());
  for (Eigen::Index k = 0; k < triangles.size(); ++k) sorted[k] = values[triangles.data()[k]];
  if (sorted.empty()) return 0;
  const std::size_t rank =
      std::min(sorted.size() - 1, static_cast<std::size_t>(share * sorted.size()));
  std::nth_element(sorted.begin(), sorted.begin() + rank, sorted.end());
  return sorted[rank];
}

render::Shape PartShape(const mesh::TetrahedralMesh& volume, int part) {
  render::Shape shape;
  shape.triangles = mesh::OuterTriangles(volume, part);
  shape.vertices = volume.nodes;
  shape.edge_width = 1.0;
  return shape;
}

// The undeformed body, behind all else.
render::Shape Outline(const mesh::TetrahedralMesh& volume, const render::Scene& scene) {
  render::Shape ghost;
  ghost.vertices = volume.nodes;
  ghost.triangles = mesh::OuterTriangles(volume);
  ghost.backdrop = true;
  ghost.color = scene.background;
  ghost.edge_width = 0.8;
  ghost.edge_color = {0.62, 0.64, 0.68};
  return ghost;
}

absl::StatusOr<std::string> Draw(render::Scene scene, const StressPictureOptions& options) {
  scene.camera = render::FitCamera(render::BoundingBox(scene), render::kViewIsometric,
                                   static_cast<double>(options.width) / options.height, true, 0.03);
  MORTISE_ASSIGN_OR_RETURN(
      const render::Image image,
      render::Render(scene, {.width = options.width, .height = options.height}));
  return render::EncodePng(image);
}

}  // namespace

absl::StatusOr<std::string> DrawStress(const mesh::TetrahedralMesh& volume,
                                       const ElasticitySolution& solution, const std::string& title,
                                       const StressPictureOptions& options) {
  const Eigen::Vector3d extent =
      volume.nodes.rowwise().maxCoeff() - volume.nodes.rowwise().minCoeff();
  const double largest = solution.summary.maximum_displacement;
  const double factor =
      largest > 0 ? RoundDown(options.visible_deflection * extent.norm() / largest) : 1;
  render::Scene scene;
  double stress_scale = 0;
  for (int p = 0; p < static_cast<int>(volume.part_names.size()); ++p) {
    render::Shape shape = PartShape(volume, p);
    stress_scale = std::max(stress_scale, Percentile(solution.von_mises, shape.triangles, 0.995));
    shape.vertices += factor * solution.displacement;
    shape.scalars = solution.von_mises / kMegapascal;
    scene.shapes.push_back(shape);
  }
  scene.shapes.push_back(Outline(volume, scene));
  scene.color_bar = render::ColorBar{0, stress_scale / kMegapascal, "von Mises (MPa)"};
  scene.title = title;
  scene.footnote =
      absl::StrFormat("deflection %s mm, drawn ×%.0f; largest stress %s MPa; %d elements",
                      render::ShortNumber(largest / kMillimetre, 3), factor,
                      render::ShortNumber(solution.von_mises.maxCoeff() / kMegapascal, 3),
                      solution.summary.elements);
  return Draw(std::move(scene), options);
}

std::vector<mesh::VtuField> ShapeFields(const ModalSolution& vibration) {
  std::vector<mesh::VtuField> fields;
  for (std::size_t m = 0; m < vibration.modes.size(); ++m) {
    const Mode& mode = vibration.modes[m];
    fields.push_back({absl::StrFormat("mode %d (%.5g Hz)", m + 1, mode.frequency), mode.shape});
  }
  return fields;
}

absl::StatusOr<std::string> DrawMode(const mesh::TetrahedralMesh& volume, const Mode& mode,
                                     const std::string& title,
                                     const StressPictureOptions& options) {
  const Eigen::VectorXd amplitude = mode.shape.colwise().norm().transpose();
  const double largest = amplitude.size() > 0 ? amplitude.maxCoeff() : 0;
  if (!(largest > 0)) {
    return PreconditionFailed("NO_SOLUTION", "the mode moves nothing", "modes");
  }
  const Eigen::Vector3d extent =
      volume.nodes.rowwise().maxCoeff() - volume.nodes.rowwise().minCoeff();
  render::Scene scene;
  for (int p = 0; p < static_cast<int>(volume.part_names.size()); ++p) {
    render::Shape shape = PartShape(volume, p);
    shape.vertices += options.visible_deflection * extent.norm() / largest * mode.shape;
    shape.scalars = amplitude / largest;
    scene.shapes.push_back(shape);
  }
  scene.shapes.push_back(Outline(volume, scene));
  scene.color_bar = render::ColorBar{0, 1, "share of the largest motion"};
  scene.title = title;
  scene.footnote = absl::StrFormat("%s Hz; %d elements", render::ShortNumber(mode.frequency, 5),
                                   volume.tetrahedra.cols());
  return Draw(std::move(scene), options);
}

absl::StatusOr<std::string> DrawTemperature(const mesh::TetrahedralMesh& volume,
                                            const Eigen::VectorXd& temperature,
                                            const std::string& title,
                                            const StressPictureOptions& options) {
  render::Scene scene;
  for (int p = 0; p < static_cast<int>(volume.part_names.size()); ++p) {
    render::Shape shape = PartShape(volume, p);
    shape.scalars = temperature;
    scene.shapes.push_back(shape);
  }
  const double minimum = temperature.minCoeff(), maximum = temperature.maxCoeff();
  // A bar needs a length, which a uniform temperature does not give.
  scene.color_bar = render::ColorBar{
      minimum, std::max(maximum, minimum + 1e-9 * std::max(1.0, std::abs(minimum))), "temperature"};
  scene.title = title;
  scene.footnote = absl::StrFormat("from %s to %s; %d elements", render::ShortNumber(minimum, 4),
                                   render::ShortNumber(maximum, 4), volume.tetrahedra.cols());
  return Draw(std::move(scene), options);
}

absl::StatusOr<std::string> DrawAirPressure(const AirflowSolution& airflow,
                                            const Eigen::Vector3d& wind, const std::string& title,
                                            const StressPictureOptions& options) {
  render::Scene scene;
  render::Shape shape;
  shape.vertices = airflow.surface.vertices;
  shape.triangles = airflow.surface.triangles;
  shape.scalars = airflow.pressure;
  shape.edges = false;  // triangles share no edges, so that each would be drawn as a border
  scene.shapes.push_back(shape);
  scene.color_bar =
      render::ColorBar{Percentile(airflow.pressure, shape.triangles, 0.005),
                       Percentile(airflow.pressure, shape.triangles, 0.995), "pressure (Pa)"};
  // Blows against the middle of the design, from outside of it.
  const Eigen::Vector3d low = shape.vertices.rowwise().minCoeff();
  const Eigen::Vector3d high = shape.vertices.rowwise().maxCoeff();
  const double radius = (high - low).norm() / 2;
  const Eigen::Vector3d along = wind.normalized();
  render::Line arrow;
  arrow.points.resize(3, 2);
  arrow.points.col(0) = (low + high) / 2 - 1.4 * radius * along;
  arrow.points.col(1) = (low + high) / 2 - 1.05 * radius * along;
  arrow.arrow = true;
  scene.lines.push_back(arrow);
  scene.title = title;
  scene.footnote = absl::StrFormat("wind %s m/s; %s to %s Pa; drag %s N; %d cells",
                                   render::ShortNumber(wind.norm(), 3),
                                   render::ShortNumber(airflow.minimum_pressure, 3),
                                   render::ShortNumber(airflow.maximum_pressure, 3),
                                   render::ShortNumber(airflow.force.dot(along), 3), airflow.cells);
  return Draw(std::move(scene), options);
}

}  // namespace mortise::simulator
