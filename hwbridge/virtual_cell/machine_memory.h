// What a virtual machine remembers through a power loss, and the material it cuts.
//
// A real machine keeps its sequence numbers in retentive memory and has a sensor behind the blade
// that tells whether the last cut went through. The virtual machine keeps both in files: the
// memory, and the cut record, which stands for the material itself and is the ground truth of the
// tests.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "hwbridge/registers/registers.h"

namespace mortise::hwbridge {

// The retentive memory of one machine.
struct MachineRecord {
  std::uint32_t identity = 0;
  std::uint32_t boot_epoch = 0;
  std::uint32_t accepted = 0;
  std::uint32_t done = 0;
  JobResult result = JobResult::kNone;
  double seconds = 0.0;           // s, of the job `done`
  std::optional<Job> open_job;    // accepted, not ended
  bool tool_in_material = false;  // the open job's cut has begun
};

// One cut that was really made.
struct Cut {
  std::string machine;  // "chop-saw" or "jigsaw"
  std::uint32_t sequence_number = 0;
  std::string part;
  std::string stock;
  double length = 0.0;  // m: of the part cut off, or of the outline
};

class MachineMemory {
 public:
  virtual ~MachineMemory() = default;

  // A fresh record with a new identity where there is none yet.
  virtual absl::StatusOr<MachineRecord> Load() = 0;

  // Returns after `record` is safe on disk.
  virtual absl::Status Store(const MachineRecord& record) = 0;

  // Cuts the material; after this returns the cut is made for good.
  virtual absl::Status MakeCut(const Cut& cut) = 0;

  // What the sensor behind the blade says: the number of the last cut (0 if none), and their count.
  virtual absl::StatusOr<Cut> LastCut() = 0;
  virtual absl::StatusOr<std::uint32_t> CutCount() = 0;
};

// Memory in the file `state` and cuts as lines of JSON appended to `cut_record`. Several machines
// may share the cut record; `machine` names this one in it.
class FileMachineMemory : public MachineMemory {
 public:
  FileMachineMemory(std::string machine, std::filesystem::path state,
                    std::filesystem::path cut_record);
  absl::StatusOr<MachineRecord> Load() override;
  absl::Status Store(const MachineRecord& record) override;
  absl::Status MakeCut(const Cut& cut) override;
  absl::StatusOr<Cut> LastCut() override;
  absl::StatusOr<std::uint32_t> CutCount() override;

 private:
  std::string machine_;
  std::filesystem::path state_;
  std::filesystem::path cut_record_;
};

// Reads a cut record; no cuts where the file is missing, DATA_LOSS naming the line that is damaged.
absl::StatusOr<std::vector<Cut>> ReadCutRecord(const std::filesystem::path& path);

}  // namespace mortise::hwbridge
