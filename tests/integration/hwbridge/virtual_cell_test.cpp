// The bridge's runner against the virtual cell as a process of its own, over Modbus TCP: work
// orders on two machines at once, and the death of either process.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "hwbridge/cutting/clock.h"
#include "hwbridge/cutting/journal.h"
#include "hwbridge/cutting/modbus_link.h"
#include "hwbridge/cutting/work_order_runner.h"
#include "tests/integration/hwbridge/line_times.h"
#include "tests/support/child_process.h"
#include "tests/support/file_watch.h"
#include "tests/support/reserved_port.h"
#include "tests/unit/hwbridge/cutting/simulated_cell.h"

namespace mortise::hwbridge {
namespace {

using std::chrono::steady_clock;

constexpr std::chrono::seconds kPatience(60);
constexpr int kCrosscuts = 8;
constexpr int kOutlines = 3;

std::vector<CutOrder> WorkOrder() {
  std::vector<CutOrder> cuts;
  for (int i = 1; i <= kCrosscuts; ++i) {
    cuts.push_back(
        {{"workOrders/a", "chop-saw", i}, CrosscutJob("leg-" + std::to_string(i), 0.3 * i, 0.297)});
  }
  for (int i = 1; i <= kOutlines; ++i) {
    cuts.push_back(
        {{"workOrders/a", "jigsaw", i}, OutlineJob("seat-" + std::to_string(i), 0.2, 40)});
  }
  return cuts;
}

// The bridge without its line to the fabplanner, with an operator who resumes what is held.
class Bridge {
 public:
  Bridge(const std::filesystem::path& journal, int port, const LineTimes& line) {
    auto opened = Journal::Open(journal);
    EXPECT_TRUE(opened.ok()) << opened.status();
    journal_ = *std::move(opened);
    std::vector<WorkOrderRunner::MachineSetup> machines;
    const std::pair<const char*, MachineKind> kinds[] = {{"chop-saw", MachineKind::kChopSaw},
                                                         {"jigsaw", MachineKind::kJigsaw}};
    for (const auto& [name, kind] : kinds) {
      WorkOrderRunner::MachineSetup setup;
      setup.worker.name = name;
      setup.worker.kind = kind;
      setup.worker.line_lost_after = line.lost_after;
      ModbusLink::Options link;
      link.address = "127.0.0.1";
      link.port = port;
      link.unit = static_cast<int>(kind);
      link.answer_timeout = line.answer_timeout;
      setup.link = std::make_unique<ModbusLink>(link);
      machines.push_back(std::move(setup));
    }
    runner_ = std::make_unique<WorkOrderRunner>(WorkOrderRunner::Options{.scan_period = 0.005},
                                                std::move(machines), *journal_, clock_, [this] {
                                                  const std::lock_guard lock(mutex_);
                                                  changed_.notify_all();
                                                });
    for (const CutOrder& cut : WorkOrder()) EXPECT_TRUE(runner_->Accept(cut).ok());
  }

  bool Finished() const {
    return journal_->OpenCuts("chop-saw").empty() && journal_->OpenCuts("jigsaw").empty();
  }

  std::size_t Reported() const { return journal_->UnacknowledgedReports().size(); }

  // Works until `done`; false if that takes too long.
  bool WorkUntil(const std::function<bool()>& done) {
    const auto deadline = steady_clock::now() + kPatience;
    std::unique_lock lock(mutex_);
    while (!done()) {
      if (steady_clock::now() > deadline) return false;
      if (resume_held) {
        lock.unlock();
        for (const MachineView& machine : runner_->Machines()) {
          if (machine.held && machine.online) (void)runner_->Resume("");
        }
        lock.lock();
      }
      changed_.wait_for(lock, std::chrono::milliseconds(50));
    }
    return true;
  }

  WorkOrderRunner& runner() { return *runner_; }
  Journal& journal() { return *journal_; }
  bool resume_held = true;

 private:
  MonotonicClock clock_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::unique_ptr<Journal> journal_;
  std::unique_ptr<WorkOrderRunner> runner_;
};

class VirtualCell : public ::testing::Test {
 protected:
  void StartCell(const std::vector<std::string>& more = {}) {
    std::vector<std::string> flags = {"--port",
                                      port_.port(),
                                      "--state",
                                      (folder_.path() / "cell").string(),
                                      "--journal",
                                      cut_record_.string(),
                                      "--heartbeat-timeout",
                                      absl::StrCat(line_.heartbeat_timeout),
                                      "--time-scale",
                                      "40"};
    flags.insert(flags.end(), more.begin(), more.end());
    cell_ = std::make_unique<testing::ServiceProcess>(testing::BuiltProgram("mortise-virtual-cell"),
                                                      flags, folder_.path() / "port");
  }

