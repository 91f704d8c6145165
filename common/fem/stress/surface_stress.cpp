#include "common/fem/stress/surface_stress.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>

#include "common/fem/elements/shape_functions.h"

namespace mortise::simulator {
namespace {

constexpr int kMaxEquations = 5;
using Equations = Eigen::Matrix<double, Eigen::Dynamic, 6, 0, kMaxEquations, 6>;
using Numbers = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxEquations, 1>;
using Square =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxEquations, kMaxEquations>;

// a · σ b as a row that multiplies σ.
Eigen::Matrix<double, 1, 6> Row(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return StrainOf(a * b.transpose()).transpose();
}

}  // namespace

// The equations of tractions at a piece, Rσ = t, and what solves them: σ = D ε + D Rᵀ w.
struct SurfaceStress::Balance {
  std::vector<int> nodes;                          // of the face, or the edge
  GradientMatrix gradients;                        // of their shape functions along it
  Eigen::Matrix3d by_u = Eigen::Matrix3d::Zero();  // H
  Eigen::Vector3d n1, n2, t1, t2, tangent;         // of an edge all of them
  ShapeVector by_length;                           // of an edge
  double length = 1;                               // m, per unit of its parameter
  Equations rows;
  Eigen::LLT<Square> system;  // R D Rᵀ
  Numbers w;
  Vector6d stress;
};

SurfaceStress::SurfaceStress(const DeformedBody& body, const PartSurface& surface)
    : body_(body), surface_(surface) {
  for (const Material& material : body.materials) {
    stiffness_.push_back(StiffnessMatrix(material));
    expansion_.push_back(ThermalStrain(material));
  }
}

bool SurfaceStress::IsKnown(int face) const {
  const Eigen::Index places = surface_.nodes().rows();
  return body_.traction.at_nodes.cols() > 0 &&
         body_.traction.at_nodes.middleCols(places * face, places).allFinite();
}

Eigen::Vector3d SurfaceStress::TractionAt(const FaceNode& at) const {
  return body_.traction.at_nodes.col(surface_.nodes().rows() * at.face + at.place);
}

std::vector<SurfacePiece> SurfaceStress::PiecesAt(int slot) const {
  std::vector<SurfacePiece> faces, edges;
  for (const FaceNode& at : surface_.At(slot)) {
    if (IsKnown(at.face)) {
      faces.push_back({at, {}});
    } else if (body_.traction.mirrors.empty() ||
               !body_.traction.mirrors[static_cast<std::size_t>(at.face)]) {
      return {};
    }
  }
  for (const int index : surface_.SharpEdgesAt(slot)) {
    const SharpEdge& edge = surface_.edge(index);
    if (!IsKnown(edge.first[0].face) || !IsKnown(edge.second[0].face)) continue;
    if (!edge.convex) return {};
    // The node's place on the edge is that at which its face has the node.
    for (int place = 0; place < 3; ++place) {
      for (const FaceNode& at : surface_.At(slot)) {
        if (at.face == edge.first[place].face && at.place == edge.first[place].place) {
          edges.push_back({edge.first[place], edge.second[place], &edge, place});
        }
      }
    }
  }
  return edges.empty() ? faces : edges;
}

SurfaceStress::Balance SurfaceStress::BalanceOf(const SurfacePiece& piece, double warmth) const {
  const mesh::TetrahedralMesh& mesh = body_.mesh;
  Balance balance;
  const auto at_first = EvaluateTriangle(FacePositions(mesh, surface_, piece.first.face),
                                         FacePlace(piece.first.place));
  balance.n1 = at_first.normal;
  balance.t1 = TractionAt(piece.first);
  if (piece.edge == nullptr) {
    for (const int node : surface_.nodes().col(piece.first.face)) balance.nodes.push_back(node);
    balance.gradients = at_first.gradients;
  } else {
    for (const FaceNode& at : piece.edge->first) {
      if (at.face >= 0) balance.nodes.push_back(surface_.nodes()(at.place, at.face));
    }
    const int count = static_cast<int>(balance.nodes.size());
    balance.by_length = EdgeDerivatives(piece.place, count);
    Eigen::Vector3d along = Eigen::Vector3d::Zero();
    for (int k = 0; k < count; ++k) {
      along += balance.by_length[k] * mesh.nodes.col(balance.nodes[k]);
    }
    balance.length = along.norm();
    balance.tangent = along / balance.length;
    balance.gradients = balance.tangent * balance.by_length.transpose() / balance.length;
    balance.n2 = EvaluateTriangle(FacePositions(mesh, surface_, piece.second.face),
                                  FacePlace(piece.second.place))
                     .normal;
    balance.t2 = TractionAt(piece.second);
  }
  for (std::size_t k = 0; k < balance.nodes.size(); ++k) {
    balance.by_u += body_.displacement.col(balance.nodes[k]) *
                    balance.gradients.col(static_cast<Eigen::Index>(k)).transpose();
  }
  Numbers wanted(piece.edge == nullptr ? 3 : 5);
  balance.rows.resize(wanted.size(), 6);
  if (piece.edge == nullptr) {
    for (int k = 0; k < 3; ++k) balance.rows.row(k) = Row(Eigen::Vector3d::Unit(k), balance.n1);
    wanted = balance.t1;
  } else {
    balance.rows << Row(balance.n1, balance.n1), Row(balance.n2, balance.n2),
        Row(balance.n1, balance.n2), Row(balance.tangent, balance.n1),
        Row(balance.tangent, balance.n2);
    wanted << balance.n1.dot(balance.t1), balance.n2.dot(balance.t2),
        (balance.n1.dot(balance.t2) + balance.n2.dot(balance.t1)) / 2,
        balance.tangent.dot(balance.t1), balance.tangent.dot(balance.t2);
  }
  const auto part = static_cast<std::size_t>(surface_.part(piece.first.face));
  const Matrix6d& stiffness = stiffness_[part];
  const Vector6d own = stiffness * (StrainOf(balance.by_u) - warmth * expansion_[part]);
  balance.system.compute(balance.rows * stiffness * balance.rows.transpose());
  balance.w = balance.system.solve(wanted - balance.rows * own);
  balance.stress = own + stiffness * balance.rows.transpose() * balance.w;
  return balance;
}

std::optional<SurfaceFan> SurfaceStress::FanAt(int slot,
                                               const std::vector<SurfacePiece>& pieces) const {
  if (pieces.empty() || pieces.size() != surface_.At(slot).size()) return std::nullopt;
  return SurfaceFan::Around(body_.mesh, surface_, slot);
}

SurfaceTurns SurfaceStress::TurnsAt(int slot, const std::vector<SurfacePiece>& pieces) const {
  std::vector<FaceNode> mirrors;
  for (const FaceNode& at : surface_.At(slot)) {
    if (!IsKnown(at.face)) mirrors.push_back(at);
  }
  return SurfaceTurns(body_.mesh, surface_, pieces, mirrors);
}

std::vector<Vector6d> SurfaceStress::StressesAt(const std::vector<SurfacePiece>& pieces,
                                                int node) const {
  const double warmth = body_.temperature.size() > 0 ? body_.temperature[node] : 0;
  std::vector<Vector6d> stresses;
  for (const SurfacePiece& piece : pieces) stresses.push_back(BalanceOf(piece, warmth).stress);
  return stresses;
}

std::vector<Vector6d> SurfaceStress::StressesAt(const SurfaceFan& fan) const {
  std::vector<Vector6d> stresses;
  for (const FaceNode& sample : fan.samples()) {
    const int node = surface_.nodes()(sample.place, sample.face);
    const double warmth = body_.temperature.size() > 0 ? body_.temperature[node] : 0;
    stresses.push_back(BalanceOf({sample, {}}, warmth).stress);
  }
  return stresses;
}

std::optional<Vector6d> SurfaceStress::At(int slot, int node) const {
  const std::vector<SurfacePiece> pieces = PiecesAt(slot);
  if (pieces.empty()) return std::nullopt;
  if (const auto fan = FanAt(slot, pieces)) return fan->Stress(StressesAt(*fan));
  return StressOf(TurnsAt(slot, pieces).shares(), StressesAt(pieces, node));
}

bool SurfaceStress::AddDerivative(int slot, const Vector6d& direction,
                                  StressDerivative& sum) const {
  const std::vector<SurfacePiece> pieces = PiecesAt(slot);
  if (pieces.empty()) return false;
  if (const auto fan = FanAt(slot, pieces)) {
    const std::vector<Vector6d> directions = fan->Directions(direction);
    for (std::size_t s = 0; s < directions.size(); ++s) {
      AddDerivative({fan->samples()[s], {}}, directions[s], sum);
    }
    fan->AddDerivative(direction, StressesAt(*fan), sum.by_position);
    return true;
  }
  const SurfaceTurns turns = TurnsAt(slot, pieces);
  const std::vector<Vector6d> directions = DirectionsOf(turns.shares(), direction);
  std::vector<Vector6d> stresses;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    AddDerivative(pieces[k], directions[k], sum);
    stresses.push_back(BalanceOf(pieces[k], 0).stress);
  }
  turns.AddDerivative(direction, stresses, sum.by_position);
  return true;
}

