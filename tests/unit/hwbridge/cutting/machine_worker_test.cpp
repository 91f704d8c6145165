// One machine worked by hand, scan by scan: what holds cuts, and what does not resume them.
#include "hwbridge/cutting/machine_worker.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "tests/unit/hwbridge/cutting/simulated_cell.h"

namespace mortise::hwbridge {
namespace {

constexpr double kScan = 0.05;  // s

class MachineWorkerTest : public testing::Test {
 protected:
  MachineWorkerTest() : plant_(MachineKind::kChopSaw), link_(plant_) {
    journal_ = *Journal::Open(folder_.path() / "journal", {.flush = false});
    MachineWorker::Options options;
    options.name = "saw";
    worker_ = std::make_unique<MachineWorker>(options, link_, *journal_, plant_);
  }

  void Give(std::int64_t sequence, const std::string& work_order = "workOrders/a") {
    const Job job = CrosscutJob("leg-" + std::to_string(sequence), 0.3 * sequence, 0.3);
    ASSERT_TRUE(journal_->AddCut({{work_order, "saw", sequence}, job}).ok());
  }

  void Scan(double seconds) {
    const double end = plant_.Now() + seconds;
    while (plant_.Now() < end) {
      worker_->Cycle();
      plant_.Advance(kScan);
    }
  }

