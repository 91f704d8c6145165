// The line to one machine.
#pragma once

#include <cstdint>
#include <span>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "hwbridge/registers/registers.h"

namespace mortise::hwbridge {

// A request that is not answered in time fails with UNAVAILABLE, and then nobody knows whether it
// took effect. A request that the machine refuses fails with FAILED_PRECONDITION, and took none.
// Used by one thread.
class MachineLink {
 public:
  virtual ~MachineLink() = default;

  // Writes holding registers from `address` on, in one request of at most 123 registers.
  virtual absl::Status Write(int address, std::span<const std::uint16_t> values) = 0;

  // INVALID_ARGUMENT if the peer does not speak our register map.
  virtual absl::StatusOr<MachineStatus> ReadStatus() = 0;
};

}  // namespace mortise::hwbridge
