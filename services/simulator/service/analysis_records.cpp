#include "services/simulator/service/analysis_records.h"

#include <google/protobuf/util/time_util.h>

#include "common/base/errors.h"
#include "common/base/identifiers.h"

namespace mortise::simulator {

absl::StatusOr<v1::Analysis> KeepAnalysis(store::Transaction& transaction, v1::Analysis analysis,
                                          const std::string& trace_id) {
  absl::StatusOr<v1::Analysis> there = kAnalyses.Get(transaction, analysis.name());
  if (!absl::IsNotFound(there.status())) return there;
  MORTISE_ASSIGN_OR_RETURN(const std::string id,
                           ParseResourceName(analysis.name(), kAnalyses.names, "name"));
  *analysis.mutable_create_time() = google::protobuf::util::TimeUtil::MicrosecondsToTimestamp(
      absl::ToUnixMicros(transaction.Now()));
  MORTISE_RETURN_IF_ERROR(
      transaction.Put(kAnalyses.kind, id, analysis.SerializeAsString()).status());
  MORTISE_RETURN_IF_ERROR(transaction.AppendEvent({.type = "analysis.created",
                                                   .subject = analysis.name(),
                                                   .payload = "{}",
                                                   .trace_id = trace_id}));
  return analysis;
}

}  // namespace mortise::simulator
