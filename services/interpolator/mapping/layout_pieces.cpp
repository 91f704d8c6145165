#include "services/interpolator/mapping/layout_pieces.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::interpolator {
namespace {

using OpenMesh::HalfedgeHandle;
using OpenMesh::VertexHandle;

// Returns V − E + F of each patch without its boundary. A patch cut open along its boundary has the
// same, as on a boundary there are as many vertices as edges.
std::vector<int> OpenEuler(const LayoutSurface& surface) {
  const mesh::HalfedgeMesh& mesh = surface.mesh();
  std::vector<int> euler(static_cast<std::size_t>(surface.patch_count()), 0);
  const auto of = [&](HalfedgeHandle halfedge) -> int& {
    return euler[static_cast<std::size_t>(surface.patch(mesh.face_handle(halfedge)))];
  };
  for (const OpenMesh::FaceHandle face : mesh.faces()) {
    ++euler[static_cast<std::size_t>(surface.patch(face))];
  }
  for (const OpenMesh::EdgeHandle edge : mesh.edges()) {
    const HalfedgeHandle halfedge = mesh.halfedge_handle(edge, 0);
    if (surface.Directed(halfedge) < 0) --of(halfedge);
  }
  for (const VertexHandle vertex : mesh.vertices()) {
    bool is_on_path = false;
    for (const HalfedgeHandle halfedge : mesh.voh_range(vertex)) {
      is_on_path = is_on_path || surface.Directed(halfedge) >= 0;
    }
    if (!is_on_path) ++of(mesh.halfedge_handle(vertex));
  }
  return euler;
}

// One end of a path: which, and whether it is the first.
using PathEnd = std::pair<std::size_t, bool>;

// Returns the ends of all paths at each node, counter-clockwise.
std::vector<std::vector<PathEnd>> EndsAround(const LayoutSurface& surface,
                                             const std::vector<std::vector<int>>& paths) {
  const mesh::HalfedgeMesh& mesh = surface.mesh();
  std::map<std::pair<int, int>, PathEnd> by_side;
  for (std::size_t p = 0; p < paths.size(); ++p) {
    const std::vector<int>& way = paths[p];
    by_side[{way.front(), way[1]}] = {p, true};
    by_side[{way.back(), way[way.size() - 2]}] = {p, false};
  }
  std::vector<std::vector<PathEnd>> around(static_cast<std::size_t>(surface.node_count()));
  for (int node = 0; node < surface.node_count(); ++node) {
    const int vertex = surface.node_vertex(node);
    const HalfedgeHandle start = mesh.halfedge_handle(VertexHandle(vertex));
    HalfedgeHandle halfedge = start;
    do {
      const auto end = by_side.find({vertex, mesh.to_vertex_handle(halfedge).idx()});
      if (end != by_side.end()) around[static_cast<std::size_t>(node)].push_back(end->second);
      halfedge = mesh.opposite_halfedge_handle(mesh.prev_halfedge_handle(halfedge));
    } while (halfedge != start);
  }
  return around;
}

// Whether two lists without repetitions are the same but for where they begin, of what is accepted.
bool IsSameCycle(std::vector<PathEnd> a, std::vector<PathEnd> b, const std::set<std::size_t>& of) {
  const auto is_other = [&](const PathEnd& end) { return of.count(end.first) == 0; };
  a.erase(std::remove_if(a.begin(), a.end(), is_other), a.end());
  b.erase(std::remove_if(b.begin(), b.end(), is_other), b.end());
  if (a.size() != b.size()) return false;
  if (a.empty()) return true;
  const auto start = std::find(b.begin(), b.end(), a.front());
  if (start == b.end()) return false;
  std::rotate(b.begin(), start, b.end());
  return a == b;
}

std::set<Corner> CornersOf(const PatchPieces& patch) {
  std::set<Corner> corners;
  for (const BoundaryPiece& piece : patch.pieces) corners.insert(piece.begin(), piece.end());
  return corners;
}

}  // namespace

std::vector<PatchPieces> FindPieces(const LayoutSurface& surface) {
  std::vector<PatchPieces> patches(static_cast<std::size_t>(surface.patch_count()));
  std::vector<int> walks(patches.size(), 0);
  std::set<int> walked;
  for (int directed = 0; directed < 2 * surface.path_count(); ++directed) {
    if (walked.count(directed) > 0) continue;
    const std::vector<int> walk = surface.Walk(directed);
    walked.insert(walk.begin(), walk.end());
    const auto patch = static_cast<std::size_t>(surface.PatchOf(directed));
    patches[patch].pieces.push_back(walk);
    ++walks[patch];
  }
  for (int node = 0; node < surface.node_count(); ++node) {
    const Corner corner =
        surface.CornerAt(surface.mesh().halfedge_handle(VertexHandle(surface.node_vertex(node))));
    if (corner < 0) {
      patches[static_cast<std::size_t>(surface.PatchOf(corner))].pieces.push_back({corner});
    }
  }
  const std::vector<int> euler = OpenEuler(surface);
  for (std::size_t p = 0; p < patches.size(); ++p) {
    patches[p].genus = (2 - walks[p] - euler[p]) / 2;
  }
  return patches;
}

std::vector<Correspondence::Path> OrderedPaths(const LayoutSurface& source,
                                               const LayoutSurface& target,
                                               const Correspondence& both) {
  std::vector<std::vector<int>> ours, theirs;
  for (const Correspondence::Path& path : both.paths) {
    ours.push_back(path.source);
    theirs.push_back(path.target);
  }
  const auto our_ends = EndsAround(source, ours), their_ends = EndsAround(target, theirs);
  std::set<std::size_t> accepted;
  std::vector<Correspondence::Path> ordered;
  for (std::size_t p = 0; p < both.paths.size(); ++p) {
    accepted.insert(p);
    bool is_in_order = true;
    for (const int vertex : {ours[p].front(), ours[p].back()}) {
      const auto node = static_cast<std::size_t>(source.Node(VertexHandle(vertex)));
      is_in_order = is_in_order && IsSameCycle(our_ends[node], their_ends[node], accepted);
    }
    if (is_in_order) ordered.push_back(both.paths[p]);
    if (!is_in_order) accepted.erase(p);
  }
  return ordered;
}

absl::Status ComparePieces(const std::vector<PatchPieces>& source,
                           const std::vector<PatchPieces>& target, const LayoutSurface& surface,
                           const Correspondence& both) {
  std::map<Corner, std::size_t> patch_of;
  for (std::size_t p = 0; p < target.size(); ++p) {
    for (const Corner corner : CornersOf(target[p])) patch_of[corner] = p;
  }
  for (const PatchPieces& patch : source) {
    const std::set<Corner> corners = CornersOf(patch);
    const std::string& name =
        both.points[static_cast<std::size_t>(surface.NodeOf(*corners.begin()))].name;
    const PatchPieces& match = target[patch_of.at(*corners.begin())];
    if (CornersOf(match) != corners || match.genus != patch.genus) {
      return PreconditionFailed(
          "TOPOLOGY_DIFFERS",
          absl::StrCat("beside point '", name,
                       "' the common paths of source and target enclose different things"));
    }
    if (patch.genus > 0) {
      return PreconditionFailed(
          "PATCH_NOT_SIMPLE", absl::StrCat("beside point '", name, "' a handle of the surface has ",
                                           "no path around it that source and target share"));
    }
  }
  return absl::OkStatus();
}

}  // namespace mortise::interpolator
