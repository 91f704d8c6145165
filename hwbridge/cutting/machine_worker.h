// Works one machine: keeps the heartbeat, notices when the machine or the line stops, and carries
// out the machine's open cuts in the order they were given.
//
// It scans like a controller does: each Cycle exchanges the heartbeat, reads the status, and takes
// at most one step. Cutting stops ("held") when the line is lost, when the machine restarts, stops
// or holds, when the emergency stop is pressed, when a cut fails or is refused, and on Hold. What
// is held goes on only by Resume: the return of the line alone never moves a machine.
//
// A machine that says what cannot be (a status of another map, an echo that contradicts itself or
// the one before, a heartbeat that stands still), does not do what it is told or does not come to
// the end of a cut raises the alarm: it is held with all orders, also with those that come later,
// until a person has looked and resumes. Nothing is repeated for ever.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "hwbridge/cutting/clock.h"
#include "hwbridge/cutting/command_handshake.h"
#include "hwbridge/cutting/cut_patience.h"
#include "hwbridge/cutting/echo.h"
#include "hwbridge/cutting/journal.h"
#include "hwbridge/cutting/machine_link.h"

namespace mortise::hwbridge {

// A machine as others see it.
struct MachineView {
  std::string name;
  MachineKind kind = MachineKind::kChopSaw;
  bool online = false;
  std::string state = "UNDEFINED";  // PackML; "UNDEFINED" while the line is down
  bool held = false;                // cuts wait for Resume
  std::string held_because;         // for people
  bool alarm = false;               // held by the alarm: whichever order a cut is of
  bool operator==(const MachineView&) const = default;
};

class MachineWorker {
 public:
  struct Options {
    std::string name;
    MachineKind kind = MachineKind::kChopSaw;
    double line_lost_after = 1.5;  // s without an answer, or with a heartbeat that stands still
    double stop_after_idle = 5.0;  // s without cuts after which the machine is commanded to stop
    double command_pace = 1.0;     // s between two times the same command
    int commands_in_vain = 10;  // that do not bring the machine where it shall go, then the alarm
    std::optional<double> cut_patience;  // s for a cut, then the alarm; by default as
                                         // DefaultCutPatience
    CommandHandshake::Options handshake;
  };

  // Cuts that the journal has open already are held, and an alarm in it stands. The references must
  // outlive the worker.
  MachineWorker(const Options& options, MachineLink& link, Journal& journal, const Clock& clock);

  // One scan. Called by one thread.
  void Cycle();

  // Give no more cuts of `work_order` (of all orders if empty) to the machine. A cut under way
  // ends. Thread safe, as all below.
  void Hold(std::string_view work_order, std::string_view because);

  // Go on: a person has looked. This clears the alarm, too. FAILED_PRECONDITION, and everything
  // stays held: reason LINE_LOST, if the machine cannot be reached or understood, or its emergency
  // stop is pressed; reason ALARM, if the alarm stands and holds no cut of `work_order` here, for
  // who resumes that order need not have looked at this machine. Fails as the journal does.
  absl::Status Resume(std::string_view work_order);

  // A person has looked at the machine: the alarm is cleared. Orders that are held stay so. OK if
  // there is no alarm; FAILED_PRECONDITION, reason LINE_LOST, as above. Fails as the journal does.
  absl::Status ClearAlarm();

  MachineView View() const;

  // Takes number `accepted` of the machine as the start of ours; needs a line.
  absl::Status AdoptNumbers();

 private:
  struct Urging {
    PackMlCommand command = PackMlCommand::kReset;
    int count = 0;      // commands since the machine was last where it should go
    double last = 0.0;  // s on the clock
  };

  absl::StatusOr<MachineStatus> Exchange();
  void NoteBeat(const MachineStatus& status);
  void NoteFailure(const absl::Status& status);
  void LoseLine(const std::string& trouble);
  void NoteStatus(const MachineStatus& status);
  void TakeStep(const MachineStatus& status, const std::optional<std::string>& contradiction);
  void StopIdleMachine(const MachineStatus& status);
  void Settle(const MachineStatus& status, const CutOrder& order,
              const std::optional<std::string>& contradiction);
  std::optional<CutOrder> NextCut() const;
  bool TakesTooLong(const CutOrder& order, const MachineStatus& status);
  bool ReadyToCut(const MachineStatus& status);
  void Urge(PackMlCommand command, const MachineStatus& status);
  void Command(PackMlCommand command);
  void RaiseAlarm(std::string_view because);
  absl::Status KeepAlarm();
  std::string Alarm() const;
  absl::Status CheckReach() const;
  absl::Status EndAlarm();
  void TakeResume();
  void HoldOpenCuts(std::string_view because);
  bool IsHeld(const std::string& work_order) const;
  bool HasOpenCuts(std::string_view work_order) const;

  const Options options_;
  MachineLink& link_;
  Journal& journal_;
  const Clock& clock_;
  CommandHandshake handshake_;

  // Only the scanning thread uses these.
  EchoWatch watch_;
  Urging urging_;
  CutPatience patience_;
  std::uint16_t heartbeat_ = 0;
  double last_answer_;
  double last_machine_beat_;
  double last_work_;
  bool contact_ = false;  // the machine has answered, and was not lost since
  bool beats_ = false;    // its heartbeat was seen to change since
  std::uint16_t machine_heartbeat_ = 0;
  std::uint32_t boot_epoch_ = 0;  // 0 before the first contact

  mutable std::mutex mutex_;
  bool running_ = false;                 // guarded by mutex_: brought to Execute, cuts are given
  std::set<std::string> held_orders_;    // guarded by mutex_
  std::string held_because_;             // guarded by mutex_
  std::string alarm_;                    // guarded by mutex_; empty while there is none
  bool alarm_is_kept_ = false;           // guarded by mutex_: `alarm_` is in the journal
  std::string line_trouble_;             // guarded by mutex_; empty while the line stands
  bool resumed_ = false;                 // guarded by mutex_: by somebody, since the last scan
  std::optional<MachineStatus> status_;  // guarded by mutex_; none while the line is down
};

}  // namespace mortise::hwbridge
