// The handshake that makes a cut happen once over a line that loses messages.
//
// Modbus has no exactly-once: a request that times out may have been carried out. So
//   1. the intent (this cut gets sequence number n) is written to the journal;
//   2. the parameters are written to the machine, with a checksum over them and n;
//   3. n itself is written last; the machine remembers n, then echoes it as accepted;
//   4. the machine cuts, remembers the result, then echoes n as done, with the result.
// Before anything is sent the echo is read, and n is sent again only while the echo says that the
// machine has not seen it; the machine ignores a number it has seen. A cut gets a second number
// only once the machine has said that under the first one nothing was cut. Which echo moves a
// number where is the table in echo.h.
//
// The handshake keeps no state that matters: where it stands follows from the journal and the echo.
// So recovery after the death of either side is no special case, it is what every step does. What
// it does keep is patience: how often and when something was sent in vain. Nothing is sent for
// ever; when patience ends, a person has to look.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "hwbridge/cutting/clock.h"
#include "hwbridge/cutting/echo.h"
#include "hwbridge/cutting/journal.h"
#include "hwbridge/cutting/machine_link.h"

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
    int number_writes = 5;       // of one number, before a person must look
    double number_pace = 1.0;    // s between two writes of a number
    int numbers_in_vain = 10;    // spent on one cut without cutting, before a person must look
    int transfer_failures = 10;  // one after the other, before a person must look
  };

  // `link`, `journal` and `clock` must outlive the handshake.
  CommandHandshake(const Options& options, MachineLink& link, Journal& journal, const Clock& clock);

  // Learns from the echo in `status`, just read, what became of the cut; sends nothing. Returns how
  // it ended, or nothing if it has not ended. Where the echo is not to be believed, `contradiction`
  // says why: then nobody knows what became of a number that was given. Fails as the journal does.
  absl::StatusOr<std::optional<CutEnd>> Settle(const CutOrder& order, const MachineStatus& status,
                                               const std::optional<std::string>& contradiction);

  // Takes the next step towards the cut: to be called after Settle with the same `status`, and only
  // while cutting is allowed and the echo can be believed. Does nothing while the machine is at the
  // cut or not in Execute. UNAVAILABLE: the line failed, call both again. FAILED_PRECONDITION: a
  // person must look, because (reason FOREIGN_NUMBERS) the machine has taken numbers that this
  // journal never gave, (NEVER_ACCEPTED) it does not take the number although it was written often
  // enough, (NUMBERS_IN_VAIN) it ends number after number without cutting, or (TRANSFER_FAILED) the
  // parameters do not get through.
  absl::Status Advance(const CutOrder& order, const MachineStatus& status);

  // A person has looked: everything may be tried as often as at first.
  void RenewPatience();

 private:
  absl::StatusOr<Intent> OpenIntent(const CutOrder& order, const MachineStatus& status);
  absl::Status Send(const CutOrder& order, const Intent& intent, const MachineStatus& status);
  absl::Status SendParameters(const EncodedJob& encoded);
  absl::Status WriteNumber(std::uint32_t number);

  // How far the parameters of a number have been sent; lost without harm.
  struct Transfer {
    std::uint32_t number = 0;
    std::uint32_t boot_epoch = 0;
    std::size_t pages_sent = 0;
    bool block_sent = false;
    int failures = 0;  // since something got through
  };
  struct NumberWrites {
    std::uint32_t number = 0;
    int count = 0;
    double last = 0.0;  // s on the clock
  };
  struct NumbersInVain {
    CutKey key;
    int count = 0;
  };

  Options options_;
  MachineLink& link_;
  Journal& journal_;
  const Clock& clock_;
  Transfer transfer_;
  NumberWrites writes_;
  NumbersInVain in_vain_;
  std::uint32_t unwritten_ = 0;  // the number that was intended and not written since; 0 if none
};

}  // namespace mortise::hwbridge
