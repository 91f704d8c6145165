#include "common/fem/stress/surface_turns.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace mortise::simulator {
namespace {

// Facets of one plane have the same normal but for rounding; planes differ by a degree or more.
constexpr double kSinePlanesDiffer = 0.02;

// What two turn by is half for each of them from their mean.
bool IsCorner(double cosine_to_mean) {
  return 2 * cosine_to_mean * cosine_to_mean - 1 <= kSharpCosine;
}

// How an edge lies: the bisector of its normals, its tangent, and what is across both.
using Frame = Eigen::Matrix3d;

Frame FrameOf(const Eigen::Vector3d& bisector, const Eigen::Vector3d& tangent) {
  Frame frame;
  frame << bisector, tangent, bisector.cross(tangent);
  return frame;
}

// Along an edge, from its nodes on its first face.
Eigen::Vector3d TangentOf(const SurfacePiece& piece, const GradientMatrix& positions) {
  const int nodes = positions.cols() > 3 ? 3 : 2;
  const ShapeVector by_length = EdgeDerivatives(piece.place, nodes);
  Eigen::Vector3d along = Eigen::Vector3d::Zero();
  for (int k = 0; k < nodes; ++k) {
    along += by_length[k] * positions.col(piece.edge->first[static_cast<std::size_t>(k)].place);
  }
  return along.normalized();
}

}  // namespace

ShapeVector EdgeDerivatives(int place, int nodes) {
  ShapeVector by_length(nodes);
  if (nodes == 2) {
    by_length << -1, 1;
  } else {
    const double s = place == 0 ? 0 : place == 1 ? 1 : 0.5;
    by_length << 4 * s - 3, 4 * s - 1, 4 - 8 * s;
  }
  return by_length;
}

SurfaceTurns::SurfaceTurns(const mesh::TetrahedralMesh& mesh, const PartSurface& surface,
                           std::span<const SurfacePiece> pieces, std::span<const FaceNode> mirrors)
    : surface_(surface),
      pieces_(pieces.begin(), pieces.end()),
      mirrors_(mirrors.begin(), mirrors.end()) {
  for (const SurfacePiece& piece : pieces_) {
    faces_.faces.push_back(piece.first.face);
    if (piece.edge != nullptr) faces_.faces.push_back(piece.second.face);
  }
  for (const FaceNode& at : mirrors_) faces_.faces.push_back(at.face);
  std::sort(faces_.faces.begin(), faces_.faces.end());
  faces_.faces.erase(std::unique(faces_.faces.begin(), faces_.faces.end()), faces_.faces.end());
  for (const int face : faces_.faces) {
    faces_.positions.push_back(FacePositions(mesh, surface, face));
  }
  shares_ = SharesAt(faces_.positions);
}

const GradientMatrix& SurfaceTurns::Of(const Positions& positions, int face) const {
  const auto found = std::lower_bound(faces_.faces.begin(), faces_.faces.end(), face);
  return positions[static_cast<std::size_t>(found - faces_.faces.begin())];
}

Eigen::Vector3d SurfaceTurns::NormalAt(const Positions& positions, const FaceNode& at) const {
  return EvaluateTriangle(Of(positions, at.face), FacePlace(at.place)).normal;
}

// What the planes of symmetry at the node are orthogonal to, orthogonal to one another.
std::vector<Eigen::Vector3d> SurfaceTurns::PlanesAt(const Positions& positions) const {
  std::vector<Eigen::Vector3d> planes;
  for (const FaceNode& at : mirrors_) {
    Eigen::Vector3d normal = NormalAt(positions, at);
    for (const Eigen::Vector3d& other : planes) normal -= normal.dot(other) * other;
    if (normal.norm() > kSinePlanesDiffer) planes.push_back(normal.normalized());
  }
  return planes;
}

std::vector<Eigen::Matrix3d> SurfaceTurns::FaceTurns(const Positions& positions) const {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const SurfacePiece& piece : pieces_) mean += NormalAt(positions, piece.first);
  const double length = mean.norm();
  for (const Eigen::Vector3d& plane : PlanesAt(positions)) mean -= mean.dot(plane) * plane;
  if (IsCorner(mean.norm() / length)) return {};
  mean.normalize();
  std::vector<Eigen::Matrix3d> turns;
  for (const SurfacePiece& piece : pieces_) {
    const Eigen::Vector3d own = NormalAt(positions, piece.first);
    // Surfaces that look away from one another touch at the node alone.
    if (!(own.dot(mean) > 0)) return {};
    turns.push_back(Eigen::Quaterniond::FromTwoVectors(own, mean).toRotationMatrix());
  }
  return turns;
}

std::vector<Eigen::Matrix3d> SurfaceTurns::EdgeTurns(const Positions& positions) const {
  const std::vector<Eigen::Vector3d> planes = PlanesAt(positions);
  // With three edges, images counted, it is a corner.
  if ((planes.empty() ? 1U : 2U * planes.size()) * pieces_.size() > 2) return {};
  std::vector<Frame> frames;
  Eigen::Vector3d bisector = Eigen::Vector3d::Zero(), tangent = Eigen::Vector3d::Zero();
  for (const SurfacePiece& piece : pieces_) {
    Eigen::Vector3d along = TangentOf(piece, Of(positions, piece.first.face));
    // Edges may be told from either end.
    if (along.dot(tangent) < 0) along = -along;
    const Eigen::Vector3d out =
        NormalAt(positions, piece.first) + NormalAt(positions, piece.second);
    frames.push_back(FrameOf(out.normalized(), along));
    bisector += frames.back().col(0);
    tangent += along;
  }
  if (!planes.empty()) {
    bisector -= bisector.dot(planes[0]) * planes[0];
    tangent = tangent.dot(planes[0]) * planes[0];
  }
  const auto count = static_cast<double>(pieces_.size());
  if (IsCorner(bisector.norm() / count) || IsCorner(tangent.norm() / count)) return {};
  bisector.normalize();
  tangent = (tangent - tangent.dot(bisector) * bisector).normalized();
  std::vector<Eigen::Matrix3d> turns;
  for (const Frame& frame : frames) {
    turns.push_back(FrameOf(bisector, tangent) * frame.transpose());
  }
  return turns;
}

std::vector<StressShare> SurfaceTurns::SharesAt(const Positions& positions) const {
  const auto turns = pieces_[0].edge == nullptr ? FaceTurns(positions) : EdgeTurns(positions);
  const double weight = 1 / static_cast<double>(pieces_.size());
  std::vector<StressShare> shares(pieces_.size(), {weight, Eigen::Matrix3d::Identity()});
  for (std::size_t k = 0; k < turns.size(); ++k) shares[k].turn = turns[k];
  return shares;
}

void SurfaceTurns::AddDerivative(const Vector6d& direction, std::span<const Vector6d> of_pieces,
                                 Eigen::Matrix3Xd& by_position) const {
  AddShareDerivative(
      surface_, faces_, [this](const Positions& positions) { return SharesAt(positions); },
      direction, of_pieces, by_position);
}

}  // namespace mortise::simulator
