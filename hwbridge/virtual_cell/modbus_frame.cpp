#include "hwbridge/virtual_cell/modbus_frame.h"

#include <iterator>

namespace mortise::hwbridge {
namespace {

constexpr std::size_t kHeader = 7;  // with the unit
constexpr std::size_t kBeforeLength = 6;
constexpr std::size_t kLongest = 254;  // of what the length counts: unit and data unit
constexpr std::size_t kShortest = 2;

std::uint16_t Word(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  return static_cast<std::uint16_t>((bytes[at] << 8) | bytes[at + 1]);
}

void Put(std::vector<std::uint8_t>& bytes, std::size_t word) {
  bytes.push_back(static_cast<std::uint8_t>(word >> 8));
  bytes.push_back(static_cast<std::uint8_t>(word & 0xff));
}

}  // namespace

void FrameReader::Add(std::span<const std::uint8_t> bytes) {
  if (!broken_) bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

std::optional<ModbusFrame> FrameReader::Next() {
  while (!broken_ && bytes_.size() >= kBeforeLength) {
    const std::uint16_t protocol = Word(bytes_, 2);
    const std::size_t length = Word(bytes_, 4);
    if (length < kShortest || length > kLongest) {
      broken_ = true;
      bytes_.clear();
      return std::nullopt;
    }
    if (bytes_.size() < kBeforeLength + length) return std::nullopt;
    const auto end = bytes_.begin() + static_cast<std::ptrdiff_t>(kBeforeLength + length);
    ModbusFrame frame{Word(bytes_, 0),
                      bytes_[kHeader - 1],
                      {bytes_.begin() + static_cast<std::ptrdiff_t>(kHeader), end}};
    bytes_.erase(bytes_.begin(), end);
    if (protocol == 0) return frame;
  }
  return std::nullopt;
}

std::vector<std::uint8_t> EncodeFrame(const ModbusFrame& frame) {
  std::vector<std::uint8_t> bytes;
  Put(bytes, frame.transaction);
  Put(bytes, 0);
  Put(bytes, frame.pdu.size() + 1);
  bytes.push_back(frame.unit);
  bytes.insert(bytes.end(), frame.pdu.begin(), frame.pdu.end());
  return bytes;
}

}  // namespace mortise::hwbridge
