// Turns the faces, or the edges, that meet at a node of a surface to the mean of them.
//
// A face is turned from its own normal to the mean normal. Two edges that go on from one another
// are turned from their own frames, the tangent and the bisector of the normals of both faces, to
// the mean frame. Beyond a plane of symmetry the surface goes on as its own image, so the mean
// there lies in the plane, and that of edges across it. What meets at a corner instead of going on
// is not turned: edges that turn, and surfaces that a plane of symmetry folds, by more than 50°.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "common/fem/elements/material.h"
#include "common/fem/elements/shape_functions.h"
#include "common/fem/stress/part_surface.h"
#include "common/fem/stress/stress_shares.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

// A piece that tells the stress at a node: a face, or a sharp edge.
struct SurfacePiece {
  FaceNode first, second;           // the node on the face, or on both faces of the edge
  const SharpEdge* edge = nullptr;  // if it is one
  int place = 0;                    // of the node on the edge
};

// Returns, for an edge of two or three nodes, the derivatives of its shape functions by 0 … 1 at
// one of them.
ShapeVector EdgeDerivatives(int place, int nodes);

class SurfaceTurns {
 public:
  // Turns the pieces at one node, one at least, that are all faces or all edges. `mirrors` has the
  // node on faces in planes of symmetry. The mesh and the surface must outlive it.
  SurfaceTurns(const mesh::TetrahedralMesh& mesh, const PartSurface& surface,
               std::span<const SurfacePiece> pieces, std::span<const FaceNode> mirrors);

  // Returns the share of each piece, in their order; all count the same.
  const std::vector<StressShare>& shares() const { return shares_; }

  // Adds the derivative of direction · StressOf(shares) by the places of nodes, 3 × nodes, for
  // stresses of the pieces that stay as they are.
  void AddDerivative(const Vector6d& direction, std::span<const Vector6d> of_pieces,
                     Eigen::Matrix3Xd& by_position) const;

 private:
  using Positions = std::vector<GradientMatrix>;  // of faces, in the order of `faces_`

  std::vector<StressShare> SharesAt(const Positions& positions) const;
  std::vector<Eigen::Matrix3d> FaceTurns(const Positions& positions) const;
  std::vector<Eigen::Matrix3d> EdgeTurns(const Positions& positions) const;
  std::vector<Eigen::Vector3d> PlanesAt(const Positions& positions) const;
  const GradientMatrix& Of(const Positions& positions, int face) const;
  Eigen::Vector3d NormalAt(const Positions& positions, const FaceNode& at) const;

  const PartSurface& surface_;
  std::vector<SurfacePiece> pieces_;
  std::vector<FaceNode> mirrors_;
  PlacedFaces faces_;
  std::vector<StressShare> shares_;
};

}  // namespace mortise::simulator
