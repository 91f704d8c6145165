#include "hwbridge/virtual_cell/modbus_answer.h"

#include <cstddef>

namespace mortise::hwbridge {
namespace {

constexpr std::uint8_t kReadDiscreteInputs = 2;
constexpr std::uint8_t kReadHoldingRegisters = 3;
constexpr std::uint8_t kReadInputRegisters = 4;
constexpr std::uint8_t kWriteRegister = 6;
constexpr std::uint8_t kWriteRegisters = 16;

constexpr int kMaxBitsRead = 2000;
constexpr int kMaxRegistersRead = 125;
constexpr int kMaxRegistersWritten = 123;
constexpr std::size_t kShortRequest = 5;  // function, address, count or value

int Word(std::span<const std::uint8_t> bytes, std::size_t at) {
  return (bytes[at] << 8) | bytes[at + 1];
}

// The answer to a read: function, number of bytes, registers.
std::vector<std::uint8_t> Registers(std::uint8_t function,
                                    std::span<const std::uint16_t> registers) {
  std::vector<std::uint8_t> answer = {function, static_cast<std::uint8_t>(2 * registers.size())};
  for (const std::uint16_t value : registers) {
    answer.push_back(static_cast<std::uint8_t>(value >> 8));
    answer.push_back(static_cast<std::uint8_t>(value & 0xff));
  }
  return answer;
}

std::vector<std::uint8_t> Read(std::span<const std::uint8_t> request, const Machine& machine) {
  const std::uint8_t function = request[0];
  const bool bits = function == kReadDiscreteInputs;
  if (request.size() != kShortRequest) {
    return ExceptionAnswer(function, ModbusException::kIllegalValue);
  }
  const int address = Word(request, 1);
  const int count = Word(request, 3);
  if (count < 1 || count > (bits ? kMaxBitsRead : kMaxRegistersRead)) {
    return ExceptionAnswer(function, ModbusException::kIllegalValue);
  }
  const auto first = static_cast<std::size_t>(address);
  const auto size = static_cast<std::size_t>(count);
  if (function == kReadHoldingRegisters && holding::HasAll(address, count)) {
    return Registers(function, machine.HoldingRegisters().subspan(first, size));
  }
  const MachineStatus status = machine.Status();
  if (function == kReadInputRegisters && address + count <= kStatusRegisters) {
    const StatusRegisters registers = EncodeStatus(status);
    return Registers(function, std::span(registers).subspan(first, size));
  }
  // The one discrete input.
  if (bits && address == 0 && count == 1) {
    return {function, 1, static_cast<std::uint8_t>(status.emergency_stop ? 1 : 0)};
  }
  return ExceptionAnswer(function, ModbusException::kIllegalAddress);
}

std::vector<std::uint8_t> Write(std::span<const std::uint8_t> request, Machine& machine) {
  const std::uint8_t function = request[0];
  std::vector<std::uint16_t> values;
  if (function == kWriteRegister && request.size() == kShortRequest) {
    values.push_back(static_cast<std::uint16_t>(Word(request, 3)));
  } else if (function == kWriteRegisters && request.size() > kShortRequest) {
    const int count = Word(request, 3);
    const auto bytes = static_cast<std::size_t>(2 * count);
    const std::size_t begin = kShortRequest + 1;
    if (count < 1 || count > kMaxRegistersWritten || request[kShortRequest] != bytes ||
        request.size() != begin + bytes) {
      return ExceptionAnswer(function, ModbusException::kIllegalValue);
    }
    for (std::size_t at = begin; at < request.size(); at += 2) {
      values.push_back(static_cast<std::uint16_t>(Word(request, at)));
    }
  } else {
    return ExceptionAnswer(function, ModbusException::kIllegalValue);
  }
  const ModbusException exception = machine.Write(Word(request, 1), values);
  if (exception != ModbusException::kNone) return ExceptionAnswer(function, exception);
  return {request.begin(), request.begin() + kShortRequest};
}

}  // namespace

std::vector<std::uint8_t> ExceptionAnswer(std::uint8_t function, ModbusException exception) {
  return {static_cast<std::uint8_t>(function | 0x80), static_cast<std::uint8_t>(exception)};
}

std::vector<std::uint8_t> AnswerTo(std::span<const std::uint8_t> request, Machine& machine) {
  switch (request[0]) {
    case kReadDiscreteInputs:
    case kReadHoldingRegisters:
    case kReadInputRegisters:
      return Read(request, machine);
    case kWriteRegister:
    case kWriteRegisters:
      return Write(request, machine);
    default:
      return ExceptionAnswer(request[0], ModbusException::kIllegalFunction);
  }
}

}  // namespace mortise::hwbridge
