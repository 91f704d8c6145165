#include "hwbridge/registers/registers.h"

#include <algorithm>
#include <boost/crc.hpp>
#include <cmath>
#include <iterator>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::hwbridge {
namespace {

constexpr double kUnitsPerMetre = 1e6;  // micrometres

// Offsets in the job block.
constexpr int kKindAt = 0;
constexpr int kPositionAt = 1;
constexpr int kLengthAt = 3;
constexpr int kPointCountAt = 5;
constexpr int kOutlineChecksumAt = 6;
constexpr int kPartAt = 8;
constexpr int kStockAt = kPartAt + kPartLabelLength / 2;
constexpr int kJobChecksumAt = kStockAt + kStockLabelLength / 2;
static_assert(kJobChecksumAt + 2 == kJobRegisters);

// The checksum of registers in the order of their bytes on the wire.
class RegisterChecksum {
 public:
  void Add(std::uint16_t value) {
    crc_.process_byte(static_cast<unsigned char>(value >> 8));
    crc_.process_byte(static_cast<unsigned char>(value & 0xff));
  }
  void Add(std::uint32_t value) {
    for (const std::uint16_t word : SplitWords(value)) Add(word);
  }
  std::uint32_t Value() const { return crc_.checksum(); }

 private:
  boost::crc_32_type crc_;
};

void Put(std::span<std::uint16_t> registers, int at, std::uint32_t value) {
  const auto words = SplitWords(value);
  registers[at] = words[0];
  registers[at + 1] = words[1];
}

std::uint32_t Get(std::span<const std::uint16_t> registers, int at) {
  return JoinWords(registers[at], registers[at + 1]);
}

// Two bytes of a label to a register, the first in the high half.
void PutLabel(std::span<std::uint16_t> registers, int at, int length, const std::string& label) {
  const int bytes = std::min(static_cast<int>(label.size()), length);
  for (int i = 0; i < bytes; ++i) {
    const auto byte = static_cast<unsigned char>(label[i]);
    registers[at + i / 2] |= static_cast<std::uint16_t>(i % 2 == 0 ? byte << 8 : byte);
  }
}

std::string GetLabel(std::span<const std::uint16_t> registers, int at, int length) {
  std::string label;
  for (int i = 0; i < length; ++i) {
    const std::uint16_t word = registers[at + i / 2];
    const char byte = static_cast<char>(i % 2 == 0 ? word >> 8 : word & 0xff);
    if (byte == '\0') break;
    label.push_back(byte);
  }
  return label;
}

std::int32_t ToUnits(double metres) {
  return static_cast<std::int32_t>(std::lround(metres * kUnitsPerMetre));
}

double ToMetres(std::int32_t units) { return units / kUnitsPerMetre; }

bool Fits(double metres) { return std::isfinite(metres) && std::abs(metres) <= kMaximumCoordinate; }

std::uint32_t OutlineChecksum(std::span<const OutlinePoint> outline) {
  RegisterChecksum checksum;
  for (const OutlinePoint& point : outline) {
    checksum.Add(static_cast<std::uint32_t>(ToUnits(point.x)));
    checksum.Add(static_cast<std::uint32_t>(ToUnits(point.y)));
  }
  return checksum.Value();
}

std::uint32_t JobChecksum(std::span<const std::uint16_t> registers, std::uint32_t sequence_number) {
  RegisterChecksum checksum;
  checksum.Add(sequence_number);
  for (int i = 0; i < kJobChecksumAt; ++i) checksum.Add(registers[i]);
  return checksum.Value();
}

absl::Status CheckJob(const Job& job) {
  if (!Fits(job.position) || job.position < 0.0) {
    return InvalidField("position", "must be between 0 and 100 m");
  }
  if (!Fits(job.length) || job.length < 0.0) {
    return InvalidField("length", "must be between 0 and 100 m");
  }
  if (job.outline.size() > kMaximumOutlinePoints) {
    return TooLarge("outline", absl::StrCat(kMaximumOutlinePoints, " points"));
  }
  for (std::size_t i = 0; i < job.outline.size(); ++i) {
    if (Fits(job.outline[i].x) && Fits(job.outline[i].y)) continue;
    return InvalidField(absl::StrCat("outline[", i, "]"), "must lie within 100 m of the origin");
  }
  return absl::OkStatus();
}

std::vector<std::vector<std::uint16_t>> EncodeOutline(std::span<const OutlinePoint> outline) {
  std::vector<std::vector<std::uint16_t>> pages;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    if (i % kPointsPerPage == 0) pages.push_back({static_cast<std::uint16_t>(i / kPointsPerPage)});
    for (const double coordinate : {outline[i].x, outline[i].y}) {
      const auto words = SplitWords(static_cast<std::uint32_t>(ToUnits(coordinate)));
      pages.back().insert(pages.back().end(), words.begin(), words.end());
    }
  }
  return pages;
}

