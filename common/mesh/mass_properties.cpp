#include "common/mesh/mass_properties.h"

#include <Eigen/Geometry>

namespace mortise::mesh {
namespace {

// Sums of signed tetrahedra: volume, first and second moments about a reference point.
class MomentSum {
 public:
  explicit MomentSum(const Eigen::Vector3d& reference) : reference_(reference) {}

  void Add(const Eigen::Vector3d& p0, const Eigen::Vector3d& p1, const Eigen::Vector3d& p2,
           const Eigen::Vector3d& p3) {
    const Eigen::Vector3d a = p0 - reference_, b = p1 - reference_, c = p2 - reference_,
                          d = p3 - reference_;
    const double volume = (b - a).dot((c - a).cross(d - a)) / 6;
    const Eigen::Vector3d sum = a + b + c + d;
    volume_ += volume;
    first_ += volume * sum / 4;
    // ∫ x xᵀ over a tetrahedron: V/20 · (Σ pᵢ pᵢᵀ + s sᵀ), s = Σ pᵢ.
    second_ += volume / 20 *
               (a * a.transpose() + b * b.transpose() + c * c.transpose() + d * d.transpose() +
                sum * sum.transpose());
  }

  MassProperties Result() const {
    MassProperties result;
    result.volume = volume_;
    if (volume_ == 0) return result;
    const Eigen::Vector3d offset = first_ / volume_;
    result.centroid = reference_ + offset;
    const Eigen::Matrix3d central = second_ - volume_ * offset * offset.transpose();
    result.inertia = central.trace() * Eigen::Matrix3d::Identity() - central;
    return result;
  }

 private:
  Eigen::Vector3d reference_;
  double volume_ = 0;
  Eigen::Vector3d first_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second_ = Eigen::Matrix3d::Zero();
};

}  // namespace

MassProperties ComputeMassProperties(const SurfaceMesh& surface) {
  if (surface.triangles.cols() == 0) return {};
  // A reference near the solid keeps cancellation small far from the origin.
  const Eigen::Vector3d reference = surface.vertices.rowwise().mean();
  MomentSum sum(reference);
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    sum.Add(reference, surface.vertices.col(surface.triangles(0, t)),
            surface.vertices.col(surface.triangles(1, t)),
            surface.vertices.col(surface.triangles(2, t)));
  }
  return sum.Result();
}

MassProperties ComputeMassProperties(const TetrahedralMesh& mesh, int part) {
  if (mesh.tetrahedra.cols() == 0) return {};
  MomentSum sum(mesh.nodes.rowwise().mean());
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    if (part >= 0 && mesh.part[e] != part) continue;
    sum.Add(mesh.nodes.col(mesh.tetrahedra(0, e)), mesh.nodes.col(mesh.tetrahedra(1, e)),
            mesh.nodes.col(mesh.tetrahedra(2, e)), mesh.nodes.col(mesh.tetrahedra(3, e)));
  }
  return sum.Result();
}

MassProperties Combine(const std::vector<MassProperties>& bodies,
                       const std::vector<double>& densities) {
  MassProperties total;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const double mass = densities[i] * bodies[i].volume;
    total.volume += mass;
    total.centroid += mass * bodies[i].centroid;
  }
  if (total.volume == 0) return total;
  total.centroid /= total.volume;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const double mass = densities[i] * bodies[i].volume;
    const Eigen::Vector3d offset = bodies[i].centroid - total.centroid;
    total.inertia +=
        densities[i] * bodies[i].inertia +
        mass * (offset.squaredNorm() * Eigen::Matrix3d::Identity() - offset * offset.transpose());
  }
  return total;
}

double SurfaceArea(const SurfaceMesh& surface) {
  double area = 0;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Vector3d a = surface.vertices.col(surface.triangles(0, t));
    const Eigen::Vector3d b = surface.vertices.col(surface.triangles(1, t));
    const Eigen::Vector3d c = surface.vertices.col(surface.triangles(2, t));
    area += 0.5 * (b - a).cross(c - a).norm();
  }
  return area;
}

}  // namespace mortise::mesh
