#include "tests/unit/services/interpolator/shapes/block_designs.h"

#include <utility>

#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::interpolator {
namespace {

// Returns the values of `at` at each of some places.
template <typename At>
Eigen::MatrixXd ValuesAt(const Eigen::Matrix3Xd& places, int components, const At& at) {
  Eigen::MatrixXd values(components, places.cols());
  for (Eigen::Index i = 0; i < places.cols(); ++i) values.col(i) = at(places.col(i));
  return values;
}

Eigen::Matrix3Xd CentresOf(const mesh::TetrahedralMesh& mesh) {
  Eigen::Matrix3Xd centres(3, mesh.tetrahedra.cols());
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    const Eigen::MatrixXd corners = mesh.nodes(Eigen::all, mesh.tetrahedra.col(e));
    centres.col(e) = corners.rowwise().mean();
  }
  return centres;
}

void AddTriangles(const BlockMesh& block, fields::DesignFields& design) {
  const Eigen::Matrix3Xi& triangles = block.marked.surface.triangles;
  design.triangles.resize(3, triangles.cols());
  fields::Region held{"held", {}};
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    double farthest = 0;
    for (int k = 0; k < 3; ++k) {
      const int node = block.node[static_cast<std::size_t>(triangles(k, t))];
      design.triangles(k, t) = node;
      farthest = std::max(farthest, block.block(0, node));
    }
    if (farthest == 0) held.triangles.push_back(static_cast<int>(t));
  }
  design.triangle_back = Eigen::VectorXi::Zero(triangles.cols());
  design.triangle_front = Eigen::VectorXi::Constant(triangles.cols(), -1);
  design.regions = {std::move(held)};
}

}  // namespace

double TemperatureAt(const Eigen::Vector3d& place) {
  return 300 + Eigen::Vector3d(40, -25, 90).dot(place);
}

Eigen::Vector3d DisplacementAt(const Eigen::Vector3d& place) {
  Eigen::Matrix3d gradient;
  gradient << 1, 2, -3, 0.5, -1, 4, 2, 2, 1;
  return 1e-3 * (gradient * place + Eigen::Vector3d(0.1, 0.2, -0.3));
}

Eigen::Matrix<double, 6, 1> StressAt(const Eigen::Vector3d& place) {
  Eigen::Matrix<double, 6, 1> stress;
  stress << 1, 2, 3, 4, 5, 6;
  return 1e6 * (1 + place.sum()) * stress;
}

Eigen::Vector3d HeatFluxAt(const Eigen::Vector3d& place) { return 100 * place; }

fields::DesignFields BlockDesign(const BlockShape& shape, const BlockCells& cells) {
  const BlockMesh block = MakeBlockMesh(shape, cells);
  const mesh::TetrahedralMesh& mesh = block.marked_mesh.mesh;
  fields::DesignFields design;
  design.nodes = mesh.nodes;
  design.tetrahedra = mesh.tetrahedra;
  design.tetrahedron_part = mesh.part;
  design.parts = {"body"};
  AddTriangles(block, design);
  for (const ControlPoint& point : block.marked_mesh.points) {
    design.control_points.push_back({point.name, mesh.nodes.col(point.vertex), point.vertex});
  }
  for (const ControlPath& path : block.marked_mesh.paths) {
    design.paths.push_back({path.name, path.vertices});
  }
  using fields::FieldPlace;
  design.fields = {
      {"temperature", "K", "", FieldPlace::kNodes,
       ValuesAt(mesh.nodes, 1,
                [](const Eigen::Vector3d& at) {
                  return Eigen::Matrix<double, 1, 1>(TemperatureAt(at));
                })},
      {"displacement", "m", "wind", FieldPlace::kNodes, ValuesAt(mesh.nodes, 3, DisplacementAt)},
      {"stress", "Pa", "wind", FieldPlace::kNodes, ValuesAt(mesh.nodes, 6, StressAt)},
      {"heat_flux", "W/m^2", "", FieldPlace::kElements, ValuesAt(CentresOf(mesh), 3, HeatFluxAt)}};
  return design;
}

fields::DesignFields SurfaceOnly(fields::DesignFields design) {
  design.tetrahedra.resize(4, 0);
  design.tetrahedron_part.resize(0);
  std::erase_if(design.fields, [](const fields::Field& field) {
    return field.place == fields::FieldPlace::kElements;
  });
  return design;
}

fields::DesignFields Quadratic(const fields::DesignFields& design) {
  mesh::TetrahedralMesh mesh;
  mesh.nodes = design.nodes;
  mesh.tetrahedra = design.tetrahedra;
  mesh.part = design.tetrahedron_part;
  mesh.part_names = design.parts;
  mesh.face_triangles = design.triangles;
  mesh.face_triangle_face = Eigen::VectorXi::Zero(design.triangles.cols());
  mesh.faces = {{.front_part = -1, .back_part = 0, .origins = {}}};
  mesh = mesh::MakeQuadratic(std::move(mesh));
  fields::DesignFields quadratic = design;
  quadratic.nodes = mesh.nodes;
  quadratic.tetrahedra = mesh.tetrahedra;
  quadratic.triangles = mesh.face_triangles;
  for (fields::Field& field : quadratic.fields) {
    if (field.place != fields::FieldPlace::kNodes) continue;
    const Eigen::MatrixXd corners = field.values;
    field.values = Eigen::MatrixXd::Constant(corners.rows(), mesh.nodes.cols(), 1e6);
    field.values.leftCols(corners.cols()) = corners;
  }
  return quadratic;
}

}  // namespace mortise::interpolator
