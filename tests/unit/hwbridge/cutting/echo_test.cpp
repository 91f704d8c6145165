// The table of echoes, cell by cell, and random conversations: whatever a machine says and whatever
// the line loses, no cut is called made untruly and no number is written again once it was taken.
#include "hwbridge/cutting/echo.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "hwbridge/cutting/machine_worker.h"
#include "tests/unit/hwbridge/cutting/scripted_machine.h"
#include "tests/unit/hwbridge/cutting/simulated_cell.h"

namespace mortise::hwbridge {
namespace {

MachineStatus Status(std::uint32_t accepted, std::uint32_t done, JobResult result) {
  MachineStatus status;
  status.identity = 7;
  status.boot_epoch = 5;
  status.accepted = accepted;
  status.done = done;
  status.result = result;
  return status;
}

Intent NumberThree(bool accepted) {
  Intent intent;
  intent.number = 3;
  intent.identity = 7;
  intent.boot_epoch = 5;
  intent.accepted = accepted;
  return intent;
}

TEST(Echo, EveryCellOfTheTable) {
  using enum NumberStep;
  struct Row {
    bool written;
    bool accepted;
    NumberStep before, running, ended, beyond;
  };
  const Row rows[] = {{false, false, kWrite, kUnknown, kUnknown, kUnknown},
                      {true, false, kWrite, kWait, kEnded, kUnknown},
                      {true, true, kUnknown, kWait, kEnded, kUnknown}};
  for (const Row& row : rows) {
    SCOPED_TRACE(testing::Message() << "written " << row.written << ", accepted " << row.accepted);
    const auto judge = [&](const MachineStatus& status) {
      const NumberVerdict verdict = JudgeNumber(NumberThree(row.accepted), row.written, status);
      EXPECT_EQ(verdict.step == kUnknown, !verdict.because.empty());
      return verdict.step;
    };
    EXPECT_EQ(judge(Status(0, 0, JobResult::kNone)), row.before);
    EXPECT_EQ(judge(Status(2, 2, JobResult::kDone)), row.before);
    EXPECT_EQ(judge(Status(2, 1, JobResult::kDone)), row.before);
    EXPECT_EQ(judge(Status(3, 2, JobResult::kDone)), row.running);
    EXPECT_EQ(judge(Status(3, 0, JobResult::kNone)), row.running);
    for (std::uint16_t result = 1; result <= 6; ++result) {
      EXPECT_EQ(judge(Status(3, 3, static_cast<JobResult>(result))), row.ended);
    }
    EXPECT_EQ(judge(Status(4, 3, JobResult::kDone)), row.beyond);
    EXPECT_EQ(judge(Status(4, 4, JobResult::kDone)), row.beyond);
    MachineStatus other = Status(3, 3, JobResult::kDone);
    other.identity = 8;
    EXPECT_EQ(judge(other), row.beyond);
    other = Status(3, 3, JobResult::kDone);
    other.boot_epoch = 4;
    EXPECT_EQ(judge(other), row.beyond);
    other.boot_epoch = 6;  // restarted, and remembers
    EXPECT_EQ(judge(other), row.ended);
  }
}

TEST(Echo, ContradictionsInOneEcho) {
  EXPECT_FALSE(ContradictionIn(Status(0, 0, JobResult::kNone)));
  EXPECT_FALSE(ContradictionIn(Status(3, 2, JobResult::kDone)));
  EXPECT_FALSE(ContradictionIn(Status(3, 3, JobResult::kInterruptedDuring)));
  EXPECT_TRUE(ContradictionIn(Status(0, 1, JobResult::kDone)));
  EXPECT_TRUE(ContradictionIn(Status(2, 3, JobResult::kDone)));
  EXPECT_TRUE(ContradictionIn(Status(3, 0, JobResult::kDone)));
  EXPECT_TRUE(ContradictionIn(Status(3, 3, JobResult::kNone)));
}

TEST(Echo, ContradictionsBetweenTwoEchoes) {
  const MachineStatus before = Status(3, 2, JobResult::kDone);
  EXPECT_FALSE(ContradictionBetween(before, before));
  EXPECT_FALSE(ContradictionBetween(before, Status(3, 3, JobResult::kWrongState)));
  EXPECT_FALSE(ContradictionBetween(before, Status(9, 9, JobResult::kDone)));
  EXPECT_TRUE(ContradictionBetween(before, Status(2, 2, JobResult::kDone)));
  EXPECT_TRUE(ContradictionBetween(before, Status(3, 1, JobResult::kDone)));
  EXPECT_TRUE(ContradictionBetween(before, Status(3, 2, JobResult::kWrongState)));
  MachineStatus other = before;
  other.boot_epoch = 6;
  EXPECT_FALSE(ContradictionBetween(before, other));
  EXPECT_TRUE(ContradictionBetween(other, before));
  other.identity = 8;
  EXPECT_TRUE(ContradictionBetween(before, other));
}

TEST(Echo, TheWatchComparesWithTheLastThatWasSound) {
  EchoWatch watch;
  EXPECT_FALSE(watch.Note(Status(3, 2, JobResult::kDone)));
  EXPECT_TRUE(watch.Note(Status(3, 9, JobResult::kDone)));
  EXPECT_FALSE(watch.Note(Status(3, 3, JobResult::kDone)));
  EXPECT_TRUE(watch.Note(Status(1, 1, JobResult::kDone)));
  EXPECT_FALSE(watch.Note(Status(1, 1, JobResult::kDone))) << "told once";
}

// A machine that keeps its word for a while and then says anything, over a line that loses
// messages, worked by a bridge that restarts, with somebody who resumes everything. Every step is
// checked against what went over the line.
class Conversation {
 public:
  explicit Conversation(std::uint64_t seed) : random_(seed), machine_(clock_) {
    liar_ = Draw(4) == 0 ? 0.0 : 0.05;
    machine_.on_read = [this] { PrepareRead(); };
    machine_.on_write = [this](int address, std::span<const std::uint16_t> values) {
      return TakeWrite(address, values);
    };
    StartBridge();
  }

