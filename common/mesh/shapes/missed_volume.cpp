#include "common/mesh/shapes/missed_volume.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "common/mesh/mass_properties.h"
#include "common/mesh/shared_edges.h"

namespace mortise::mesh {
namespace {

constexpr double kFlat = 1e-5;      // rad, between triangles in one plane
constexpr double kSameLine = 1e-3;  // sine and, of its width, distance: edges of a facet in a line
constexpr double kOpposite = -0.9;  // cosine, between what edges at opposite sides of a facet face

// Triangles of one face in one plane, which the face stands out from. Cutting the triangles does
// not change it.
struct Facet {
  // An edge at which the face bends, however many pieces it is cut into.
  struct Bend {
    Eigen::Vector3d at;      // m, a point of it
    Eigen::Vector3d inward;  // across it, in the plane of the facet
    double slope = 0;        // of the face there; negative if it is hollow
    double width = 0;        // m, from it to the far side
  };
  std::vector<int> triangles;
  std::vector<Bend> bends;

  // m, by which the face stands out at a point: a parabola between two bends that face each other;
  // otherwise one from each to the far side.
  double HeightAt(const Eigen::Vector3d& point) const {
    double height = 0;
    for (const Bend& bend : bends) {
      const double from = bend.inward.dot(point - bend.at);
      height += bend.slope * from * (1 - from / bend.width);
    }
    return height;
  }
};

// The slope of a parabola on a chord that has the area of the arc whose chords turn by this much.
double SlopeOfArc(double turn) {
  const double half = std::sin(turn / 2);
  return 0.75 * (turn - std::sin(turn)) / (half * half);
}

class FacetSearch {
 public:
  explicit FacetSearch(const DrawnShape& shape)
      : shape_(shape),
        vertices_(shape.size.asDiagonal() * shape.fractions),
        normals_(TriangleNormals(vertices_, shape.triangles)) {
    const std::vector<SharedEdge> edges = SharedEdges(shape.triangles);
    JoinTriangles(edges);
    for (const SharedEdge& edge : edges) NoteBend(edge);
    for (Facet& facet : facets_) Measure(facet);
  }

  std::vector<Facet> Found() { return std::move(facets_); }

 private:
  bool AreOfOneFace(const SharedEdge& edge) const {
    return shape_.triangle_face(edge.first) == shape_.triangle_face(edge.second);
  }
  bool IsFlat(const SharedEdge& edge) const {
    return (normals_.col(edge.first) - normals_.col(edge.second)).norm() <= kFlat;
  }

  void JoinTriangles(const std::vector<SharedEdge>& edges) {
    facet_of_.resize(static_cast<std::size_t>(shape_.triangles.cols()));
    for (std::vector<int>& triangles : ConnectedTriangles(
             shape_.triangles.cols(), edges,
             [&](const SharedEdge& edge) { return AreOfOneFace(edge) && IsFlat(edge); })) {
      for (const int t : triangles) facet_of_[static_cast<std::size_t>(t)] = facets_.size();
      facets_.emplace_back().triangles = std::move(triangles);
    }
  }

  void NoteBend(const SharedEdge& edge) {
    if (!AreOfOneFace(edge) || IsFlat(edge)) return;
    const double turn = TurnBetween(normals_.col(edge.first), normals_.col(edge.second));
    if (turn > kSharpTurn) return;
    const Eigen::Vector3d at = vertices_.col(edge.low);
    const Eigen::Vector3d along = (vertices_.col(edge.high) - at).normalized();
    const Eigen::Vector3d inward = InwardFrom(at, along, edge.first);
    // Beyond a convex edge, the outward normal of the one looks away from the other.
    const bool is_hollow = normals_.col(edge.second).dot(inward) > 0;
    const double slope = is_hollow ? -SlopeOfArc(turn) : SlopeOfArc(turn);
    Add({at, inward, slope}, edge.first);
    Add({at, InwardFrom(at, along, edge.second), slope}, edge.second);
  }

  // Across an edge of a triangle, to its third corner.
  Eigen::Vector3d InwardFrom(const Eigen::Vector3d& at, const Eigen::Vector3d& along,
                             int triangle) const {
    const Eigen::Vector3d across = normals_.col(triangle).cross(along);
    double side = 0;
    for (int k = 0; k < 3; ++k) {
      side += across.dot(vertices_.col(shape_.triangles(k, triangle)) - at);
    }
    return side < 0 ? -across : across;
  }