// Whether each register has one of the values that the map gives it.
absl::Status CheckStatus(std::span<const std::uint16_t> registers) {
  if (registers[0] != kRegisterMapVersion) {
    return InvalidField("status[0]", absl::StrCat("register map ", registers[0], ", not 1"));
  }
  if (registers[1] != 1 && registers[1] != 2) {
    return InvalidField("status[1]", absl::StrCat("unknown kind of machine ", registers[1]));
  }
  if (!IsPackMlState(registers[7])) {
    return InvalidField("status[7]", absl::StrCat("unknown PackML state ", registers[7]));
  }
  if (registers[8] > 1) {
    return InvalidField("status[8]",
                        absl::StrCat("emergency stop is ", registers[8], ", neither 0 nor 1"));
  }
  if (registers[9] > static_cast<std::uint16_t>(HoldReason::kRestarted)) {
    return InvalidField("status[9]", absl::StrCat("unknown hold reason ", registers[9]));
  }
  if (registers[14] > static_cast<std::uint16_t>(JobResult::kInterruptedDuring)) {
    return InvalidField("status[14]", absl::StrCat("unknown result ", registers[14]));
  }
  if (registers[15] > 1000) {
    return InvalidField("status[15]", absl::StrCat("progress is ", registers[15], " of 1000"));
  }
  return absl::OkStatus();
}

}  // namespace

std::array<std::uint16_t, 2> SplitWords(std::uint32_t value) {
  return {static_cast<std::uint16_t>(value >> 16), static_cast<std::uint16_t>(value & 0xffff)};
}

std::uint32_t JoinWords(std::uint16_t high, std::uint16_t low) {
  return (static_cast<std::uint32_t>(high) << 16) | low;
}

bool holding::HasAll(int address, int count) {
  // First and end of each run of registers.
  constexpr std::pair<int, int> kRuns[] = {{kControllerHeartbeat, kCommandRequest + 1},
                                           {kJob, kJob + kJobRegisters},
                                           {kSequenceNumber, kSequenceNumber + 2},
                                           {kOutlinePage, kCount}};
  return count > 0 && std::any_of(std::begin(kRuns), std::end(kRuns), [&](const auto& run) {
           return run.first <= address && address + count <= run.second;
         });
}

std::string MachineKindName(MachineKind kind) {
  return kind == MachineKind::kChopSaw ? "chop-saw" : "jigsaw";
}

std::string JobResultName(JobResult result) {
  switch (result) {
    case JobResult::kNone:
      return "none";
    case JobResult::kDone:
      return "done";
    case JobResult::kChecksumMismatch:
      return "checksum-mismatch";
    case JobResult::kParametersRefused:
      return "parameters-refused";
    case JobResult::kWrongState:
      return "wrong-state";
    case JobResult::kInterruptedBefore:
      return "interrupted-before-cut";
    case JobResult::kInterruptedDuring:
      return "interrupted-during-cut";
    case JobResult::kUnknown:
      return "unknown";
  }
  return absl::StrCat("result ", static_cast<int>(result));
}

std::string HoldReasonName(HoldReason reason) {
  switch (reason) {
    case HoldReason::kNone:
      return "none";
    case HoldReason::kCommand:
      return "command";
    case HoldReason::kControllerLost:
      return "controller-lost";
    case HoldReason::kEmergencyStop:
      return "emergency-stop";
    case HoldReason::kRestarted:
      return "restarted";
  }
  return absl::StrCat("reason ", static_cast<int>(reason));
}

double OutlineLength(std::span<const OutlinePoint> outline) {
  double length = 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const OutlinePoint& next = outline[(i + 1) % outline.size()];
    length += std::hypot(next.x - outline[i].x, next.y - outline[i].y);
  }
  return length;
}

absl::StatusOr<EncodedJob> EncodeJob(const Job& job, std::uint32_t sequence_number) {
  MORTISE_RETURN_IF_ERROR(CheckJob(job));
  EncodedJob encoded;
  encoded.outline_pages = EncodeOutline(job.outline);
  auto& registers = encoded.registers;
  registers[kKindAt] = static_cast<std::uint16_t>(job.kind);
  Put(registers, kPositionAt, static_cast<std::uint32_t>(ToUnits(job.position)));
  Put(registers, kLengthAt, static_cast<std::uint32_t>(ToUnits(job.length)));
  registers[kPointCountAt] = static_cast<std::uint16_t>(job.outline.size());
  Put(registers, kOutlineChecksumAt, OutlineChecksum(job.outline));
  PutLabel(registers, kPartAt, kPartLabelLength, job.part);
  PutLabel(registers, kStockAt, kStockLabelLength, job.stock);
  Put(registers, kJobChecksumAt, JobChecksum(registers, sequence_number));
  return encoded;
}

