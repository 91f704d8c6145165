#include "services/fabplanner/shop_floor/report_ledger.h"

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::fabplanner {

absl::StatusOr<ReportLedger> ReportLedger::ForNewBridge(int64_t next_report_number) {
  if (next_report_number < 1) {
    return InvalidField("hello.next_report_number", "must be at least 1");
  }
  return ReportLedger(next_report_number - 1);
}

absl::Status ReportLedger::CheckHello(int64_t next_report_number) const {
  MORTISE_RETURN_IF_ERROR(ForNewBridge(next_report_number).status());
  if (next_report_number > stored_) return absl::OkStatus();
  return PreconditionFailed(
      "JOURNAL_LOST",
      absl::StrCat("the bridge will use report number ", next_report_number, ", but report ",
                   stored_,
                   " is stored: its journal was lost or copied. Check its machines, then "
                   "attach it under a new name"),
      "hello.next_report_number");
}

}  // namespace mortise::fabplanner
