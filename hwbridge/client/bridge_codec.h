// Cuts, reports and machines between their messages and the bridge's own types.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "hwbridge/cutting/journal.h"
#include "hwbridge/cutting/machine_worker.h"
#include "mortise/v1/hwbridge.pb.h"

namespace mortise::hwbridge {

// INVALID_ARGUMENT naming the field where the command has no name, number or cut. The numbers of
// the cut are checked by WorkOrderRunner::Accept.
absl::StatusOr<CutOrder> CutFromProto(const v1::CutCommand& command);

v1::CutReport ReportToProto(const CutReport& report);

// The state is the machine's, but HELD where the machine could go on and the bridge does not let
// it.
v1::Machine MachineToProto(const MachineView& view);

}  // namespace mortise::hwbridge
