// Mid-edge nodes and the outside of volume meshes; declared in mesher.h.
#include <algorithm>
#include <array>
#include <cstdint>
#include <unordered_map>

#include "common/mesh/element_faces.h"

namespace mortise::mesh {
namespace {

// Numbers the edges of a mesh as new nodes after the existing ones.
class EdgeNodes {
 public:
  explicit EdgeNodes(int first) : next_(first) {}

  int Node(int a, int b) {
    const std::uint64_t key = (static_cast<std::uint64_t>(std::min(a, b)) << 32) |
                              static_cast<std::uint32_t>(std::max(a, b));
    const auto [found, added] = nodes_.try_emplace(key, next_);
    if (added) {
      ++next_;
      edges_.push_back({a, b});
    }
    return found->second;
  }

  const std::vector<std::array<int, 2>>& edges() const { return edges_; }

 private:
  int next_;
  std::unordered_map<std::uint64_t, int> nodes_;
  std::vector<std::array<int, 2>> edges_;
};

// The corner and mid node indices (6) of one side of a quadratic element, corners outward.
std::array<int, 6> QuadraticSide(const TetrahedralMesh& mesh, const ElementFace& face) {
  const auto& corner = kTetrahedronFaces[face.side];
  std::array<int, 6> nodes{};
  for (int k = 0; k < 3; ++k) {
    nodes[k] = mesh.tetrahedra(corner[k], face.element);
    const int low = std::min(corner[k], corner[(k + 1) % 3]);
    const int high = std::max(corner[k], corner[(k + 1) % 3]);
    for (int edge = 0; edge < 6; ++edge) {
      if (kTetrahedronEdges[edge][0] == low && kTetrahedronEdges[edge][1] == high) {
        nodes[3 + k] = mesh.tetrahedra(4 + edge, face.element);
      }
    }
  }
  return nodes;
}

}  // namespace

TetrahedralMesh MakeQuadratic(TetrahedralMesh mesh) {
  if (mesh.IsQuadratic()) return mesh;
  EdgeNodes middle(static_cast<int>(mesh.nodes.cols()));
  Eigen::MatrixXi tetrahedra(10, mesh.tetrahedra.cols());
  for (Eigen::Index e = 0; e < tetrahedra.cols(); ++e) {
    tetrahedra.col(e).head(4) = mesh.tetrahedra.col(e);
    for (int k = 0; k < 6; ++k) {
      tetrahedra(4 + k, e) = middle.Node(mesh.tetrahedra(kTetrahedronEdges[k][0], e),
                                         mesh.tetrahedra(kTetrahedronEdges[k][1], e));
    }
  }
  Eigen::MatrixXi triangles(6, mesh.face_triangles.cols());
  for (Eigen::Index f = 0; f < triangles.cols(); ++f) {
    for (int k = 0; k < 3; ++k) {
      triangles(k, f) = mesh.face_triangles(k, f);
      triangles(3 + k, f) =
          middle.Node(mesh.face_triangles(k, f), mesh.face_triangles((k + 1) % 3, f));
    }
  }
  const Eigen::Index corners = mesh.nodes.cols();
  mesh.nodes.conservativeResize(3, corners + middle.edges().size());
  for (std::size_t i = 0; i < middle.edges().size(); ++i) {
    mesh.nodes.col(corners + i) =
        0.5 * (mesh.nodes.col(middle.edges()[i][0]) + mesh.nodes.col(middle.edges()[i][1]));
  }
  mesh.tetrahedra = std::move(tetrahedra);
  mesh.face_triangles = std::move(triangles);
  return mesh;
}

Eigen::Matrix3Xi OuterTriangles(const TetrahedralMesh& mesh, int part) {
  const TetrahedralMesh* subject = &mesh;
  TetrahedralMesh chosen;
  if (part >= 0) {
    std::vector<int> elements;
    for (int e = 0; e < mesh.part.size(); ++e) {
      if (mesh.part[e] == part) elements.push_back(e);
    }
    chosen.tetrahedra.resize(mesh.tetrahedra.rows(), elements.size());
    for (std::size_t i = 0; i < elements.size(); ++i) {
      chosen.tetrahedra.col(i) = mesh.tetrahedra.col(elements[i]);
    }
    subject = &chosen;
  }
  const auto outer = ElementFaces(*subject).Outer();
  const int pieces = subject->IsQuadratic() ? 4 : 1;
  Eigen::Matrix3Xi triangles(3, pieces * outer.size());
  for (std::size_t i = 0; i < outer.size(); ++i) {
    if (pieces == 1) {
      for (int k = 0; k < 3; ++k) {
        triangles(k, i) =
            subject->tetrahedra(kTetrahedronFaces[outer[i].side][k], outer[i].element);
      }
      continue;
    }
    const auto n = QuadraticSide(*subject, outer[i]);
    triangles.col(4 * i) << n[0], n[3], n[5];
    triangles.col(4 * i + 1) << n[3], n[1], n[4];
    triangles.col(4 * i + 2) << n[5], n[4], n[2];
    triangles.col(4 * i + 3) << n[3], n[4], n[5];
  }
  return triangles;
}

}  // namespace mortise::mesh
