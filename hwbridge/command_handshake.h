// The handshake that makes a cut happen once over a line that loses messages.
//
// Modbus has no exactly-once: a request that times out may have been carried out. So
//   1. the intent (this cut gets sequence number n) is written to the journal;
//   2. the parameters are written to the machine, with a checksum over them and n;
//   3. n itself is written last; the machine remembers n, then echoes it as accepted;
//   4. the machine cuts, remembers the result, then echoes n as done, with the result.
// Before anything is sent the echo is read, and n is sent again only while the echo says that the
// machine has not seen it; the machine ignores a number it has seen. A cut gets a second number
// only once the machine has said that under the first one nothing was cut.
//
// The handshake keeps no state that matters: where it stands follows from the journal and the echo.
// So recovery after the death of either side is no special case, it is what every step does.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "hwbridge/journal.h"
#include "hwbridge/machine_link.h"

namespace mortise::hwbridge {

// How a cut ended for good.
struct CutEnd {
  CutOutcome outcome = CutOutcome::kDone;
  std::string message;
  double seconds = 0.0;
};

class CommandHandshake {
 public:
  struct Options {
    int checksum_attempts = 10;  // numbers spent on transfers that arrive damaged
    int pages_at_once = 16;      // outline pages sent between two readings of the echo
  };

  // `link` and `journal` must outlive the handshake.
  CommandHandshake(const Options& options, MachineLink& link, Journal& journal);

  // Learns from the echo in `status`, just read, what became of the cut; sends nothing. Returns how
  // it ended, or nothing if it has not ended. Fails as the journal does.
  absl::StatusOr<std::optional<CutEnd>> Settle(const CutOrder& order, const MachineStatus& status);

  // Takes the next step towards the cut: to be called after Settle with the same `status`, and only
  // while cutting is allowed. Does nothing while the machine is at the cut or not in Execute.
  // UNAVAILABLE: the line failed, call both again. FAILED_PRECONDITION, reason FOREIGN_NUMBERS: the
  // machine has taken numbers that this journal never gave.
  absl::Status Advance(const CutOrder& order, const MachineStatus& status);

 private:
  absl::StatusOr<Intent> OpenIntent(const CutOrder& order, const MachineStatus& status);
  absl::Status Send(const CutOrder& order, const Intent& intent, const MachineStatus& status);

  // How far the parameters of a number have been sent; lost without harm.
  struct Transfer {
    std::uint32_t number = 0;
    std::uint32_t boot_epoch = 0;
    std::size_t pages_sent = 0;
    bool block_sent = false;
  };

  Options options_;
  MachineLink& link_;
  Journal& journal_;
  Transfer transfer_;
};

}  // namespace mortise::hwbridge
