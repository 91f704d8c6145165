#include "services/interpolator/mapping/patch_layout.h"

#include <map>
#include <utility>

#include "common/base/errors.h"
#include "services/interpolator/mapping/layout_builder.h"
#include "services/interpolator/mapping/layout_pieces.h"
#include "services/interpolator/mapping/layout_surface.h"
#include "services/interpolator/mapping/path_samples.h"

namespace mortise::interpolator {
namespace {

using OpenMesh::FaceHandle;
using OpenMesh::HalfedgeHandle;
using OpenMesh::VertexHandle;

// Makes disks of the patches: a vertex on paths is as many vertices of a disk as the disk has
// corners there.
class DiskCutter {
 public:
  DiskCutter(const LayoutSurface& surface, std::vector<int> triangles) : surface_(surface) {
    patch_.triangles = std::move(triangles);
  }

  LaidSurface::Patch Cut(const std::vector<int>& walk) {
    const mesh::HalfedgeMesh& mesh = surface_.mesh();
    patch_.disk.resize(3, static_cast<Eigen::Index>(patch_.triangles.size()));
    for (std::size_t i = 0; i < patch_.triangles.size(); ++i) {
      int corner = 0;
      for (const HalfedgeHandle halfedge : mesh.fh_range(FaceHandle(patch_.triangles[i]))) {
        patch_.disk(corner++, static_cast<Eigen::Index>(i)) = VertexAt(halfedge);
      }
    }
    for (const int directed : walk) {
      HalfedgeHandle halfedge = surface_.FirstOf(directed);
      const std::size_t count = surface_.path(directed / 2).size() - 1;
      for (std::size_t i = 0; i < count; ++i) {
        patch_.boundary.push_back(VertexAt(halfedge));
        halfedge = surface_.NextOnBoundary(halfedge);
      }
    }
    return std::move(patch_);
  }

 private:
  // Returns the disk's vertex that a half-edge leaves: known by the vertex itself within, on the
  // boundary by the half-edge of a path from which its corner is counted.
  int VertexAt(HalfedgeHandle halfedge) {
    const mesh::HalfedgeMesh& mesh = surface_.mesh();
    const VertexHandle vertex = mesh.from_vertex_handle(halfedge);
    int key = -1 - vertex.idx();
    if (!surface_.IsFree(vertex)) {
      while (surface_.Directed(halfedge) < 0) {
        halfedge = mesh.next_halfedge_handle(mesh.opposite_halfedge_handle(halfedge));
      }
      key = halfedge.idx();
    }
    const auto [entry, is_new] = index_.try_emplace(key, static_cast<int>(patch_.vertices.size()));
    if (is_new) patch_.vertices.push_back(vertex.idx());
    return entry->second;
  }

  const LayoutSurface& surface_;
  LaidSurface::Patch patch_;
  std::map<int, int> index_;
};

LaidSurface Laid(const LayoutSurface& surface, const std::vector<BoundaryPiece>& walks) {
  LaidSurface laid;
  laid.surface = mesh::ToSurfaceMesh(surface.mesh());
  std::vector<std::vector<int>> triangles(static_cast<std::size_t>(surface.patch_count()));
  for (const FaceHandle face : surface.mesh().faces()) {
    laid.origin.push_back(surface.origin(face));
    triangles[static_cast<std::size_t>(surface.patch(face))].push_back(face.idx());
  }
  for (int path = 0; path < surface.path_count(); ++path) {
    laid.paths.push_back(surface.path(path));
  }
  for (const BoundaryPiece& walk : walks) {
    std::vector<int>& of_patch = triangles[static_cast<std::size_t>(surface.PatchOf(walk.front()))];
    laid.patches.push_back(DiskCutter(surface, std::move(of_patch)).Cut(walk));
  }
  return laid;
}

PatchLayout Describe(const LayoutSurface& source, const Correspondence& both,
                     const std::vector<Correspondence::Path>& given) {
  PatchLayout layout;
  for (const Correspondence::Point& point : both.points) layout.points.push_back(point.name);
  for (int path = 0; path < source.path_count(); ++path) {
    const auto index = static_cast<std::size_t>(path);
    layout.paths.push_back({source.NodeOf(2 * path), source.NodeOf(2 * path + 1),
                            index < given.size() ? given[index].name : ""});
  }
  return layout;
}

}  // namespace

absl::StatusOr<PatchLayout> BuildPatchLayout(const MarkedSurface& source,
                                             const MarkedSurface& target,
                                             const LayoutOptions& options) {
  MORTISE_RETURN_IF_ERROR(CheckMarkedSurface(source, "source"));
  MORTISE_RETURN_IF_ERROR(CheckMarkedSurface(target, "target"));
  MORTISE_ASSIGN_OR_RETURN(const Correspondence both, FindCorrespondence(source, target));
  std::vector<int> our_nodes, their_nodes;
  for (const Correspondence::Point& point : both.points) {
    our_nodes.push_back(point.source);
    their_nodes.push_back(point.target);
  }
  MORTISE_ASSIGN_OR_RETURN(LayoutSurface ours, LayoutSurface::Create(source.surface, our_nodes));
  MORTISE_ASSIGN_OR_RETURN(LayoutSurface theirs,
                           LayoutSurface::Create(target.surface, their_nodes));
  const std::vector<Correspondence::Path> given = OrderedPaths(ours, theirs, both);
  for (const Correspondence::Path& path : given) {
    MORTISE_RETURN_IF_ERROR(ours.AddPath(path.source).status());
    MORTISE_RETURN_IF_ERROR(theirs.AddPath(path.target).status());
  }
  ours.LabelPatches();
  theirs.LabelPatches();
  const std::vector<PatchPieces> pieces = FindPieces(ours);
  MORTISE_RETURN_IF_ERROR(ComparePieces(pieces, FindPieces(theirs), ours, both));
  LayoutBuilder builder(ours, theirs, pieces, options);
  MORTISE_RETURN_IF_ERROR(builder.Connect());
  MORTISE_RETURN_IF_ERROR(builder.Subdivide());
  for (int path = 0; path < ours.path_count(); ++path) ShareSamples(ours, theirs, path);
  PatchLayout layout = Describe(ours, both, given);
  layout.walks = builder.walks();
  layout.source = Laid(ours, builder.walks());
  layout.target = Laid(theirs, builder.walks());
  return layout;
}

}  // namespace mortise::interpolator
