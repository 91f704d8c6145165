#include "tests/support/mesh_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/mesh/element_faces.h"
#include "common/mesh/tetrahedra/mesher.h"

namespace mortise::testing {
namespace {

using mesh::ElementSide;
using mesh::GroupedMesh;

mesh::TetrahedralMesh LatticeBox(const Eigen::Vector3d& size, const Eigen::Vector3i& cells) {
  mesh::TetrahedralMesh box;
  const Eigen::Vector3i points = cells.array() + 1;
  const auto node = [&](const Eigen::Vector3i& at) {
    return at[0] + points[0] * (at[1] + points[1] * at[2]);
  };
  box.nodes.resize(3, points.prod());
  box.tetrahedra.resize(4, 6 * cells.prod());
  box.part_names = {"body"};
  constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  int e = 0;
  for (int z = 0; z <= cells[2]; ++z) {
    for (int y = 0; y <= cells[1]; ++y) {
      for (int x = 0; x <= cells[0]; ++x) {
        const Eigen::Vector3i low(x, y, z);
        box.nodes.col(node(low)) =
            (low.cast<double>().array() / cells.cast<double>().array() * size.array()).matrix();
        if (x == cells[0] || y == cells[1] || z == cells[2]) continue;
        for (int t = 0; t < 6; ++t, ++e) {
          Eigen::Vector3i at = low;
          box.tetrahedra(0, e) = node(at);
          for (int k = 0; k < 3; ++k) {
            ++at[kOrders[t][k]];
            box.tetrahedra(k + 1, e) = node(at);
          }
          if (t >= 3) std::swap(box.tetrahedra(1, e), box.tetrahedra(2, e));
        }
      }
    }
  }
  box.part = Eigen::VectorXi::Zero(e);
  return box;
}

// Numbers as text, or as bytes.
class Writer {
 public:
  explicit Writer(bool is_binary) : is_binary_(is_binary) {}

  void Text(const std::string& text) { bytes_ += text; }
  void Int(std::int64_t value) { Number(static_cast<std::int32_t>(value), absl::StrCat(value)); }
  void Size(std::int64_t value) { Number(value, absl::StrCat(value)); }
  void Double(double value) { Number(value, absl::StrFormat("%.17g", value)); }
  void EndLine() {
    if (!is_binary_) bytes_ += "\n";
  }
  std::string Take() { return std::move(bytes_); }

 private:
  template <typename T>
  void Number(T value, const std::string& text) {
    if (is_binary_) {
      bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    } else {
      if (!bytes_.empty() && bytes_.back() != '\n') bytes_ += ' ';
      bytes_ += text;
    }
  }

