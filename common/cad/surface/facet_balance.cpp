#include "common/cad/surface/facet_balance.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRep_Tool.hxx>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <Poly_Triangulation.hxx>
#include <algorithm>
#include <array>
#include <cmath>

#include "common/cad/occt_vectors.h"
#include "common/mesh/surface_check.h"

namespace mortise::cad {
namespace {

// Corners are looked at a little within their triangle: at a pole there is no normal, and at the
// apex of a cone each triangle has its own.
constexpr double kInwards = 1e-3;
// The 19/120 of the series of sqrt(a / sin a) - 1, which gives a regular prism the cylinder's area,
// over that of sin²(a/2) / 3.
constexpr double kFourthOrder = 19.0 / 120;
constexpr double kOneNormal =
    0.9;                           // length of the mean of normals that belong to one tangent plane
constexpr double kInPlane = 1e-6;  // of a unit vector: what is left of it outside some planes
constexpr double kAtACorner = 0.5;  // singular value below which a face runs along the others

constexpr double kTurned = 0.05;  // of a triangle's area: what is left of one that nearly folds
constexpr int kRounds = 20;
constexpr int kMaxCrossings = 100;

// The surface's normal, whichever way the face is turned; zero if it has none.
Eigen::Vector3d NormalAt(const BRepAdaptor_Surface& surface, const gp_XY& place) {
  gp_Pnt point;
  gp_Vec along_u, along_v;
  surface.D1(place.X(), place.Y(), point, along_u, along_v);
  const Eigen::Vector3d normal = ToEigen(along_u.XYZ()).cross(ToEigen(along_v.XYZ()));
  const double length = normal.norm();
  return length > 0 ? Eigen::Vector3d(normal / length) : Eigen::Vector3d::Zero();
}

// How far the middle of a chord lies below the surface that has these normals at its ends.
double SagOf(const Eigen::Vector3d& chord, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d turn = to - from;
  return chord.dot(turn) / 8 * (1 + kFourthOrder * turn.squaredNorm());
}

// An orthonormal basis, by columns, of the directions along all of some planes.
Eigen::MatrixXd AlongAll(const std::vector<Eigen::Vector3d>& normals) {
  Eigen::Matrix3Xd across(3, 0);
  Eigen::Matrix3d free = Eigen::Matrix3d::Identity();
  for (const Eigen::Vector3d& normal : normals) {
    const Eigen::Vector3d rest = free * normal;
    if (rest.norm() <= kInPlane) continue;
    const Eigen::Vector3d unit = rest.normalized();
    free -= unit * unit.transpose();
    across.conservativeResize(3, across.cols() + 1);
    across.rightCols(1) = unit;
    if (across.cols() == 3) break;
  }
  if (across.cols() == 0) return Eigen::Matrix3d::Identity();
  const Eigen::JacobiSVD<Eigen::Matrix3Xd> svd(across, Eigen::ComputeFullU);
  return svd.matrixU().rightCols(3 - across.cols());
}

Eigen::Vector3d AreaOf(const Eigen::Matrix3Xd& vertices, const Eigen::Vector3i& corners) {
  const Eigen::Vector3d first = vertices.col(corners(0));
  return (vertices.col(corners(1)) - first).cross(vertices.col(corners(2)) - first);
}

// Triangles that turn over when the vertices are moved, or cross others.
std::vector<int> BadTriangles(const mesh::AssemblySurface& surface, const Eigen::Matrix3Xd& moved) {
  std::vector<int> bad;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Vector3i corners = surface.triangles.col(t);
    const Eigen::Vector3d before = AreaOf(surface.vertices, corners);
    if (before.dot(AreaOf(moved, corners)) <= kTurned * before.squaredNorm()) {
      bad.push_back(static_cast<int>(t));
    }
  }
  for (const mesh::Intersection& found :
       mesh::FindIntersections(moved, surface.triangles, kMaxCrossings)) {
    bad.push_back(found.first);
    bad.push_back(found.second);
  }
  return bad;
}

}  // namespace

