#include "tests/unit/common/fem/problems/structured_mesh.h"

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "common/mesh/element_faces.h"

namespace mortise::mesh {
namespace {

using Index = std::array<int, 3>;

// The points of a box in a lattice twice as fine as its cells: odd places are middles of edges.
class Lattice {
 public:
  Lattice(const MappedBox& box, bool quadratic) : box_(box), step_(quadratic ? 1 : 2) {
    for (int d = 0; d < 3; ++d) cells_[d] = static_cast<int>(box.ticks[d].size()) - 1;
  }

  int cells(int direction) const { return cells_[direction]; }

  int Count() const { return Points(0) * Points(1) * Points(2); }

  int Node(const Index& at) const {
    return at[0] / step_ + Points(0) * (at[1] / step_ + Points(1) * (at[2] / step_));
  }

  Eigen::Vector3d Parameters(int node) const {
    Eigen::Vector3d uvw;
    for (int d = 0; d < 3; ++d) {
      const int at = node % Points(d) * step_;
      node /= Points(d);
      const auto& ticks = box_.ticks[d];
      uvw[d] = at % 2 == 0 ? ticks[at / 2] : 0.5 * (ticks[at / 2] + ticks[at / 2 + 1]);
    }
    return uvw;
  }

 private:
  int Points(int d) const { return 2 * cells_[d] / step_ + 1; }

