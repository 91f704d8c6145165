#include "services/retrieval/service/cover_methods.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/host/chunk_stream.h"
#include "common/host/idle_workers.h"
#include "common/store/blob_folder.h"
#include "services/retrieval/service/cover_making.h"
#include "services/retrieval/service/cover_queue.h"

namespace mortise::retrieval::methods {
namespace {

constexpr std::int64_t kMaxCover = std::int64_t{1} << 30;  // bytes
constexpr std::size_t kKeySize = 64;

// `seconds`, or `otherwise` for 0; INVALID_ARGUMENT naming `field` outside the range.
absl::StatusOr<absl::Duration> Seconds(double seconds, double otherwise, double minimum,
                                       double maximum, const char* field) {
  if (seconds == 0) seconds = otherwise;
  if (seconds >= minimum && seconds <= maximum) return absl::Seconds(seconds);
  return InvalidField(field, absl::StrCat("must be within ", minimum, " to ", maximum));
}

absl::StatusOr<absl::Duration> LeaseOf(double seconds) {
  return Seconds(seconds, 30, 1, 3600, "lease_seconds");
}

// The key of a task that was leased: a digest.
absl::StatusOr<std::string> KeyOf(const std::string& name, int attempt) {
  constexpr absl::string_view kPrefix = "tasks/";
  const bool is_name =
      absl::StartsWith(name, kPrefix) && name.size() == kPrefix.size() + kKeySize &&
      std::all_of(name.begin() + kPrefix.size(), name.end(),
                  [](char c) { return (c >= 'a' && c <= 'f') || (c >= '0' && c <= '9'); });
  if (!is_name) return InvalidField("task", "must have the form tasks/{id}, as leased");
  if (attempt < 1) return InvalidField("attempt", "must be at least 1, as leased");
  return name.substr(kPrefix.size());
}

using Reader = rpc::UploadReader<v1::Chunk, v1::UploadCoverResponse>;

// Receives the file of a cover. One that was damaged since it was stored is replaced.
class CoverReader final : public Reader {
 public:
  explicit CoverReader(store::BlobFolder* blobs) : assembler_(blobs, kMaxCover) {}

  absl::Status OnMessage(const v1::Chunk& chunk) override { return assembler_.Append(chunk); }

  absl::StatusOr<v1::UploadCoverResponse> Complete() override {
    v1::UploadCoverResponse response;
    MORTISE_ASSIGN_OR_RETURN(*response.mutable_sha256(), assembler_.Finish());
    return response;
  }

 private:
  rpc::ChunkAssembler assembler_;
};

}  // namespace

absl::Status LeaseCover(const Retrieval& retrieval, const rpc::Call& call,
                        const v1::LeaseCoverRequest& asked,
                        rpc::Responder<v1::LeaseCoverResponse> respond) {
  if (asked.worker().empty()) return InvalidField("worker", "must name the worker");
  if (absl::StartsWith(asked.worker(), kOwnWorker)) {
    return InvalidField("worker",
                        absl::StrCat("must not begin with ", kOwnWorker, ", as the service's own"));
  }
  MORTISE_ASSIGN_OR_RETURN(const absl::Duration lease, LeaseOf(asked.lease_seconds()));
  MORTISE_ASSIGN_OR_RETURN(const absl::Duration wait,
                           Seconds(asked.wait_seconds(), 0, 0, 60, "wait_seconds"));
  if (asked.cover_version() != kCoverVersion) {
    return PreconditionFailed("WORKER_VERSION",
                              absl::StrCat("the worker makes covers as '", asked.cover_version(),
                                           "', the service as '", kCoverVersion, "'"),
                              "cover_version");
  }
  CoverQueue& covers = retrieval.covers;
  const auto take = [&covers, worker = asked.worker(),
                     lease](bool) -> absl::StatusOr<v1::LeaseCoverResponse> {
    MORTISE_ASSIGN_OR_RETURN(std::optional<v1::CoverTask> task, covers.Lease(worker, lease));
    v1::LeaseCoverResponse response;
    if (task) *response.mutable_task() = *std::move(task);
    return response;
  };
  rpc::RespondWhenWork<v1::LeaseCoverResponse>(
      covers.idle_workers(), kCoverQueue, wait, call, std::move(respond), take,
      [](const v1::LeaseCoverResponse& response) { return !response.has_task(); });
  return absl::OkStatus();
}

absl::StatusOr<v1::RenewCoverResponse> RenewCover(const Retrieval& retrieval, const rpc::Call&,
                                                  const v1::RenewCoverRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(const std::string key, KeyOf(asked.task(), asked.attempt()));
  MORTISE_ASSIGN_OR_RETURN(const absl::Duration lease, LeaseOf(asked.lease_seconds()));
  const absl::Status renewed = retrieval.covers.Renew(key, asked.attempt(), lease);
  v1::RenewCoverResponse response;
  response.set_lost(IsLost(renewed));
  if (!renewed.ok() && !response.lost()) return renewed;
  return response;
}

absl::StatusOr<std::unique_ptr<Reader>> UploadCover(const Retrieval& retrieval, const rpc::Call&) {
  return std::make_unique<CoverReader>(retrieval.blobs);
}

absl::StatusOr<v1::ReportCoverResponse> ReportCover(const Retrieval& retrieval, const rpc::Call&,
                                                    const v1::ReportCoverRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(const std::string key, KeyOf(asked.task(), asked.attempt()));
  MORTISE_ASSIGN_OR_RETURN(const absl::Duration lease, LeaseOf(asked.lease_seconds()));
  if (asked.has_error() == asked.has_cover()) {
    return InvalidField("cover", "is to be given, or an error");
  }
  if (asked.cover().evaluations() < 0) {
    return InvalidField("cover.evaluations", "must not be negative");
  }
  if (asked.cover().failed_evaluations() < 0) {
    return InvalidField("cover.failed_evaluations", "must not be negative");
  }
  MORTISE_RETURN_IF_ERROR(retrieval.covers.Report(key, asked, lease));
  return v1::ReportCoverResponse();
}

}  // namespace mortise::retrieval::methods
