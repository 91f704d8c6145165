#include "common/fem/stress/surface_traction.h"

#include <cmath>
#include <limits>

#include "common/fem/elements/loads.h"
#include "common/fem/elements/shape_derivative.h"
#include "common/fem/elements/shape_functions.h"

namespace mortise::simulator {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// A face is held along its normal where that is an axis up to rounding.
constexpr double kAlongAxis = 1 - 1e-9;

// The free face of a part's surface that is a triangle of the mesh; -1 if there is none.
int FaceOf(const mesh::TetrahedralMesh& mesh, const PartSurface& surface, int triangle) {
  return surface.FreeFaceWith({mesh.face_triangles(0, triangle), mesh.face_triangles(1, triangle),
                               mesh.face_triangles(2, triangle)});
}

// Which of x, y and z are held at each node; those of planes of symmetry are not among them.
Eigen::Array3Xi HeldAxes(const mesh::TetrahedralMesh& mesh, const std::vector<Support>& supports) {
  Eigen::Array3Xi held = Eigen::Array3Xi::Zero(3, mesh.nodes.cols());
  for (const Support& support : supports) {
    if (support.symmetric) continue;
    const Eigen::Array3i axes(support.fixed[0], support.fixed[1], support.fixed[2]);
    for (const int t : TrianglesOn(mesh, support.face, false)) {
      for (const int node : mesh.face_triangles.col(t)) held.col(node) = held.col(node).max(axes);
    }
    if (!support.face.name.empty()) continue;
    for (const int node : support.nodes) held.col(node) = held.col(node).max(axes);
  }
  return held;
}

// Which nodes have forces of their own, those of the elements round a point under a force among
// them.
std::vector<bool> UnderForces(const mesh::TetrahedralMesh& mesh, const LoadCase& loads) {
  std::vector<bool> under(static_cast<std::size_t>(mesh.nodes.cols()));
  for (const NodalForce& load : loads.nodal_forces) {
    if (!load.force.isZero(0)) under[static_cast<std::size_t>(load.node)] = true;
  }
  if (loads.point_forces.empty()) return under;
  LoadCase points;
  points.point_forces = loads.point_forces;
  const auto forces = AssembleLoads(mesh, {}, points);
  if (!forces.ok()) return under;
  for (Eigen::Index v = 0; v < forces->cols(); ++v) {
    if (!forces->col(v).isZero(0)) under[static_cast<std::size_t>(v)] = true;
  }
  return under;
}

// Adds what `of` makes of the place and the normal at each node of a loaded face.
template <typename Of>
void AddOn(const mesh::TetrahedralMesh& mesh, const PartSurface& surface,
           const mesh::NamedFace& loaded, const Of& of, Eigen::Matrix3Xd& at_nodes) {
  const Eigen::Index places = surface.nodes().rows();
  for (const int t : TrianglesOn(mesh, loaded, true)) {
    const int face = FaceOf(mesh, surface, t);
    if (face < 0) continue;
    const GradientMatrix positions = FacePositions(mesh, surface, face);
    for (int k = 0; k < places; ++k) {
      const Eigen::Vector3d position = positions.col(k);
      const Eigen::Vector3d normal = TriangleAreaVector(positions, FacePlace(k)).normalized();
      at_nodes.col(places * face + k) += of(position, normal);
    }
  }
}

// What acts on the nodes of all faces, wherever they are.
Eigen::Matrix3Xd LoadsOn(const mesh::TetrahedralMesh& mesh, const PartSurface& surface,
                         const LoadCase& loads) {
  using Vector = Eigen::Vector3d;
  Eigen::Matrix3Xd at_nodes = Eigen::Matrix3Xd::Zero(3, surface.nodes().rows() * surface.size());
  for (const FaceForce& force : loads.forces) {
    const double area = AreaOfTriangles(mesh, TrianglesOn(mesh, force.face, true)).value;
    const auto even = [&](const Vector&, const Vector&) -> Vector { return force.force / area; };
    AddOn(mesh, surface, force.face, even, at_nodes);
  }
  for (const FacePressure& pressure : loads.pressures) {
    const auto inward = [&](const Vector&, const Vector& normal) -> Vector {
      return -pressure.pressure * normal;
    };
    AddOn(mesh, surface, pressure.face, inward, at_nodes);
  }
  for (const FaceTraction& given : loads.tractions) {
    AddOn(mesh, surface, given.face, given.traction, at_nodes);
  }
  return at_nodes;
}

// How a face is held.
enum class Hold { kNot, kAlongItsNormal, kOtherwise };

std::vector<Hold> HoldsOf(const mesh::TetrahedralMesh& mesh, const PartSurface& surface,
                          const std::vector<Support>& supports) {
  std::vector<Hold> holds(static_cast<std::size_t>(surface.size()), Hold::kNot);
  const Eigen::Array3Xi held = HeldAxes(mesh, supports);
  for (int face = 0; face < surface.size(); ++face) {
    Eigen::Array3i axes = Eigen::Array3i::Ones();  // along which all corners are held
    for (int k = 0; k < 3; ++k) axes = axes.min(held.col(surface.nodes()(k, face)));
    if (axes.sum() == 0) continue;
    const Eigen::Vector3d normal =
        TriangleAreaVector(FacePositions(mesh, surface, face), FacePlace(0)).normalized();
    const bool along_normal =
        axes.sum() == 1 && normal.cwiseAbs().dot(axes.matrix().cast<double>()) > kAlongAxis;
    holds[static_cast<std::size_t>(face)] = along_normal ? Hold::kAlongItsNormal : Hold::kOtherwise;
  }
  for (const Support& support : supports) {
    if (!support.symmetric) continue;
    for (const int t : TrianglesOn(mesh, support.face, false)) {
      const int face = FaceOf(mesh, surface, t);
      if (face < 0) continue;
      Hold& hold = holds[static_cast<std::size_t>(face)];
      if (hold == Hold::kNot) hold = Hold::kAlongItsNormal;
    }
  }
  return holds;
}

}  // namespace

