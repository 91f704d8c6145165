// The durable log and the journal on it.
#include "hwbridge/cutting/journal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "common/base/errors.h"
#include "common/base/files.h"
#include "hwbridge/cutting/durable_log.h"
#include "tests/unit/hwbridge/cutting/simulated_cell.h"

namespace mortise::hwbridge {
namespace {

using testing::ElementsAre;

class JournalTest : public testing::Test {
 protected:
  std::unique_ptr<Journal> Open() {
    auto journal = Journal::Open(path_);
    EXPECT_TRUE(journal.ok()) << journal.status();
    return *std::move(journal);
  }

  static CutOrder Cut(std::int64_t sequence, std::string machine = "saw") {
    return {{"workOrders/a", std::move(machine), sequence},
            CrosscutJob("part-" + std::to_string(sequence), 0.5 * sequence, 0.5)};
  }

  static Intent MakeIntent(const CutKey& key, std::uint32_t number) {
    return {key, number, 7, 1, JobResult::kNone, 0.0};
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "journal";
};

TEST(DurableLog, ReadsWhatItWrote) {
  TemporaryFolder folder;
  const auto path = folder.path() / "new" / "log";
  {
    auto log = DurableLog::Open(path, {});
    ASSERT_TRUE(log.ok()) << log.status();
    ASSERT_TRUE((*log)->Append("one").ok());
    ASSERT_TRUE((*log)->Append("").ok());
    ASSERT_TRUE((*log)->Append("größer").ok());
  }
  auto log = DurableLog::Open(path, {});
  ASSERT_TRUE(log.ok());
  EXPECT_THAT((*log)->TakeLines(), ElementsAre("one", "", "größer"));
}

TEST(DurableLog, ATornLastLineIsCutOffWhereverItTore) {
  TemporaryFolder folder;
  const auto path = folder.path() / "log";
  const std::string whole = FormatLogLine("first") + FormatLogLine("second");
  const std::size_t first = FormatLogLine("first").size();
  for (std::size_t size = first; size < whole.size(); ++size) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << whole.substr(0, size);
    auto log = DurableLog::Open(path, {});
    ASSERT_TRUE(log.ok()) << log.status();
    EXPECT_THAT((*log)->TakeLines(), ElementsAre("first"));
    ASSERT_TRUE((*log)->Append("third").ok());
    log->reset();
    EXPECT_EQ(*ReadFile(path), FormatLogLine("first") + FormatLogLine("third"));
  }
}

TEST(DurableLog, DamageInTheMiddleIsNotPassedOver) {
  TemporaryFolder folder;
  const auto path = folder.path() / "log";
  std::string bytes = FormatLogLine("first") + FormatLogLine("second");
  bytes[10] ^= 1;
  std::ofstream(path, std::ios::binary) << bytes;
  EXPECT_TRUE(absl::IsDataLoss(DurableLog::Open(path, {}).status()));
}

TEST(DurableLog, ASecondOwnerIsRefused) {
  TemporaryFolder folder;
  auto first = DurableLog::Open(folder.path() / "log", {});
  ASSERT_TRUE(first.ok());
  const auto second = DurableLog::Open(folder.path() / "log", {});
  EXPECT_EQ(DetailOf(second.status()).reason, "JOURNAL_IN_USE");
}

TEST(DurableLog, AnUnwritableFolderIsAClearError) {
  EXPECT_EQ(DetailOf(DurableLog::Open("/proc/no/log", {}).status()).reason, "STORAGE_FAILED");
}

TEST(DurableLog, AFullDiskIsAnErrorAndChangesNothing) {
  auto log = DurableLog::Open("/dev/full", {});
  if (!log.ok()) GTEST_SKIP() << log.status();
  EXPECT_EQ(DetailOf((*log)->Append("text")).reason, "STORAGE_FAILED");
}

TEST_F(JournalTest, RemembersWhatTheMachineTookAndWhyNobodyKnows) {
  const CutOrder cut = Cut(1);
  {
    auto journal = Open();
    ASSERT_TRUE(journal->AddCut(cut).ok());
    EXPECT_EQ(journal->AddAcceptance("saw", 1).code(), absl::StatusCode::kNotFound);
    ASSERT_TRUE(journal->AddIntent(MakeIntent(cut.key, 1)).ok());
    EXPECT_FALSE(journal->Intents(cut.key).back().accepted);
    ASSERT_TRUE(journal->AddAcceptance("saw", 1).ok());
    ASSERT_TRUE(journal->AddResult("saw", 1, JobResult::kUnknown, 0.0, "it jumped").ok());
  }
  const Intent intent = Open()->Intents(cut.key).back();
  EXPECT_TRUE(intent.accepted);
  EXPECT_EQ(intent.result, JobResult::kUnknown);
  EXPECT_EQ(intent.because, "it jumped");
}

TEST_F(JournalTest, EverythingSurvivesARestart) {
  {
    auto journal = Open();
    EXPECT_TRUE(*journal->AddCut(Cut(1)));
    EXPECT_FALSE(*journal->AddCut(Cut(1)));
    EXPECT_TRUE(*journal->AddCut(Cut(2)));
    EXPECT_TRUE(*journal->AddCut(Cut(1, "robot")));
    ASSERT_TRUE(journal->AddIntent(MakeIntent(Cut(1).key, 3)).ok());
    ASSERT_TRUE(journal->AddResult("saw", 3, JobResult::kInterruptedBefore, 0.5).ok());
    ASSERT_TRUE(journal->AddIntent(MakeIntent(Cut(1).key, 4)).ok());
    ASSERT_TRUE(journal->AddResult("saw", 4, JobResult::kDone, 6.5).ok());
    ASSERT_TRUE(journal->AddReport(Cut(1).key, CutOutcome::kDone, "", 6.5).ok());
    ASSERT_TRUE(journal->AddIntent(MakeIntent(Cut(2).key, 5)).ok());
  }
  auto journal = Open();
  EXPECT_EQ(journal->HighestNumber("saw"), 5u);
  EXPECT_EQ(journal->HighestNumber("robot"), 0u);
  const auto open = journal->OpenCuts("saw");
  ASSERT_EQ(open.size(), 1u);
  EXPECT_EQ(open[0].key, Cut(2).key);
  EXPECT_EQ(open[0].job.part, "part-2");
  EXPECT_DOUBLE_EQ(open[0].job.position, 1.0);
  const auto intents = journal->Intents(Cut(1).key);
  ASSERT_EQ(intents.size(), 2u);
  EXPECT_EQ(intents[0].result, JobResult::kInterruptedBefore);
  EXPECT_EQ(intents[1].result, JobResult::kDone);
  EXPECT_DOUBLE_EQ(intents[1].seconds, 6.5);
  EXPECT_EQ(journal->Intents(Cut(2).key).back().result, JobResult::kNone);
  ASSERT_EQ(journal->UnacknowledgedReports().size(), 1u);
  EXPECT_EQ(journal->NextReportNumber(), 2);
}

TEST_F(JournalTest, ReportsAreKeptUntilAcknowledged) {
  auto journal = Open();
  for (int i = 1; i <= 3; ++i) {
    ASSERT_TRUE(journal->AddCut(Cut(i)).ok());
    const auto report = journal->AddReport(Cut(i).key, CutOutcome::kRejected, "no", 0.0);
    ASSERT_TRUE(report.ok());
    EXPECT_EQ(report->number, i);
  }
  EXPECT_FALSE(journal->AddReport(Cut(3).key, CutOutcome::kDone, "", 0.0).ok());
  EXPECT_EQ(DetailOf(journal->AddAcknowledgement(4)).field, "report_number");
  ASSERT_TRUE(journal->AddAcknowledgement(2).ok());
  ASSERT_TRUE(journal->AddAcknowledgement(1).ok());
  journal.reset();
  journal = Open();
  ASSERT_EQ(journal->UnacknowledgedReports().size(), 1u);
  EXPECT_EQ(journal->UnacknowledgedReports()[0].number, 3);
  EXPECT_EQ(journal->NextReportNumber(), 4);
}

TEST_F(JournalTest, ARejectionNeedsNoCut) {
  auto journal = Open();
  ASSERT_TRUE(journal->AddRejection(Cut(1, "nowhere").key, "no such machine").ok());
  ASSERT_TRUE(journal->AddRejection(Cut(1, "nowhere").key, "no such machine").ok());
  journal.reset();
  journal = Open();
  ASSERT_EQ(journal->UnacknowledgedReports().size(), 1u);
  EXPECT_EQ(journal->UnacknowledgedReports()[0].message, "no such machine");
  EXPECT_FALSE(*journal->AddCut(Cut(1, "nowhere")));
  EXPECT_TRUE(journal->OpenCuts("nowhere").empty());
}

TEST_F(JournalTest, NumbersOnlyGrow) {
  auto journal = Open();
  ASSERT_TRUE(journal->AddCut(Cut(1)).ok());
  ASSERT_TRUE(journal->AdoptNumber("saw", 9).ok());
  EXPECT_FALSE(journal->AddIntent(MakeIntent(Cut(1).key, 9)).ok());
  EXPECT_TRUE(journal->AddIntent(MakeIntent(Cut(1).key, 10)).ok());
  EXPECT_FALSE(journal->AddResult("saw", 9, JobResult::kDone, 1.0).ok());
}

TEST_F(JournalTest, AnAlarmStandsUntilItIsCleared) {
  {
    auto journal = Open();
    EXPECT_EQ(journal->Alarm("saw"), "");
    ASSERT_TRUE(journal->AddAlarm("saw", "it jumped").ok());
    EXPECT_EQ(journal->Alarm("saw"), "it jumped");
    EXPECT_EQ(journal->Alarm("robot"), "");
  }
  const RememberedEcho seen = {9, 3, 5, 4, JobResult::kDone};
  {
    auto journal = Open();
    EXPECT_EQ(journal->Alarm("saw"), "it jumped");
    ASSERT_TRUE(journal->ClearAlarm("saw", seen).ok());
  }
  auto journal = Open();
  EXPECT_EQ(journal->Alarm("saw"), "");
  EXPECT_EQ(journal->LastEcho("saw"), seen);
}

// Bridges from before alarms were kept know no record of an alarm, and read of an adoption only the
// machine and a number that changes nothing unless it is the highest.
TEST_F(JournalTest, AnAlarmIsReadByOlderBridgesAsNothing) {
  {
    auto journal = Open();
    ASSERT_TRUE(journal->AddAlarm("saw", "it jumped").ok());
    ASSERT_TRUE(journal->ClearAlarm("saw", {9, 3, 5, 4, JobResult::kDone}).ok());
  }
  auto log = DurableLog::Open(path_, {});
  ASSERT_TRUE(log.ok());
  const std::vector<std::string> lines = (*log)->TakeLines();
  ASSERT_EQ(lines.size(), 2u);
  for (const std::string& line : lines) {
    EXPECT_THAT(line,
                testing::StartsWith(R"({"type":"adopted","machine":"saw","number":0,"alarm":)"));
  }
}

TEST_F(JournalTest, RemembersWhatTheMachineLastSaid) {
  {
    auto journal = Open();
    EXPECT_EQ(journal->LastEcho("saw"), std::nullopt);
    ASSERT_TRUE(journal->AddCut(Cut(1)).ok());
    ASSERT_TRUE(journal->AddCut(Cut(2)).ok());
    ASSERT_TRUE(journal->AddIntent(MakeIntent(Cut(1).key, 3)).ok());
    ASSERT_TRUE(journal->AddAcceptance("saw", 3).ok());
    ASSERT_TRUE(journal->AddResult("saw", 3, JobResult::kDone, 1.0).ok());
    ASSERT_TRUE(journal->AddIntent(MakeIntent(Cut(2).key, 4)).ok());
    ASSERT_TRUE(journal->AddAcceptance("saw", 4).ok());
  }
  auto journal = Open();
  EXPECT_EQ(journal->LastEcho("saw"), (RememberedEcho{7, 1, 4, 3, JobResult::kDone}));
  // What nobody knows is not remembered.
  ASSERT_TRUE(journal->AddResult("saw", 4, JobResult::kUnknown, 0.0, "it jumped").ok());
  EXPECT_EQ(journal->LastEcho("saw"), (RememberedEcho{7, 1, 4, 3, JobResult::kDone}));
  // Nor what another memory said.
  Intent other = MakeIntent(Cut(2).key, 5);
  other.identity = 8;
  ASSERT_TRUE(journal->AddIntent(other).ok());
  EXPECT_EQ(journal->LastEcho("saw"), (RememberedEcho{8, 1, 0, 0, JobResult::kNone}));
}

TEST_F(JournalTest, ACutThatIsNotANumberNeverReachesTheFile) {
  auto journal = Open();
  CutOrder order = Cut(1);
  order.job.length = std::nan("");
  EXPECT_EQ(DetailOf(journal->AddCut(order).status()).field, "length");
  journal.reset();
  EXPECT_TRUE(Open()->OpenCuts("saw").empty());
}

TEST_F(JournalTest, ARecordThatMakesNoSenseNamesItsLine) {
  for (
      const char* text :
      {"{}", "not json", R"({"type":"other"})", R"({"type":"report","number":5})",
       R"({"type":"intent","work_order":"w","machine":"m","sequence":1,"number":1,"identity":1,"boot_epoch":1})",
       R"({"type":"result","machine":"m","number":1,"result":1,"seconds":1})",
       R"({"type":"acknowledged","number":1e300})", R"({"type":"acknowledged","number":0.5})",
       R"({"type":"adopted","machine":"m","number":4294967296})",
       R"({"type":"adopted","machine":"m","number":-1})",
       R"({"type":"adopted","machine":"m","number":0,"alarm":7})",
       R"({"type":"adopted","machine":"m","number":0,"alarm":""})"}) {
    std::ofstream(path_, std::ios::binary | std::ios::trunc)
        << FormatLogLine(R"({"type":"acknowledged","number":0})") << FormatLogLine(text);
    const auto journal = Journal::Open(path_);
    EXPECT_TRUE(absl::IsDataLoss(journal.status())) << text;
    EXPECT_THAT(std::string(journal.status().message()), testing::HasSubstr("journal:2"));
  }
}

}  // namespace
}  // namespace mortise::hwbridge