  void Run() {
    for (int scan = 0; scan < 600 && !testing::Test::HasFatalFailure(); ++scan) {
      if (Draw(200) == 0) StartBridge();
      if (Draw(20) == 0) (void)worker_->Resume("");
      if (Draw(40) == 0) AddCut();
      const std::int64_t reports = journal_->NextReportNumber();
      worker_->Cycle();
      if (journal_->NextReportNumber() != reports) CheckReports(reports);
      clock_.now += 0.4;
    }
  }

  int made() const { return made_; }
  int failed() const { return failed_; }

 private:
  int Draw(int below) { return std::uniform_int_distribution<int>(0, below - 1)(random_); }
  bool Chance(double p) { return std::uniform_real_distribution<double>(0.0, 1.0)(random_) < p; }

  void StartBridge() {
    worker_.reset();
    journal_.reset();
    journal_ = *Journal::Open(folder_.path() / "journal", {.flush = false});
    MachineWorker::Options options;
    options.name = "saw";
    worker_ = std::make_unique<MachineWorker>(options, machine_, *journal_, clock_);
  }

  void AddCut() {
    ++sequence_;
    const CutKey key = {"workOrders/a", "saw", sequence_};
    (void)journal_->AddCut({key, CrosscutJob("leg", 0.3, 0.3)});
  }

  // What the honest machine is about to say, or a lie.
  void PrepareRead() {
    if (done_ < accepted_ && Draw(4) == 0) {
      done_ = accepted_;
      static constexpr JobResult kResults[] = {
          JobResult::kDone,       JobResult::kDone,
          JobResult::kDone,       JobResult::kChecksumMismatch,
          JobResult::kWrongState, JobResult::kInterruptedBefore};
      result_ = kResults[Draw(6)];
    }
    machine_.registers[input::kIdentity] = 7;
    machine_.registers[input::kBootEpoch] = 5;
    machine_.registers[input::kState] = 6;
    machine_.Echo(accepted_, done_, result_);
    machine_.read_answer = Chance(0.03) ? PeerUnavailable("saw", "timed out") : absl::OkStatus();
    if (Chance(liar_)) Lie();
    if (machine_.read_answer.ok()) NoteRead();
  }

