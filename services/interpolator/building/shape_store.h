// Designs, canonical meshes and shapes by the digests of their files, each read once while there is
// room for it in memory. Private to this folder.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "common/base/single_flight_cache.h"
#include "common/fields/design_fields.h"
#include "services/interpolator/building/shape_options.h"
#include "services/interpolator/building/traits.h"
#include "services/interpolator/shapes/bring_into.h"
#include "services/interpolator/shapes/packed_shape.h"

namespace mortise::interpolator {

// A canonical mesh, ready to be used.
struct ReadyMesh {
  ReadyMesh(std::shared_ptr<const CanonicalMesh> made, const MeshMapOptions& options)
      : prepared(std::move(made), options), traits(ChooseTraits(prepared.mesh())) {}

  const PreparedMesh prepared;
  const TraitPlaces traits;

  const CanonicalMesh& mesh() const { return prepared.mesh(); }
};

// Thread safe.
class ShapeStore {
 public:
  // `options` outlives it.
  explicit ShapeStore(const ShapeOptions& options);

  // Reads a design. What `get` fails with; INVALID_ARGUMENT, reason SHAPE_UNREADABLE, where the
  // file is no design's or not finite.
  absl::StatusOr<std::shared_ptr<const fields::DesignFields>> Design(const std::string& digest);
  // Reads a canonical mesh. What `get` fails with; DATA_LOSS where the file is none.
  absl::StatusOr<std::shared_ptr<const ReadyMesh>> Mesh(const std::string& digest);
  // Reads a shape in that mesh; fails likewise.
  absl::StatusOr<std::shared_ptr<const PackedShape>> Shape(const std::string& digest,
                                                           const CanonicalMesh& mesh);
  // Keeps bytes; returns their digest.
  absl::StatusOr<std::string> Put(const std::string& bytes) { return options_.put(bytes); }

 private:
  const ShapeOptions& options_;
  SingleFlightCache<std::shared_ptr<const fields::DesignFields>> designs_;
  SingleFlightCache<std::shared_ptr<const ReadyMesh>> meshes_;
  SingleFlightCache<std::shared_ptr<const PackedShape>> shapes_;
};

}  // namespace mortise::interpolator