absl::StatusOr<Job> DecodeJob(std::span<const std::uint16_t> registers,
                              std::span<const OutlinePoint> outline,
                              std::uint32_t sequence_number) {
  if (registers.size() != kJobRegisters) {
    return InvalidField("job",
                        absl::StrCat("has ", registers.size(), " registers, not ", kJobRegisters));
  }
  if (Get(registers, kJobChecksumAt) != JobChecksum(registers, sequence_number)) {
    return absl::DataLossError("the job block does not fit its checksum");
  }
  Job job;
  if (registers[kKindAt] != 1 && registers[kKindAt] != 2) {
    return InvalidField("job.kind", "must be 1 (chop saw) or 2 (jigsaw)");
  }
  job.kind = static_cast<MachineKind>(registers[kKindAt]);
  job.position = Get(registers, kPositionAt) / kUnitsPerMetre;
  job.length = Get(registers, kLengthAt) / kUnitsPerMetre;
  if (registers[kPointCountAt] > outline.size()) {
    return InvalidField("job.outline", "has more points than the machine holds");
  }
  job.outline.assign(outline.begin(), outline.begin() + registers[kPointCountAt]);
  if (Get(registers, kOutlineChecksumAt) != OutlineChecksum(job.outline)) {
    return absl::DataLossError("the outline does not fit its checksum");
  }
  job.part = GetLabel(registers, kPartAt, kPartLabelLength);
  job.stock = GetLabel(registers, kStockAt, kStockLabelLength);
  return job;
}

absl::StatusOr<OutlinePage> DecodeOutlinePage(std::span<const std::uint16_t> registers) {
  if (registers.empty()) return InvalidField("outline_page", "is empty");
  const std::size_t words = registers.size() - 1;
  if (words % 4 != 0 || words > 4 * kPointsPerPage) {
    return InvalidField("outline_page", "must hold up to 30 whole points");
  }
  OutlinePage page;
  page.first_point = registers[0] * kPointsPerPage;
  const int count = static_cast<int>(words / 4);
  if (page.first_point + count > kMaximumOutlinePoints) {
    return InvalidField("outline_page", "lies past the last page");
  }
  for (int i = 0; i < count; ++i) {
    const int at = 1 + 4 * i;
    page.points.push_back({ToMetres(static_cast<std::int32_t>(Get(registers, at))),
                           ToMetres(static_cast<std::int32_t>(Get(registers, at + 2)))});
  }
  return page;
}

StatusRegisters EncodeStatus(const MachineStatus& status) {
  StatusRegisters registers{};
  registers[0] = kRegisterMapVersion;
  registers[1] = static_cast<std::uint16_t>(status.kind);
  Put(registers, 2, status.identity);
  Put(registers, 4, status.boot_epoch);
  registers[6] = status.heartbeat;
  registers[7] = static_cast<std::uint16_t>(status.state);
  registers[8] = status.emergency_stop ? 1 : 0;
  registers[9] = static_cast<std::uint16_t>(status.hold_reason);
  Put(registers, 10, status.accepted);
  Put(registers, 12, status.done);
  registers[14] = static_cast<std::uint16_t>(status.result);
  registers[15] =
      static_cast<std::uint16_t>(std::lround(1000.0 * std::clamp(status.progress, 0.0, 1.0)));
  Put(registers, 16, status.cuts);
  registers[18] = static_cast<std::uint16_t>(
      std::lround(std::clamp(1000.0 * status.heartbeat_timeout, 0.0, 65535.0)));
  Put(registers, 19, static_cast<std::uint32_t>(std::llround(1000.0 * status.seconds)));
  return registers;
}

absl::StatusOr<MachineStatus> DecodeStatus(std::span<const std::uint16_t> registers) {
  if (registers.size() != kStatusRegisters) {
    return InvalidField(
        "status", absl::StrCat("has ", registers.size(), " registers, not ", kStatusRegisters));
  }
  MORTISE_RETURN_IF_ERROR(CheckStatus(registers));
  MachineStatus status;
  status.kind = static_cast<MachineKind>(registers[1]);
  status.identity = Get(registers, 2);
  status.boot_epoch = Get(registers, 4);
  status.heartbeat = registers[6];
  status.state = static_cast<PackMlState>(registers[7]);
  status.emergency_stop = registers[8] != 0;
  status.hold_reason = static_cast<HoldReason>(registers[9]);
  status.accepted = Get(registers, 10);
  status.done = Get(registers, 12);
  status.result = static_cast<JobResult>(registers[14]);
  status.progress = registers[15] / 1000.0;
  status.cuts = Get(registers, 16);
  status.heartbeat_timeout = registers[18] / 1000.0;
  status.seconds = Get(registers, 19) / 1000.0;
  return status;
}

}  // namespace mortise::hwbridge
