// What the catalog does by itself, at its start and every hour: it removes shapes, drawings,
// unfinished uploads and outcomes of searches that nobody wants any more.
#pragma once

#include <filesystem>

#include "common/base/repeated_work.h"

namespace mortise::store {
class BlobFolder;
class Store;
}  // namespace mortise::store

namespace mortise::catalog {

// Does it once: SweepShapes, SweepSearches, and TidyUploads of drawings, whose blobs are in
// `folder`. What fails is logged; the next time comes.
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
