// Work orders: assignment, pauses, failures, and exactly one effect a cut over a line that loses,
// repeats and reorders messages while both ends restart.
#include "services/fabplanner/shop_floor/work_order.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "common/base/errors.h"
#include "services/fabplanner/planning/planning.h"
#include "services/fabplanner/shop_floor/report_ledger.h"
#include "tests/unit/services/fabplanner/example_table.h"

namespace mortise::fabplanner {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const MachineAddress kSaw{"north", "saw", MachineKind::kChopSaw};
const MachineAddress kSecondSaw{"south", "saw", MachineKind::kChopSaw};
const MachineAddress kJigsawRobot{"north", "jigsaw", MachineKind::kJigsaw};

std::vector<Cut> TableCuts() {
  return CutsFor(MakePlan(ExampleTable(), ExampleItems(), 1).value());
}

// `boards` boards of `cuts_each` cuts and one sheet of two outlines.
std::vector<Cut> SimpleCuts(int boards, int cuts_each) {
  std::vector<Cut> cuts;
  for (int board = 1; board <= boards; ++board) {
    for (int i = 0; i < cuts_each; ++i) {
      Cut cut;
      cut.stock = "board-" + std::to_string(board);
      cut.part = cut.stock + "/" + std::to_string(i);
      cuts.push_back(cut);
    }
  }
  for (int i = 0; i < 2; ++i) {
    Cut cut;
    cut.kind = MachineKind::kJigsaw;
    cut.stock = "sheet-1";
    cut.part = "sheet/" + std::to_string(i);
    cuts.push_back(cut);
  }
  return cuts;
}

CutReport Done(const Cut& cut) { return {cut.machine, cut.sequence, CutOutcome::kDone, "", 4}; }

TEST(WorkOrderTest, BoardsWithSlopedEndsAreLeftToPeople) {
  FabricationPlan plan = MakePlan(ExampleTable(), ExampleItems(), 1).value();
  const std::vector<Cut> square = CutsFor(plan);
  const BoardLayout sloped = plan.boards.front();
  plan.boards.front().segments.back().ends.rear = SlopeOf(M_PI / 4, 0);
  const std::vector<Cut> cuts = CutsFor(plan);
  EXPECT_EQ(cuts.size(), square.size() - 1 - sloped.segments.size());  // with its trim
  for (const Cut& cut : cuts) EXPECT_NE(cut.stock, sloped.label);
}

TEST(WorkOrderTest, CutsOfAPlanFollowTheBoards) {
  const std::vector<Cut> cuts = TableCuts();
  ASSERT_EQ(cuts.size(), 4 + 8 + 1);  // trims, crosscuts, the top
  EXPECT_EQ(cuts[0].part, "board-1.trim");
  EXPECT_NEAR(cuts[0].position, 0.007, 1e-12);
  EXPECT_NEAR(cuts[1].position - cuts[1].length, 0.010, 1e-12);  // behind trim and blade
  EXPECT_EQ(cuts.back().kind, MachineKind::kJigsaw);
  EXPECT_EQ(cuts.back().outline.size(), 4);
}

TEST(WorkOrderTest, GivesWholeBoardsToMachinesOfTheirKind) {
  WorkOrder order(SimpleCuts(4, 3));
  const std::vector<int> sent = order.GiveOut({kSaw, kJigsawRobot});
  // Two boards ahead for the saw, the sheet for the jigsaw.
  EXPECT_THAT(sent, ElementsAre(0, 1, 2, 3, 4, 5, 12, 13));
  EXPECT_EQ(order.state(), OrderState::kInProgress);
  EXPECT_EQ(order.cuts()[5].sequence, 6);
  EXPECT_EQ(order.cuts()[12].machine, "jigsaw");
  EXPECT_EQ(order.cuts()[12].sequence, 1);
  EXPECT_THAT(order.GiveOut({kSaw, kJigsawRobot}), IsEmpty());
  // A second saw, of the same name at another bridge, takes the rest.
  EXPECT_THAT(order.GiveOut({kSaw, kSecondSaw}), ElementsAre(6, 7, 8, 9, 10, 11));
  EXPECT_EQ(order.cuts()[6].bridge, "south");
  EXPECT_EQ(order.cuts()[6].sequence, 1);
}

TEST(WorkOrderTest, FinishedBoardsMakeRoom) {
  WorkOrder order(SimpleCuts(3, 2));
  order.GiveOut({kSaw});
  for (int i : {0, 1}) {
    EXPECT_EQ(order.Accept("north", "saw", order.cuts()[i].sequence), i);
    EXPECT_EQ(order.Report("north", Done(order.cuts()[i])), i);
  }
  EXPECT_THAT(order.GiveOut({kSaw}), ElementsAre(4, 5));
  EXPECT_EQ(order.done(), 2);
}

TEST(WorkOrderTest, WaitsForMachinesOfTheKind) {
  WorkOrder order(SimpleCuts(1, 1));
  EXPECT_THAT(order.GiveOut({}), IsEmpty());
  EXPECT_EQ(order.state(), OrderState::kReleased);
  EXPECT_THAT(order.GiveOut({kJigsawRobot}), ElementsAre(1, 2));
}

TEST(WorkOrderTest, RepetitionsChangeNothing) {
  WorkOrder order(SimpleCuts(1, 1));
  order.GiveOut({kSaw});
  EXPECT_EQ(order.Accept("north", "saw", 1), 0);
  EXPECT_EQ(order.Accept("north", "saw", 1), std::nullopt);
  EXPECT_EQ(order.Report("north", Done(order.cuts()[0])), 0);
  EXPECT_EQ(order.Report("north", {"saw", 1, CutOutcome::kFailed, "late", 0}), std::nullopt);
  EXPECT_EQ(order.cuts()[0].state, CutState::kCut);
  EXPECT_EQ(order.Report("north", {"saw", 99, CutOutcome::kDone, "", 0}), std::nullopt);
  EXPECT_EQ(order.Report("south", Done(order.cuts()[0])), std::nullopt);
}

TEST(WorkOrderTest, LastCutCompletesEvenAHeldOrder) {
  WorkOrder order(SimpleCuts(1, 1));
  order.GiveOut({kSaw, kJigsawRobot});
  ASSERT_TRUE(order.Hold("workOrders/1").ok());
  EXPECT_THAT(order.CutsToSendAgain("north"), IsEmpty());
  for (const Cut& cut : std::vector<Cut>(order.cuts())) order.Report("north", Done(cut));
  EXPECT_EQ(order.state(), OrderState::kCompleted);
  EXPECT_EQ(DetailOf(order.Hold("workOrders/1")).reason, "WORK_ORDER_FINISHED");
  EXPECT_EQ(DetailOf(order.Cancel("workOrders/1")).field, "workOrders/1");
}

TEST(WorkOrderTest, HoldStopsGivingOutAndResumeGoesOn) {
  WorkOrder order(SimpleCuts(3, 1));
  ASSERT_TRUE(order.Hold("w").ok());
  EXPECT_THAT(order.GiveOut({kSaw}), IsEmpty());
  ASSERT_TRUE(order.Resume("w").ok());
  EXPECT_EQ(order.state(), OrderState::kReleased);
  EXPECT_THAT(order.GiveOut({kSaw}), ElementsAre(0, 1));
  ASSERT_TRUE(order.Hold("w").ok());
  ASSERT_TRUE(order.Resume("w").ok());
  EXPECT_EQ(order.state(), OrderState::kInProgress);
  EXPECT_THAT(order.CutsToSendAgain("north"), ElementsAre(0, 1));
}

TEST(WorkOrderTest, ATroubledCutFailsTheOrderAndIsNamed) {
  WorkOrder order(SimpleCuts(3, 1));
  order.GiveOut({kSaw});
  order.Report("north", {"saw", 1, CutOutcome::kFailed, "blade stalled", 2});
  EXPECT_EQ(order.state(), OrderState::kFailed);
  EXPECT_THAT(order.GiveOut({kSaw}), IsEmpty());
  EXPECT_THAT(order.Trouble(), HasSubstr("board-1/0"));
  EXPECT_THAT(order.Trouble(), HasSubstr("blade stalled"));
  EXPECT_EQ(order.Report("north", Done(order.cuts()[1])), 1);  // what was under way is recorded
  EXPECT_EQ(order.state(), OrderState::kFailed);
}

TEST(ReportLedgerTest, StoresWithoutGaps) {
  ReportLedger ledger = ReportLedger::ForNewBridge(1).value();
  EXPECT_EQ(ledger.Judge(2), ReportLedger::Verdict::kEarly);
  EXPECT_EQ(ledger.Judge(1), ReportLedger::Verdict::kNew);
  ledger.Advance();
  EXPECT_EQ(ledger.Judge(1), ReportLedger::Verdict::kDuplicate);
  EXPECT_EQ(ledger.Judge(2), ReportLedger::Verdict::kNew);
  EXPECT_TRUE(ledger.CheckHello(2).ok());
  EXPECT_EQ(DetailOf(ledger.CheckHello(1)).reason, "JOURNAL_LOST");
  EXPECT_FALSE(ReportLedger::ForNewBridge(0).ok());
}

// ---- A model bridge on a bad line
// ----------------------------------------------------------------

struct Command {
  std::string machine;
  int64_t sequence;
  std::string part;
};

struct FromBridge {
  bool is_report = false;
  int64_t report_number = 0;
  CutReport report;  // machine and sequence also of an acceptance
};

// A bridge with a journal that survives restarts; machines cut what it accepts, once.
class ModelBridge {
 public:
  ModelBridge(std::string name, std::map<std::string, int>* effects)
      : name_(std::move(name)), effects_(effects) {}

