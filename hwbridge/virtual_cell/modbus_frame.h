// The frames of Modbus TCP as a server reads and writes them: a header of seven bytes (transaction,
// protocol, length, unit), then the protocol data unit, whose first byte is the function.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace mortise::hwbridge {

struct ModbusFrame {
  std::uint16_t transaction = 0;
  std::uint8_t unit = 0;
  std::vector<std::uint8_t> pdu;  // 1 to 253 bytes
};

// Cuts the bytes of one connection, which come in any pieces, into frames.
class FrameReader {
 public:
  void Add(std::span<const std::uint8_t> bytes);

  // The next whole frame. Frames of another protocol than Modbus (identifier 0) are passed over.
  std::optional<ModbusFrame> Next();

  // A length came that no frame has: where the next one begins is not known any more, and no other
  // will be found.
  bool broken() const { return broken_; }

 private:
  std::vector<std::uint8_t> bytes_;  // at most what was added since the last whole frame
  bool broken_ = false;
};

std::vector<std::uint8_t> EncodeFrame(const ModbusFrame& frame);

}  // namespace mortise::hwbridge
