// Computes natural frequencies and shapes of vibration.
//
// The lowest solutions of K φ = ω² M φ with the stiffness of elasticity and the consistent mass, by
// Lanczos' method on K⁻¹ M, restarted (Spectra; Lehoucq and Sorensen, SIAM J. Matrix Anal. Appl.
// 17, 1996, 789-821). What supports and hinges leave free to move without deforming is found from
// the geometry (free_motions.h) and kept out of the iteration: K⁻¹ is then that of the structure
// held at as many displacements as it has such motions, of loads that are balanced without them.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/fem/elements/analysis_case.h"
#include "common/fem/linear/sparse_cholesky.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

struct ModalOptions {
  int count = 6;            // of modes that deform; rigid motions come in addition
  double tolerance = 1e-9;  // relative, of ω²
  CholeskyOptions cholesky{};
  int threads = 1;  // that assemble; the result is the same for any number
};

struct Mode {
  double frequency = 0;    // Hz; 0 of rigid motions
  bool rigid = false;      // moves without deforming
  Eigen::Matrix3Xd shape;  // 3 × nodes; φᵀ M φ = 1 kg
  double residual = 0;     // |K φ − ω² M φ| / |K φ| of free directions; 0 of rigid motions
};

struct ModalSolution {
  std::vector<Mode> modes;  // rigid motions, then by frequency
  int rigid_motions = 0;
  std::string rigid_motion;  // one of them, for people; empty if there are none
  double mass = 0;           // kg, of the assembly
  int solves = 0;            // of linear systems
  double seconds = 0;
};

// Returns the lowest modes of an assembly at rest on its supports, or free in space; prescribed
// displacements count as fixed. Multiple frequencies are all found: the iteration is repeated
// beside what it found until nothing lower turns up. Errors: INVALID_ARGUMENT naming the field of
// the model, the element at fault, or "count" if that is not positive or more than the mesh has;
// FAILED_PRECONDITION, reason SINGULAR or NOT_CONVERGED; RESOURCE_EXHAUSTED, also if more than 300
// motions are free or those that are, as displacements of all nodes, exceed the limit of memory.
absl::StatusOr<ModalSolution> FindModes(const mesh::TetrahedralMesh& mesh,
                                        const std::vector<Material>& materials,
                                        const std::vector<Support>& supports,
                                        const ModalOptions& options = {});

// Returns what one should know of the motions that are free, or nothing if there are none: "6 modes
// at 0 Hz move something without deforming it: part 'body' is free to move along x and in 5 other
// ways".
std::string NoteOnRigidMotions(const ModalSolution& solution);

}  // namespace mortise::simulator
