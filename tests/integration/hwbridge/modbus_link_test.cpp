// The line to a machine that answers slower than anybody may wait.
#include "hwbridge/cutting/modbus_link.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <thread>
#include <vector>

namespace mortise::hwbridge {
namespace {

// Answers the first request with a sound status, a byte every 50 ms, until the peer closes.
class DribblingMachine {
 public:
  DribblingMachine() : listener_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    EXPECT_EQ(::bind(listener_, reinterpret_cast<const sockaddr*>(&address), size), 0);
    EXPECT_EQ(::listen(listener_, 1), 0);
    EXPECT_EQ(::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { Serve(); });
  }
  ~DribblingMachine() {
    thread_.join();
    ::close(listener_);
  }
  int port() const { return port_; }
  bool finished() const { return finished_; }

  void Join() {
    thread_.join();
    thread_ = std::thread([] {});
  }

 private:
  void Serve() {
    const int client = ::accept(listener_, nullptr, nullptr);
    std::array<std::uint8_t, 12> request{};
    EXPECT_EQ(::recv(client, request.data(), request.size(), MSG_WAITALL), 12);
    std::vector<std::uint8_t> answer = {request[0], request[1], 0, 0, 0, 47, 1, 4, 44};
    MachineStatus status;
    for (const std::uint16_t value : EncodeStatus(status)) {
      answer.push_back(static_cast<std::uint8_t>(value >> 8));
      answer.push_back(static_cast<std::uint8_t>(value & 0xff));
    }
    std::size_t sent = 0;
    for (; sent < answer.size(); ++sent) {
      pollfd closing{client, POLLIN, 0};
      if (::poll(&closing, 1, 50) != 0) break;
      if (::send(client, &answer[sent], 1, MSG_NOSIGNAL) != 1) break;
    }
    finished_ = sent == answer.size();
    ::close(client);
  }

  int listener_;
  int port_ = 0;
  bool finished_ = false;  // of the thread, read after it ended
  std::thread thread_;
};

TEST(ModbusLink, AWholeAnswerHasToComeInTime) {
  DribblingMachine machine;
  {
    ModbusLink link(
        {.address = "127.0.0.1", .port = machine.port(), .unit = 1, .answer_timeout = 0.3});
    EXPECT_EQ(link.ReadStatus().status().code(), absl::StatusCode::kUnavailable);
  }
  machine.Join();
  EXPECT_FALSE(machine.finished()) << "the link waited for all of it";
}

}  // namespace
}  // namespace mortise::hwbridge
