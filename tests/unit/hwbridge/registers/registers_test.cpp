// The register map: what is written is what is read, and damage is noticed.
#include "hwbridge/registers/registers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "common/base/errors.h"
#include "hwbridge/registers/packml.h"
#include "tests/unit/hwbridge/cutting/simulated_cell.h"

namespace mortise::hwbridge {
namespace {

std::vector<OutlinePoint> Received(const EncodedJob& encoded) {
  std::vector<OutlinePoint> outline(kMaximumOutlinePoints);
  for (const auto& registers : encoded.outline_pages) {
    const auto page = DecodeOutlinePage(registers);
    EXPECT_TRUE(page.ok()) << page.status();
    std::copy(page->points.begin(), page->points.end(), outline.begin() + page->first_point);
  }
  return outline;
}

TEST(Registers, JobSurvivesTheWire) {
  Job job = OutlineJob("tabletop", 0.6, 50);
  job.outline[3] = {-0.123456, 1.5};
  const auto encoded = EncodeJob(job, 12);
  ASSERT_TRUE(encoded.ok()) << encoded.status();
  EXPECT_EQ(encoded->outline_pages.size(), 7u);
  for (const auto& page : encoded->outline_pages) EXPECT_LE(page.size(), 123u);
  const auto decoded = DecodeJob(encoded->registers, Received(*encoded), 12);
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_EQ(decoded->kind, MachineKind::kJigsaw);
  EXPECT_EQ(decoded->part, "tabletop");
  EXPECT_EQ(decoded->stock, "sheet-1");
  ASSERT_EQ(decoded->outline.size(), job.outline.size());
  for (std::size_t i = 0; i < job.outline.size(); ++i) {
    EXPECT_NEAR(decoded->outline[i].x, job.outline[i].x, 5e-7);
    EXPECT_NEAR(decoded->outline[i].y, job.outline[i].y, 5e-7);
  }
}

TEST(Registers, CrosscutSurvivesTheWireToTheMicrometre) {
  const auto encoded = EncodeJob(CrosscutJob("leg-1", 1.432101, 0.712345), 1);
  ASSERT_TRUE(encoded.ok());
  const auto decoded = DecodeJob(encoded->registers, {}, 1);
  ASSERT_TRUE(decoded.ok());
  EXPECT_NEAR(decoded->position, 1.432101, 1e-9);
  EXPECT_NEAR(decoded->length, 0.712345, 1e-9);
}

TEST(Registers, EveryDamagedBitAndEveryOtherNumberIsNoticed) {
  const auto encoded = EncodeJob(CrosscutJob("leg-1", 0.7, 0.7), 5);
  ASSERT_TRUE(encoded.ok());
  for (int at = 0; at < kJobRegisters; ++at) {
    for (int bit = 0; bit < 16; ++bit) {
      auto damaged = encoded->registers;
      damaged[at] ^= static_cast<std::uint16_t>(1 << bit);
      EXPECT_TRUE(absl::IsDataLoss(DecodeJob(damaged, {}, 5).status()));
    }
  }
  EXPECT_TRUE(absl::IsDataLoss(DecodeJob(encoded->registers, {}, 4).status()));
}

TEST(Registers, DamagedOutlineIsNoticed) {
  const auto encoded = EncodeJob(OutlineJob("seat", 0.3, 10), 5);
  auto outline = Received(*encoded);
  outline[17].y += 1e-6;
  EXPECT_TRUE(absl::IsDataLoss(DecodeJob(encoded->registers, outline, 5).status()));
}

TEST(Registers, LabelsAreCutToTheirSpace) {
  Job job = CrosscutJob(std::string(50, 'p'), 1, 1);
  job.stock = std::string(50, 's');
  const auto encoded = EncodeJob(job, 1);
  const auto decoded = DecodeJob(encoded->registers, {}, 1);
  ASSERT_TRUE(decoded.ok());
  EXPECT_EQ(decoded->part, std::string(32, 'p'));
  EXPECT_EQ(decoded->stock, std::string(16, 's'));
}

TEST(Registers, RefusesWhatDoesNotFit) {
  for (const double value : {-0.1, 101.0, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(DetailOf(EncodeJob(CrosscutJob("p", 1, value), 1).status()).field, "length");
    EXPECT_EQ(DetailOf(EncodeJob(CrosscutJob("p", value, 1), 1).status()).field, "position");
  }
  Job job = OutlineJob("p", 1, 2);
  job.outline[5].x = std::nan("");
  EXPECT_EQ(DetailOf(EncodeJob(job, 1).status()).field, "outline[5]");
  job.outline.assign(kMaximumOutlinePoints + 1, {0, 0});
  EXPECT_EQ(EncodeJob(job, 1).status().code(), absl::StatusCode::kResourceExhausted);
}

TEST(Registers, StatusSurvivesTheWire) {
  MachineStatus status;
  status.kind = MachineKind::kJigsaw;
  status.identity = 0xdeadbeef;
  status.boot_epoch = 70000;
  status.heartbeat = 65535;
  status.state = PackMlState::kHolding;
  status.emergency_stop = true;
  status.hold_reason = HoldReason::kControllerLost;
  status.accepted = 100001;
  status.done = 100000;
  status.result = JobResult::kInterruptedBefore;
  status.progress = 0.25;
  status.cuts = 99999;
  status.heartbeat_timeout = 2.0;
  status.seconds = 123.456;
  const auto decoded = DecodeStatus(EncodeStatus(status));
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_EQ(EncodeStatus(*decoded), EncodeStatus(status));
  EXPECT_EQ(decoded->accepted, 100001u);
  EXPECT_DOUBLE_EQ(decoded->seconds, 123.456);
}

TEST(Registers, StatusOfAnotherMapIsRefusedAndNamed) {
  const StatusRegisters good = EncodeStatus(MachineStatus{});
  const auto field = [&](int at, std::uint16_t value) {
    StatusRegisters bad = good;
    bad[at] = value;
    return DetailOf(DecodeStatus(bad).status()).field;
  };
  EXPECT_EQ(field(0, 2), "status[0]");
  EXPECT_EQ(field(1, 3), "status[1]");
  EXPECT_EQ(field(7, 18), "status[7]");
  EXPECT_EQ(field(8, 2), "status[8]");
  EXPECT_EQ(field(9, 5), "status[9]");
  EXPECT_EQ(field(14, 7), "status[14]");
  EXPECT_EQ(field(15, 1001), "status[15]");
  EXPECT_FALSE(DecodeStatus(std::span(good).first(5)).ok());
}

TEST(PackMl, EveryCommandKeepsToTheStandard) {
  using enum PackMlState;
  for (std::uint16_t number = 1; number <= 17; ++number) {
    const auto state = static_cast<PackMlState>(number);
    EXPECT_TRUE(IsPackMlState(number));
    const bool aborted = state == kAborted || state == kAborting;
    EXPECT_EQ(AfterCommand(state, PackMlCommand::kAbort), aborted ? state : kAborting);
    if (IsActingState(state)) {
      EXPECT_FALSE(IsActingState(AfterActing(state))) << PackMlStateName(state);
    }
  }
  EXPECT_FALSE(IsPackMlState(0));
  EXPECT_FALSE(IsPackMlState(18));
  EXPECT_EQ(AfterCommand(kAborted, PackMlCommand::kClear), kClearing);
  EXPECT_EQ(AfterCommand(kStopped, PackMlCommand::kReset), kResetting);
  EXPECT_EQ(AfterCommand(kIdle, PackMlCommand::kStart), kStarting);
  EXPECT_EQ(AfterCommand(kStopped, PackMlCommand::kStart), kStopped);
  EXPECT_EQ(AfterCommand(kExecute, PackMlCommand::kHold), kHolding);
  EXPECT_EQ(AfterCommand(kHeld, PackMlCommand::kUnhold), kUnholding);
  EXPECT_EQ(AfterCommand(kAborted, PackMlCommand::kStop), kAborted);
  EXPECT_EQ(PackMlStateName(kExecute), "EXECUTE");
}

}  // namespace
}  // namespace mortise::hwbridge
