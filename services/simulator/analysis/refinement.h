// Refines meshes adaptively where the estimated error is, until all load cases are as accurate as
// wanted.
//
//   Refinement refinement({.wanted_error = 0.02});
//   for (;;) {
//     … solve on `mesh`, estimate the error of each load case …
//     MORTISE_ASSIGN_OR_RETURN(auto finer, refinement.Next(mesh, estimates));
//     if (!finer) break;
//     mesh = *std::move(finer);
//   }
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/fem/stress/error_estimate.h"
#include "common/mesh/tetrahedra/mesher.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

struct RefinementOptions {
  double wanted_error = 0.05;  // of the stresses, as a share of all, in the energy norm
  mesh::MeshOptions mesh{};    // as the first mesh was made
  double memory_limit = 8e9;   // bytes that a solution may take
  int most_rounds = 12;
};

// A mesh that was solved on.
struct RefinementStep {
  int elements = 0;
  int nodes = 0;
  double relative_error = 0;  // estimated, of the worst load case
};

class Refinement {
 public:
  explicit Refinement(RefinementOptions options) : options_(std::move(options)) {}

  // Notes what the solutions on `mesh` miss, one estimate for each load case, and gives the next
  // mesh; nothing if all are accurate enough, or no finer mesh can be had within the limits: then
  // shortfall() says why. Fewer elements are added than the accuracy takes where that is all that
  // the limits allow. INVALID_ARGUMENT, naming "wanted_error", unless it is within 0.001 to 1.
  //
  // Where stress is singular its error falls too, as elements shrink towards the place; the stress
  // there grows without end all the same.
  absl::StatusOr<std::optional<mesh::TetrahedralMesh>> Next(
      const mesh::TetrahedralMesh& mesh, std::span<const ErrorEstimate> estimates);

  const std::vector<RefinementStep>& steps() const { return steps_; }

  // Says why the wanted error is not reached; empty while, or if, it is.
  const std::string& shortfall() const { return shortfall_; }

  // Ends the refinement short of what is wanted: the mesh that Next gave last could not be used.
  void GiveUp(const std::string& reason);

 private:
  std::optional<mesh::TetrahedralMesh> Stop(const std::string& reason);
  bool Affords(const mesh::TetrahedralMesh& mesh, double elements) const;

  const RefinementOptions options_;
  std::vector<RefinementStep> steps_;
  std::string shortfall_;
};

}  // namespace mortise::simulator