  const bool is_binary_;
  std::string bytes_;
};

std::string GmshHeader(const char* version, bool is_binary) {
  std::string header = absl::StrCat("$MeshFormat\n", version, is_binary ? " 1 8\n" : " 0 8\n");
  if (is_binary) {
    const std::int32_t one = 1;
    header.append(reinterpret_cast<const char*>(&one), sizeof one);
    header += "\n";
  }
  return header + "$EndMeshFormat\n";
}

// Physical groups: points, then surfaces, then volumes, numbered through.
std::string GmshNames(const GroupedMesh& mesh) {
  std::string names;
  int count = 0;
  const auto add = [&](int dimension, const std::string& name) {
    absl::StrAppend(&names, dimension, " ", ++count, " \"", name, "\"\n");
  };
  for (const auto& group : mesh.node_groups) add(0, group.name);
  for (const auto& group : mesh.face_groups) add(2, group.name);
  for (const auto& group : mesh.element_groups) add(3, group.name);
  return absl::StrCat("$PhysicalNames\n", count, "\n", names, "$EndPhysicalNames\n");
}

// Elements of one kind in one group; 0 for none.
struct GmshBlock {
  int dimension;
  int type;
  int group;
  std::vector<std::vector<std::int64_t>> nodes;
  std::vector<std::int64_t> numbers;  // of tetrahedra
};

std::vector<GmshBlock> GmshBlocks(const GroupedMesh& mesh) {
  const bool quadratic = mesh.tetrahedra.rows() == 10;
  std::vector<GmshBlock> blocks;
  int group = 0;
  for (const auto& nodes : mesh.node_groups) {
    GmshBlock& block = blocks.emplace_back(GmshBlock{0, 15, ++group, {}, {}});
    for (const int v : nodes.members) block.nodes.push_back({mesh.node_numbers[v]});
  }
  for (const auto& faces : mesh.face_groups) {
    GmshBlock& block = blocks.emplace_back(GmshBlock{2, quadratic ? 9 : 2, ++group, {}, {}});
    for (const ElementSide& side : faces.members) {
      auto& nodes = block.nodes.emplace_back();
      for (const int v : mesh::SideNodes(mesh.tetrahedra, side)) {
        nodes.push_back(mesh.node_numbers[v]);
      }
    }
  }
  std::vector<bool> is_written(mesh.tetrahedra.cols());
  const auto add = [&](GmshBlock& block, int e) {
    auto& nodes = block.nodes.emplace_back();
    for (Eigen::Index k = 0; k < mesh.tetrahedra.rows(); ++k) {
      nodes.push_back(mesh.node_numbers[mesh.tetrahedra(k, e)]);
    }
    if (quadratic) std::swap(nodes[8], nodes[9]);
    block.numbers.push_back(is_written[e] ? 900'000 + e : mesh.element_numbers[e]);
    is_written[e] = true;
  };
  for (const auto& elements : mesh.element_groups) {
    GmshBlock& block = blocks.emplace_back(GmshBlock{3, quadratic ? 11 : 4, ++group, {}, {}});
    for (const int e : elements.members) add(block, e);
  }
  GmshBlock& rest = blocks.emplace_back(GmshBlock{3, quadratic ? 11 : 4, 0, {}, {}});
  for (int e = 0; e < mesh.tetrahedra.cols(); ++e) {
    if (!is_written[e]) add(rest, e);
  }
  std::erase_if(blocks, [](const GmshBlock& block) { return block.nodes.empty(); });
  return blocks;
}

}  // namespace

GroupedMesh GroupedBox(const Eigen::Vector3d& size, const Eigen::Vector3i& cells, bool quadratic) {
  mesh::TetrahedralMesh box = LatticeBox(size, cells);
  if (quadratic) box = mesh::MakeQuadratic(std::move(box));
  GroupedMesh grouped;
  grouped.nodes = box.nodes;
  grouped.tetrahedra = box.tetrahedra;
  for (int v = 0; v < box.nodes.cols(); ++v) grouped.node_numbers.push_back(10 + 3 * v);
  for (int e = 0; e < box.tetrahedra.cols(); ++e) grouped.element_numbers.push_back(5000 + 2 * e);
  grouped.element_groups = {{"high", {}}, {"low", {}}};
  static constexpr const char* kFaces[6] = {"x_max", "x_min", "y_max", "y_min", "z_max", "z_min"};
  for (const char* name : kFaces) grouped.face_groups.push_back({name, {}});
  for (int e = 0; e < box.tetrahedra.cols(); ++e) {
    double x = 0;
    for (int k = 0; k < 4; ++k) x += box.nodes(0, box.tetrahedra(k, e)) / 4;
    grouped.element_groups[x < size[0] / 2 ? 1 : 0].members.push_back(e);
    for (int side = 0; side < 4; ++side) {
      for (int plane = 0; plane < 6; ++plane) {
        const double at = plane % 2 == 0 ? size[plane / 2] : 0;
        const bool is_on = std::all_of(
            mesh::kTetrahedronFaces[side].begin(), mesh::kTetrahedronFaces[side].end(), [&](int k) {
              return std::abs(box.nodes(plane / 2, box.tetrahedra(k, e)) - at) < 1e-9 * size.norm();
            });
        if (is_on) grouped.face_groups[plane].members.push_back({e, side});
      }
    }
  }
  grouped.node_groups = {{"origin", {0}}, {"tip", {}}};
  for (int v = 0; v < box.nodes.cols(); ++v) {
    if (box.nodes(0, v) > size[0] * (1 - 1e-9)) grouped.node_groups[1].members.push_back(v);
  }
  return grouped;
}

std::string WriteGmsh22(const GroupedMesh& mesh, bool is_binary) {
  Writer out(is_binary);
  out.Text(GmshHeader("2.2", is_binary) + GmshNames(mesh));
  out.Text(absl::StrCat("$Nodes\n", mesh.nodes.cols(), "\n"));
  for (Eigen::Index v = 0; v < mesh.nodes.cols(); ++v) {
    out.Int(mesh.node_numbers[v]);
    for (int k = 0; k < 3; ++k) out.Double(mesh.nodes(k, v));
    out.EndLine();
  }
  if (is_binary) out.Text("\n");
  const std::vector<GmshBlock> blocks = GmshBlocks(mesh);
  std::size_t count = 0;
  for (const GmshBlock& block : blocks) count += block.nodes.size();
  out.Text(absl::StrCat("$EndNodes\n$Elements\n", count, "\n"));
  std::int64_t next = 1'000'000;
  for (const GmshBlock& block : blocks) {
    if (is_binary) {
      out.Int(block.type);
      out.Int(static_cast<std::int64_t>(block.nodes.size()));
      out.Int(2);
    }
    for (std::size_t i = 0; i < block.nodes.size(); ++i) {
      out.Int(block.dimension == 3 ? block.numbers[i] : next++);
      if (!is_binary) {
        out.Int(block.type);
        out.Int(2);
      }
      out.Int(block.group);
      out.Int(1);
      for (const std::int64_t node : block.nodes[i]) out.Int(node);
      out.EndLine();
    }
  }
  if (is_binary) out.Text("\n");
  out.Text("$EndElements\n");
  return out.Take();
}

std::string WriteGmsh41(const GroupedMesh& mesh, bool is_binary) {
  const std::vector<GmshBlock> blocks = GmshBlocks(mesh);
  Writer out(is_binary);
  out.Text(GmshHeader("4.1", is_binary) + GmshNames(mesh) + "$Entities\n");
  // One entity for each block, of the same number as its group.
  for (int dimension = 0; dimension < 4; ++dimension) {
    out.Size(std::count_if(blocks.begin(), blocks.end(),
                           [&](const GmshBlock& block) { return block.dimension == dimension; }));
  }
  out.EndLine();
  for (int dimension = 0; dimension < 4; ++dimension) {
    for (const GmshBlock& block : blocks) {
      if (block.dimension != dimension) continue;
      out.Int(1 + block.group);
      for (int k = 0; k < (dimension == 0 ? 3 : 6); ++k) out.Double(0);
      out.Size(block.group > 0 ? 1 : 0);
      if (block.group > 0) out.Int(dimension == 2 ? -block.group : block.group);
      if (dimension > 0) {
        out.Size(1);
        out.Int(-7);
      }
      out.EndLine();
    }
  }
  if (is_binary) out.Text("\n");
  out.Text("$EndEntities\n$Nodes\n");
  const Eigen::Index half = mesh.nodes.cols() / 2;
  for (const std::int64_t total :
       {std::int64_t{2}, std::int64_t{mesh.nodes.cols()}, std::int64_t{1}, std::int64_t{9}}) {
    out.Size(total);
  }
  out.EndLine();
  for (int b = 0; b < 2; ++b) {
    // The second block has parameters on its surface, which readers skip.
    const Eigen::Index begin = b == 0 ? 0 : half, end = b == 0 ? half : mesh.nodes.cols();
    for (const int value : {b == 0 ? 3 : 2, 1, b}) out.Int(value);
    out.Size(end - begin);
    out.EndLine();
    for (Eigen::Index v = begin; v < end; ++v) {
      out.Size(mesh.node_numbers[v]);
      out.EndLine();
    }
    for (Eigen::Index v = begin; v < end; ++v) {
      for (int k = 0; k < 3; ++k) out.Double(mesh.nodes(k, v));
      for (int k = 0; k < 2 * b; ++k) out.Double(0.5);
      out.EndLine();
    }
  }
  if (is_binary) out.Text("\n");
  out.Text("$EndNodes\n$Elements\n");
  std::int64_t count = 0;
  for (const GmshBlock& block : blocks) count += static_cast<std::int64_t>(block.nodes.size());
  for (const std::int64_t total :
       {static_cast<std::int64_t>(blocks.size()), count, std::int64_t{1}, std::int64_t{9}}) {
    out.Size(total);
  }
  out.EndLine();
  std::int64_t next = 1'000'000;
  for (const GmshBlock& block : blocks) {
    for (const int value : {block.dimension, 1 + block.group, block.type}) out.Int(value);
    out.Size(static_cast<std::int64_t>(block.nodes.size()));
    out.EndLine();
    for (std::size_t i = 0; i < block.nodes.size(); ++i) {
      out.Size(block.dimension == 3 ? block.numbers[i] : next++);
      for (const std::int64_t node : block.nodes[i]) out.Size(node);
      out.EndLine();
    }
  }
  if (is_binary) out.Text("\n");
  out.Text("$EndElements\n");
  return out.Take();
}

std::string WriteAbaqus(const GroupedMesh& mesh) {
  std::string out = "*HEADING\n a box, by a test\n** nodes\n*Node, nset=Nall\n";
  for (Eigen::Index v = 0; v < mesh.nodes.cols(); ++v) {
    absl::StrAppendFormat(&out, "%d, %.17g, %.17g, %.17g\n", mesh.node_numbers[v], mesh.nodes(0, v),
                          mesh.nodes(1, v), mesh.nodes(2, v));
  }
  const Eigen::Index nodes = mesh.tetrahedra.rows();
  absl::StrAppend(&out, "*ELEMENT, TYPE = ", nodes == 10 ? "C3D10" : "C3D4", ", ELSET=Eall\n");
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    absl::StrAppend(&out, mesh.element_numbers[e]);
    for (Eigen::Index k = 0; k < nodes; ++k) {
      // Quadratic elements go on in a second line.
      absl::StrAppend(&out, k == 7 ? ",\n " : ", ", mesh.node_numbers[mesh.tetrahedra(k, e)]);
    }
    out += "\n";
  }
  for (const auto& group : mesh.element_groups) {
    absl::StrAppend(&out, "*ELSET, ELSET=", group.name, "\n");
    for (const int e : group.members) absl::StrAppend(&out, mesh.element_numbers[e], ",\n");
  }
  for (const auto& group : mesh.node_groups) {
    absl::StrAppend(&out, "*nset, nset=\"", group.name, "\"\n");
    for (const int v : group.members) absl::StrAppend(&out, mesh.node_numbers[v], ",\n");
  }
  // Sides opposite corners 0 to 3.
  static constexpr const char* kLabels[4] = {"S3", "S4", "S2", "S1"};
  for (const auto& group : mesh.face_groups) {
    absl::StrAppend(&out, "*SURFACE, NAME=", group.name, ", TYPE=ELEMENT\n");
    for (const ElementSide& side : group.members) {
      absl::StrAppend(&out, mesh.element_numbers[side.element], ", ", kLabels[side.side], "\n");
    }
  }
  return out + "*MATERIAL, NAME=STEEL\n*ELASTIC\n210000, 0.3\n*STEP\n*STATIC\n*END STEP\n";
}

}  // namespace mortise::testing
