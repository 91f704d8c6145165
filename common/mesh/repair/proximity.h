// Finds which surfaces come near each other: the connectivity graph of a design (thesis §3.4.1).
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::mesh {

// Two surfaces that touch: an edge of the graph.
struct Proximity {
  int first = 0;        // index of a surface
  int second = 0;       // a higher one
  double distance = 0;  // m, between them; 0 if they meet, cross, or one lies inside the other
};

// Returns all pairs of closed surfaces no further apart than `tolerance`, in metres, in the order
// of their indices. The distance is that of the triangles, so nothing depends on how finely a
// surface is triangulated. INVALID_ARGUMENT naming "surfaces[i]" for one without triangles, with
// indices out of range or vertices that are not finite, or "tolerance" if that is negative or not
// finite.
//
// It uses axis-aligned bounding box trees (CGAL): about O(n log n) for n triangles, as long as most
// of them are far apart. `goes_on` is told after each surface how many have been held against those
// after them; CANCELLED soon after it returns false.
absl::StatusOr<std::vector<Proximity>> FindProximities(
    const std::vector<SurfaceMesh>& surfaces, double tolerance,
    const std::function<bool(std::size_t done)>& goes_on = [](std::size_t) { return true; });

// A closed surface that is asked again and again how it stands to others. Immutable; copies share
// what was prepared.
class ProbedSurface {
 public:
  // The surface must have triangles, indices in range and finite vertices.
  explicit ProbedSurface(const SurfaceMesh& surface);

  // Returns how far the solids within two surfaces are apart, m, infinity beyond `limit`; 0 where
  // they meet or reach into each other. The smaller the limit, the less is looked at.
  static double Distance(const ProbedSurface& a, const ProbedSurface& b, double limit);

  // Returns the same distance, but where the solids reach into each other minus the depth. That is
  // the largest distance from the surface of the one that a point of the other's edges within it
  // has; 0 if they only touch, or reach no deeper than `least`, m. Of round parts that fit into
  // each other all points lie near the other's surface, and a few tenths of a millimetre spare
  // nearly all of the work.
  static double Separation(const ProbedSurface& a, const ProbedSurface& b, double limit,
                           double least = 0);

  struct Prepared;

 private:
  std::shared_ptr<const Prepared> prepared_;
};

}  // namespace mortise::mesh
