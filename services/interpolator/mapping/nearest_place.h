// Finds the nearest places on a surface, of any triangles.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"
#include "services/interpolator/mapping/disk_map.h"

namespace mortise::interpolator {

// A surface that is asked again and again. May be used from any number of threads.
class NearestPlaces {
 public:
  // The surface must have triangles, indices in range and finite vertices. Triangles without area
  // are left out, as their neighbours have their points; if all are, the first corner is all of it.
  // RESOURCE_EXHAUSTED where there is too little memory; INTERNAL where CGAL cannot do it.
  static absl::StatusOr<NearestPlaces> Create(const mesh::SurfaceMesh& surface);
  NearestPlaces(NearestPlaces&&) noexcept;
  NearestPlaces& operator=(NearestPlaces&&) noexcept;
  ~NearestPlaces();

  // Returns the place on the surface that is nearest to a point. Fails as Create.
  absl::StatusOr<TrianglePlace> Find(const Eigen::Vector3d& point) const;

  // Returns how far it is, m. Fails likewise.
  absl::StatusOr<double> Distance(const Eigen::Vector3d& point) const;

 private:
  struct Tree;
  explicit NearestPlaces(std::unique_ptr<const Tree> tree);
  std::unique_ptr<const Tree> tree_;
};

}  // namespace mortise::interpolator
