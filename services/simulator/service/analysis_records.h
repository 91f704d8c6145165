// Analyses in the store.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "common/resources/collection.h"
#include "common/store/store.h"
#include "mortise/v1/simulator.pb.h"

namespace mortise::simulator {

// Records hold mortise.v1.Analysis by the analysis' id, which is that of the operation that made
// it.
inline constexpr resources::Collection<v1::Analysis> kAnalyses{
    .names = "analyses", .kind = "analyses", .event = "analysis"};

// Writes an analysis that has finished, with its time of creation, and tells of it
// ("analysis.created"). Returns it as it is stored: one that an earlier run of its operation wrote
// stays, as its external ids and labels may have changed since. INTERNAL, STORAGE_FAILED.
absl::StatusOr<v1::Analysis> KeepAnalysis(store::Transaction& transaction, v1::Analysis analysis,
                                          const std::string& trace_id);

}  // namespace mortise::simulator
