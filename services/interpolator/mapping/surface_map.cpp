#include "services/interpolator/mapping/surface_map.h"

#include <utility>

#include "common/base/errors.h"
#include "services/interpolator/mapping/barycentric.h"
#include "services/interpolator/mapping/patch_region.h"

namespace mortise::interpolator {
namespace {

DiskPatch Disk(const LaidSurface& laid, const LaidSurface::Patch& patch) {
  DiskPatch disk;
  disk.vertices.resize(3, static_cast<Eigen::Index>(patch.vertices.size()));
  for (std::size_t i = 0; i < patch.vertices.size(); ++i) {
    disk.vertices.col(static_cast<Eigen::Index>(i)) = laid.surface.vertices.col(patch.vertices[i]);
  }
  disk.triangles = patch.disk;
  disk.boundary = patch.boundary;
  return disk;
}

class SurfaceMapper {
 public:
  SurfaceMapper(const MarkedSurface& source, const MarkedSurface& target, const PatchLayout& layout)
      : given_(source.surface), layout_(layout) {
    const Eigen::Index count = target.surface.vertices.cols();
    map_.positions = Eigen::Matrix3Xd::Zero(3, count);
    map_.places.resize(static_cast<std::size_t>(count));
    map_.points = static_cast<int>(layout.points.size());
    for (const PatchLayout::Path& path : layout.paths) {
      ++(path.name.empty() ? map_.added_paths : map_.given_paths);
    }
    map_.patches = static_cast<int>(layout.walks.size());
  }

  absl::StatusOr<SurfaceMap> Map() {
    PlaceOnPaths();
    for (std::size_t patch = 0; patch < layout_.walks.size(); ++patch) {
      MORTISE_RETURN_IF_ERROR(PlaceInPatch(patch, RegionOf(layout_, patch)));
    }
    return std::move(map_);
  }

 private:
  bool IsWanted(int target_vertex) const {
    return target_vertex < static_cast<int>(map_.positions.cols());
  }

  // Places a vertex in a triangle of the divided source.
  void Place(int target_vertex, int triangle, const Eigen::Vector3d& barycentric) {
    const mesh::SurfaceMesh& divided = layout_.source.surface;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      position += barycentric[k] * divided.vertices.col(divided.triangles(k, triangle));
    }
    const int origin = layout_.source.origin[static_cast<std::size_t>(triangle)];
    const Eigen::Vector3i corners = given_.triangles.col(origin);
    Eigen::Matrix3d at;
    for (int k = 0; k < 3; ++k) at.col(k) = given_.vertices.col(corners[k]);
    const Eigen::Vector3d in_given = BarycentricIn(at, position);
    map_.positions.col(target_vertex) = position;
    map_.places[static_cast<std::size_t>(target_vertex)] = {origin, in_given};
  }

  void PlaceOnPaths() {
    const mesh::SurfaceMesh& divided = layout_.source.surface;
    std::vector<std::pair<int, int>> corner_of(static_cast<std::size_t>(divided.vertices.cols()));
    for (int t = 0; t < static_cast<int>(divided.triangles.cols()); ++t) {
      for (int k = 0; k < 3; ++k) {
        corner_of[static_cast<std::size_t>(divided.triangles(k, t))] = {t, k};
      }
    }
    for (std::size_t p = 0; p < layout_.paths.size(); ++p) {
      const std::vector<int>& ours = layout_.source.paths[p];
      const std::vector<int>& theirs = layout_.target.paths[p];
      for (std::size_t i = 0; i < theirs.size(); ++i) {
        if (!IsWanted(theirs[i])) continue;
        const auto [triangle, corner] = corner_of[static_cast<std::size_t>(ours[i])];
        Place(theirs[i], triangle, Eigen::Vector3d::Unit(corner));
      }
    }
  }

  absl::Status PlaceInPatch(std::size_t patch, const Eigen::Matrix2Xd& boundary) {
    const LaidSurface::Patch& ours = layout_.source.patches[patch];
    const LaidSurface::Patch& theirs = layout_.target.patches[patch];
    MORTISE_ASSIGN_OR_RETURN(const DiskMap our_disk,
                             DiskMap::Create(Disk(layout_.source, ours), boundary));
    MORTISE_ASSIGN_OR_RETURN(const DiskMap their_disk,
                             DiskMap::Create(Disk(layout_.target, theirs), boundary));
    std::vector<bool> is_inner(theirs.vertices.size(), true);
    for (const int vertex : theirs.boundary) is_inner[static_cast<std::size_t>(vertex)] = false;
    int hint = 0;
    for (std::size_t v = 0; v < theirs.vertices.size(); ++v) {
      if (!is_inner[v] || !IsWanted(theirs.vertices[v])) continue;
      const TrianglePlace place =
          our_disk.Locate(their_disk.positions().col(static_cast<Eigen::Index>(v)), hint);
      hint = place.triangle;
      Place(theirs.vertices[v], ours.triangles[static_cast<std::size_t>(place.triangle)],
            place.barycentric);
    }
    return absl::OkStatus();
  }

  const mesh::SurfaceMesh& given_;
  const PatchLayout& layout_;
  SurfaceMap map_;
};

}  // namespace

absl::StatusOr<SurfaceMap> MapSurface(const MarkedSurface& source, const MarkedSurface& target,
                                      const LayoutOptions& options) {
  MORTISE_ASSIGN_OR_RETURN(const PatchLayout layout, BuildPatchLayout(source, target, options));
  return SurfaceMapper(source, target, layout).Map();
}

}  // namespace mortise::interpolator