void FacetBalance::Add(const TopoDS_Face& face, const std::vector<int>& points) {
  const int index = static_cast<int>(is_flat_.size());
  const BRepAdaptor_Surface surface(face, Standard_False);
  is_flat_.push_back(surface.GetType() == GeomAbs_Plane);
  TopLoc_Location location;
  const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
  if (is_flat_.back() || !mesh->HasUVNodes()) return;
  const bool is_reversed = face.Orientation() == TopAbs_REVERSED;
  for (int t = 1; t <= mesh->NbTriangles(); ++t) {
    std::array<int, 3> nodes{};
    mesh->Triangle(t).Get(nodes[0], nodes[1], nodes[2]);
    if (is_reversed) std::swap(nodes[1], nodes[2]);
    std::array<Eigen::Vector3d, 3> places, normals;
    gp_XY middle(0, 0);
    for (const int node : nodes) middle += mesh->UVNode(node).XY() / 3;
    for (std::size_t k = 0; k < 3; ++k) {
      places[k] = ToEigen(mesh->Node(nodes[k]).Transformed(location.Transformation()).XYZ());
      const gp_XY corner = mesh->UVNode(nodes[k]).XY();
      normals[k] = NormalAt(surface, corner + kInwards * (middle - corner));
      if (is_reversed) normals[k] = -normals[k];
    }
    const double area = (places[1] - places[0]).cross(places[2] - places[0]).norm() / 2;
    double miss = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      miss += SagOf(places[next] - places[k], normals[k], normals[next]) / 3;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      Share& share = shares_[{points[static_cast<std::size_t>(nodes[k])], index}];
      share.normal += area * normals[k];
      share.miss += area * miss;
      share.area += area;
    }
  }
}

Eigen::Matrix3Xd FacetBalance::ShiftsOf(const mesh::AssemblySurface& surface) const {
  std::map<int, std::vector<Eigen::Vector3d>> planes;  // normals of those at each point
  const auto is_curved_point = [&](int point) {
    const auto found = shares_.lower_bound({point, 0});
    return found != shares_.end() && found->first.first == point;
  };
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    if (!is_flat_[static_cast<std::size_t>(surface.triangle_face(t))]) continue;
    const Eigen::Vector3i corners = surface.triangles.col(t);
    const Eigen::Vector3d normal = AreaOf(surface.vertices, corners).normalized();
    for (const int point : corners) {
      if (is_curved_point(point)) planes[point].push_back(normal);
    }
  }
  Eigen::Matrix3Xd shifts = Eigen::Matrix3Xd::Zero(3, surface.vertices.cols());
  for (auto first = shares_.begin(); first != shares_.end();) {
    const int point = first->first.first;
    Eigen::MatrixX3d normals(0, 3);
    Eigen::VectorXd misses(0);
    for (; first != shares_.end() && first->first.first == point; ++first) {
      const Share& share = first->second;
      if (!(share.normal.norm() >= kOneNormal * share.area && share.area > 0)) continue;
      normals.conservativeResize(normals.rows() + 1, 3);
      normals.bottomRows(1) = share.normal.normalized().transpose();
      misses.conservativeResize(misses.size() + 1);
      misses.tail(1)(0) = share.miss / share.area;
    }
    const auto flat = planes.find(point);
    const Eigen::MatrixXd along =
        flat == planes.end() ? Eigen::Matrix3d::Identity() : AlongAll(flat->second);
    if (along.cols() == 0 || normals.rows() == 0) continue;
    Eigen::JacobiSVD<Eigen::MatrixXd> svd(normals * along,
                                          Eigen::ComputeThinU | Eigen::ComputeThinV);
    Eigen::VectorXd step = svd.matrixU().transpose() * misses;
    for (Eigen::Index i = 0; i < step.size(); ++i) {
      const double value = svd.singularValues()(i);
      step(i) = value < kAtACorner ? 0 : step(i) / value;
    }
    shifts.col(point) = along * (svd.matrixV() * step);
  }
  return shifts;
}

void FacetBalance::Apply(mesh::AssemblySurface& surface) const {
  Eigen::Matrix3Xd shifts = ShiftsOf(surface);
  for (int round = 0; round < kRounds && !shifts.isZero(0); ++round) {
    const Eigen::Matrix3Xd moved = surface.vertices + shifts;
    bool is_better = false;
    for (const int triangle : BadTriangles(surface, moved)) {
      for (const int point : surface.triangles.col(triangle)) {
        is_better = is_better || !shifts.col(point).isZero(0);
        shifts.col(point).setZero();
      }
    }
    // What crosses though nothing moves there crossed before, which others tell of.
    if (!is_better) {
      surface.vertices = moved;
      return;
    }
  }
}

}  // namespace mortise::cad
