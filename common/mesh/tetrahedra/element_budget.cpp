#include "common/mesh/tetrahedra/element_budget.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "common/mesh/mass_properties.h"
#include "common/mesh/surface_check.h"
#include "common/mesh/tetrahedra/surface_remesh.h"

namespace mortise::mesh {
namespace {

constexpr double kElementsForTriangle = 1.5;  // measured: 1.45 to 1.52 of boards in one layer
constexpr double kElementsForVolume = 2;      // elements have half the volume that they may have
constexpr double kSurfaceLayer = 0.4;         // of the size, as thick as what triangles make
constexpr double kRegular = 6 * std::numbers::sqrt2;  // tetrahedra of edge 1 in a unit of volume
constexpr double kShareAimedAt = 2 / 3.0;  // of the budget, as what is estimated may be off
constexpr double kEquilateral = 0.433;     // area of a triangle, of its edge squared
constexpr double kCoarser = 1.25;          // than a size whose mesh was beyond the budget
constexpr int kTries = 6;

// What of a surface tells how many elements fill it.
class WideElements {
 public:
  explicit WideElements(const AssemblySurface& assembly) : faces_(KindsOfFaces(assembly)) {
    for (int p = 0; p < static_cast<int>(assembly.part_names.size()); ++p) {
      const SurfaceMesh surface = PartSurface(assembly, p);
      bodies_.push_back({ComputeMassProperties(surface).volume, SurfaceArea(surface)});
    }
  }

  // About how many there are, of this size, m.
  double Count(double size) const {
    const double triangles =
        faces_.plane_area / (kEquilateral * size * size) + faces_.curved_triangles;
    double elements = kElementsForTriangle * triangles;
    for (const Body& body : bodies_) {
      const double inside = body.volume - kSurfaceLayer * size * body.area;
      elements += kElementsForVolume * std::max(inside, 0.0) * kRegular / std::pow(size, 3);
    }
    return elements;
  }

  // The size, m, of which there are `elements`; not above four times `wanted`, as where curved
  // faces alone have too many triangles no size is large enough.
  double SizeFor(double elements, double wanted) const {
    constexpr int kHalvings = 40;
    double fine = wanted / 1000, coarse = wanted * 4;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = std::sqrt(fine * coarse);
      (Count(middle) > elements ? fine : coarse) = middle;
    }
    return coarse;
  }

 private:
  struct Body {
    double volume = 0;  // m³
    double area = 0;    // m²
  };

  const FaceKinds faces_;
  std::vector<Body> bodies_;
};

// Nothing where no mesh of at most `most` elements came out.
std::optional<BudgetedMesh> MeshWide(const AssemblySurface& assembly, MeshOptions options,
                                     double size, double most) {
  options.keep_triangles = true;
  for (int i = 0; i < kTries; ++i, size *= kCoarser) {
    absl::StatusOr<AssemblySurface> drawn = WithEvenTriangles(assembly, size);
    if (!drawn.ok()) continue;
    options.element_size = size;
    absl::StatusOr<TetrahedralMesh> mesh = MeshAssembly(*drawn, options);
    if (!mesh.ok() || static_cast<double>(mesh->tetrahedra.cols()) > most) continue;
    BudgetedMesh budgeted;
    budgeted.mesh = *std::move(mesh);
    budgeted.chosen_size = size;
    return budgeted;
  }
  return std::nullopt;
}

}  // namespace

double ElementsOf(const ElementBudget& budget) {
  const double finer = std::min(budget.size_scale, 1.0);
  return budget.elements / (finer * finer * finer);
}

double EstimateWideElements(const AssemblySurface& assembly, double size) {
  return WideElements(assembly).Count(size);
}

absl::StatusOr<BudgetedMesh> MeshWithinBudget(const AssemblySurface& assembly,
                                              const MeshOptions& options,
                                              const ElementBudget& budget) {
  MORTISE_RETURN_IF_ERROR(CheckAssembly(assembly));
  const double most = std::min<double>(ElementsOf(budget), options.element_limit);
  BudgetedMesh budgeted;
  budgeted.wanted_size =
      options.element_size > 0 ? options.element_size : DefaultElementSize(assembly);
  MeshOptions tried = options;
  // A mesh has more than two elements for each point, and TetGen may add a third of the limit.
  tried.element_limit = static_cast<int>(std::min<double>(1.5 * most, options.element_limit));
  absl::StatusOr<TetrahedralMesh> mesh = MeshAssembly(assembly, tried);
  // Stopped on its way to more elements than it may make, TetGen may leave flat ones, or fail.
  const bool is_too_large = absl::IsResourceExhausted(mesh.status()) ||
                            absl::IsInternal(mesh.status()) ||
                            (mesh.ok() && static_cast<double>(mesh->tetrahedra.cols()) > most);
  if (!is_too_large) {
    MORTISE_RETURN_IF_ERROR(mesh.status());
    budgeted.mesh = *std::move(mesh);
    return budgeted;
  }
  const double size =
      budget.size_scale *
      WideElements(assembly).SizeFor(kShareAimedAt * budget.elements, budgeted.wanted_size);
  if (std::optional<BudgetedMesh> wide = MeshWide(assembly, tried, size, most)) {
    wide->wanted_size = budgeted.wanted_size;
    return *std::move(wide);
  }
  MORTISE_ASSIGN_OR_RETURN(budgeted.mesh, MeshAssembly(assembly, options));
  budgeted.is_beyond = static_cast<double>(budgeted.mesh.tetrahedra.cols()) > most;
  return budgeted;
}

}  // namespace mortise::mesh
