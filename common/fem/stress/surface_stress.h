// The stress on the outside of a body where the traction on it is known.
//
// Elements tell the strain along a surface well, since it follows from displacements on the surface
// alone, and the rest badly: how displacements change inwards, where stress falls steeply, is known
// from one side only. But that the traction determines. With the gradient of the displacement along
// the surface, H, and the normal n, the strain is sym(H + b nᵀ) for some b, and
//   σ = D (sym(H + b nᵀ) − ε_T),   σ n = t
// are three equations for b. (Boundary elements recover stresses so; see also the membranes of no
// stiffness that are laid over solids to read their surface.) At a node, the mean over its faces is
// taken, each turned to how they lie in the mean (surface_turns.h); at a corner of quadratic
// elements that faces surround, a fit to what they have round it (surface_fan.h). Along a convex
// edge, where two faces meet at an angle, only the stretch along the edge is taken from the
// displacements, and both tractions determine the rest.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "common/fem/elements/material.h"
#include "common/fem/stress/part_surface.h"
#include "common/fem/stress/surface_fan.h"
#include "common/fem/stress/surface_traction.h"
#include "common/fem/stress/surface_turns.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

// A body under load, in small displacements.
struct DeformedBody {
  const mesh::TetrahedralMesh& mesh;
  const std::vector<Material>& materials;  // one for each part
  const Eigen::Matrix3Xd& displacement;    // 3 × nodes, m
  const Eigen::VectorXd& temperature;      // nodes, K above that of no stress, or empty
  const SurfaceTraction& traction;         // empty where nothing is known of it
};

// The derivatives of a stress, or of something made of it.
struct StressDerivative {
  double value = 0;                  // Pa
  Eigen::Matrix3Xd by_displacement;  // 3 × nodes
  Eigen::Matrix3Xd by_position;      // 3 × nodes, tractions staying as they are
  std::vector<ByTraction> by_traction = {};
};

class SurfaceStress {
 public:
  // The surface, and what the body refers to, must outlive it.
  SurfaceStress(const DeformedBody& body, const PartSurface& surface);

  // Returns xx yy zz xy yz xz, Pa, at a slot of the surface's part; nothing inside, where the
  // traction is not known all round (planes of symmetry excepted), and at inner edges, where stress
  // has no limit.
  std::optional<Vector6d> At(int slot, int node) const;

  // Adds the derivative of direction · σ there, for a body that is not warm. Returns false, and
  // adds nothing, where At gives nothing.
  bool AddDerivative(int slot, const Vector6d& direction, StressDerivative& sum) const;

 private:
  // What one face, or one edge, tells at a node.
  struct Balance;

  std::vector<SurfacePiece> PiecesAt(int slot) const;
  // Returns the fan round a slot all of whose faces are among its pieces.
  std::optional<SurfaceFan> FanAt(int slot, const std::vector<SurfacePiece>& pieces) const;
  SurfaceTurns TurnsAt(int slot, const std::vector<SurfacePiece>& pieces) const;
  std::vector<Vector6d> StressesAt(const std::vector<SurfacePiece>& pieces, int node) const;
  // Tells the stress at each of a fan's samples.
  std::vector<Vector6d> StressesAt(const SurfaceFan& fan) const;
  bool IsKnown(int face) const;
  Eigen::Vector3d TractionAt(const FaceNode& at) const;
  Balance BalanceOf(const SurfacePiece& piece, double warmth) const;
  void AddDerivative(const SurfacePiece& piece, const Vector6d& direction,
                     StressDerivative& sum) const;

  const DeformedBody body_;
  const PartSurface& surface_;
  std::vector<Matrix6d> stiffness_;  // of parts
  std::vector<Vector6d> expansion_;
};

}  // namespace mortise::simulator
