// Every cut is made once: whichever side dies at whichever step, whatever the line loses.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "common/base/files.h"
#include "hwbridge/cutting/machine_worker.h"
#include "tests/unit/hwbridge/cutting/simulated_cell.h"

namespace mortise::hwbridge {
namespace {

constexpr double kScan = 0.05;          // s
constexpr double kOperatorDelay = 1.0;  // s after which held cuts are resumed
constexpr double kLinger = 4.0;         // s for which the bridge stays after the last report
constexpr double kPatience = 7200.0;    // s of simulated time

// Where things go wrong in one run. Counts of steps begin at 1; 0 is never.
struct Faults {
  long bridge_dies_at = 0;
  bool journal_torn = false;  // the bridge died while it wrote the last line
  long machine_dies_at = 0;   // step of the machine's memory
  long power_off_at = 0;      // scan at which the machine loses power
  long request_lost_at = 0;
  long answer_lost_at = 0;
  long request_late_at = 0;
};

// Drives one bridge and one machine through a work order, with an operator who resumes what is
// held.
class Shop {
 public:
  Shop(MachineKind kind, std::vector<Job> jobs)
      : kind_(kind), jobs_(std::move(jobs)), plant(kind), link(plant) {
    plant.world.on_step = [this] {
      if (++machine_steps == faults.machine_dies_at) throw MachineCrash{};
    };
    link.on_step = [this] {
      if (++bridge_steps == faults.bridge_dies_at) throw BridgeCrash{};
      if (faults.journal_torn) journal_size_ = JournalSize();
    };
    link.next_fault = [this] {
      ++requests;
      if (requests == faults.request_lost_at) return LineFault::kLoseRequest;
      if (requests == faults.answer_lost_at) return LineFault::kLoseAnswer;
      if (requests == faults.request_late_at) return LineFault::kDelay;
      return LineFault::kNone;
    };
  }

  // Runs until every cut is reported; false if the operator's patience ends first.
  bool Run() {
    while (plant.Now() < kPatience) {
      try {
        if (RunBridge()) return true;
      } catch (const BridgeCrash&) {
        TearJournal();
        plant.Advance(3.0);
      }
    }
    return false;
  }

  std::map<std::string, int> CutsOfParts() const {
    std::map<std::string, int> counts;
    for (const Cut& cut : plant.world.cuts) ++counts[cut.part];
    return counts;
  }

  std::vector<CutReport> Reports() {
    auto journal = Journal::Open(path_, {.flush = false});
    return (*journal)->UnacknowledgedReports();
  }

  const MachineKind kind_;
  const std::vector<Job> jobs_;
  SimulatedPlant plant;
  SimulatedLink link;
  Faults faults;
  std::function<void()> on_scan;
  long machine_steps = 0;
  long bridge_steps = 0;
  long requests = 0;
  long scans = 0;

 private:
  CutKey Key(std::size_t i) const {
    return {"workOrders/a", "machine", static_cast<std::int64_t>(i + 1)};
  }

  // One life of the bridge.
  bool RunBridge() {
    auto journal = Journal::Open(path_, {.flush = false});
    EXPECT_TRUE(journal.ok()) << journal.status();
    MachineWorker::Options options;
    options.name = "machine";
    options.kind = kind_;
    MachineWorker worker(options, link, **journal, plant);
    // The fabplanner gives every cut again; those in the journal are known.
    for (std::size_t i = 0; i < jobs_.size(); ++i) {
      EXPECT_TRUE((*journal)->AddCut({Key(i), jobs_[i]}).ok());
    }
    double held_since = -1.0;
    while (plant.Now() < kPatience) {
      if (++scans == faults.power_off_at) plant.PowerOff();
      if (on_scan) on_scan();
      const bool held = worker.View().held;
      const int numbers = link.numbers_written;
      worker.Cycle();
      if (held) {
        EXPECT_EQ(link.numbers_written, numbers) << "a number was sent while cuts were held";
      }
      plant.Advance(kScan);
      if ((*journal)->OpenCuts("machine").empty()) {
        // Late messages must find the machine ready, or their harm would go unseen.
        if (done_at_ < 0.0) done_at_ = plant.Now();
        if (plant.Now() - done_at_ > kLinger) return true;
      }
      if (!worker.View().held) {
        held_since = -1.0;
      } else if (held_since < 0.0) {
        held_since = plant.Now();
      } else if (plant.Now() - held_since > kOperatorDelay) {
        (void)worker.Resume("");  // refused while the line is down
      }
    }
    return false;
  }

  long JournalSize() const {
    std::error_code ignored;
    return static_cast<long>(std::filesystem::file_size(path_, ignored));
  }