  TemporaryFolder folder_;
  SimulatedPlant plant_;
  SimulatedLink link_;
  std::unique_ptr<Journal> journal_;
  std::unique_ptr<MachineWorker> worker_;
};

TEST_F(MachineWorkerTest, TheReturnOfTheLineResumesNothing) {
  for (int i = 1; i <= 3; ++i) Give(i);
  Scan(4.0);  // in the first cut
  link_.next_fault = [] { return LineFault::kLoseRequest; };
  Scan(30.0);
  EXPECT_FALSE(worker_->View().online);
  EXPECT_EQ(worker_->View().state, "UNDEFINED");
  EXPECT_TRUE(worker_->View().held);
  EXPECT_EQ(worker_->Resume("").code(), absl::StatusCode::kFailedPrecondition);
  link_.next_fault = nullptr;
  Scan(100.0);
  EXPECT_TRUE(worker_->View().online);
  EXPECT_EQ(worker_->View().state, "HELD");
  EXPECT_EQ(plant_.world.cuts.size(), 1u);  // the machine finished the one it had begun
  EXPECT_EQ(journal_->UnacknowledgedReports().size(), 1u);  // and that is noticed without Resume
  ASSERT_TRUE(worker_->Resume("workOrders/a").ok());
  Scan(20.0);
  EXPECT_EQ(plant_.world.cuts.size(), 3u);
}

TEST_F(MachineWorkerTest, HoldEndsTheCutUnderWayAndBeginsNoOther) {
  for (int i = 1; i <= 3; ++i) Give(i);
  Scan(4.0);
  worker_->Hold("workOrders/a", "an operator said so");
  Scan(60.0);
  EXPECT_EQ(plant_.world.cuts.size(), 1u);
  EXPECT_EQ(worker_->View().held_because, "an operator said so");
  ASSERT_TRUE(worker_->Resume("workOrders/a").ok());
  Scan(20.0);
  EXPECT_EQ(plant_.world.cuts.size(), 3u);
}

TEST_F(MachineWorkerTest, AHeldWorkOrderDoesNotBlockAnother) {
  for (int i = 1; i <= 3; ++i) Give(i);
  Scan(4.0);
  worker_->Hold("workOrders/a", "an operator said so");
  for (int i = 1; i <= 2; ++i) Give(i, "workOrders/b");
  Scan(60.0);
  EXPECT_EQ(plant_.world.cuts.size(), 3u);
  EXPECT_TRUE(worker_->View().held);
  ASSERT_TRUE(worker_->Resume("workOrders/a").ok());
  Scan(20.0);
  EXPECT_EQ(plant_.world.cuts.size(), 5u);
}

// The machine has a cut of the held order in hand, so nobody else may have it.
TEST_F(MachineWorkerTest, ACutInHandBlocksAllOthers) {
  Give(1);
  Scan(1.0);
  plant_.PowerOff();
  Scan(10.0);
  Give(1, "workOrders/b");
  Scan(60.0);
  EXPECT_TRUE(plant_.world.cuts.empty());
  EXPECT_TRUE(worker_->View().held);
  ASSERT_TRUE(worker_->Resume("workOrders/a").ok());
  Scan(30.0);
  EXPECT_EQ(plant_.world.cuts.size(), 2u);
}

TEST_F(MachineWorkerTest, AMachineWithoutOrdersIsStoppedAndStartedForTheNext) {
  Give(1);
  Scan(20.0);
  EXPECT_EQ(worker_->View().state, "STOPPED");
  Give(1, "workOrders/b");
  Scan(10.0);
  EXPECT_EQ(plant_.world.cuts.size(), 2u);
  EXPECT_FALSE(worker_->View().held);
}

TEST_F(MachineWorkerTest, AMachineThatLostItsMemoryIsNotTrusted) {
  Give(1);
  Give(2);
  Scan(4.0);
  plant_.PowerOff();
  plant_.world.record = MachineRecord{};
  plant_.world.record->identity = 8;
  Scan(10.0);
  const auto reports = journal_->UnacknowledgedReports();
  ASSERT_EQ(reports.size(), 1u);
  EXPECT_EQ(reports[0].outcome, CutOutcome::kFailed);
  EXPECT_TRUE(worker_->View().held);
}

TEST_F(MachineWorkerTest, NumbersThatWeNeverGaveHoldUsUntilTheyAreAdopted) {
  plant_.world.record = MachineRecord{};
  plant_.world.record->identity = 7;
  plant_.world.record->accepted = 41;
  Give(1);
  Scan(20.0);
  EXPECT_TRUE(plant_.world.cuts.empty());
  EXPECT_TRUE(worker_->View().held);
  ASSERT_TRUE(worker_->AdoptNumbers().ok());
  ASSERT_TRUE(worker_->Resume("").ok());
  Scan(20.0);
  ASSERT_EQ(plant_.world.cuts.size(), 1u);
  EXPECT_EQ(plant_.world.cuts[0].sequence_number, 42u);
}

TEST_F(MachineWorkerTest, APressedEmergencyStopHoldsUntilReleasedAndResumed) {
  Give(1);
  Scan(1.0);  // it feeds
  plant_.WithMachine([](Machine& machine) { machine.SetEmergencyStop(true); });
  Scan(10.0);
  EXPECT_TRUE(worker_->View().held);
  EXPECT_FALSE(worker_->Resume("").ok());
  plant_.WithMachine([](Machine& machine) { machine.SetEmergencyStop(false); });
  Scan(30.0);
  EXPECT_TRUE(plant_.world.cuts.empty());  // the release alone starts nothing
  ASSERT_TRUE(worker_->Resume("").ok());
  Scan(20.0);
  EXPECT_EQ(plant_.world.cuts.size(), 1u);
}

TEST_F(MachineWorkerTest, ARefusedCutIsReportedAndHoldsTheRest) {
  Job impossible = CrosscutJob("mast", 20.0, 20.0);
  ASSERT_TRUE(journal_->AddCut({{"workOrders/a", "saw", 1}, impossible}).ok());
  Give(2);
  Scan(30.0);
  ASSERT_EQ(journal_->UnacknowledgedReports().size(), 1u);
  EXPECT_EQ(journal_->UnacknowledgedReports()[0].outcome, CutOutcome::kRejected);
  EXPECT_TRUE(worker_->View().held);
  EXPECT_TRUE(plant_.world.cuts.empty());
}

}  // namespace
}  // namespace mortise::hwbridge
