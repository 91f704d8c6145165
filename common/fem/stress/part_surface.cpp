#include "common/fem/stress/part_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <tuple>
#include <utility>

#include "common/mesh/element_faces.h"

namespace mortise::simulator {
namespace {

// A face of an element of a part, by its corners in ascending order.
struct ElementSide {
  std::array<int, 3> corners;
  int part = -1;
  int element = -1;
  int side = -1;
};

std::array<int, 3> Ascending(std::array<int, 3> corners) {
  std::sort(corners.begin(), corners.end());
  return corners;
}

std::vector<ElementSide> SidesOf(const mesh::TetrahedralMesh& mesh) {
  std::vector<ElementSide> sides;
  sides.reserve(static_cast<std::size_t>(4 * mesh.tetrahedra.cols()));
  for (int e = 0; e < mesh.tetrahedra.cols(); ++e) {
    for (int side = 0; side < 4; ++side) {
      const auto& corner = mesh::kTetrahedronFaces[side];
      sides.push_back({Ascending({mesh.tetrahedra(corner[0], e), mesh.tetrahedra(corner[1], e),
                                  mesh.tetrahedra(corner[2], e)}),
                       mesh.part[e], e, side});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const ElementSide& a, const ElementSide& b) {
    return std::tie(a.corners, a.part, a.element) < std::tie(b.corners, b.part, b.element);
  });
  return sides;
}

// Which nodes of an element are the corners and middles of one of its faces.
std::array<int, 6> NodesOfSide(int side) {
  const auto& corner = mesh::kTetrahedronFaces[side];
  std::array<int, 6> nodes{corner[0], corner[1], corner[2], 0, 0, 0};
  for (int k = 0; k < 3; ++k) {
    const int a = corner[k], b = corner[(k + 1) % 3];
    int edge = 0;
    while (std::minmax(a, b) !=
           std::minmax(mesh::kTetrahedronEdges[edge][0], mesh::kTetrahedronEdges[edge][1])) {
      ++edge;
    }
    nodes[3 + k] = 4 + edge;
  }
  return nodes;
}

// A side of a face: from one corner to the next.
struct FaceSide {
  std::pair<int, int> ends;  // ascending
  int part = -1;
  int face = -1;
  int side = -1;
};

}  // namespace

Eigen::Vector3d FacePlace(int place) {
  Eigen::Vector3d l = Eigen::Vector3d::Zero();
  if (place < 3) {
    l[place] = 1;
  } else {
    l[place - 3] = l[(place - 2) % 3] = 0.5;
  }
  return l;
}

PartNodes::PartNodes(const mesh::TetrahedralMesh& mesh) {
  const int nodes = static_cast<int>(mesh.nodes.cols());
  const int corners = static_cast<int>(mesh.tetrahedra.rows());
  const int elements = static_cast<int>(mesh.tetrahedra.cols());
  // The slots of a node form a chain, in the order in which its parts are met.
  std::vector<int> head(nodes, -1), next;
  element_slots_.resize(corners, elements);
  for (int e = 0; e < elements; ++e) {
    for (int k = 0; k < corners; ++k) {
      const int node = mesh.tetrahedra(k, e);
      int slot = head[node];
      while (slot >= 0 && part_[slot] != mesh.part[e]) slot = next[slot];
      if (slot < 0) {
        slot = size();
        node_.push_back(node);
        part_.push_back(mesh.part[e]);
        next.push_back(head[node]);
        head[node] = slot;
      }
      element_slots_(k, e) = slot;
    }
  }
  first_.assign(size() + 1, 0);
  for (Eigen::Index k = 0; k < element_slots_.size(); ++k) ++first_[element_slots_.data()[k] + 1];
  for (int slot = 0; slot < size(); ++slot) first_[slot + 1] += first_[slot];
  around_.resize(element_slots_.size());
  std::vector<int> place(first_.begin(), first_.end() - 1);
  for (int e = 0; e < elements; ++e) {
    for (int k = 0; k < corners; ++k) around_[place[element_slots_(k, e)]++] = e;
  }
}

PartSurface::PartSurface(const mesh::TetrahedralMesh& mesh, const PartNodes& nodes) {
  FindFaces(mesh, nodes);
  std::vector<std::pair<int, FaceNode>> faces;
  for (int face = 0; face < size(); ++face) {
    for (int place = 0; place < slots_.rows(); ++place) {
      faces.push_back({slots_(place, face), {face, place}});
    }
  }
  at_slot_ = BySlot<FaceNode>(nodes.size(), faces);
  FindSharpEdges(mesh);
  std::vector<std::pair<int, int>> edges;
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    for (const FaceNode& at : edges_[e].first) {
      if (at.face >= 0) edges.push_back({slots_(at.place, at.face), static_cast<int>(e)});
    }
  }
  edges_at_slot_ = BySlot<int>(nodes.size(), edges);
}

