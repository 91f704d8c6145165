#include "services/catalog/records/upkeep.h"

#include <chrono>

#include "common/base/logging.h"
#include "common/host/uploaded_files.h"
#include "common/store/store.h"
#include "services/catalog/records/drawing_records.h"
#include "services/catalog/records/search_records.h"
#include "services/catalog/records/shape_sweep.h"

namespace mortise::catalog {
namespace {

constexpr std::chrono::hours kPause{1};

}  // namespace

void TidyUp(store::Store* store, store::BlobFolder* blobs, const std::filesystem::path& folder) {
  const auto shapes = SweepShapes(*store);
  if (!shapes.ok()) {
    Log(LogLevel::kWarning, "unused shapes could not be removed",
        {{"error", shapes.status().ToString()}});
  } else if (!shapes->empty()) {
    Log(LogLevel::kInfo, "removed shapes that nothing refers to", {{"shapes", shapes->size()}});
  }
  const auto searches = SweepSearches(*store);
  if (!searches.ok()) {
    Log(LogLevel::kWarning, "what searches came to could not be removed",
        {{"error", searches.status().ToString()}});
  }
  rpc::TidyUploads(*store, blobs, folder, Drawings());
}

Upkeep::Upkeep(store::Store* store, store::BlobFolder* blobs, const std::filesystem::path& folder)
    : work_(kPause, [store, blobs, folder] { TidyUp(store, blobs, folder); }) {}

}  // namespace mortise::catalog
