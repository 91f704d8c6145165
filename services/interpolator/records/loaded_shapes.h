// Canonical meshes and shapes of maps that are asked, each read and checked once.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "common/base/single_flight_cache.h"
#include "common/store/blob_folder.h"
#include "services/interpolator/shapes/canonical_mesh.h"
#include "services/interpolator/shapes/packed_shape.h"

namespace mortise::interpolator {

// Thread safe.
class LoadedShapes {
 public:
  // The folder outlives it. `capacity`: bytes of meshes and shapes in memory together, of which the
  // least recently used are forgotten first; those in use elsewhere stay there as long.
  explicit LoadedShapes(store::BlobFolder* blobs, std::size_t capacity = std::size_t{512} << 20);

  // Returns the mesh, or the shape in this mesh, whose file has this digest. DATA_LOSS where the
  // file is damaged or gone: nothing is ever answered from such a one.
  absl::StatusOr<std::shared_ptr<const CanonicalMesh>> Mesh(const std::string& file);
  absl::StatusOr<std::shared_ptr<const PackedShape>> Shape(const std::string& mesh,
                                                           const std::string& file);

  // Returns how much is kept, bytes.
  std::size_t bytes() const { return kept_.bytes(); }

 private:
  // One of the two.
  struct Loaded {
    std::shared_ptr<const CanonicalMesh> mesh;
    std::shared_ptr<const PackedShape> shape;
  };
  using Kept = SingleFlightCache<Loaded>;

  absl::StatusOr<std::string> Read(const std::string& file) const;
  absl::StatusOr<Kept::Made> LoadMesh(const std::string& file) const;
  absl::StatusOr<Kept::Made> LoadShape(const std::string& mesh, const std::string& file);

  store::BlobFolder* const blobs_;
  Kept kept_;  // by digest; of shapes by both digests
};

}  // namespace mortise::interpolator
