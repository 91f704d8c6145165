#include "hwbridge/cutting/modbus_link.h"

#include <modbus/modbus.h>

#include <cerrno>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::hwbridge {

void ModbusLink::ContextDeleter::operator()(modbus_t* context) const {
  modbus_close(context);
  modbus_free(context);
}

ModbusLink::ModbusLink(const Options& options)
    : options_(options),
      peer_(absl::StrCat(options.address, ":", options.port, " unit ", options.unit)) {}

ModbusLink::~ModbusLink() = default;

absl::Status ModbusLink::Connect() {
  if (context_) return absl::OkStatus();
  std::unique_ptr<modbus_t, ContextDeleter> context(
      modbus_new_tcp(options_.address.c_str(), options_.port));
  if (!context) return PeerUnavailable(peer_, modbus_strerror(errno));
  const double seconds = std::floor(options_.answer_timeout);
  const auto whole = static_cast<std::uint32_t>(seconds);
  const auto micro = static_cast<std::uint32_t>((options_.answer_timeout - seconds) * 1e6);
  modbus_set_response_timeout(context.get(), whole, micro);
  // Without one of its own between bytes, the whole answer has to come in that time: a peer that
  // dribbles must not keep the scan from the heartbeat.
  modbus_set_byte_timeout(context.get(), 0, 0);
  if (modbus_set_slave(context.get(), options_.unit) != 0 || modbus_connect(context.get()) != 0) {
    return PeerUnavailable(peer_, modbus_strerror(errno));
  }
  context_ = std::move(context);
  return absl::OkStatus();
}

absl::Status ModbusLink::Failure(int error) {
  const std::string message = absl::StrCat(peer_, ": ", modbus_strerror(error));
  const bool answered = error >= EMBXILFUN && error <= EMBXGTAR;
  // libmodbus names its exceptions by their distance from a base.
  if (answered && error != EMBXGTAR) {
    return PreconditionFailed("MACHINE_REFUSED", message, peer_);
  }
  context_.reset();
  return PeerUnavailable(peer_, modbus_strerror(error));
}

absl::Status ModbusLink::Write(int address, std::span<const std::uint16_t> values) {
  MORTISE_RETURN_IF_ERROR(Connect());
  const int count = static_cast<int>(values.size());
  const int written = modbus_write_registers(context_.get(), address, count, values.data());
  return written == count ? absl::OkStatus() : Failure(errno);
}

absl::StatusOr<MachineStatus> ModbusLink::ReadStatus() {
  MORTISE_RETURN_IF_ERROR(Connect());
  StatusRegisters registers{};
  const int read =
      modbus_read_input_registers(context_.get(), 0, kStatusRegisters, registers.data());
  if (read != kStatusRegisters) return Failure(errno);
  return DecodeStatus(registers);
}

}  // namespace mortise::hwbridge
