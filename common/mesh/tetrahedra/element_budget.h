// Bounds the number of elements where nobody says how fine a mesh is to be.
//
// A mesher that keeps to good shapes makes elements of a thin board hardly wider than the board is
// thick, whatever size is asked for: about 3.7 for each square as wide as the thickness. A back
// panel of 0.9 m by 1.8 m and 6.5 mm alone takes 126,000. Quadratic elements bend exactly at any
// width, so that fewer, wider ones in one layer lose little.
#pragma once

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"
#include "common/mesh/tetrahedra/mesher.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::mesh {

// The elements that a mesh may have where nobody asks for a size: as many as a static analysis of a
// load case solves in ten to fifteen seconds on one core of 2.5 GHz (docs/simulator.md, "Solvers").
// Fixed numbers, so that a design has the same mesh on every machine.
inline constexpr int kQuadraticBudget = 60'000;
inline constexpr int kLinearBudget = 160'000;

struct ElementBudget {
  int elements = kQuadraticBudget;

  // Times the size that the budget allows; the budget itself grows for finer meshes as their
  // elements do (1 / scale³) and is the same for coarser ones. MeshOptions::element_size is not
  // scaled by it.
  double size_scale = 1;
};

// Returns the elements that a mesh of the budget's scale may have.
double ElementsOf(const ElementBudget& budget);

struct BudgetedMesh {
  TetrahedralMesh mesh;
  double wanted_size = 0;  // m, that the options ask for, or the default

  // m, that it was made with instead, as that would have taken more than the budget; 0 where it was
  // made with `wanted_size`.
  double chosen_size = 0;

  // Whether it has more elements than the budget, as no coarser mesh could be made.
  bool is_beyond = false;
};

// Meshes as MeshAssembly does, and makes that mesh where the budget allows it. Where not, plane
// faces are drawn anew with edges as long as the budget allows (WithEvenTriangles), and elements
// are as wide as these, in one layer where a board is thinner. What is curved keeps its triangles.
// The same input gives the same mesh. Fails as MeshAssembly.
absl::StatusOr<BudgetedMesh> MeshWithinBudget(const AssemblySurface& assembly,
                                              const MeshOptions& options,
                                              const ElementBudget& budget);

// Returns about how many elements a mesh has whose plane faces are drawn with edges of `size`, m:
// one and a half for each triangle, and those that fill what is farther from the surface than half
// an element.
double EstimateWideElements(const AssemblySurface& assembly, double size);

}  // namespace mortise::mesh
