#include "hwbridge/virtual_cell/faulty_memory.h"

#include <utility>

namespace mortise::hwbridge {

FaultyMemory::FaultyMemory(std::unique_ptr<MachineMemory> inner, Options options)
    : inner_(std::move(inner)), options_(std::move(options)) {}

absl::StatusOr<MachineRecord> FaultyMemory::Load() {
  absl::StatusOr<MachineRecord> record = inner_->Load();
  if (record.ok()) accepted_ = record->accepted;
  return record;
}

absl::Status FaultyMemory::Store(const MachineRecord& record) {
  absl::Status stored = inner_->Store(record);
  if (options_.crash_after_accept && stored.ok() && record.accepted > accepted_) options_.crash();
  accepted_ = record.accepted;
  return stored;
}

absl::Status FaultyMemory::MakeCut(const Cut& cut) {
  absl::Status made = inner_->MakeCut(cut);
  if (options_.crash_after_cut && made.ok()) options_.crash();
  return made;
}

}  // namespace mortise::hwbridge
