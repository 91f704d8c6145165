// Moves the nodes inside a tetrahedral mesh when its surface takes another shape (thesis §6.6.2,
// interior mapping).
//
// The nodes follow as those of a linear-elastic body whose surface is displaced. Elasticity rather
// than a harmonic map is used, as it resists the shear that turns elements over, and the solver is
// there. Where elements turn over, the body is solved again with small elements stiffer (Stein,
// Tezduyar and Benney, Mesh moving techniques, 2003), then in steps, each on the shape before; and
// what is still turned over then is untangled node by node (untangling.h).
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::interpolator {

struct VolumeMapOptions {
  double memory_limit = 8e9;  // bytes, of the solver
  int threads = 1;            // the result is the same for any number
};

struct VolumeMap {
  Eigen::Matrix3Xd nodes;     // 3 × N, m; middles of edges of quadratic elements are halfway
  int solves = 0;             // of the elastic body
  int unsound = 0;            // elements that are turned over or flat in the mesh itself
  int inverted_at_first = 0;  // elements that the first solution turned over
  int untangled = 0;          // elements that only moving single nodes turned back
  std::vector<int> inverted;  // elements that are still turned over or flat, and are sound in the
                              // mesh itself
};

// A mesh whose surface is displaced again and again: its stiffness is assembled, and the solver
// made ready, once.
class VolumeMapper {
 public:
  // `outer`: all corners on the surface of the mesh, which must outlive the mapper and stay as it
  // is. An element counts as turned over where its volume between corners is not positive beyond
  // rounding; a few are so to begin with where curved sides keep elements sound whose corners lie
  // on one round face. INVALID_ARGUMENT naming "mesh" if these have more than a thousandth of its
  // volume, "outer" if these are no corners of the mesh, or one on the surface is missing.
  static absl::StatusOr<std::unique_ptr<const VolumeMapper>> Create(
      const mesh::TetrahedralMesh& mesh, std::vector<int> outer,
      const VolumeMapOptions& options = {});
  ~VolumeMapper();

  // Returns the nodes of the mesh when node outer[i] is at positions.col(i). `slides`, 3 × outer:
  // non-zero where a node keeps no more than the other coordinates of its position, as on a flat
  // face on which it need not be in one place; empty for none. The result does not depend on what
  // was mapped before. May be called from any number of threads, which wait for each other to
  // solve; a solver is kept for each of the last few patterns of `slides`. INVALID_ARGUMENT naming
  // "positions" unless they are finite and as many as `outer`, or "slides". Fails as the linear
  // solver does; RESOURCE_EXHAUSTED.
  absl::StatusOr<VolumeMap> Map(const Eigen::Matrix3Xd& positions,
                                const Eigen::Array3Xi& slides = {}) const;

  struct State;  // private to volume_map.cpp

 private:
  explicit VolumeMapper(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

// Returns the elements that are turned over or flat with nodes at these places. Only corners count.
std::vector<int> InvertedElements(const mesh::TetrahedralMesh& mesh, const Eigen::Matrix3Xd& nodes);

}  // namespace mortise::interpolator
