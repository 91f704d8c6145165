#include "common/mesh/files/stl.h"

#include <Eigen/Geometry>
#include <cstdint>

#include "common/base/errors.h"
#include "common/base/units.h"

namespace mortise::mesh {
namespace {

constexpr std::size_t kHeaderSize = 80;

void AppendVector(const Eigen::Vector3d& vector, std::string& bytes) {
  const Eigen::Vector3f values = vector.cast<float>();
  bytes.append(reinterpret_cast<const char*>(values.data()), 3 * sizeof(float));
}

}  // namespace

absl::StatusOr<std::string> WriteStl(const SurfaceMesh& surface, const std::string& title) {
  if (surface.triangles.size() > 0 && (surface.triangles.minCoeff() < 0 ||
                                       surface.triangles.maxCoeff() >= surface.vertices.cols())) {
    return InvalidField("triangles", "a triangle names a vertex that does not exist");
  }
  // Readers take a header that begins with "solid" for the text form.
  std::string bytes = "STL (mm) " + title;
  bytes.resize(kHeaderSize, ' ');
  const auto count = static_cast<std::uint32_t>(surface.triangles.cols());
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    Eigen::Vector3d corner[3];
    for (int k = 0; k < 3; ++k) {
      corner[k] = surface.vertices.col(surface.triangles(k, t)) / kMillimetre;
    }
    AppendVector((corner[1] - corner[0]).cross(corner[2] - corner[0]).stableNormalized(), bytes);
    for (const Eigen::Vector3d& point : corner) AppendVector(point, bytes);
    bytes.append(2, '\0');
  }
  return bytes;
}

}  // namespace mortise::mesh