  // As if the bridge had died while it wrote the line after its last request.
  void TearJournal() {
    const long size = JournalSize();
    if (!faults.journal_torn || size <= journal_size_) return;
    std::filesystem::resize_file(path_, static_cast<std::uintmax_t>(size - 5));
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "journal";
  long journal_size_ = 0;
  double done_at_ = -1.0;  // s, when the last cut was reported
};

std::vector<Job> Crosscuts(int count) {
  std::vector<Job> jobs;
  for (int i = 1; i <= count; ++i) {
    jobs.push_back(CrosscutJob("leg-" + std::to_string(i), 0.3 * i, 0.3));
  }
  return jobs;
}

void ExpectEachCutOnce(Shop& shop, const std::string& what) {
  ASSERT_TRUE(shop.Run()) << what << ": never finished";
  const auto counts = shop.CutsOfParts();
  for (const Job& job : shop.jobs_) {
    const auto count = counts.find(job.part);
    ASSERT_TRUE(count != counts.end()) << what << ": lost cut " << job.part;
    ASSERT_EQ(count->second, 1) << what << ": double cut " << job.part;
  }
  ASSERT_EQ(shop.plant.world.cuts.size(), shop.jobs_.size()) << what;
  const auto reports = shop.Reports();
  ASSERT_EQ(reports.size(), shop.jobs_.size()) << what;
  for (std::size_t i = 0; i < reports.size(); ++i) {
    ASSERT_EQ(reports[i].key.sequence, static_cast<std::int64_t>(i + 1)) << what;
    ASSERT_EQ(reports[i].outcome, CutOutcome::kDone) << what << ": " << reports[i].message;
  }
}

TEST(ExactlyOnce, WithoutFaultsCutsTakeTheirTime) {
  Shop shop(MachineKind::kChopSaw, Crosscuts(3));
  ExpectEachCutOnce(shop, "no faults");
  // Per cut 1 s feed, 0.5 s clamp, 4 s cut, and a few scans.
  EXPECT_NEAR(shop.plant.Now(), 3 * 5.5 + 0.5 + kLinger, 1.0);
  EXPECT_EQ(shop.link.numbers_written, 3);
}

// Each test below first counts the steps of a run without faults, then fails at each in turn. A
// fault prolongs the run, so a little more than the count is covered.

TEST(ExactlyOnce, TheBridgeDiesAtEveryStep) {
  Shop plain(MachineKind::kChopSaw, Crosscuts(2));
  ASSERT_TRUE(plain.Run());
  for (const bool torn : {false, true}) {
    for (long at = 1; at <= plain.bridge_steps; ++at) {
      Shop shop(MachineKind::kChopSaw, Crosscuts(2));
      shop.faults.bridge_dies_at = at;
      shop.faults.journal_torn = torn;
      ExpectEachCutOnce(shop, "bridge dies at step " + std::to_string(at));
      if (HasFatalFailure()) return;
    }
  }
}

TEST(ExactlyOnce, TheMachineDiesAtEveryStepOfItsMemory) {
  Shop plain(MachineKind::kChopSaw, Crosscuts(3));
  ASSERT_TRUE(plain.Run());
  for (long at = 1; at <= plain.machine_steps + 4; ++at) {
    Shop shop(MachineKind::kChopSaw, Crosscuts(3));
    shop.faults.machine_dies_at = at;
    ExpectEachCutOnce(shop, "machine dies at step " + std::to_string(at));
    if (HasFatalFailure()) return;
  }
}

TEST(ExactlyOnce, TheMachineLosesPowerAtEveryMoment) {
  Shop plain(MachineKind::kChopSaw, Crosscuts(2));
  ASSERT_TRUE(plain.Run());
  for (long at = 1; at <= plain.scans; ++at) {
    Shop shop(MachineKind::kChopSaw, Crosscuts(2));
    shop.faults.power_off_at = at;
    ExpectEachCutOnce(shop, "power off at scan " + std::to_string(at));
    if (HasFatalFailure()) return;
  }
}

TEST(ExactlyOnce, TheLineLosesEveryMessage) {
  Shop plain(MachineKind::kChopSaw, Crosscuts(2));
  ASSERT_TRUE(plain.Run());
  for (long at = 1; at <= plain.requests; ++at) {
    for (long Faults::*fault : {&Faults::request_lost_at, &Faults::answer_lost_at}) {
      Shop shop(MachineKind::kChopSaw, Crosscuts(2));
      shop.faults.*fault = at;
      ExpectEachCutOnce(shop, "loss of request " + std::to_string(at));
      if (HasFatalFailure()) return;
    }
  }
}

// A request that was given up arrives after all: while its cut is made, just after, or later still.
TEST(ExactlyOnce, TheLineDelaysEveryMessage) {
  Shop plain(MachineKind::kChopSaw, Crosscuts(2));
  ASSERT_TRUE(plain.Run());
  for (long at = 1; at <= plain.requests; ++at) {
    for (const double late_by : {1.0, 6.1, 6.5}) {
      Shop shop(MachineKind::kChopSaw, Crosscuts(2));
      shop.faults.request_late_at = at;
      shop.link.late_by = late_by;
      ExpectEachCutOnce(shop, "request " + std::to_string(at) + " late");
      if (HasFatalFailure()) return;
    }
  }
}

// Both die at once: the machine at a step of its memory, and the bridge within a few steps of it.
TEST(ExactlyOnce, BothSidesDieTogether) {
  Shop plain(MachineKind::kChopSaw, Crosscuts(2));
  std::vector<long> bridge_steps;  // of the bridge when the machine took each step
  plain.plant.world.on_step = [&] { bridge_steps.push_back(plain.bridge_steps); };
  ASSERT_TRUE(plain.Run());
  for (std::size_t i = 0; i < bridge_steps.size(); ++i) {
    for (long offset = -3; offset <= 8; ++offset) {
      Shop shop(MachineKind::kChopSaw, Crosscuts(2));
      shop.faults.machine_dies_at = static_cast<long>(i + 1);
      shop.faults.bridge_dies_at = std::max(1L, bridge_steps[i] + offset);
      ExpectEachCutOnce(shop, "machine step " + std::to_string(i + 1) + ", bridge step " +
                                  std::to_string(shop.faults.bridge_dies_at));
      if (HasFatalFailure()) return;
    }
  }
}

// Everything at random, many times over.
class Storm {
 public:
  Storm(Shop& shop, std::uint64_t seed) : shop_(shop), random_(seed) {
    shop.link.next_fault = [this] {
      const double draw = Draw();
      shop_.link.late_by = 10.0 * Draw();
      if (draw < 0.02) return LineFault::kLoseRequest;
      if (draw < 0.04) return LineFault::kLoseAnswer;
      return draw < 0.06 ? LineFault::kDelay : LineFault::kNone;
    };
    shop.link.on_step = [this] {
      if (Draw() < 0.002) throw BridgeCrash{};
    };
    shop.plant.world.on_step = [this] {
      if (Draw() < 0.05) throw MachineCrash{};
    };
    shop.on_scan = [this] {
      if (Draw() < 0.001) shop_.plant.PowerOff();
      if (emergency_stops && Draw() < 0.002) PressEmergencyStop();
    };
  }

