// Maps that are asked, each read and checked once.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/base/single_flight_cache.h"
#include "common/maps/interpolation_map.h"
#include "common/maps/packed_weights.h"
#include "common/store/blob_folder.h"
#include "common/store/store.h"
#include "mortise/v1/interpolator.pb.h"
#include "services/interpolator/records/stored_map.h"

namespace mortise::interpolator {

// What a structure's map has of shapes, ready to be asked.
struct ServedShapes {
  StoredShapes stored;
  maps::PackedWeights weights;
  std::vector<int> order;  // of each node of the tree that is an element: its place in `stored`
};

// A map as it was stored, ready to be asked.
struct LoadedMap {
  v1::DesignMap record;                            // when it was read first
  std::vector<maps::InterpolationMap> structures;  // in the order of record.structures
  std::vector<ServedShapes> shapes;                // likewise; none of a map of metrics alone
};

// Thread safe.
class LoadedMaps {
 public:
  // Both outlive it. `capacity`: bytes of maps that are kept, the least recently used forgotten
  // first.
  LoadedMaps(store::Store* store, store::BlobFolder* blobs,
             std::size_t capacity = std::size_t{256} << 20);

  // Returns a map that is stored. NOT_FOUND; INVALID_ARGUMENT naming "name"; DATA_LOSS where its
  // file is damaged or gone: nothing is ever answered from such a one.
  absl::StatusOr<std::shared_ptr<const LoadedMap>> Get(const std::string& name);

 private:
  using Kept = SingleFlightCache<std::shared_ptr<const LoadedMap>>;

  absl::StatusOr<Kept::Made> Load(v1::DesignMap record) const;

  store::Store* const store_;
  store::BlobFolder* const blobs_;
  Kept kept_;  // by name
};

}  // namespace mortise::interpolator
