#include "tests/unit/common/fem/problems/hinged_bodies.h"

#include "absl/strings/str_format.h"

namespace mortise::simulator {
namespace {

bool IsIn(const Eigen::Vector3d& p, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  return (p.array() > low.array()).all() && (p.array() < high.array()).all();
}

Region Boxes(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
             const Eigen::Vector3d& other_low, const Eigen::Vector3d& other_high) {
  return [=](const Eigen::Vector3d& p) {
    return IsIn(p, low, high) || IsIn(p, other_low, other_high);
  };
}

std::function<mesh::TetrahedralMesh(int, bool)> CutOf(const Eigen::Vector3i& cubes,
                                                      const Region& region) {
  return [cubes, region](int cells, bool quadratic) {
    return Cut(Cubes(cubes, cells, quadratic), region);
  };
}

// Six tetrahedra around its diagonal make a cube; these are the coordinates of one in descending
// order.
bool Descends(double a, double b, double c) { return a > b && b > c; }

}  // namespace

mesh::TetrahedralMesh Cut(const mesh::TetrahedralMesh& mesh, const Region& region) {
  std::vector<int> kept;
  std::vector<int> number(mesh.nodes.cols(), -1);
  for (int e = 0; e < mesh.tetrahedra.cols(); ++e) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (int k = 0; k < 4; ++k) middle += mesh.nodes.col(mesh.tetrahedra(k, e)) / 4;
    if (!region(middle)) continue;
    kept.push_back(e);
    for (const int v : mesh.tetrahedra.col(e)) number[v] = 0;
  }
  mesh::TetrahedralMesh cut;
  cut.part_names = mesh.part_names;
  int count = 0;
  for (int& v : number) v = v < 0 ? -1 : count++;
  cut.nodes.resize(3, count);
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] >= 0) cut.nodes.col(number[v]) = mesh.nodes.col(v);
  }
  cut.tetrahedra.resize(mesh.tetrahedra.rows(), kept.size());
  cut.part.resize(kept.size());
  for (std::size_t e = 0; e < kept.size(); ++e) {
    cut.part[e] = mesh.part[kept[e]];
    for (int k = 0; k < mesh.tetrahedra.rows(); ++k) {
      cut.tetrahedra(k, e) = number[mesh.tetrahedra(k, kept[e])];
    }
  }
  cut.face_triangles.resize(mesh.face_triangles.rows(), 0);
  return cut;
}

mesh::TetrahedralMesh Cubes(const Eigen::Vector3i& cubes, int cells, bool quadratic) {
  mesh::MappedBox box;
  for (int k = 0; k < 3; ++k) box.ticks[k] = mesh::Ticks(cubes[k] * cells);
  box.place = [cubes](const Eigen::Vector3d& uvw) -> Eigen::Vector3d {
    return cubes.cast<double>().cwiseProduct(uvw);
  };
  return mesh::MeshMappedBox(box, quadratic);
}

std::vector<int> NodesAt(const mesh::TetrahedralMesh& mesh, const Region& condition) {
  std::vector<int> nodes;
  for (int v = 0; v < mesh.nodes.cols(); ++v) {
    if (condition(mesh.nodes.col(v))) nodes.push_back(v);
  }
  return nodes;
}

std::vector<Hinge> Hinges() {
  const Region at_start = [](const Eigen::Vector3d& p) { return p.x() < 1e-9; };
  const auto beyond = [](double x) { return [x](const Eigen::Vector3d& p) { return p.x() > x; }; };
  // Two tetrahedra that share the diagonal of their cubes, or a part or an end of it.
  const auto tetrahedra = [](double shift) {
    return [shift](const Eigen::Vector3d& p) {
      const bool first = (p.array() < 2).all() && Descends(p.y(), p.z(), p.x());
      const bool second = (p.array() > shift).all() && (p.array() < shift + 2).all() &&
                          Descends(p.x(), p.z(), p.y());
      return first || second;
    };
  };
  const auto diagonal = [](int middle) {
    return absl::StrFormat("rotate about (0.577, 0.577, 0.577) through (%d, %d, %d) mm", middle,
                           middle, middle);
  };
  return {
      {"CubesByEdge", CutOf({2, 2, 1}, Boxes({0, 0, 0}, {1, 1, 1}, {1, 1, 0}, {2, 2, 1})), at_start,
       beyond(1.5), 1, "rotate about z through (1000, 1000, 500) mm"},
      {"CubesByPartOfEdge", CutOf({2, 2, 3}, Boxes({0, 0, 0}, {1, 1, 2}, {1, 1, 1}, {2, 2, 3})),
       at_start, beyond(1.5), 1, "rotate about z through (1000, 1000, 2000) mm"},
      {"CubesByPoint", CutOf({2, 2, 2}, Boxes({0, 0, 0}, {1, 1, 1}, {1, 1, 1}, {2, 2, 2})),
       at_start, beyond(1.5), 3,
       "rotate about x through (1000, 1000, 1000) mm and in 2 other ways"},
      {"BarsByEdge", CutOf({8, 2, 1}, Boxes({0, 0, 0}, {4, 1, 1}, {4, 1, 0}, {8, 2, 1})), at_start,
       beyond(7.5), 1, "rotate about z through (4000, 1000, 500) mm"},
      {"BarsByPoint", CutOf({8, 2, 2}, Boxes({0, 0, 0}, {4, 1, 1}, {4, 1, 1}, {8, 2, 2})), at_start,
       beyond(7.5), 3, "rotate about x through (4000, 1000, 1000) mm and in 2 other ways"},
      {"BarsByPartOfEdge", CutOf({8, 2, 2}, Boxes({0, 0, 0}, {4, 1, 2}, {4, 1, 1}, {8, 2, 2})),
       at_start, beyond(7.5), 1, "rotate about z through (4000, 1000, 1500) mm"},
      {"TetrahedraByEdge", CutOf({2, 2, 2}, tetrahedra(0)), at_start, beyond(1.4), 1,
       diagonal(1000)},
      {"TetrahedraByPartOfEdge", CutOf({3, 3, 3}, tetrahedra(1)), at_start, beyond(2.4), 1,
       diagonal(2000)},
      {"TetrahedraByPoint", CutOf({4, 4, 4}, tetrahedra(2)), at_start, beyond(3.4), 3,
       "rotate about x through (2000, 2000, 2000) mm and in 2 other ways"},
  };
}

}  // namespace mortise::simulator