void PartSurface::FindFaces(const mesh::TetrahedralMesh& mesh, const PartNodes& nodes) {
  const std::vector<ElementSide> sides = SidesOf(mesh);
  std::vector<ElementSide> outer;
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].corners == sides[i].corners) ++end;
    for (std::size_t k = i; k < end; ++k) {
      const bool is_inner = (k > i && sides[k - 1].part == sides[k].part) ||
                            (k + 1 < end && sides[k + 1].part == sides[k].part);
      if (is_inner) continue;
      outer.push_back(sides[k]);
      free_.push_back(end - i == 1);
    }
    i = end;
  }
  const int places = mesh.IsQuadratic() ? 6 : 3;
  nodes_.resize(places, static_cast<Eigen::Index>(outer.size()));
  slots_.resize(places, static_cast<Eigen::Index>(outer.size()));
  for (std::size_t f = 0; f < outer.size(); ++f) {
    const std::array<int, 6> of_element = NodesOfSide(outer[f].side);
    for (int place = 0; place < places; ++place) {
      const int k = of_element[place];
      nodes_(place, static_cast<Eigen::Index>(f)) = mesh.tetrahedra(k, outer[f].element);
      slots_(place, static_cast<Eigen::Index>(f)) = nodes.element_slots()(k, outer[f].element);
    }
    corners_.push_back(outer[f].corners);
    part_.push_back(outer[f].part);
  }
}

void PartSurface::FindSharpEdges(const mesh::TetrahedralMesh& mesh) {
  std::vector<FaceSide> sides;
  for (int face = 0; face < size(); ++face) {
    for (int side = 0; side < 3; ++side) {
      sides.push_back({std::minmax({nodes_(side, face), nodes_((side + 1) % 3, face)}), part_[face],
                       face, side});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const FaceSide& a, const FaceSide& b) {
    return std::tie(a.part, a.ends, a.face) < std::tie(b.part, b.ends, b.face);
  });
  const bool quadratic = mesh.IsQuadratic();
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].part == sides[i].part &&
           sides[end].ends == sides[i].ends) {
      ++end;
    }
    const FaceSide &a = sides[i], &b = sides[end - 1];
    const GradientMatrix at = FacePositions(mesh, *this, a.face);
    const Eigen::Vector3d normal = TriangleAreaVector(at, FacePlace(3 + a.side)).normalized();
    const Eigen::Vector3d other =
        TriangleAreaVector(FacePositions(mesh, *this, b.face), FacePlace(3 + b.side)).normalized();
    // Where more than two faces meet, the part hangs together by this edge.
    const bool is_pair = end - i == 2;
    i = end;
    if (is_pair && normal.dot(other) > kSharpCosine) continue;
    SharpEdge edge;
    // Two faces that are counter-clockwise from outside pass their common side in opposite ways.
    edge.first = {FaceNode{a.face, a.side}, FaceNode{a.face, (a.side + 1) % 3},
                  quadratic ? FaceNode{a.face, 3 + a.side} : FaceNode{}};
    edge.second = {FaceNode{b.face, (b.side + 1) % 3}, FaceNode{b.face, b.side},
                   quadratic ? FaceNode{b.face, 3 + b.side} : FaceNode{}};
    edge.convex = is_pair && normal.cross(other).dot(at.col((a.side + 1) % 3) - at.col(a.side)) > 0;
    edges_.push_back(edge);
  }
}

GradientMatrix FacePositions(const mesh::TetrahedralMesh& mesh, const PartSurface& surface,
                             int face) {
  GradientMatrix positions(3, surface.nodes().rows());
  for (Eigen::Index k = 0; k < positions.cols(); ++k) {
    positions.col(k) = mesh.nodes.col(surface.nodes()(k, face));
  }
  return positions;
}

int PartSurface::FreeFaceWith(std::array<int, 3> corners) const {
  const auto key = Ascending(corners);
  const auto found = std::lower_bound(corners_.begin(), corners_.end(), key);
  if (found == corners_.end() || *found != key) return -1;
  const auto face = found - corners_.begin();
  return free_[face] ? static_cast<int>(face) : -1;
}

}  // namespace mortise::simulator
