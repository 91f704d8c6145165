// A Modbus server whose registers say what a test wants and never change by themselves, except for
// the heartbeat. It takes whatever is written and does nothing about it.
#pragma once

#include <modbus/modbus.h>
#include <sys/select.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

#include "hwbridge/registers/registers.h"

namespace mortise::hwbridge {

class FixedMachine {
 public:
  // Listens on `port` of loopback.
  FixedMachine(int port, const StatusRegisters& status)
      : context_(modbus_new_tcp("127.0.0.1", port)),
        mapping_(modbus_mapping_new(0, 1, holding::kCount, kStatusRegisters)) {
    std::copy(status.begin(), status.end(), mapping_->tab_input_registers);
    listener_ = modbus_tcp_listen(context_.get(), 4);
    thread_ = std::thread([this] { Serve(); });
  }

  ~FixedMachine() {
    stopping_ = true;
    thread_.join();
    if (listener_ >= 0) ::close(listener_);
  }

  // How often a sequence number was written.
  int numbers() const { return numbers_; }

 private:
  struct Deleter {
    void operator()(modbus_t* context) const { modbus_free(context); }
    void operator()(modbus_mapping_t* mapping) const { modbus_mapping_free(mapping); }
  };

  void Serve() {
    std::vector<int> clients;
    while (!stopping_) {
      fd_set waiting;
      FD_ZERO(&waiting);
      FD_SET(listener_, &waiting);
      for (const int client : clients) FD_SET(client, &waiting);
      timeval tick{0, 10000};
      if (::select(FD_SETSIZE, &waiting, nullptr, nullptr, &tick) <= 0) continue;
      std::erase_if(clients, [&](int client) {
        const bool gone = FD_ISSET(client, &waiting) && !Answer(client);
        if (gone) ::close(client);
        return gone;
      });
      if (!FD_ISSET(listener_, &waiting)) continue;
      int listener = listener_;  // changed by libmodbus where it fails
      const int client = modbus_tcp_accept(context_.get(), &listener);
      if (client >= 0) clients.push_back(client);
    }
    for (const int client : clients) ::close(client);
  }

  // Returns false when the client is gone.
  bool Answer(int client) {
    constexpr int kFunctionAt = 7;
    modbus_set_socket(context_.get(), client);
    std::vector<std::uint8_t> request(MODBUS_TCP_MAX_ADU_LENGTH);
    const int length = modbus_receive(context_.get(), request.data());
    if (length < 0) return false;
    const int address = (request[kFunctionAt + 1] << 8) | request[kFunctionAt + 2];
    const bool writes = request[kFunctionAt] == MODBUS_FC_WRITE_MULTIPLE_REGISTERS;
    if (writes && address == holding::kSequenceNumber) ++numbers_;
    ++mapping_->tab_input_registers[6];  // the heartbeat
    return modbus_reply(context_.get(), request.data(), length, mapping_.get()) >= 0;
  }

  std::unique_ptr<modbus_t, Deleter> context_;
  std::unique_ptr<modbus_mapping_t, Deleter> mapping_;
  int listener_ = -1;
  std::atomic<bool> stopping_{false};
  std::atomic<int> numbers_{0};
  std::thread thread_;
};

}  // namespace mortise::hwbridge
