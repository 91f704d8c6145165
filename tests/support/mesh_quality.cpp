#include "tests/support/mesh_quality.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "absl/strings/str_format.h"

namespace mortise::testing {
namespace {

struct ElementShape {
  double volume = 0;
  double minimum_dihedral = std::numbers::pi;
  double maximum_dihedral = 0;
  double aspect = std::numeric_limits<double>::infinity();
};

ElementShape Measure(const std::array<Eigen::Vector3d, 4>& corner) {
  ElementShape shape;
  shape.volume =
      (corner[1] - corner[0]).dot((corner[2] - corner[0]).cross(corner[3] - corner[0])) / 6;
  std::array<Eigen::Vector3d, 4>
      normal;  // of the face opposite each corner; length is twice its area
  double largest_face = 0, longest = 0;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d &a = corner[(i + 1) % 4], &b = corner[(i + 2) % 4],
                          &c = corner[(i + 3) % 4];
    normal[i] = (b - a).cross(c - a);
    if (normal[i].dot(corner[i] - a) > 0) normal[i] = -normal[i];  // outward
    largest_face = std::max(largest_face, 0.5 * normal[i].norm());
  }
  for (int i = 0; i < 4; ++i) {
    for (int j = i + 1; j < 4; ++j) {
      longest = std::max(longest, (corner[i] - corner[j]).norm());
      const double cosine =
          std::clamp(-normal[i].normalized().dot(normal[j].normalized()), -1.0, 1.0);
      const double angle = std::acos(cosine);
      shape.minimum_dihedral = std::min(shape.minimum_dihedral, angle);
      shape.maximum_dihedral = std::max(shape.maximum_dihedral, angle);
    }
  }
  const double height = 3 * std::abs(shape.volume) / largest_face;
  if (height > 0) shape.aspect = std::sqrt(2.0 / 3) * longest / height;
  return shape;
}

}  // namespace

QualityReport MeasureQuality(const mesh::TetrahedralMesh& mesh) {
  QualityReport report;
  report.elements = static_cast<int>(mesh.tetrahedra.cols());
  report.nodes = static_cast<int>(mesh.nodes.cols());
  if (report.elements == 0) return report;
  report.minimum_volume = std::numeric_limits<double>::infinity();
  report.minimum_dihedral = std::numbers::pi;
  for (int e = 0; e < report.elements; ++e) {
    std::array<Eigen::Vector3d, 4> corner;
    for (int k = 0; k < 4; ++k) corner[k] = mesh.nodes.col(mesh.tetrahedra(k, e));
    const ElementShape shape = Measure(corner);
    report.minimum_volume = std::min(report.minimum_volume, shape.volume);
    report.minimum_dihedral = std::min(report.minimum_dihedral, shape.minimum_dihedral);
    report.maximum_dihedral = std::max(report.maximum_dihedral, shape.maximum_dihedral);
    report.mean_aspect += shape.aspect / report.elements;
    if (!(shape.aspect <= report.maximum_aspect)) {
      report.maximum_aspect = shape.aspect;
      report.worst_element = e;
    }
    const int bin = static_cast<int>(shape.minimum_dihedral * 36 / std::numbers::pi);
    ++report.dihedral_histogram[std::clamp(bin, 0, 17)];
  }
  return report;
}

std::string ToText(const QualityReport& report) {
  const double degrees = 180 / std::numbers::pi;
  return absl::StrFormat(
      "%d elements, %d nodes; dihedral angles %.1f to %.1f degrees; aspect ratio %.2f on average, "
      "at worst %.2f (element %d)",
      report.elements, report.nodes, degrees * report.minimum_dihedral,
      degrees * report.maximum_dihedral, report.mean_aspect, report.maximum_aspect,
      report.worst_element);
}

}  // namespace mortise::testing
