// Starts a house, watches its processes, starts again what dies, and stops all of it in order.
//
// A launcher is one thread: the children's parent-death signal is tied to the thread that starts
// them.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "cli/launcher/house.h"
#include "cli/launcher/state_folder.h"

namespace mortise::cli {

class Launcher {
 public:
  using Clock = std::chrono::steady_clock;

  // `changed` is called whenever a process starts to serve, dies or is started again.
  Launcher(HouseOptions options, HousePlan plan, std::function<void(const RunningHouse&)> changed);

  // Stops what still runs.
  ~Launcher();
  Launcher(const Launcher&) = delete;
  Launcher& operator=(const Launcher&) = delete;

  // Starts every process. The first that cannot be started fails the call.
  absl::Status Start();

  // One look at every process: collects the dead, starts them again when their back-off has passed,
  // notices who serves now. FAILED_PRECONDITION with the end of its log if a process has died five
  // times without ever serving.
  absl::Status Supervise();

  // Whether every process serves.
  bool Serving() const;

  // Returns the names of those that do not serve yet.
  std::vector<std::string> Starting() const;

  // Returns a number that changes while processes get on with starting: those that serve, and the
  // time of processors that the others have taken.
  std::int64_t StartProgress() const;

  const RunningHouse& house() const { return house_; }

  // Asks every process to drain (the gateway first, then the services), kills what has not ended
  // after `patience`, or as soon as `hurry` says so.
  void Stop(
      std::chrono::milliseconds patience,
      const std::function<bool()>& hurry = [] { return false; });

 private:
  struct Child {
    pid_t pid = 0;
    int restarts = 0;
    int deaths_before_serving = 0;
    Clock::time_point started;
    Clock::time_point start_again;  // when pid is 0
    Clock::duration back_off{};
    bool serving = false;
  };

  absl::Status StartChild(std::size_t index);
  bool ChildServes(std::size_t index) const;
  absl::Status NoticeDeath(std::size_t index, const std::string& how);
  void Publish();
  std::filesystem::path LogOf(std::size_t index) const;

  const HouseOptions options_;
  const HousePlan plan_;
  const std::function<void(const RunningHouse&)> changed_;
  std::vector<Child> children_;
  RunningHouse house_;
};

}  // namespace mortise::cli
