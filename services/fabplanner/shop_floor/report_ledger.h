// Which reports of a bridge are stored. A bridge numbers its reports 1, 2, 3 … and repeats them
// until their number is acknowledged; the fabplanner stores them without gaps.
#pragma once

#include <cstdint>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace mortise::fabplanner {

class ReportLedger {
 public:
  enum class Verdict {
    kNew,        // apply it, then Advance
    kDuplicate,  // stored already: acknowledge again
    kEarly,      // earlier ones are missing: ignore, the bridge repeats it
  };

  // `stored`: reports up to this number are stored.
  explicit ReportLedger(int64_t stored = 0) : stored_(stored) {}

  // Returns the ledger of a bridge that attaches for the first time and will use
  // `next_report_number`. Earlier reports went to a store that is gone and cannot be asked for
  // again; those it still repeats are below the number and acknowledged unseen.
  static absl::StatusOr<ReportLedger> ForNewBridge(int64_t next_report_number);

  // Whether a known bridge that attaches can be trusted. FAILED_PRECONDITION, reason
  // JOURNAL_LOST, if it would use a number again that is stored: its journal was lost or copied,
  // so it no longer knows what its machines did.
  absl::Status CheckHello(int64_t next_report_number) const;

  Verdict Judge(int64_t report_number) const {
    if (report_number <= stored_) return Verdict::kDuplicate;
    return report_number == stored_ + 1 ? Verdict::kNew : Verdict::kEarly;
  }
  void Advance() { ++stored_; }
  int64_t stored() const { return stored_; }

 private:
  int64_t stored_;
};

}  // namespace mortise::fabplanner
