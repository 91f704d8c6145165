#include "hwbridge/virtual_cell/cell_server.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "hwbridge/virtual_cell/modbus_answer.h"

namespace mortise::hwbridge {
namespace {

constexpr int kTickMilliseconds = 5;
constexpr std::size_t kBytesAtOnce = 1024;
constexpr std::size_t kAnswersWaiting = 16;  // of one connection, before it is not read any more

double MonotonicSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

bool WouldBlock(int error) { return error == EAGAIN || error == EWOULDBLOCK || error == EINTR; }

}  // namespace

CellServer::CellServer(const Options& options, std::vector<std::unique_ptr<Machine>> machines)
    : options_(options), machines_(std::move(machines)) {}

CellServer::~CellServer() {
  for (const Connection& connection : connections_) ::close(connection.socket);
  if (listener_ >= 0) ::close(listener_);
}

absl::StatusOr<std::unique_ptr<CellServer>> CellServer::Listen(
    const Options& options, std::vector<std::unique_ptr<Machine>> machines) {
  std::unique_ptr<CellServer> server(new CellServer(options, std::move(machines)));
  if (absl::Status status = server->Open(); !status.ok()) return status;
  return server;
}

absl::Status CellServer::Open() {
  const std::string peer = absl::StrCat(options_.address, ":", options_.port);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(options_.port));
  if (::inet_pton(AF_INET, options_.address.c_str(), &address.sin_addr) != 1) {
    return InvalidField("address", "must be a numeric IPv4 address");
  }
  listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int yes = 1;
  socklen_t size = sizeof(address);
  const bool listens = listener_ >= 0 &&
                       ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes)) == 0 &&
                       ::bind(listener_, reinterpret_cast<const sockaddr*>(&address), size) == 0 &&
                       ::listen(listener_, options_.connections) == 0 &&
                       ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) == 0;
  if (!listens) return PeerUnavailable(peer, std::strerror(errno));
  port_ = ntohs(address.sin_port);
  last_advance_ = MonotonicSeconds();
  return absl::OkStatus();
}

void CellServer::AdvanceMachines() {
  const double now = MonotonicSeconds();
  const double real = now - last_advance_;
  last_advance_ = now;
  for (const auto& machine : machines_) machine->Advance(real * options_.time_scale, real);
}

absl::Status CellServer::Run(int signals) {
  while (true) {
    std::vector<pollfd> events = {{signals, POLLIN, 0}, {listener_, POLLIN, 0}};
    for (const Connection& connection : connections_) {
      // One that does not fetch its answers asks no more.
      const bool listen = connection.answers.size() < kAnswersWaiting;
      events.push_back({connection.socket, static_cast<short>(listen ? POLLIN : 0), 0});
    }
    if (::poll(events.data(), events.size(), kTickMilliseconds) < 0 && errno != EINTR) {
      return PeerUnavailable("virtual cell", std::strerror(errno));
    }
    AdvanceMachines();
    if (events[0].revents != 0 && !TakeSignal(signals)) return absl::OkStatus();
    const double now = MonotonicSeconds();
    ServeConnections(events, now);
    if (events[1].revents != 0) Accept(now);
  }
}

// Returns false when the cell shall end.
bool CellServer::TakeSignal(int signals) {
  signalfd_siginfo info{};
  if (::read(signals, &info, sizeof(info)) != sizeof(info)) return true;
  if (info.ssi_signo != SIGUSR1 && info.ssi_signo != SIGUSR2) return false;
  for (const auto& machine : machines_) machine->SetEmergencyStop(info.ssi_signo == SIGUSR1);
  return true;
}

// `events` has two more in front of those of the connections.
void CellServer::ServeConnections(const std::vector<pollfd>& events, double now) {
  for (std::size_t i = 0; i < connections_.size(); ++i) {
    Connection& connection = connections_[i];
    if (events[i + 2].revents != 0) Receive(connection, now);
    Send(connection, now);
    if (now - connection.last_request > options_.idle_timeout) connection.closed = true;
  }
  std::erase_if(connections_, [](const Connection& connection) {
    if (connection.closed) ::close(connection.socket);
    return connection.closed;
  });
}

void CellServer::Receive(Connection& connection, double now) {
  std::array<std::uint8_t, kBytesAtOnce> bytes;
  const ssize_t count = ::recv(connection.socket, bytes.data(), bytes.size(), 0);
  if (count <= 0) {
    connection.closed = count == 0 || !WouldBlock(errno);
    return;
  }
  connection.reader.Add(std::span(bytes).first(static_cast<std::size_t>(count)));
  while (const auto request = connection.reader.Next()) Take(connection, *request, now);
  if (connection.reader.broken()) connection.closed = true;
}

void CellServer::Take(Connection& connection, const ModbusFrame& request, double now) {
  connection.has_asked = true;
  connection.last_request = now;
  ModbusFrame answer{request.transaction, request.unit, {}};
  if (request.unit < 1 || request.unit > machines_.size()) {
    answer.pdu = ExceptionAnswer(request.pdu[0], ModbusException::kNoSuchUnit);
  } else {
    answer.pdu = AnswerTo(request.pdu, *machines_[request.unit - 1]);
  }
  ++answers_;
  if (options_.drop_response_every > 0 && answers_ % options_.drop_response_every == 0) return;
  connection.answers.push_back({now + options_.delay, EncodeFrame(answer)});
}

// As much as is due and the peer takes.
void CellServer::Send(Connection& connection, double now) {
  while (!connection.closed && !connection.answers.empty()) {
    Answer& answer = connection.answers.front();
    if (answer.due > now) return;
    const ssize_t sent =
        ::send(connection.socket, answer.bytes.data(), answer.bytes.size(), MSG_NOSIGNAL);
    if (sent < 0) {
      connection.closed = !WouldBlock(errno);
      return;
    }
    answer.bytes.erase(answer.bytes.begin(), answer.bytes.begin() + sent);
    if (!answer.bytes.empty()) return;
    connection.answers.pop_front();
  }
}

void CellServer::Accept(double now) {
  const int socket = ::accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (socket < 0) {
    if (errno == EMFILE || errno == ENFILE) MakeRoom();
    return;
  }
  if (connections_.size() >= static_cast<std::size_t>(options_.connections)) MakeRoom();
  const int yes = 1;
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
  Connection& connection = connections_.emplace_back();
  connection.socket = socket;
  connection.last_request = now;
}

// Closes the connection that is missed least: one that never asked anything, else the one that has
// asked nothing for the longest time.
void CellServer::MakeRoom() {
  const auto idlest = std::min_element(
      connections_.begin(), connections_.end(), [](const Connection& a, const Connection& b) {
        return std::tie(a.has_asked, a.last_request) < std::tie(b.has_asked, b.last_request);
      });
  if (idlest == connections_.end()) return;
  ::close(idlest->socket);
  connections_.erase(idlest);
}

}  // namespace mortise::hwbridge