  void Receive(const Command& command, std::vector<FromBridge>* out) {
    if (journal_.emplace(std::pair(command.machine, command.sequence), command.part).second) {
      to_cut_.push_back(command);
    }
    // The same number always means the same part.
    EXPECT_EQ(journal_.at({command.machine, command.sequence}), command.part);
    out->push_back({false, 0, {command.machine, command.sequence, CutOutcome::kDone, "", 0}});
  }

  void CutSomething(std::mt19937& random, std::vector<FromBridge>* out) {
    if (to_cut_.empty()) return;
    const std::size_t index = random() % to_cut_.size();
    const Command command = to_cut_[index];
    to_cut_.erase(to_cut_.begin() + static_cast<long>(index));
    ++(*effects_)[command.part];
    const int64_t number = static_cast<int64_t>(reports_.size()) + 1;
    reports_.push_back(
        {true, number, {command.machine, command.sequence, CutOutcome::kDone, "", 1}});
    out->push_back(reports_.back());
  }

  void RepeatReports(std::vector<FromBridge>* out) {
    for (const FromBridge& report : reports_) {
      if (report.report_number > acknowledged_) out->push_back(report);
    }
  }

  void Acknowledge(int64_t number) { acknowledged_ = std::max(acknowledged_, number); }
  int64_t next_report_number() const { return static_cast<int64_t>(reports_.size()) + 1; }
  const std::string& name() const { return name_; }

