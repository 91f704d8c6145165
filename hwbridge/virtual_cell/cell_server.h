// The Modbus TCP door of the virtual cell: several machines behind one port, told apart by unit id.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "hwbridge/virtual_cell/machine.h"

struct _modbus;
struct _modbus_mapping_t;

namespace mortise::hwbridge {

class CellServer {
 public:
  struct Options {
    std::string address = "127.0.0.1";
    int port = 0;                 // 0: the system chooses
    double time_scale = 1.0;      // simulated seconds in a real one
    int drop_response_every = 0;  // fault injection: every n-th answer is lost; 0: none
    double delay = 0.0;           // fault injection: s before each answer
  };

  // Binds and listens. Machine i answers to unit id i + 1. UNAVAILABLE if the port is taken.
  static absl::StatusOr<std::unique_ptr<CellServer>> Listen(
      const Options& options, std::vector<std::unique_ptr<Machine>> machines);
  ~CellServer();
  CellServer(const CellServer&) = delete;
  CellServer& operator=(const CellServer&) = delete;

  int port() const { return port_; }

  // Serves on this thread until `signals`, a signalfd, delivers SIGTERM or SIGINT. SIGUSR1 presses
  // the emergency stop of all machines, SIGUSR2 releases it.
  absl::Status Run(int signals);

 private:
  struct ContextDeleter {
    void operator()(_modbus* context) const;
  };
  struct MappingDeleter {
    void operator()(_modbus_mapping_t* mapping) const;
  };
  struct Request {
    std::vector<std::uint8_t> bytes;  // with its header
    int unit = 0;
    int function = 0;
  };

  CellServer(const Options& options, std::vector<std::unique_ptr<Machine>> machines);
  absl::Status Open();
  void AdvanceMachines();
  bool TakeSignal(int signals);
  bool Serve(int client);
  int WriteRegisters(Machine& machine, const Request& request);
  void Publish(const Machine& machine);
  bool Reply(const Request& request, int exception);

  Options options_;
  std::vector<std::unique_ptr<Machine>> machines_;
  std::unique_ptr<_modbus, ContextDeleter> context_;
  std::unique_ptr<_modbus_mapping_t, MappingDeleter> mapping_;
  int listener_ = -1;
  int port_ = 0;
  std::vector<int> clients_;
  long answers_ = 0;
  double last_advance_ = 0.0;  // s on the monotonic clock
};

}  // namespace mortise::hwbridge
