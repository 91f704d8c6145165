#include "hwbridge/cutting/echo.h"

#include "absl/strings/str_cat.h"

namespace mortise::hwbridge {

std::optional<std::string> ContradictionIn(const MachineStatus& status) {
  if (status.done > status.accepted) {
    return absl::StrCat("the machine says that number ", status.done,
                        " is done, but has accepted none above ", status.accepted);
  }
  if (status.done == 0 && status.result != JobResult::kNone) {
    return absl::StrCat("the machine says how a number ended (", JobResultName(status.result),
                        "), but has done none");
  }
  if (status.done != 0 && status.result == JobResult::kNone) {
    return absl::StrCat("the machine says that number ", status.done,
                        " is done, but not how it ended");
  }
  return std::nullopt;
}

std::optional<std::string> ContradictionBetween(const MachineStatus& before,
                                                const MachineStatus& status) {
  if (status.identity != before.identity) {
    return absl::StrCat("the identity of the machine's memory changed from ", before.identity,
                        " to ", status.identity);
  }
  if (status.boot_epoch < before.boot_epoch) {
    return absl::StrCat("the machine's boot epoch went back from ", before.boot_epoch, " to ",
                        status.boot_epoch);
  }
  if (status.accepted < before.accepted) {
    return absl::StrCat("the number that the machine has accepted went back from ", before.accepted,
                        " to ", status.accepted);
  }
  if (status.done < before.done) {
    return absl::StrCat("the number that the machine has done went back from ", before.done, " to ",
                        status.done);
  }
  if (status.done == before.done && status.result != before.result) {
    return absl::StrCat("how number ", status.done, " ended changed from ",
                        JobResultName(before.result), " to ", JobResultName(status.result));
  }
  return std::nullopt;
}

std::optional<std::string> ContradictionWith(const RememberedEcho& remembered,
                                             const MachineStatus& status) {
  if (status.identity != remembered.identity) {
    return absl::StrCat("the identity of the machine's memory was ", remembered.identity,
                        " and now is ", status.identity);
  }
  if (status.boot_epoch < remembered.boot_epoch) {
    return absl::StrCat("the machine's boot epoch was already ", remembered.boot_epoch,
                        " and now is ", status.boot_epoch);
  }
  if (status.accepted < remembered.accepted) {
    return absl::StrCat("the machine had accepted number ", remembered.accepted, " and now says ",
                        status.accepted);
  }
  if (status.done < remembered.done) {
    return absl::StrCat("the machine had done number ", remembered.done, " and now says ",
                        status.done);
  }
  if (status.done == remembered.done && status.result != remembered.result) {
    return absl::StrCat("number ", status.done, " had ended as ", JobResultName(remembered.result),
                        " and now as ", JobResultName(status.result));
  }
  return std::nullopt;
}

std::optional<std::string> EchoWatch::Note(const MachineStatus& status) {
  if (auto contradiction = ContradictionIn(status)) return contradiction;
  const std::optional<MachineStatus> before = last_;
  last_ = status;
  if (before) return ContradictionBetween(*before, status);
  return remembered_ ? ContradictionWith(*remembered_, status) : std::nullopt;
}

NumberVerdict JudgeNumber(const Intent& intent, bool written, const MachineStatus& status) {
  const auto unknown = [](std::string because) {
    return NumberVerdict{NumberStep::kUnknown, std::move(because)};
  };
  if (status.identity != intent.identity) {
    return unknown(absl::StrCat("the machine's memory is not the one that number ", intent.number,
                                " was meant for"));
  }
  if (status.boot_epoch < intent.boot_epoch) {
    return unknown(absl::StrCat("the machine's boot epoch is ", status.boot_epoch,
                                ", but was already ", intent.boot_epoch));
  }
  if (status.accepted > intent.number) {
    return unknown(absl::StrCat("the machine has taken number ", status.accepted,
                                ", the journal gave only ", intent.number));
  }
  if (status.accepted < intent.number) {
    if (!intent.accepted) return {};
    return unknown(absl::StrCat("the machine had accepted number ", intent.number, " and now says ",
                                status.accepted));
  }
  if (!written) {
    return unknown(absl::StrCat("the machine says that it accepted number ", intent.number,
                                " before it was given it"));
  }
  return {status.done == intent.number ? NumberStep::kEnded : NumberStep::kWait, ""};
}

}  // namespace mortise::hwbridge