  void Lie() {
    const auto near = [this](std::uint16_t value) {
      return static_cast<std::uint16_t>(std::max(0, value + Draw(5) - 2));
    };
    switch (Draw(6)) {
      case 0:
        return machine_.Echo(near(accepted_), near(done_), static_cast<JobResult>(Draw(8)));
      case 1:
        return machine_.Echo(accepted_, accepted_, JobResult::kDone);
      case 2:
        return machine_.Echo(near(accepted_), accepted_, JobResult::kDone);
      case 3:
        machine_.registers[input::kIdentity] = 8;
        return machine_.Echo(accepted_, accepted_, JobResult::kDone);
      case 4:
        machine_.registers[input::kBootEpoch] = static_cast<std::uint16_t>(4 + Draw(3));
        return machine_.Echo(accepted_, accepted_, JobResult::kDone);
      default:
        machine_.registers[input::kState] = 99;
        return machine_.Echo(accepted_, accepted_, JobResult::kDone);
    }
  }

  void NoteRead() {
    const auto status = DecodeStatus(machine_.registers);
    if (!status.ok()) return;
    last_ = *status;
    if (written_.contains(status->accepted)) taken_.insert(status->accepted);
  }

  absl::Status TakeWrite(int address, std::span<const std::uint16_t> values) {
    const bool lost = Chance(0.05);
    if (address != holding::kSequenceNumber) {
      return lost ? PeerUnavailable("saw", "timed out") : absl::OkStatus();
    }
    const std::uint16_t number = values[1];
    EXPECT_FALSE(taken_.contains(number))
        << "number " << number << " was written after it was taken";
    written_.insert(number);
    if (!lost && number > accepted_ && done_ == accepted_ && !Chance(0.05)) accepted_ = number;
    return lost || Chance(0.05) ? PeerUnavailable("saw", "timed out") : absl::OkStatus();
  }

  // Of the reports from `first` on: made is only what the last echo says is made.
  void CheckReports(std::int64_t first) {
    for (const CutReport& report : journal_->UnacknowledgedReports()) {
      if (report.number < first) continue;
      ASSERT_TRUE(reported_.insert(report.key).second) << "a cut was reported twice";
      failed_ += report.outcome == CutOutcome::kFailed ? 1 : 0;
      if (report.outcome != CutOutcome::kDone) continue;
      ++made_;
      const Intent intent = journal_->Intents(report.key).back();
      ASSERT_TRUE(written_.contains(intent.number)) << "made without having been given";
      ASSERT_EQ(last_.accepted, intent.number);
      ASSERT_EQ(last_.done, intent.number);
      ASSERT_EQ(last_.result, JobResult::kDone);
      ASSERT_EQ(last_.identity, intent.identity);
      ASSERT_GE(last_.boot_epoch, intent.boot_epoch);
    }
  }

  std::mt19937_64 random_;
  TemporaryFolder folder_;
  ManualClock clock_;
  ScriptedMachine machine_;
  std::unique_ptr<Journal> journal_;
  std::unique_ptr<MachineWorker> worker_;
  double liar_ = 0.0;
  std::int64_t sequence_ = 0;
  // The honest machine.
  std::uint16_t accepted_ = 0;
  std::uint16_t done_ = 0;
  JobResult result_ = JobResult::kNone;
  // What went over the line.
  MachineStatus last_;
  std::set<std::uint32_t> written_;
  std::set<std::uint32_t> taken_;
  std::set<CutKey> reported_;
  int made_ = 0;
  int failed_ = 0;
};

TEST(Echo, InRandomConversationsNothingUntrueIsReported) {
  int made = 0;
  int failed = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Conversation conversation(seed);
    conversation.Run();
    if (testing::Test::HasFailure()) return;
    made += conversation.made();
    failed += conversation.failed();
  }
  EXPECT_GT(made, 300);
  EXPECT_GT(failed, 100);
}

}  // namespace
}  // namespace mortise::hwbridge