  void Add(Facet::Bend bend, int triangle) {
    Facet& facet = facets_[facet_of_[static_cast<std::size_t>(triangle)]];
    for (const int t : facet.triangles) {
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d from = vertices_.col(shape_.triangles(k, t)) - bend.at;
        bend.width = std::max(bend.width, bend.inward.dot(from));
      }
    }
    const bool is_known =
        std::any_of(facet.bends.begin(), facet.bends.end(), [&](const Facet::Bend& known) {
          return known.inward.dot(bend.inward) > 0 &&
                 known.inward.cross(bend.inward).norm() <= kSameLine &&
                 std::abs(known.inward.dot(bend.at - known.at)) <= kSameLine * known.width;
        });
    if (!is_known) facet.bends.push_back(bend);
  }

  // Of two bends that face each other, each tells half.
  static void Measure(Facet& facet) {
    std::vector<double> shares;
    for (const Facet::Bend& bend : facet.bends) {
      const bool is_faced = std::any_of(
          facet.bends.begin(), facet.bends.end(),
          [&](const Facet::Bend& other) { return bend.inward.dot(other.inward) < kOpposite; });
      shares.push_back(is_faced ? 0.5 : 1);
    }
    for (std::size_t i = 0; i < shares.size(); ++i) facet.bends[i].slope *= shares[i];
  }

  const DrawnShape& shape_;
  const Eigen::Matrix3Xd vertices_;  // m as drawn
  const Eigen::Matrix3Xd normals_;
  std::vector<std::size_t> facet_of_;  // of each triangle
  std::vector<Facet> facets_;
};

// Those that a face stands out from.
std::vector<Facet> FacetsOf(const DrawnShape& shape) {
  if (shape.deflection == 0) return {};
  std::vector<Facet> facets = FacetSearch(shape).Found();
  std::erase_if(facets, [](const Facet& facet) { return facet.bends.empty(); });
  return facets;
}

// What a face stands out from a triangle of a facet, m³ as drawn. The middles of the
// edges weigh alike, which is exact for parabolas.
double VolumeOver(const Facet& facet, const Eigen::Matrix3d& corners) {
  const Eigen::Vector3d a = corners.col(0), b = corners.col(1), c = corners.col(2);
  const double area = (b - a).cross(c - a).norm() / 2;
  return area / 3 *
         (facet.HeightAt((a + b) / 2) + facet.HeightAt((b + c) / 2) + facet.HeightAt((c + a) / 2));
}

// By how much a stretch enlarges what lies at a place of the drawn box.
double FactorAt(const DrawnShape& shape, const BoxStretch& stretch, const Eigen::Vector3d& place) {
  double factor = 1;
  for (int axis = 0; axis < 3; ++axis) {
    factor *= stretch.SlopeAt(axis, place[axis]) / shape.size[axis];
  }
  return factor;
}

}  // namespace

Eigen::VectorXd MissedVolumes(const DrawnShape& shape) {
  Eigen::VectorXd missed = Eigen::VectorXd::Zero(shape.triangles.cols());
  for (const Facet& facet : FacetsOf(shape)) {
    for (const int t : facet.triangles) {
      const Eigen::Matrix3d corners = shape.fractions(Eigen::all, shape.triangles.col(t));
      missed[t] = VolumeOver(facet, shape.size.asDiagonal() * corners);
    }
  }
  const double triangles = ComputeMassProperties(SurfaceIn(shape, shape.size)).volume;
  const double left = shape.volume - triangles - missed.sum();
  const double amount = missed.cwiseAbs().sum();
  if (amount > 0) {
    missed += left / amount * missed.cwiseAbs();
  } else {
    missed.array() += left / static_cast<double>(missed.size());
  }
  return missed;
}

double MissedVolumeIn(const DrawnShape& shape, const BoxStretch& stretch) {
  if (shape.missed_volumes.size() != shape.triangles.cols()) {
    DrawnShape measured = shape;
    measured.missed_volumes = MissedVolumes(shape);
    return MissedVolumeIn(measured, stretch);
  }
  double missed = 0;
  for (Eigen::Index t = 0; t < shape.triangles.cols(); ++t) {
    if (shape.missed_volumes[t] == 0) continue;
    const Eigen::Matrix3d corners = shape.fractions(Eigen::all, shape.triangles.col(t));
    missed += shape.missed_volumes[t] * FactorAt(shape, stretch, corners.rowwise().mean());
  }
  return missed;
}

}  // namespace mortise::mesh
