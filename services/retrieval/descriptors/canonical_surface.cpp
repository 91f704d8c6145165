#include "services/retrieval/descriptors/canonical_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <tuple>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::retrieval {
namespace {

using mesh::SurfaceMesh;

constexpr double kMaxCoordinate = 1e100;    // m; squares must not overflow
constexpr double kMinTriangleArea = 1e-14;  // in the box [-1, 1]³
constexpr double kMinArea = 4e-10;          // of all triangles, in the box [-1, 1]³
constexpr int kMortonBits = 21;             // for each axis

absl::Status CheckTriangles(const SurfaceMesh& surface) {
  if (surface.triangles.cols() == 0) return InvalidField("surface", "has no triangles");
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    for (const int corner : surface.triangles.col(t)) {
      if (corner < 0 || corner >= surface.vertices.cols()) {
        return InvalidField(absl::StrCat("surface.triangles[", t, "]"),
                            absl::StrCat("vertex ", corner, " does not exist"));
      }
      const Eigen::Vector3d vertex = surface.vertices.col(corner);
      if (!vertex.allFinite() || vertex.cwiseAbs().maxCoeff() > kMaxCoordinate) {
        return InvalidField(absl::StrCat("surface.vertices[", corner, "]"),
                            "is not finite, or lies beyond 1e100 m");
      }
    }
  }
  return absl::OkStatus();
}

// Spreads the lowest 21 bits so that two zeros follow each.
std::uint64_t Spread(std::uint64_t bits) {
  bits = (bits | bits << 32) & 0x1f00000000ffffULL;
  bits = (bits | bits << 16) & 0x1f0000ff0000ffULL;
  bits = (bits | bits << 8) & 0x100f00f00f00f00fULL;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3ULL;
  bits = (bits | bits << 2) & 0x1249249249249249ULL;
  return bits;
}

// The place of a point of [-1, 1]³ on Morton's curve.
std::uint64_t MortonCode(const Eigen::Vector3d& point) {
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double share = std::clamp((point[axis] + 1) / 2, 0.0, 1.0);
    const auto cell = static_cast<std::uint64_t>(share * ((1 << kMortonBits) - 1));
    code |= Spread(cell) << axis;
  }
  return code;
}

struct PlacedTriangle {
  std::uint64_t code = 0;
  std::array<int, 3> corners{};
};

// Orders triangles, and their corners, by where they lie.
class PlaceOrder {
 public:
  explicit PlaceOrder(const Eigen::Matrix3Xd& vertices) : vertices_(vertices) {}

  std::tuple<double, double, double> Place(int vertex) const {
    return {vertices_(0, vertex), vertices_(1, vertex), vertices_(2, vertex)};
  }

  bool operator()(const PlacedTriangle& a, const PlacedTriangle& b) const {
    if (a.code != b.code) return a.code < b.code;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto place_a = Place(a.corners[k]), place_b = Place(b.corners[k]);
      if (place_a != place_b) return place_a < place_b;
    }
    return false;
  }

  void SortCorners(PlacedTriangle& triangle) const {
    std::sort(triangle.corners.begin(), triangle.corners.end(),
              [this](int a, int b) { return Place(a) < Place(b); });
  }

 private:
  const Eigen::Matrix3Xd& vertices_;
};

// Whether there is a column for each vertex, and those of the triangles' corners may be squared.
bool UsedAreFinite(const CanonicalSurface& surface, const Eigen::Matrix3Xd& columns) {
  if (columns.cols() != surface.vertices) return false;
  for (const int corner : surface.triangles.reshaped()) {
    if (!(columns.col(corner).cwiseAbs().maxCoeff() <= kMaxCoordinate) ||
        columns.col(corner).hasNaN()) {
      return false;
    }
  }
  return true;
}

}  // namespace

absl::StatusOr<CanonicalSurface> MakeCanonical(const SurfaceMesh& surface) {
  MORTISE_RETURN_IF_ERROR(CheckTriangles(surface));
  Eigen::AlignedBox3d box;
  for (const int corner : surface.triangles.reshaped()) box.extend(surface.vertices.col(corner));
  CanonicalSurface canonical;
  canonical.vertices = surface.vertices.cols();
  canonical.centre = box.center();
  canonical.half_size = box.sizes().maxCoeff() / 2;
  if (!(canonical.half_size > 0)) return InvalidField("surface", "has no area: it is one point");
  const Eigen::Matrix3Xd vertices =
      (surface.vertices.colwise() - canonical.centre) / canonical.half_size;

  const PlaceOrder order(vertices);
  std::vector<PlacedTriangle> placed;
  placed.reserve(static_cast<std::size_t>(surface.triangles.cols()));
  double area = 0;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Vector3i corners = surface.triangles.col(t);
    PlacedTriangle triangle{0, {corners[0], corners[1], corners[2]}};
    order.SortCorners(triangle);
    const Eigen::Vector3d a = vertices.col(triangle.corners[0]);
    const Eigen::Vector3d b = vertices.col(triangle.corners[1]);
    const Eigen::Vector3d c = vertices.col(triangle.corners[2]);
    const double triangle_area = (b - a).cross(c - a).norm() / 2;
    if (triangle_area < kMinTriangleArea) continue;
    area += triangle_area;
    triangle.code = MortonCode((a + b + c) / 3);
    placed.push_back(triangle);
  }
  if (area < kMinArea) return InvalidField("surface", "has no area");
  std::sort(placed.begin(), placed.end(), order);
  const auto same = [&order](const PlacedTriangle& a, const PlacedTriangle& b) {
    return !order(a, b) && !order(b, a);
  };
  placed.erase(std::unique(placed.begin(), placed.end(), same), placed.end());
  canonical.triangles.resize(3, static_cast<Eigen::Index>(placed.size()));
  for (std::size_t t = 0; t < placed.size(); ++t) {
    canonical.triangles.col(static_cast<Eigen::Index>(t)) =
        Eigen::Map<const Eigen::Vector3i>(placed[t].corners.data());
  }
  return canonical;
}

absl::StatusOr<Eigen::Matrix3Xd> ToReferenceBox(const CanonicalSurface& surface,
                                                const Eigen::Matrix3Xd& vertices) {
  Eigen::Matrix3Xd placed = (vertices.colwise() - surface.centre) / surface.half_size;
  if (UsedAreFinite(surface, placed)) return placed;
  return InvalidField("vertices",
                      absl::StrCat("must be ", surface.vertices, " points of finite coordinates"));
}

absl::StatusOr<Eigen::Matrix3Xd> VelocitiesInReferenceBox(const CanonicalSurface& surface,
                                                          const Eigen::Matrix3Xd& velocities,
                                                          Eigen::Index index) {
  Eigen::Matrix3Xd placed = velocities / surface.half_size;
  if (UsedAreFinite(surface, placed)) return placed;
  return InvalidField(absl::StrCat("velocities[", index, "]"),
                      absl::StrCat("must be ", surface.vertices, " finite velocities"));
}

}  // namespace mortise::retrieval
