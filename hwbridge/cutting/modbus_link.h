// The line to one machine over Modbus TCP.
#pragma once

#include <memory>
#include <string>

#include "hwbridge/cutting/machine_link.h"

struct _modbus;

namespace mortise::hwbridge {

// Connects when first needed, and again after every failure: an answer that comes too late must not
// be taken for that of a later request.
class ModbusLink : public MachineLink {
 public:
  struct Options {
    std::string address;  // numeric IPv4 address
    int port = 502;
    int unit = 1;                 // 1 to 247
    double answer_timeout = 0.5;  // s
  };

  explicit ModbusLink(const Options& options);
  ~ModbusLink() override;
  absl::Status Write(int address, std::span<const std::uint16_t> values) override;
  absl::StatusOr<MachineStatus> ReadStatus() override;

 private:
  struct ContextDeleter {
    void operator()(_modbus* context) const;
  };
  absl::Status Connect();
  absl::Status Failure(int error);

  Options options_;
  std::string peer_;                                  // for messages
  std::unique_ptr<_modbus, ContextDeleter> context_;  // null while there is no connection
};

}  // namespace mortise::hwbridge