 private:
  std::string name_;
  std::map<std::string, int>* effects_;
  std::map<std::pair<std::string, int64_t>, std::string> journal_;
  std::vector<Command> to_cut_;
  std::vector<FromBridge> reports_;
  int64_t acknowledged_ = 0;
};

// Takes a random message and loses it, delivers it, or delivers it and keeps it for a second time.
template <class Message>
std::optional<Message> Deliver(std::vector<Message>& line, std::mt19937& random, bool reliable) {
  if (line.empty()) return std::nullopt;
  const std::size_t index = reliable ? 0 : random() % line.size();
  const Message message = line[index];
  const unsigned fate = reliable ? 1 : random() % 10;
  if (fate != 0) line.erase(line.begin() + static_cast<long>(index));
  if (fate >= 8) return std::nullopt;
  return message;
}

TEST(WorkOrderPropertyTest, EveryCutHasExactlyOneEffectOnABadLine) {
  for (unsigned seed = 0; seed < 150; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::map<std::string, int> effects;
    std::vector<Cut> initial =
        SimpleCuts(1 + static_cast<int>(random() % 6), 1 + static_cast<int>(random() % 4));
    const std::size_t total = initial.size();
    WorkOrder order(initial);
    std::vector<ModelBridge> bridges;
    bridges.emplace_back("north", &effects);
    bridges.emplace_back("south", &effects);
    std::map<std::string, ReportLedger> ledgers;
    std::map<std::string, std::vector<Command>> commands;
    std::map<std::string, std::vector<FromBridge>> reports;
    std::set<std::string> attached;

    const auto send = [&](const std::vector<int>& cuts) {
      for (int i : cuts) {
        const Cut& cut = order.cuts()[i];
        if (attached.contains(cut.bridge)) {
          commands[cut.bridge].push_back({cut.machine, cut.sequence, cut.part});
        }
      }
    };
    const auto give_out = [&] {
      std::vector<MachineAddress> machines;
      for (const std::string& bridge : attached) {
        machines.push_back({bridge, "saw", MachineKind::kChopSaw});
        if (bridge == "north") machines.push_back({bridge, "jigsaw", MachineKind::kJigsaw});
      }
      send(order.GiveOut(machines));
    };
    const auto attach = [&](ModelBridge& bridge) {
      const std::string& name = bridge.name();
      if (!ledgers.contains(name)) {
        ledgers[name] = ReportLedger::ForNewBridge(bridge.next_report_number()).value();
      }
      ASSERT_TRUE(ledgers[name].CheckHello(bridge.next_report_number()).ok());
      commands[name].clear();
      reports[name].clear();
      attached.insert(name);
      bridge.Acknowledge(ledgers[name].stored());
      send(order.CutsToSendAgain(name));
      give_out();
      bridge.RepeatReports(&reports[name]);
    };
    const auto step = [&](ModelBridge& bridge, bool reliable) {
      const std::string& name = bridge.name();
      if (auto command = Deliver(commands[name], random, reliable)) {
        bridge.Receive(*command, &reports[name]);
      }
      bridge.CutSomething(random, &reports[name]);
      if (auto message = Deliver(reports[name], random, reliable)) {
        if (!message->is_report) {
          order.Accept(name, message->report.machine, message->report.sequence);
        } else {
          ReportLedger& ledger = ledgers[name];
          if (ledger.Judge(message->report_number) == ReportLedger::Verdict::kNew) {
            EXPECT_TRUE(order.Report(name, message->report).has_value());
            ledger.Advance();
            give_out();
          }
          if (random() % 2 == 0) bridge.Acknowledge(ledger.stored());
        }
      }
      if (random() % 20 == 0) bridge.RepeatReports(&reports[name]);
    };

    for (int round = 0; round < 300; ++round) {
      ModelBridge& bridge = bridges[random() % 2];
      if (!attached.contains(bridge.name())) {
        if (random() % 5 == 0) attach(bridge);
        continue;
      }
      step(bridge, false);
      if (random() % 15 == 0) attached.erase(bridge.name());  // the line drops
      if (random() % 30 == 0) {                               // the fabplanner is killed
        order = WorkOrder(order.cuts(), order.state());
        attached.clear();
      }
      if (random() % 40 == 0) {
        EXPECT_TRUE(IsFinal(order.state()) || order.Hold("w").ok());
        EXPECT_TRUE(IsFinal(order.state()) || order.Resume("w").ok());
      }
    }
    for (ModelBridge& bridge : bridges) attach(bridge);  // the line gets well
    for (int round = 0; round < 4000 && order.state() != OrderState::kCompleted; ++round) {
      for (ModelBridge& bridge : bridges) step(bridge, true);
    }
    EXPECT_EQ(order.state(), OrderState::kCompleted);
    EXPECT_EQ(effects.size(), total);
    for (const auto& [part, times] : effects) EXPECT_EQ(times, 1) << part;
    std::set<std::tuple<std::string, std::string, int64_t>> keys;
    for (const Cut& cut : order.cuts()) keys.insert({cut.bridge, cut.machine, cut.sequence});
    EXPECT_EQ(keys.size(), total);
  }
}

}  // namespace
}  // namespace mortise::fabplanner
