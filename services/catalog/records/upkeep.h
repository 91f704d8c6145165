// What the catalog does by itself, at its start and every hour: it removes shapes, drawings and
// unfinished uploads that nobody wants any more.
#pragma once

#include <filesystem>

#include "absl/time/time.h"
#include "common/base/repeated_work.h"

namespace mortise::store {
class BlobFolder;
class Store;
}  // namespace mortise::store

namespace mortise::catalog {

// How long a drawing stays after it was last uploaded.
inline constexpr absl::Duration kDrawingLife = absl::Hours(24);

// Does it once: SweepShapes, ForgetDrawings, and RemoveAbandonedParts of `folder`, where the blobs
// are. What fails is logged; the next time comes.
void TidyUp(store::Store* store, store::BlobFolder* blobs, const std::filesystem::path& folder);

// Does it on a thread of its own, until it is destroyed.
class Upkeep {
 public:
  // Store and blobs outlive it.
  Upkeep(store::Store* store, store::BlobFolder* blobs, const std::filesystem::path& folder);

 private:
  const RepeatedWork work_;
};

}  // namespace mortise::catalog