  const MappedBox& box_;
  int step_;
  Index cells_;
};

// Corners of the six tetrahedra of a cell: each goes from its low to its high corner along the
// three directions in one of their orders.
std::array<std::array<Index, 4>, 6> CellTetrahedra() {
  static constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                        {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  std::array<std::array<Index, 4>, 6> tetrahedra{};
  for (int t = 0; t < 6; ++t) {
    Index at{0, 0, 0};
    for (int k = 0; k < 3; ++k) {
      at[kOrders[t][k]] = 1;
      tetrahedra[t][k + 1] = at;
    }
    if (t >= 3) std::swap(tetrahedra[t][1], tetrahedra[t][2]);
  }
  return tetrahedra;
}

// The element's corners in the doubled lattice.
std::array<Index, 4> Corners(const Index& cell, const std::array<Index, 4>& tetrahedron) {
  std::array<Index, 4> corners;
  for (int k = 0; k < 4; ++k) {
    for (int d = 0; d < 3; ++d) corners[k][d] = 2 * (cell[d] + tetrahedron[k][d]);
  }
  return corners;
}

Index Middle(const Index& a, const Index& b) {
  return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
}

// The face of the box (0 … 5) that a triangle lies on, or -1.
int FaceOf(const Lattice& lattice, const Index& a, const Index& b, const Index& c) {
  for (int d = 0; d < 3; ++d) {
    if (a[d] != b[d] || b[d] != c[d]) continue;
    if (a[d] == 0) return 2 * d;
    if (a[d] == 2 * lattice.cells(d)) return 2 * d + 1;
  }
  return -1;
}

// Whether the first cell's axes, where the nodes are, turn left hands into right ones.
bool IsMirrored(const Lattice& lattice, const TetrahedralMesh& mesh) {
  Eigen::Matrix3d axes;
  for (int d = 0; d < 3; ++d) {
    Index one{0, 0, 0};
    one[d] = 2;
    axes.col(d) = mesh.nodes.col(lattice.Node(one)) - mesh.nodes.col(0);
  }
  return axes.col(0).cross(axes.col(1)).dot(axes.col(2)) < 0;
}

// The outer triangles that have been found, and the face of each.
struct Outside {
  std::vector<Eigen::VectorXi> triangles;
  std::vector<int> faces;
};

void AddSides(const Lattice& lattice, const std::array<Index, 4>& corners, bool quadratic,
              Outside& outside) {
  for (const auto& side : kTetrahedronFaces) {
    const Index &a = corners[side[0]], &b = corners[side[1]], &c = corners[side[2]];
    const int face = FaceOf(lattice, a, b, c);
    if (face < 0) continue;
    Eigen::VectorXi triangle(quadratic ? 6 : 3);
    triangle.head<3>() << lattice.Node(a), lattice.Node(b), lattice.Node(c);
    if (quadratic) {
      triangle.tail<3>() << lattice.Node(Middle(a, b)), lattice.Node(Middle(b, c)),
          lattice.Node(Middle(c, a));
    }
    outside.triangles.push_back(triangle);
    outside.faces.push_back(face);
  }
}

// Every cell of the lattice, the first axis running fastest.
std::vector<Index> CellsOf(const Lattice& lattice) {
  std::vector<Index> cells;
  Index cell;
  for (cell[2] = 0; cell[2] < lattice.cells(2); ++cell[2]) {
    for (cell[1] = 0; cell[1] < lattice.cells(1); ++cell[1]) {
      for (cell[0] = 0; cell[0] < lattice.cells(0); ++cell[0]) cells.push_back(cell);
    }
  }
  return cells;
}

}  // namespace

std::vector<double> Ticks(int n, double ratio) {
  const double growth = n > 1 ? std::pow(ratio, 1.0 / (n - 1)) : 1;
  std::vector<double> ticks{0};
  double step = 1;
  for (int k = 0; k < n; ++k, step *= growth) ticks.push_back(ticks.back() + step);
  for (double& tick : ticks) tick /= ticks[n];
  return ticks;
}

TetrahedralMesh MeshMappedBox(const MappedBox& box, bool quadratic) {
  const Lattice lattice(box, quadratic);
  TetrahedralMesh mesh;
  mesh.part_names = {"body"};
  for (const char* name : {"u_min", "u_max", "v_min", "v_max", "w_min", "w_max"}) {
    mesh.faces.push_back({-1, 0, {{0, name}}});
  }
  mesh.nodes.resize(3, lattice.Count());
  for (int v = 0; v < lattice.Count(); ++v) mesh.nodes.col(v) = box.place(lattice.Parameters(v));

  const int elements = 6 * lattice.cells(0) * lattice.cells(1) * lattice.cells(2);
  mesh.tetrahedra.resize(quadratic ? 10 : 4, elements);
  mesh.part = Eigen::VectorXi::Zero(elements);
  auto shapes = CellTetrahedra();
  if (IsMirrored(lattice, mesh)) {
    for (auto& shape : shapes) std::swap(shape[1], shape[2]);
  }
  Outside outside;
  int e = 0;
  for (const Index& cell : CellsOf(lattice)) {
    for (const auto& shape : shapes) {
      const auto corners = Corners(cell, shape);
      for (int k = 0; k < 4; ++k) mesh.tetrahedra(k, e) = lattice.Node(corners[k]);
      for (int k = 4; k < mesh.tetrahedra.rows(); ++k) {
        const auto [a, b] = kTetrahedronEdges[k - 4];
        mesh.tetrahedra(k, e) = lattice.Node(Middle(corners[a], corners[b]));
      }
      AddSides(lattice, corners, quadratic, outside);
      ++e;
    }
  }
  const std::size_t count = outside.triangles.size();
  mesh.face_triangles.resize(quadratic ? 6 : 3, count);
  for (std::size_t t = 0; t < count; ++t) mesh.face_triangles.col(t) = outside.triangles[t];
  mesh.face_triangle_face = Eigen::Map<Eigen::VectorXi>(outside.faces.data(), count);
  return mesh;
}

std::vector<int> NodesWhere(const MappedBox& box, bool quadratic,
                            const std::function<bool(const Eigen::Vector3d& uvw)>& condition) {
  const Lattice lattice(box, quadratic);
  std::vector<int> nodes;
  for (int v = 0; v < lattice.Count(); ++v) {
    if (condition(lattice.Parameters(v))) nodes.push_back(v);
  }
  return nodes;
}

void Shake(TetrahedralMesh& mesh, double distance, unsigned seed) {
  std::vector<bool> outer(mesh.nodes.cols(), false);
  for (Eigen::Index k = 0; k < mesh.face_triangles.size(); ++k) {
    outer[mesh.face_triangles.data()[k]] = true;
  }
  std::mt19937 random(seed);
  for (Eigen::Index v = 0; v < mesh.nodes.cols(); ++v) {
    for (int k = 0; k < 3; ++k) {
      const double share = 2.0 * random() / std::mt19937::max() - 1;
      if (!outer[v]) mesh.nodes(k, v) += distance * share;
    }
  }
}

}  // namespace mortise::mesh
