// What a mutation leaves in the store beside its change: the answer, for repeated requests, and the
// audit record. And how one asks to be prepared anew, where others came before it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/resources/record_page.h"
#include "common/rpc/call.h"

namespace google::protobuf {
class Message;
}
namespace mortise::v1 {
class AuditRecord;
}

namespace mortise::rpc {

// How long answers are kept for repeated requests.
inline constexpr absl::Duration kAnswerRetention = absl::Hours(7 * 24);

// What identifies a mutating request.
struct MutationKey {
  std::string request_id;      // as the client chose it
  std::string record_key;      // of method, subject and request_id
  std::string request_sha256;  // of the request
};

// INVALID_ARGUMENT naming request_id if it is missing, longer than 128 bytes, or has characters
// other than printable ASCII.
absl::StatusOr<MutationKey> MakeMutationKey(const Call& call,
                                            const google::protobuf::Message& request);

// Fills `response` and returns true if this request was answered before. INVALID_ARGUMENT naming
// request_id if the id was used for another request.
absl::StatusOr<bool> FindAnswer(store::ReadTransaction& transaction, const MutationKey& key,
                                google::protobuf::Message* response);

// Keeps the answer and the audit record. `service`: the process that made the change.
absl::Status RecordMutation(store::Transaction& transaction, std::string_view service,
                            const Call& call, const MutationKey& key,
                            const google::protobuf::Message& request,
                            const google::protobuf::Message& response);

// How often a prepared mutation is prepared and tried, at most.
inline constexpr int kMostPreparations = 10;

// Marks the failure of a prepared mutation's change (handler.h): what it was prepared of is another
// by now, and it may succeed if it is prepared again. It is, up to kMostPreparations times; then
// the failure is answered.
absl::Status PrepareAgain(absl::Status failure);

// Whether a failure is marked. The mark is taken away.
bool TakesPreparingAgain(absl::Status& failure);

// Forgets answers older than kAnswerRetention; returns how many.
absl::StatusOr<int> ForgetOldAnswers(store::Store& store);

// Returns a page of audit records, newest first.
absl::StatusOr<resources::Page<v1::AuditRecord>> ListAudit(store::Store& store,
                                                           const resources::PageQuery& query);

}  // namespace mortise::rpc
