// The Modbus TCP door of the virtual cell: several machines behind one port, told apart by unit id.
//
// No connection waits for another: a request that has half arrived, an answer that is not fetched
// and one that is delayed wait by themselves. Connections are few, and a place is always free for
// the next one: the one that has asked nothing for the longest time makes way.
#pragma once

#include <poll.h>

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "hwbridge/virtual_cell/machine.h"
#include "hwbridge/virtual_cell/modbus_frame.h"

namespace mortise::hwbridge {

class CellServer {
 public:
  struct Options {
    std::string address = "127.0.0.1";  // numeric IPv4
    int port = 0;                       // 0: the system chooses
    double time_scale = 1.0;            // simulated seconds in a real one
    int connections = 16;               // at once
    double idle_timeout = 60.0;         // s without a whole request, then a connection is closed
    int drop_response_every = 0;        // fault injection: every n-th answer is lost; 0: none
    double delay = 0.0;                 // fault injection: s before each answer
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
  struct Answer {
    double due = 0.0;  // s on the monotonic clock
    std::vector<std::uint8_t> bytes;
  };
  struct Connection {
    int socket = -1;
    FrameReader reader;
    std::deque<Answer> answers;
    bool has_asked = false;     // a whole request
    double last_request = 0.0;  // s on the monotonic clock; of its beginning before the first
    bool closed = false;
  };

  CellServer(const Options& options, std::vector<std::unique_ptr<Machine>> machines);
  absl::Status Open();
  void AdvanceMachines();
  bool TakeSignal(int signals);
  void ServeConnections(const std::vector<pollfd>& events, double now);
  void Receive(Connection& connection, double now);
  void Take(Connection& connection, const ModbusFrame& request, double now);
  void Send(Connection& connection, double now);
  void Accept(double now);
  void MakeRoom();

  Options options_;
  std::vector<std::unique_ptr<Machine>> machines_;
  int listener_ = -1;
  int port_ = 0;
  std::vector<Connection> connections_;
  long answers_ = 0;
  double last_advance_ = 0.0;  // s on the monotonic clock
};

}  // namespace mortise::hwbridge