  bool emergency_stops = false;

 private:
  double Draw() { return std::uniform_real_distribution<double>(0.0, 1.0)(random_); }

  void PressEmergencyStop() {
    shop_.plant.WithMachine([](Machine& machine) { machine.SetEmergencyStop(true); });
    shop_.plant.Advance(1.0);
    shop_.plant.WithMachine([](Machine& machine) { machine.SetEmergencyStop(false); });
  }

  Shop& shop_;
  std::mt19937_64 random_;
};

TEST(ExactlyOnce, InStormsOfFaults) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const bool saw = seed % 2 == 0;
    std::vector<Job> outlines;
    for (int i = 1; i <= 3; ++i) {
      outlines.push_back(OutlineJob("seat-" + std::to_string(i), 0.05, 20));
    }
    Shop shop(saw ? MachineKind::kChopSaw : MachineKind::kJigsaw, saw ? Crosscuts(5) : outlines);
    Storm storm(shop, seed);
    ExpectEachCutOnce(shop, "seed " + std::to_string(seed));
    if (HasFatalFailure()) return;
  }
}

// An emergency stop may ruin a cut; then it is reported as failed, and never made again.
TEST(ExactlyOnce, WithEmergencyStopsWhatIsReportedIsTrue) {
  int failed = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Shop shop(MachineKind::kChopSaw, Crosscuts(5));
    Storm storm(shop, seed);
    storm.emergency_stops = true;
    ASSERT_TRUE(shop.Run()) << "seed " << seed;
    const auto counts = shop.CutsOfParts();
    for (const CutReport& report : shop.Reports()) {
      const std::string part = "leg-" + std::to_string(report.key.sequence);
      const int cuts = counts.contains(part) ? counts.at(part) : 0;
      const bool done = report.outcome == CutOutcome::kDone;
      ASSERT_EQ(cuts, done ? 1 : 0) << "seed " << seed << " " << part << ": " << report.message;
      failed += done ? 0 : 1;
    }
  }
  EXPECT_GT(failed, 0);
}

}  // namespace
}  // namespace mortise::hwbridge
