// Registers from any peer are decoded or refused; a machine takes any sequence of writes.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <vector>

#include "hwbridge/registers/registers.h"
#include "hwbridge/virtual_cell/machine.h"
#include "tests/unit/hwbridge/cutting/simulated_cell.h"

namespace {

using namespace mortise::hwbridge;

void DecodeEverything(std::span<const std::uint16_t> registers) {
  const auto status = DecodeStatus(registers);
  if (status.ok() && !DecodeStatus(EncodeStatus(*status)).ok()) std::abort();
  (void)DecodeOutlinePage(registers);
  const std::vector<OutlinePoint> outline(8);
  const auto job = DecodeJob(registers, outline, 1);
  if (job.ok() && job->outline.size() > outline.size()) std::abort();
}

// Reads the input as requests: address, count, values.
void WriteEverything(std::span<const std::uint16_t> input) {
  World world;
  auto machine = Machine::Start({}, std::make_unique<SimulatedMemory>(world));
  while (input.size() >= 2) {
    const int address = input[0] % 200;
    const std::size_t count = std::min<std::size_t>(input[1] % 123 + 1, input.size() - 2);
    (void)(*machine)->Write(address, input.subspan(2, count));
    (*machine)->Advance(1.0, 0.1);
    (void)EncodeStatus((*machine)->Status());
    input = input.subspan(2 + count);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::uint16_t> registers;
  for (std::size_t i = 0; i + 1 < size; i += 2) {
    registers.push_back(static_cast<std::uint16_t>((data[i] << 8) | data[i + 1]));
  }
  DecodeEverything(registers);
  WriteEverything(registers);
  return 0;
}
