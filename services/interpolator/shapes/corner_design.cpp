#include "services/interpolator/shapes/corner_design.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "common/mesh/element_faces.h"

namespace mortise::interpolator {
namespace {

using Key = std::array<int, 3>;

Key KeyOf(const Eigen::Ref<const Eigen::Vector3i>& triangle) {
  Key key{triangle[0], triangle[1], triangle[2]};
  std::sort(key.begin(), key.end());
  return key;
}

// Numbers the nodes that cells name, in their order; -1 of others.
class NodeNumbers {
 public:
  explicit NodeNumbers(Eigen::Index nodes) : number_(static_cast<std::size_t>(nodes), -1) {}

  void Use(const Eigen::MatrixXi& cells) {
    for (Eigen::Index i = 0; i < cells.size(); ++i) {
      number_[static_cast<std::size_t>(cells.data()[i])] = 0;
    }
  }

  void Number() {
    for (std::size_t node = 0; node < number_.size(); ++node) {
      if (number_[node] < 0) continue;
      number_[node] = static_cast<int>(kept_.size());
      kept_.push_back(static_cast<int>(node));
    }
  }

  const std::vector<int>& kept() const { return kept_; }
  int Of(int node) const { return node < 0 ? -1 : number_[static_cast<std::size_t>(node)]; }

  void Apply(Eigen::MatrixXi& cells) const {
    for (Eigen::Index i = 0; i < cells.size(); ++i) cells.data()[i] = Of(cells.data()[i]);
  }

 private:
  std::vector<int> number_;
  std::vector<int> kept_;
};

void KeepControls(const fields::DesignFields& design, const NodeNumbers& numbers,
                  fields::DesignFields& corners) {
  for (fields::ControlPoint point : design.control_points) {
    point.node = numbers.Of(point.node);
    corners.control_points.push_back(std::move(point));
  }
  corners.ways = design.ways;
  for (const fields::Path& path : design.paths) {
    fields::Path kept{path.id, {}};
    for (const int node : path.nodes) {
      if (const int number = numbers.Of(node); number >= 0) kept.nodes.push_back(number);
    }
    if (kept.nodes.size() >= 2) corners.paths.push_back(std::move(kept));
  }
}

void KeepFields(const fields::DesignFields& design, const std::vector<int>& nodes,
                bool with_elements, fields::DesignFields& corners) {
  for (const fields::Field& field : design.fields) {
    const bool of_nodes = field.place == fields::FieldPlace::kNodes;
    if (!of_nodes && !with_elements) continue;
    fields::Field& kept = corners.fields.emplace_back();
    kept.name = field.name;
    kept.unit = field.unit;
    kept.load_case = field.load_case;
    kept.place = field.place;
    kept.values = of_nodes ? Eigen::MatrixXd(field.values(Eigen::all, nodes)) : field.values;
  }
}

// Takes the given triangles that are outside first, then the other outer faces.
OuterTriangles OuterFaces(const fields::DesignFields& design) {
  const std::vector<mesh::ElementFace> faces = mesh::ElementFaces(ElementsOf(design)).Outer();
  std::map<Key, std::size_t> given;
  for (Eigen::Index t = 0; t < design.triangles.cols(); ++t) {
    given.emplace(KeyOf(design.triangles.col(t).head<3>()), static_cast<std::size_t>(t));
  }
  std::vector<std::pair<std::size_t, std::size_t>> order;  // given triangle or behind them, face
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const auto found = given.find(faces[f].key);
    order.emplace_back(found == given.end() ? given.size() + f : found->second, f);
  }
  std::sort(order.begin(), order.end());
  OuterTriangles outer;
  const auto count = static_cast<Eigen::Index>(order.size());
  outer.triangles.resize(3, count);
  outer.part.resize(count);
  outer.outer_of.assign(static_cast<std::size_t>(design.triangles.cols()), -1);
  for (Eigen::Index t = 0; t < count; ++t) {
    const auto [rank, f] = order[static_cast<std::size_t>(t)];
    const mesh::ElementFace& face = faces[f];
    const auto& corner = mesh::kTetrahedronFaces[static_cast<std::size_t>(face.side)];
    for (int k = 0; k < 3; ++k) {
      outer.triangles(k, t) = design.tetrahedra(corner[static_cast<std::size_t>(k)], face.element);
    }
    outer.part[t] = design.tetrahedron_part[face.element];
    outer.element.push_back(face.element);
    if (given.contains(face.key)) outer.outer_of[rank] = static_cast<int>(t);
  }
  return outer;
}

OuterTriangles GivenOnOutside(const fields::DesignFields& design) {
  OuterTriangles outer;
  outer.outer_of.assign(static_cast<std::size_t>(design.triangles.cols()), -1);
  int count = 0;
  for (Eigen::Index t = 0; t < design.triangles.cols(); ++t) {
    if (design.triangle_back[t] >= 0 && design.triangle_front[t] >= 0) continue;
    outer.outer_of[static_cast<std::size_t>(t)] = count++;
  }
  outer.triangles.resize(3, count);
  outer.part.resize(count);
  outer.element.assign(static_cast<std::size_t>(count), -1);
  if (design.triangles.rows() == 6) outer.middles.resize(3, count);
  for (Eigen::Index t = 0; t < design.triangles.cols(); ++t) {
    const int number = outer.outer_of[static_cast<std::size_t>(t)];
    if (number < 0) continue;
    outer.triangles.col(number) = design.triangles.col(t).head<3>();
    const int back = design.triangle_back[t], front = design.triangle_front[t];
    if (front >= 0) std::swap(outer.triangles(1, number), outer.triangles(2, number));
    outer.part[number] = std::max(back, front);
    if (outer.middles.cols() == 0) continue;
    outer.middles.col(number) = design.triangles.col(t).tail<3>();
    if (front >= 0) std::swap(outer.middles(0, number), outer.middles(2, number));
  }
  return outer;
}

}  // namespace

