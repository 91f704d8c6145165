// What the catalog does by itself, at its start and every hour: it removes shapes and forgets
// drawings that nobody wants any more.
#pragma once

#include <thread>

#include "absl/time/time.h"

namespace mortise::store {
class BlobFolder;
class Store;
}  // namespace mortise::store

namespace mortise::catalog {

// How long a drawing stays after it was last uploaded.
inline constexpr absl::Duration kDrawingLife = absl::Hours(24);

// Does it once: SweepShapes and ForgetDrawings. What fails is logged; the next time comes.
void TidyUp(store::Store* store, store::BlobFolder* blobs);

// Does it on a thread of its own, until it is destroyed.
class Upkeep {
 public:
  // Both outlive it.
  Upkeep(store::Store* store, store::BlobFolder* blobs);

 private:
  std::jthread thread_;
};

}  // namespace mortise::catalog
