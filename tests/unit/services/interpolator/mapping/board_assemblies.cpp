#include "tests/unit/services/interpolator/mapping/board_assemblies.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/cad/surface/assembly_surface.h"

namespace mortise::interpolator {
namespace {

using Edge = std::pair<int, int>;
using Names = std::set<std::string>;

const char* const kSides[] = {"y_min", "x_max", "y_max", "x_min", "z_min", "z_max"};

// Two sides with a shelf between them, whose front is flush.
std::vector<Board> Shelf(double width, double height, double depth, double at) {
  const double t = 0.018;
  return {{"left", {0, 0, 0}, {t, depth, height}},
          {"right", {width - t, 0, 0}, {width, depth, height}},
          {"shelf", {t, 0, at}, {width - t, depth - 0.03, at + t}}};
}

// A board on posts that do not reach its edges.
std::vector<Board> Table(double length, double width, double post) {
  std::vector<Board> boards = {{"top", {0, 0, 0.7}, {length, width, 0.73}}};
  for (const double x : {0.1, length - 0.1 - post}) {
    for (const double y : {0.05, width - 0.05 - post}) {
      boards.push_back({absl::StrCat("post", boards.size()), {x, y, 0}, {x + post, y + post, 0.7}});
    }
  }
  return boards;
}

// Two blocks on a base that meet in an edge.
std::vector<Board> Corners(double length, double height) {
  return {{"base", {0, 0, 0}, {2 * length, 0.4, 0.1}},
          {"near", {0, 0, 0.1}, {length, 0.2, 0.1 + height}},
          {"far", {length, 0.2, 0.1}, {2 * length, 0.4, 0.1 + height}}};
}

mesh::PartShape ShapeOf(const Board& board) {
  const Eigen::Vector3d size = board.high - board.low;
  mesh::PartShape shape;
  shape.name = board.name;
  shape.origin = board.low;
  shape.outline.resize(2, 4);
  shape.outline << 0, size.x(), size.x(), 0, 0, 0, size.y(), size.y();
  shape.height = size.z();
  shape.face_names.assign(std::begin(kSides), std::end(kSides));
  return shape;
}

// What bounds the faces on the outside: which meet at each vertex, and along each edge.
struct FaceEdges {
  std::map<int, Names> at_vertex;
  std::map<Edge, std::vector<std::string>> at_edge;
};

FaceEdges EdgesOf(const mesh::AssemblySurface& assembly) {
  FaceEdges edges;
  for (Eigen::Index t = 0; t < assembly.triangles.cols(); ++t) {
    const mesh::AssemblyFace& face =
        assembly.faces[static_cast<std::size_t>(assembly.triangle_face[t])];
    if (face.front_part >= 0) continue;
    const mesh::NamedFace& origin = face.origins.front();
    const std::string name =
        absl::StrCat(assembly.part_names[static_cast<std::size_t>(origin.part)], "/", origin.name);
    for (int k = 0; k < 3; ++k) {
      const int from = assembly.triangles(k, t), to = assembly.triangles((k + 1) % 3, t);
      edges.at_vertex[from].insert(name);
      edges.at_edge[{std::min(from, to), std::max(from, to)}].push_back(name);
    }
  }
  return edges;
}

mesh::ControlVariables VariablesOf(const mesh::AssemblySurface& assembly) {
  const FaceEdges edges = EdgesOf(assembly);
  std::map<std::string, std::vector<int>> by_name;
  for (const auto& [vertex, names] : edges.at_vertex) {
    if (names.size() >= 3) by_name[absl::StrJoin(names, " & ")].push_back(vertex);
  }
  mesh::ControlVariables variables;
  std::map<int, int> point_at;
  for (const auto& [name, vertices] : by_name) {
    if (vertices.size() > 1) continue;
    point_at[vertices[0]] = static_cast<int>(variables.points.size());
    variables.points.push_back({name, assembly.vertices.col(vertices[0])});
  }
  // The sides of triangles between two faces, from which ways are followed from point to point.
  std::map<std::pair<int, std::string>, std::vector<int>> next;
  for (const auto& [edge, faces] : edges.at_edge) {
    if (faces.size() != 2 || faces[0] == faces[1]) continue;
    const std::string name = absl::StrJoin(Names(faces.begin(), faces.end()), " & ");
    next[{edge.first, name}].push_back(edge.second);
    next[{edge.second, name}].push_back(edge.first);
  }
  for (const auto& [start, ways] : next) {
    if (point_at.count(start.first) == 0) continue;
    for (int at : ways) {
      std::vector<int> way = {start.first, at};
      while (point_at.count(at) == 0) {
        const std::vector<int>& ends = next[{at, start.second}];
        if (ends.size() != 2) break;
        at = ends[0] == way[way.size() - 2] ? ends[1] : ends[0];
        way.push_back(at);
      }
      const auto end = point_at.find(at);
      if (end == point_at.end() || start.first >= at) continue;
      variables.paths.push_back({start.second, point_at.at(start.first), end->second,
                                 assembly.vertices(Eigen::all, way)});
    }
  }
  return variables;
}

double OffFace(const std::vector<Board>& boards, const mesh::NamedFace& face,
               const Eigen::Vector3d& position) {
  const Board& board = boards[static_cast<std::size_t>(face.part)];
  const int axis = face.name[0] - 'x';
  const double plane = face.name.substr(2) == "min" ? board.low[axis] : board.high[axis];
  return std::abs(position[axis] - plane);
}

}  // namespace

std::vector<BoardAssembly> BoardAssemblies() {
  return {{"shelf", false, Shelf(0.6, 0.9, 0.3, 0.3), Shelf(0.8, 0.7, 0.25, 0.4)},
          {"table", false, Table(1.2, 0.6, 0.05), Table(0.9, 0.7, 0.08)},
          {"corners", true, Corners(0.3, 0.2), Corners(0.2, 0.3)}};
}

absl::StatusOr<BoardSurface> Fused(const std::vector<Board>& boards) {
  std::vector<mesh::PartShape> parts;
  for (const Board& board : boards) parts.push_back(ShapeOf(board));
  auto assembly = cad::FuseAssembly(parts);
  if (!assembly.ok()) return assembly.status();
  BoardSurface surface;
  ModelSurface& model = surface.model;
  model.surface = {assembly->vertices, assembly->triangles};
  model.back.resize(assembly->triangles.cols());
  model.front.resize(assembly->triangles.cols());
  for (Eigen::Index t = 0; t < assembly->triangles.cols(); ++t) {
    const mesh::AssemblyFace& face =
        assembly->faces[static_cast<std::size_t>(assembly->triangle_face[t])];
    model.back[t] = face.back_part;
    model.front[t] = face.front_part;
  }
  model.variables = VariablesOf(*assembly);
  surface.assembly = *std::move(assembly);
  return surface;
}

double FarthestOffFaces(const std::vector<Board>& boards, const mesh::AssemblySurface& assembly,
                        const Eigen::Matrix3Xd& positions) {
  double farthest = 0;
  for (Eigen::Index t = 0; t < assembly.triangles.cols(); ++t) {
    const auto face = static_cast<std::size_t>(assembly.triangle_face[t]);
    for (const mesh::NamedFace& origin : assembly.faces[face].origins) {
      for (const int vertex : assembly.triangles.col(t)) {
        farthest = std::max(farthest, OffFace(boards, origin, positions.col(vertex)));
      }
    }
  }
  return farthest;
}

double FarthestOffFaces(const std::vector<Board>& boards, const mesh::TetrahedralMesh& mesh,
                        const Eigen::Matrix3Xd& nodes) {
  double farthest = 0;
  for (Eigen::Index t = 0; t < mesh.face_triangles.cols(); ++t) {
    const auto face = static_cast<std::size_t>(mesh.face_triangle_face[t]);
    if (mesh.faces[face].front_part >= 0) continue;
    for (const int node : mesh.face_triangles.col(t)) {
      farthest =
          std::max(farthest, OffFace(boards, mesh.faces[face].origins.front(), nodes.col(node)));
    }
  }
  return farthest;
}

}  // namespace mortise::interpolator