// With λ = (R D Rᵀ)⁻¹ R D d and g = D (d − Rᵀλ), the value d · σ changes by
//   g · δε + λ · δt − λ · δR σ + w · δR g,
// so that a row a · σ b changes it by δa · (w G − λ σ) b and b likewise, G being g as a tensor.
void SurfaceStress::AddDerivative(const SurfacePiece& piece, const Vector6d& direction,
                                  StressDerivative& sum) const {
  const Balance at = BalanceOf(piece, 0);
  const auto part = static_cast<std::size_t>(surface_.part(piece.first.face));
  const Matrix6d& stiffness = stiffness_[part];
  const Numbers lambda = at.system.solve(at.rows * stiffness * direction);
  const Vector6d g = stiffness * (direction - at.rows.transpose() * lambda);
  const Eigen::Matrix3d by_gradient = StressTensor(g), stress = StressTensor(at.stress);
  sum.value += direction.dot(at.stress);
  for (std::size_t k = 0; k < at.nodes.size(); ++k) {
    sum.by_displacement.col(at.nodes[k]) +=
        by_gradient * at.gradients.col(static_cast<Eigen::Index>(k));
  }
  const auto row = [&](int k) -> Eigen::Matrix3d {
    return at.w[k] * by_gradient - lambda[k] * stress;
  };
  if (piece.edge == nullptr) {
    const Eigen::Vector3d by_normal = by_gradient * at.w - stress * lambda;
    const Eigen::Vector3d across = at.by_u.transpose() * by_gradient * at.n1;
    for (std::size_t k = 0; k < at.nodes.size(); ++k) {
      // δ∇N = −(∇V)ᵀ ∇N + n (∇N · (∇V)ᵀ n) along the surface.
      const Eigen::Vector3d gradient = at.gradients.col(static_cast<Eigen::Index>(k));
      sum.by_position.col(at.nodes[k]) +=
          gradient.dot(across) * at.n1 - at.by_u.transpose() * by_gradient * gradient;
    }
    AddNormalDerivative(body_.mesh, surface_, piece.first, by_normal, sum.by_position);
    sum.by_traction.push_back({piece.first, lambda});
    return;
  }
  const Eigen::Vector3d by_n1 = 2 * row(0) * at.n1 + row(2) * at.n2 + row(3) * at.tangent +
                                lambda[0] * at.t1 + lambda[2] / 2 * at.t2;
  const Eigen::Vector3d by_n2 = 2 * row(1) * at.n2 + row(2) * at.n1 + row(4) * at.tangent +
                                lambda[1] * at.t2 + lambda[2] / 2 * at.t1;
  const Eigen::Vector3d by_tangent =
      row(3) * at.n1 + row(4) * at.n2 + lambda[3] * at.t1 + lambda[4] * at.t2;
  AddNormalDerivative(body_.mesh, surface_, piece.first, by_n1, sum.by_position);
  AddNormalDerivative(body_.mesh, surface_, piece.second, by_n2, sum.by_position);
  // H = u' τᵀ / l, where τ and l are the direction and the length of x'.
  const Eigen::Vector3d pull = by_gradient * at.by_u * at.tangent;
  const Eigen::Vector3d by_along = (pull - 2 * at.tangent.dot(pull) * at.tangent + by_tangent -
                                    at.tangent.dot(by_tangent) * at.tangent) /
                                   at.length;
  for (std::size_t k = 0; k < at.nodes.size(); ++k) {
    sum.by_position.col(at.nodes[k]) += at.by_length[static_cast<Eigen::Index>(k)] * by_along;
  }
  sum.by_traction.push_back(
      {piece.first, lambda[0] * at.n1 + lambda[2] / 2 * at.n2 + lambda[3] * at.tangent});
  sum.by_traction.push_back(
      {piece.second, lambda[1] * at.n2 + lambda[2] / 2 * at.n1 + lambda[4] * at.tangent});
}

}  // namespace mortise::simulator
