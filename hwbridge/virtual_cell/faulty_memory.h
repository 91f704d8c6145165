// Fault injection: a machine memory that takes the power away at the worst moments.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "hwbridge/virtual_cell/machine_memory.h"

namespace mortise::hwbridge {

// Passes everything on to `inner`, and calls `crash`, which does not return, where asked.
class FaultyMemory : public MachineMemory {
 public:
  struct Options {
    bool crash_after_accept = false;  // once a new number is remembered, before it is answered
    bool crash_after_cut = false;     // once the material is cut, before that is remembered
    std::function<void()> crash;      // ends the process, or throws in a test
  };

  FaultyMemory(std::unique_ptr<MachineMemory> inner, Options options);
  absl::StatusOr<MachineRecord> Load() override;
  absl::Status Store(const MachineRecord& record) override;
  absl::Status MakeCut(const Cut& cut) override;
  absl::StatusOr<Cut> LastCut() override { return inner_->LastCut(); }
  absl::StatusOr<std::uint32_t> CutCount() override { return inner_->CutCount(); }

 private:
  std::unique_ptr<MachineMemory> inner_;
  Options options_;
  std::uint32_t accepted_ = 0;
};

}  // namespace mortise::hwbridge
