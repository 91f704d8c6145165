// The Modbus register map shared by every machine of a cell, and its encoding.
//
// The same map is documented for machine builders in docs/protocol/modbus-registers.md. Numbers
// wider than a register are stored high word first. Addresses count from zero, as on the wire.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "hwbridge/registers/packml.h"

namespace mortise::hwbridge {

inline constexpr std::uint16_t kRegisterMapVersion = 1;

// Holding registers, written by the controller.
namespace holding {
inline constexpr int kControllerHeartbeat = 0;  // any change tells that the controller lives
inline constexpr int kCommand = 1;              // a PackMlCommand
inline constexpr int kCommandRequest = 2;       // 1: carry out kCommand; the machine sets it to 0
inline constexpr int kJob = 16;                 // the job block, kJobRegisters long
inline constexpr int kSequenceNumber = 56;      // two registers, written last and in one request
inline constexpr int kOutlinePage = 64;         // page number, then 30 points of two int32
inline constexpr int kCount = 185;

// Whether the map has all of these registers, without a gap between them.
bool HasAll(int address, int count);
}  // namespace holding

// The job block: kind, position and length (µm, uint32 each), number of outline points, outline
// checksum (uint32), label of the part (16 registers), label of the stock (8), job checksum
// (uint32).
inline constexpr int kJobRegisters = 34;
inline constexpr int kPartLabelLength = 32;   // bytes, zero padded
inline constexpr int kStockLabelLength = 16;  // bytes, zero padded
inline constexpr int kPointsPerPage = 30;     // fits one write of 123 registers
inline constexpr int kMaximumOutlinePoints = 4096;
inline constexpr double kMaximumCoordinate = 100.0;  // m, of lengths and outline points

// Input registers, written by the machine.
inline constexpr int kStatusRegisters = 22;
using StatusRegisters = std::array<std::uint16_t, kStatusRegisters>;

enum class MachineKind : std::uint16_t { kChopSaw = 1, kJigsaw = 2 };

// "chop-saw" or "jigsaw".
std::string MachineKindName(MachineKind kind);

// What became of the last sequence number. Every number that was accepted ends with one of these.
enum class JobResult : std::uint16_t {
  kNone = 0,               // nothing is done yet
  kDone = 1,               // the cut was made
  kChecksumMismatch = 2,   // refused, nothing cut: the parameters do not fit the checksum
  kParametersRefused = 3,  // refused, nothing cut: outside what the machine can do
  kWrongState = 4,         // refused, nothing cut: the machine is not in Execute
  kInterruptedBefore = 5,  // stopped before the tool touched the material
  kInterruptedDuring = 6,  // stopped with the tool in the material: a person must look
  kUnknown = 100,          // never on the wire: the bridge's word when a machine lost its memory
};

std::string JobResultName(JobResult result);

enum class HoldReason : std::uint16_t {
  kNone = 0,
  kCommand = 1,
  kControllerLost = 2,  // the controller's heartbeat stopped
  kEmergencyStop = 3,
  kRestarted = 4,  // the machine restarted with an unfinished job
};
std::string HoldReasonName(HoldReason reason);

// One snapshot of a machine, read in one request.
struct MachineStatus {
  MachineKind kind = MachineKind::kChopSaw;
  std::uint32_t identity = 0;    // drawn once, when the machine's memory was made
  std::uint32_t boot_epoch = 0;  // grows by one at each start of the machine
  std::uint16_t heartbeat = 0;
  PackMlState state = PackMlState::kStopped;
  bool emergency_stop = false;
  HoldReason hold_reason = HoldReason::kNone;
  std::uint32_t accepted = 0;           // the highest sequence number the machine has seen
  std::uint32_t done = 0;               // the last sequence number that ended
  JobResult result = JobResult::kNone;  // of `done`
  double progress = 0.0;                // of the running job, 0 to 1
  std::uint32_t cuts = 0;               // cuts made since the machine's memory was made
  double heartbeat_timeout = 0.0;       // s, after which the machine holds by itself
  double seconds = 0.0;                 // s on the machine's clock that the job `done` took
};

struct OutlinePoint {
  double x = 0.0;  // m
  double y = 0.0;  // m
  bool operator==(const OutlinePoint&) const = default;
};

// The length of a closed polygon, in metres.
double OutlineLength(std::span<const OutlinePoint> outline);

// One cut. On the wire lengths and coordinates are whole micrometres.
struct Job {
  MachineKind kind = MachineKind::kChopSaw;
  std::string part;                   // label; the first 32 bytes are sent
  std::string stock;                  // label of the board or sheet; the first 16 bytes are sent
  double position = 0.0;              // m, chop saw: from the board's front end to the cut
  double length = 0.0;                // m, chop saw: length of the part cut off
  std::vector<OutlinePoint> outline;  // jigsaw: closed polygon, the last point joins the first
};

// A job as the controller writes it: pages of the outline window, then the job block.
struct EncodedJob {
  std::vector<std::vector<std::uint16_t>> outline_pages;  // page number followed by coordinates
  std::array<std::uint16_t, kJobRegisters> registers{};
};

// INVALID_ARGUMENT naming the field where a value is not finite or does not fit its registers.
// The job checksum covers `sequence_number` too, so that parameters of one job can never be taken
// for those of another.
absl::StatusOr<EncodedJob> EncodeJob(const Job& job, std::uint32_t sequence_number);

// The job block and outline as the machine holds them. `outline` has at least as many points as the
// block says. INVALID_ARGUMENT: the kind is unknown or the outline shorter than promised;
// DATA_LOSS: a checksum does not fit.
absl::StatusOr<Job> DecodeJob(std::span<const std::uint16_t> registers,
                              std::span<const OutlinePoint> outline, std::uint32_t sequence_number);

// The points of one page as written to the outline window. INVALID_ARGUMENT past the last page or
// with an odd number of coordinates.
struct OutlinePage {
  int first_point = 0;
  std::vector<OutlinePoint> points;
};
absl::StatusOr<OutlinePage> DecodeOutlinePage(std::span<const std::uint16_t> registers);

StatusRegisters EncodeStatus(const MachineStatus& status);

// INVALID_ARGUMENT naming the register when the values are not those of this map.
absl::StatusOr<MachineStatus> DecodeStatus(std::span<const std::uint16_t> registers);

// Two registers, high word first.
std::array<std::uint16_t, 2> SplitWords(std::uint32_t value);
std::uint32_t JoinWords(std::uint16_t high, std::uint16_t low);

}  // namespace mortise::hwbridge
