// What the service does by itself, at its start and every hour: it removes files that nothing
// refers to any more, as those of covers and indexes that others have taken the place of.
#pragma once

#include <filesystem>

#include "absl/status/statusor.h"
#include "common/base/repeated_work.h"
#include "common/host/run_service.h"
#include "common/store/blob_upkeep.h"
#include "common/store/store.h"

namespace mortise::retrieval {

// Removes what no cover, no index and no uploaded mesh names, as rpc::RemoveUnusedFiles does: what
// a search still reads stays readable to it.
absl::StatusOr<store::RemovedBlobs> RemoveUnusedFiles(store::Store& store,
                                                      operations::Operations& operations,
                                                      const std::filesystem::path& folder);

class FileUpkeep {
 public:
  // Does that until it is destroyed. What fails is logged; the next time comes.
  explicit FileUpkeep(const rpc::ServiceEnvironment& environment);

 private:
  const RepeatedWork work_;
};

}  // namespace mortise::retrieval
