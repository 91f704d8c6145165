// Runs the cuts of work orders on all machines of a cell at once, one thread a machine.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "absl/status/status.h"
#include "hwbridge/cutting/clock.h"
#include "hwbridge/cutting/journal.h"
#include "hwbridge/cutting/machine_link.h"
#include "hwbridge/cutting/machine_worker.h"

namespace mortise::hwbridge {

// Thread safe.
class WorkOrderRunner {
 public:
  struct Options {
    double scan_period = 0.05;  // s between two scans of a machine
  };
  struct MachineSetup {
    MachineWorker::Options worker;
    std::unique_ptr<MachineLink> link;
  };

  // Starts scanning at once. Cuts that the journal has open already are held until Resume.
  // `on_change` is called, by the machines' threads, when a machine's view or the reports changed.
  // `journal` and `clock` must outlive the runner.
  WorkOrderRunner(const Options& options, std::vector<MachineSetup> machines, Journal& journal,
                  const Clock& clock, std::function<void()> on_change);

  // Ends the threads; cuts under way go on at the machines, which then hold by themselves.
  ~WorkOrderRunner();
  WorkOrderRunner(const WorkOrderRunner&) = delete;
  WorkOrderRunner& operator=(const WorkOrderRunner&) = delete;

  // Takes a cut over: when this returns OK it is in the journal, and will be made or reported. A
  // cut that is impossible from the start (unknown machine, wrong kind, lengths that are not
  // numbers) is reported as rejected. Giving the same cut again does nothing. Fails as the journal
  // does.
  absl::Status Accept(const CutOrder& order);

  // As MachineWorker's, on all machines; Resume returns the first failure but tries all.
  void Hold(std::string_view work_order, std::string_view because);
  absl::Status Resume(std::string_view work_order);

  // As MachineWorker's, on one machine. INVALID_ARGUMENT, field "machine", if it is not here.
  absl::Status ClearAlarm(std::string_view machine);

  // In the order of the setup.
  std::vector<MachineView> Machines() const;

  // Waits until every machine has answered; returns false if `seconds` pass first.
  bool WaitUntilOnline(double seconds);

  // As MachineWorker's, on all machines.
  absl::Status AdoptNumbers();

 private:
  struct Station {
    std::string name;
    MachineKind kind;
    std::unique_ptr<MachineLink> link;
    std::unique_ptr<MachineWorker> worker;
  };

  absl::Status Check(const CutOrder& order) const;
  void Wake();
  void Scan(std::stop_token stop, Station& station);

  const Options options_;
  Journal& journal_;
  const std::function<void()> on_change_;
  std::vector<Station> stations_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  long wakes_ = 0;  // guarded by mutex_: counts what scanning should not wait for
  std::vector<std::jthread> threads_;  // last, so that they end first
};

}  // namespace mortise::hwbridge
