#include "hwbridge/cutting/command_handshake.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::hwbridge {
namespace {

int Count(const std::vector<Intent>& intents, JobResult result) {
  return static_cast<int>(std::count_if(intents.begin(), intents.end(), [&](const Intent& intent) {
    return intent.result == result;
  }));
}

std::string NobodyKnows(const std::string& because) {
  constexpr char kLook[] =
      "the machine no longer knows whether it made the cut; look at the material";
  return because.empty() ? kLook : absl::StrCat(because, ": ", kLook);
}

// How the cut ended for good if its last number ended so; nothing if it gets another number.
std::optional<CutEnd> EndOf(const std::vector<Intent>& intents, int checksum_attempts) {
  const Intent& last = intents.back();
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
      return CutEnd{CutOutcome::kFailed, NobodyKnows(last.because), 0.0};
    case JobResult::kNone:
    case JobResult::kWrongState:
    case JobResult::kInterruptedBefore:
      return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

CommandHandshake::CommandHandshake(const Options& options, MachineLink& link, Journal& journal,
                                   const Clock& clock)
    : options_(options), link_(link), journal_(journal), clock_(clock) {}

void CommandHandshake::RenewPatience() {
  transfer_.failures = 0;
  writes_ = {};
  in_vain_ = {};
}

absl::StatusOr<std::optional<CutEnd>> CommandHandshake::Settle(
    const CutOrder& order, const MachineStatus& status,
    const std::optional<std::string>& contradiction) {
  std::vector<Intent> intents = journal_.Intents(order.key);
  if (intents.empty()) return std::nullopt;
  Intent& last = intents.back();
  if (last.result != JobResult::kNone) return EndOf(intents, options_.checksum_attempts);
  const NumberVerdict verdict = contradiction
                                    ? NumberVerdict{NumberStep::kUnknown, *contradiction}
                                    : JudgeNumber(last, last.number != unwritten_, status);
  if (verdict.step == NumberStep::kWrite) return std::nullopt;
  if (verdict.step == NumberStep::kWait) {
    if (last.accepted) return std::nullopt;
    MORTISE_RETURN_IF_ERROR(journal_.AddAcceptance(order.key.machine, last.number));
    return std::nullopt;
  }
  const bool ended = verdict.step == NumberStep::kEnded;
  last.result = ended ? status.result : JobResult::kUnknown;
  last.seconds = ended ? status.seconds : 0.0;
  last.because = verdict.because;
  MORTISE_RETURN_IF_ERROR(
      journal_.AddResult(order.key.machine, last.number, last.result, last.seconds, last.because));
  return EndOf(intents, options_.checksum_attempts);
}

absl::Status CommandHandshake::Advance(const CutOrder& order, const MachineStatus& status) {
  if (status.state != PackMlState::kExecute) return absl::OkStatus();
  MORTISE_ASSIGN_OR_RETURN(const Intent intent, OpenIntent(order, status));
  const NumberVerdict verdict = JudgeNumber(intent, intent.number != unwritten_, status);
  if (verdict.step != NumberStep::kWrite) return absl::OkStatus();
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
  if (in_vain_.key != order.key) in_vain_ = {order.key, 0};
  if (in_vain_.count >= options_.numbers_in_vain) {
    return PreconditionFailed(
        "NUMBERS_IN_VAIN",
        absl::StrCat("the machine ended ", in_vain_.count, " numbers without cutting, the last as ",
                     JobResultName(intents.back().result), "; look at the machine"),
        order.key.machine);
  }
  ++in_vain_.count;
  Intent intent;
  intent.key = order.key;
  intent.number = highest + 1;
  intent.identity = status.identity;
  intent.boot_epoch = status.boot_epoch;
  MORTISE_RETURN_IF_ERROR(journal_.AddIntent(intent));
  unwritten_ = intent.number;
  return intent;
}

absl::Status CommandHandshake::Send(const CutOrder& order, const Intent& intent,
                                    const MachineStatus& status) {
  MORTISE_ASSIGN_OR_RETURN(const EncodedJob encoded, EncodeJob(order.job, intent.number));
  if (transfer_.number != intent.number || transfer_.boot_epoch != status.boot_epoch) {
    transfer_ = Transfer{intent.number, status.boot_epoch, 0, false, 0};
  }
  const absl::Status sent = SendParameters(encoded);
  if (absl::IsUnavailable(sent) && ++transfer_.failures >= options_.transfer_failures) {
    return PreconditionFailed(
        "TRANSFER_FAILED",
        absl::StrCat("the parameters of number ", intent.number, " did not reach the machine in ",
                     transfer_.failures, " tries: ", absl::string_view(sent.message())),
        order.key.machine);
  }
  if (!sent.ok() || !transfer_.block_sent) return sent;
  return WriteNumber(intent.number);
}

// A few pages, or after the last of them the job block.
absl::Status CommandHandshake::SendParameters(const EncodedJob& encoded) {
  const std::size_t end =
      std::min(encoded.outline_pages.size(), transfer_.pages_sent + options_.pages_at_once);
  for (; transfer_.pages_sent < end; ++transfer_.pages_sent) {
    MORTISE_RETURN_IF_ERROR(
        link_.Write(holding::kOutlinePage, encoded.outline_pages[transfer_.pages_sent]));
    transfer_.failures = 0;
  }
  if (transfer_.pages_sent < encoded.outline_pages.size() || transfer_.block_sent) {
    return absl::OkStatus();
  }
  MORTISE_RETURN_IF_ERROR(link_.Write(holding::kJob, encoded.registers));
  transfer_.block_sent = true;
  transfer_.failures = 0;
  return absl::OkStatus();
}

// The machine answers before the echo is read again, so that a number which was written and is not
// in the echo was lost, or the machine does not keep its word.
absl::Status CommandHandshake::WriteNumber(std::uint32_t number) {
  if (writes_.number != number) writes_ = {number, 0, 0.0};
  const double now = clock_.Now();
  if (writes_.count > 0 && now - writes_.last < options_.number_pace) return absl::OkStatus();
  if (writes_.count >= options_.number_writes) {
    return PreconditionFailed(
        "NEVER_ACCEPTED", absl::StrCat("the machine was given number ", number, " ", writes_.count,
                                       " times and never accepted it; look at the machine"));
  }
  ++writes_.count;
  writes_.last = now;
  unwritten_ = 0;
  return link_.Write(holding::kSequenceNumber, SplitWords(number));
}

}  // namespace mortise::hwbridge
