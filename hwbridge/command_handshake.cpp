#include "hwbridge/command_handshake.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::hwbridge {
namespace {

// What the echo says of an open intent; kNone while it is still to be carried out.
JobResult ResultFromEcho(const Intent& intent, const MachineStatus& status) {
  // Another memory than the one that was given the number cannot tell.
  if (status.identity != intent.identity || status.boot_epoch < intent.boot_epoch) {
    return JobResult::kUnknown;
  }
  if (status.done == intent.number) return status.result;
  // A later number than ours was accepted, so the echo of ours is gone.
  return status.accepted > intent.number ? JobResult::kUnknown : JobResult::kNone;
}

int Count(const std::vector<Intent>& intents, JobResult result) {
  return static_cast<int>(std::count_if(intents.begin(), intents.end(), [&](const Intent& intent) {
    return intent.result == result;
  }));
}

// How the cut ended for good if its last number ended so; nothing if it gets another number.
std::optional<CutEnd> EndOf(const std::vector<Intent>& intents, int checksum_attempts) {
  const Intent& last = intents.back();
  const std::string name = JobResultName(last.result);
  switch (last.result) {
    case JobResult::kDone:
      return CutEnd{CutOutcome::kDone, "", last.seconds};
    case JobResult::kParametersRefused:
      return CutEnd{CutOutcome::kRejected, "the machine refused the parameters", 0.0};
    case JobResult::kChecksumMismatch:
      if (Count(intents, last.result) < checksum_attempts) return std::nullopt;
      return CutEnd{CutOutcome::kRejected, "the parameters arrived damaged every time", 0.0};
    case JobResult::kInterruptedDuring:
      return CutEnd{CutOutcome::kFailed, "the machine stopped in the cut", last.seconds};
    case JobResult::kUnknown:
      return CutEnd{CutOutcome::kFailed,
                    "the machine no longer knows whether it made the cut; look at the material",
                    0.0};
    case JobResult::kNone:
    case JobResult::kWrongState:
    case JobResult::kInterruptedBefore:
      return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

CommandHandshake::CommandHandshake(const Options& options, MachineLink& link, Journal& journal)
    : options_(options), link_(link), journal_(journal) {}

absl::StatusOr<std::optional<CutEnd>> CommandHandshake::Settle(const CutOrder& order,
                                                               const MachineStatus& status) {
  std::vector<Intent> intents = journal_.Intents(order.key);
  if (intents.empty()) return std::nullopt;
  Intent& last = intents.back();
  if (last.result == JobResult::kNone) {
    const JobResult result = ResultFromEcho(last, status);
    if (result == JobResult::kNone) return std::nullopt;
    const double seconds = result == JobResult::kUnknown ? 0.0 : status.seconds;
    MORTISE_RETURN_IF_ERROR(journal_.AddResult(order.key.machine, last.number, result, seconds));
    last.result = result;
    last.seconds = seconds;
  }
  return EndOf(intents, options_.checksum_attempts);
}

absl::Status CommandHandshake::Advance(const CutOrder& order, const MachineStatus& status) {
  if (status.state != PackMlState::kExecute) return absl::OkStatus();
  MORTISE_ASSIGN_OR_RETURN(const Intent intent, OpenIntent(order, status));
  if (status.accepted >= intent.number) return absl::OkStatus();  // the machine is at it
  return Send(order, intent, status);
}

// The open intent of the cut, or a new one.
absl::StatusOr<Intent> CommandHandshake::OpenIntent(const CutOrder& order,
                                                    const MachineStatus& status) {
  const std::vector<Intent> intents = journal_.Intents(order.key);
  if (!intents.empty() && intents.back().result == JobResult::kNone) return intents.back();
  const std::uint32_t highest = journal_.HighestNumber(order.key.machine);
  if (status.accepted > highest) {
    return PreconditionFailed(
        "FOREIGN_NUMBERS",
        absl::StrCat("the machine has taken number ", status.accepted, ", the journal gave only ",
                     highest, "; look at the material, then adopt the machine's number"),
        order.key.machine);
  }
  Intent intent;
  intent.key = order.key;
  intent.number = highest + 1;
  intent.identity = status.identity;
  intent.boot_epoch = status.boot_epoch;
  MORTISE_RETURN_IF_ERROR(journal_.AddIntent(intent));
  return intent;
}

absl::Status CommandHandshake::Send(const CutOrder& order, const Intent& intent,
                                    const MachineStatus& status) {
  MORTISE_ASSIGN_OR_RETURN(const EncodedJob encoded, EncodeJob(order.job, intent.number));
  if (transfer_.number != intent.number || transfer_.boot_epoch != status.boot_epoch) {
    transfer_ = Transfer{intent.number, status.boot_epoch, 0, false};
  }
  const std::size_t end =
      std::min(encoded.outline_pages.size(), transfer_.pages_sent + options_.pages_at_once);
  for (; transfer_.pages_sent < end; ++transfer_.pages_sent) {
    MORTISE_RETURN_IF_ERROR(
        link_.Write(holding::kOutlinePage, encoded.outline_pages[transfer_.pages_sent]));
  }
  if (transfer_.pages_sent < encoded.outline_pages.size()) return absl::OkStatus();
  if (!transfer_.block_sent) {
    MORTISE_RETURN_IF_ERROR(link_.Write(holding::kJob, encoded.registers));
    transfer_.block_sent = true;
  }
  return link_.Write(holding::kSequenceNumber, SplitWords(intent.number));
}

}  // namespace mortise::hwbridge