fields::DesignFields CornersOf(const fields::DesignFields& design, bool with_elements) {
  const bool has_elements = with_elements && design.tetrahedra.cols() > 0;
  fields::DesignFields corners;
  if (has_elements) {
    corners.tetrahedra = design.tetrahedra.topRows(4);
    corners.tetrahedron_part = design.tetrahedron_part;
  } else {
    corners.tetrahedra.resize(4, 0);
    corners.tetrahedron_part.resize(0);
  }
  corners.triangles = design.triangles.topRows(3);
  corners.triangle_back = design.triangle_back;
  corners.triangle_front = design.triangle_front;
  NodeNumbers numbers(design.nodes.cols());
  numbers.Use(corners.tetrahedra);
  numbers.Use(corners.triangles);
  numbers.Number();
  numbers.Apply(corners.tetrahedra);
  numbers.Apply(corners.triangles);
  corners.nodes = design.nodes(Eigen::all, numbers.kept());
  corners.parts = design.parts;
  corners.regions = design.regions;
  KeepControls(design, numbers, corners);
  KeepFields(design, numbers.kept(), has_elements, corners);
  return corners;
}

OuterTriangles FindOuterTriangles(const fields::DesignFields& design) {
  return design.tetrahedra.cols() > 0 ? OuterFaces(design) : GivenOnOutside(design);
}

mesh::SurfaceMesh FineSurface(const fields::DesignFields& design, const OuterTriangles& outer) {
  mesh::SurfaceMesh fine;
  fine.vertices = design.nodes;
  if (design.triangles.rows() != 6) {
    fine.triangles = outer.triangles;
    return fine;
  }
  std::vector<bool> is_given(static_cast<std::size_t>(outer.triangles.cols()), false);
  std::vector<Eigen::Vector3i> triangles;
  for (Eigen::Index t = 0; t < design.triangles.cols(); ++t) {
    const int number = outer.outer_of[static_cast<std::size_t>(t)];
    if (number < 0) continue;
    is_given[static_cast<std::size_t>(number)] = true;
    const Eigen::Matrix<int, 6, 1> nodes = design.triangles.col(t);
    triangles.emplace_back(nodes[0], nodes[3], nodes[5]);
    triangles.emplace_back(nodes[3], nodes[1], nodes[4]);
    triangles.emplace_back(nodes[5], nodes[4], nodes[2]);
    triangles.emplace_back(nodes[3], nodes[4], nodes[5]);
  }
  for (Eigen::Index t = 0; t < outer.triangles.cols(); ++t) {
    if (!is_given[static_cast<std::size_t>(t)]) triangles.emplace_back(outer.triangles.col(t));
  }
  fine.triangles.resize(3, std::ssize(triangles));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    fine.triangles.col(static_cast<Eigen::Index>(t)) = triangles[t];
  }
  return fine;
}

fields::DesignFields WithoutElements(fields::DesignFields design) {
  design.tetrahedra.resize(4, 0);
  design.tetrahedron_part.resize(0);
  std::erase_if(design.fields, [](const fields::Field& field) {
    return field.place == fields::FieldPlace::kElements;
  });
  return design;
}

NodeSurface SurfaceOf(const Eigen::Matrix3Xd& nodes, const Eigen::Matrix3Xi& triangles) {
  NodeNumbers numbers(nodes.cols());
  Eigen::MatrixXi renumbered = triangles;
  numbers.Use(renumbered);
  numbers.Number();
  numbers.Apply(renumbered);
  return {{nodes(Eigen::all, numbers.kept()), renumbered}, numbers.kept()};
}

mesh::TetrahedralMesh ElementsOf(const fields::DesignFields& design) {
  mesh::TetrahedralMesh mesh;
  mesh.nodes = design.nodes;
  mesh.tetrahedra = design.tetrahedra;
  mesh.part = design.tetrahedron_part;
  mesh.part_names = design.parts;
  mesh.face_triangles.resize(3, 0);
  return mesh;
}

}  // namespace mortise::interpolator