SurfaceTraction TractionOn(const mesh::TetrahedralMesh& mesh, const PartSurface& surface,
                           const std::vector<Support>& supports, const LoadCase& loads) {
  const Eigen::Index places = surface.nodes().rows();
  SurfaceTraction traction;
  traction.at_nodes = LoadsOn(mesh, surface, loads);
  const std::vector<Hold> holds = HoldsOf(mesh, surface, supports);
  const std::vector<bool> under_forces = UnderForces(mesh, loads);
  for (int face = 0; face < surface.size(); ++face) {
    const Hold hold = holds[static_cast<std::size_t>(face)];
    bool is_known = hold == Hold::kNot && surface.IsFree(face);
    for (const int node : surface.nodes().col(face)) {
      is_known = is_known && !under_forces[static_cast<std::size_t>(node)];
    }
    traction.mirrors.push_back(hold == Hold::kAlongItsNormal);
    if (!is_known) traction.at_nodes.middleCols(places * face, places).setConstant(kUnknown);
  }
  return traction;
}

Eigen::Matrix3Xd TractionDerivative(const mesh::TetrahedralMesh& mesh, const PartSurface& surface,
                                    const LoadCase& loads, const std::vector<ByTraction>& changes) {
  Eigen::Matrix3Xd sum = Eigen::Matrix3Xd::Zero(3, mesh.nodes.cols());
  // What changes with the traction at the nodes of a loaded face.
  const auto on = [&](const mesh::NamedFace& loaded) {
    std::vector<bool> wanted(static_cast<std::size_t>(surface.size()));
    for (const int t : TrianglesOn(mesh, loaded, true)) {
      const int face = FaceOf(mesh, surface, t);
      if (face >= 0) wanted[static_cast<std::size_t>(face)] = true;
    }
    std::vector<ByTraction> found;
    for (const ByTraction& change : changes) {
      if (wanted[static_cast<std::size_t>(change.at.face)]) found.push_back(change);
    }
    return found;
  };
  for (const FaceForce& force : loads.forces) {
    const std::vector<ByTraction> found = on(force.face);
    if (found.empty()) continue;
    const FaceArea area = AreaOfTriangles(mesh, TrianglesOn(mesh, force.face, true));
    for (const ByTraction& change : found) {
      sum -= change.derivative.dot(force.force) / (area.value * area.value) * area.by_position;
    }
  }
  for (const FacePressure& pressure : loads.pressures) {
    for (const ByTraction& change : on(pressure.face)) {
      AddNormalDerivative(mesh, surface, change.at, -pressure.pressure * change.derivative, sum);
    }
  }
  return sum;
}

void AddNormalDerivative(const mesh::TetrahedralMesh& mesh, const PartSurface& surface,
                         const FaceNode& at, const Eigen::Vector3d& by_normal,
                         Eigen::Matrix3Xd& by_position) {
  const TriangleGeometry geometry =
      EvaluateTriangle(FacePositions(mesh, surface, at.face), FacePlace(at.place));
  for (Eigen::Index k = 0; k < surface.nodes().rows(); ++k) {
    by_position.col(surface.nodes()(k, at.face)) -=
        geometry.gradients.col(k).dot(by_normal) * geometry.normal;
  }
}

}  // namespace mortise::simulator