  std::unique_ptr<Bridge> StartBridge() {
    return std::make_unique<Bridge>(folder_.path() / "journal", std::stoi(port_.port()), line_);
  }

  void ExpectEachCutOnce() {
    const auto cuts = ReadCutRecord(cut_record_);
    ASSERT_TRUE(cuts.ok()) << cuts.status();
    std::map<std::string, int> counts;
    for (const Cut& cut : *cuts) ++counts[cut.part];
    for (const CutOrder& cut : WorkOrder()) {
      EXPECT_EQ(counts[cut.job.part], 1) << cut.job.part;
    }
    EXPECT_EQ(cuts->size(), WorkOrder().size());
  }

  LineTimes line_ = kPatientLine;
  TemporaryFolder folder_;
  std::filesystem::path cut_record_ = folder_.path() / "cuts";
  const testing::ReservedPort port_;
  std::unique_ptr<testing::ChildProcess> cell_;
};

TEST_F(VirtualCell, RunsAWorkOrderOnTwoMachinesAtOnce) {
  StartCell();
  auto bridge = StartBridge();
  ASSERT_TRUE(bridge->runner().WaitUntilOnline(10.0));
  ASSERT_TRUE(bridge->WorkUntil([&] { return bridge->Finished(); }));
  ExpectEachCutOnce();
  double longest = 0.0;
  std::map<std::string, double> seconds;
  for (const CutReport& report : bridge->journal().UnacknowledgedReports()) {
    EXPECT_EQ(report.outcome, CutOutcome::kDone) << report.message;
    seconds[report.key.machine] += report.seconds;
    longest = std::max(longest, seconds[report.key.machine]);
  }
  // Each in order, both at once: the cut record has them interleaved.
  const auto cuts = ReadCutRecord(cut_record_);
  EXPECT_NE(cuts->front().machine, cuts->back().machine);
  EXPECT_NEAR(seconds["chop-saw"], kCrosscuts * (1.0 + 0.5 + 4.0), 0.1);
  EXPECT_NEAR(seconds["jigsaw"], kOutlines * 0.8 / 0.02, 0.1);
  EXPECT_EQ(cell_->End(SIGTERM), 0);
}

TEST_F(VirtualCell, SurvivesALineThatLosesAndDelaysAnswers) {
  line_ = kHastyLine;
  StartCell({"--drop-response-every", "40", "--delay", "0.002"});
  auto bridge = StartBridge();
  ASSERT_TRUE(bridge->WorkUntil([&] { return bridge->Finished(); }));
  ExpectEachCutOnce();
}

TEST_F(VirtualCell, SurvivesTheDeathOfTheCellAgainAndAgain) {
  line_ = kHastyLine;
  StartCell();
  auto bridge = StartBridge();
  for (std::size_t reports = 1; reports <= 5; ++reports) {
    ASSERT_TRUE(bridge->WorkUntil([&] { return bridge->Reported() >= reports; }));
    cell_->End(SIGKILL);
    StartCell();
  }
  ASSERT_TRUE(bridge->WorkUntil([&] { return bridge->Finished(); }));
  ExpectEachCutOnce();
}

TEST_F(VirtualCell, SurvivesDeathAfterTakingANumberAndAfterTheCut) {
  line_ = kHastyLine;
  for (const char* fault : {"--crash-after-accept", "--crash-after-cut"}) {
    SCOPED_TRACE(fault);
    StartCell({fault});
    auto bridge = StartBridge();
    bridge->resume_held = true;
    // Polled, because the observable is the end of another process.
    const int status = [&] {
      std::jthread working(
          [&](std::stop_token stop) { bridge->WorkUntil([&] { return stop.stop_requested(); }); });
      return cell_->Wait();
    }();
    EXPECT_EQ(status, -SIGKILL);
    StartCell();
    ASSERT_TRUE(bridge->WorkUntil([&] { return bridge->Finished(); }));
    ExpectEachCutOnce();
    bridge.reset();
    cell_.reset();
    std::filesystem::remove_all(folder_.path());
    std::filesystem::create_directories(folder_.path());
  }
}

TEST_F(VirtualCell, TheReturnOfTheCellResumesNothing) {
  line_ = kHastyLine;
  StartCell();
  auto bridge = StartBridge();
  ASSERT_TRUE(bridge->WorkUntil([&] { return bridge->Reported() >= 2; }));
  bridge->resume_held = false;
  cell_->End(SIGKILL);
  const auto offline = [&] {
    for (const MachineView& machine : bridge->runner().Machines()) {
      if (machine.online) return false;
    }
    return true;
  };
  ASSERT_TRUE(bridge->WorkUntil(offline));
  const std::size_t cuts = ReadCutRecord(cut_record_)->size();
  StartCell();
  ASSERT_TRUE(bridge->runner().WaitUntilOnline(10.0));
  // The machine's clock runs 40 times as fast: in this time it would have made several cuts.
  const auto start = steady_clock::now();
  bridge->WorkUntil([&] { return steady_clock::now() - start > std::chrono::seconds(1); });
  EXPECT_EQ(ReadCutRecord(cut_record_)->size(), cuts);
  ASSERT_TRUE(bridge->runner().Resume("").ok());
  // From here on somebody stands by: a starved machine may lose the line once more, and hold.
  bridge->resume_held = true;
  ASSERT_TRUE(bridge->WorkUntil([&] { return bridge->Finished(); }));
  ExpectEachCutOnce();
}

TEST_F(VirtualCell, TheEmergencyStopIsSeenAndHolds) {
  StartCell();
  auto bridge = StartBridge();
  bridge->resume_held = false;
  ASSERT_TRUE(bridge->WorkUntil([&] { return bridge->Reported() >= 1; }));
  cell_->Signal(SIGUSR1);
  const auto aborted = [&] {
    for (const MachineView& machine : bridge->runner().Machines()) {
      if (machine.state != "ABORTED" || !machine.held) return false;
    }
    return true;
  };
  ASSERT_TRUE(bridge->WorkUntil(aborted));
  EXPECT_FALSE(bridge->runner().Resume("").ok());
  cell_->Signal(SIGUSR2);
  ASSERT_TRUE(bridge->WorkUntil([&] { return bridge->runner().Resume("").ok(); }));
  bridge->resume_held = true;  // cuts that the stop ruined hold the rest once more
  ASSERT_TRUE(bridge->WorkUntil([&] { return bridge->Finished(); }));
  std::map<std::string, int> counts;
  const auto cuts = ReadCutRecord(cut_record_);
  for (const Cut& cut : *cuts) EXPECT_EQ(++counts[cut.part], 1) << cut.part;
}

// The bridge runs in a forked process, which is killed again and again.
TEST_F(VirtualCell, SurvivesTheDeathOfTheBridgeAgainAndAgain) {
  line_ = kHastyLine;
  StartCell();
  for (int life = 1; life <= 8; ++life) {
    const bool last = life == 8;
    const std::size_t before = ReadCutRecord(cut_record_)->size();
    const pid_t pid = ::fork();
    ASSERT_GE(pid, 0);
    if (pid == 0) {
      auto bridge = StartBridge();
      const bool finished = bridge->WorkUntil([&] { return bridge->Finished(); });
      ::_exit(finished ? 0 : 1);
    }
    // Dies in the middle of things: in each life a few more steps after the next cut, of those that
    // the bridge and the machines write down.
    if (!last) {
      int steps = 0;
      const testing::ProcessEnd end(pid);
      testing::WaitForFiles(
          folder_.path(),
          [&] { return ReadCutRecord(cut_record_)->size() > before && ++steps > 2 * life; },
          absl::FromChrono(kPatience), end.descriptor());
      ::kill(pid, SIGKILL);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(pid, &status, 0), pid);
    if (last) {
      EXPECT_EQ(status, 0);
    }
  }
  ExpectEachCutOnce();
}

TEST_F(VirtualCell, ATakenPortIsAClearError) {
  StartCell();
  testing::ChildProcess second({testing::BuiltProgram("mortise-virtual-cell"), "--port",
                                port_.port(), "--state", (folder_.path() / "second").string()});
  EXPECT_EQ(second.Wait(), 1);
  EXPECT_NE(second.Output().find(port_.port()), std::string::npos) << second.Output();
}

}  // namespace
}  // namespace mortise::hwbridge
