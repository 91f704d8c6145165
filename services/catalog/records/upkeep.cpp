#include "services/catalog/records/upkeep.h"

#include <chrono>

#include "absl/time/clock.h"
#include "common/base/logging.h"
#include "common/store/blob_upkeep.h"
#include "common/store/store.h"
#include "services/catalog/records/drawing_records.h"
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
  const auto drawings = ForgetDrawings(store, blobs, store->Now() - kDrawingLife);
  if (!drawings.ok()) {
    Log(LogLevel::kWarning, "old drawings could not be removed",
        {{"error", drawings.status().ToString()}});
  } else if (*drawings > 0) {
    Log(LogLevel::kInfo, "forgot drawings that were uploaded", {{"drawings", *drawings}});
  }
  // Uploads that broke off with the process that received them.
  const auto abandoned = store::RemoveAbandonedParts(folder, absl::Now() - kDrawingLife);
  if (!abandoned.ok()) {
    Log(LogLevel::kWarning, "unfinished uploads could not be removed",
        {{"error", abandoned.status().ToString()}});
  }
}

Upkeep::Upkeep(store::Store* store, store::BlobFolder* blobs, const std::filesystem::path& folder)
    : work_(kPause, [store, blobs, folder] { TidyUp(store, blobs, folder); }) {}

}  // namespace mortise::catalog
