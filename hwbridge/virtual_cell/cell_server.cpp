#include "hwbridge/virtual_cell/cell_server.h"

#include <modbus/modbus.h>
#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/logging.h"

namespace mortise::hwbridge {
namespace {

constexpr int kTickMilliseconds = 5;
constexpr int kMaximumClients = 16;
constexpr int kTcpHeader = 7;  // MBAP header; the function code follows

double MonotonicSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

int Word(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  return (bytes[at] << 8) | bytes[at + 1];
}

}  // namespace

void CellServer::ContextDeleter::operator()(modbus_t* context) const { modbus_free(context); }

void CellServer::MappingDeleter::operator()(modbus_mapping_t* mapping) const {
  modbus_mapping_free(mapping);
}

CellServer::CellServer(const Options& options, std::vector<std::unique_ptr<Machine>> machines)
    : options_(options), machines_(std::move(machines)) {}

CellServer::~CellServer() {
  for (const int client : clients_) ::close(client);
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
  context_.reset(modbus_new_tcp(options_.address.c_str(), options_.port));
  mapping_.reset(modbus_mapping_new(0, 1, holding::kCount, kStatusRegisters));
  if (!context_ || !mapping_) return PeerUnavailable(peer, modbus_strerror(errno));
  // libmodbus sleeps this long before it answers with an exception.
  modbus_set_response_timeout(context_.get(), 0, 1000);
  listener_ = modbus_tcp_listen(context_.get(), kMaximumClients);
  if (listener_ < 0) return PeerUnavailable(peer, modbus_strerror(errno));
  sockaddr_in bound{};
  socklen_t size = sizeof(bound);
  if (::getsockname(listener_, reinterpret_cast<sockaddr*>(&bound), &size) != 0) {
    return PeerUnavailable(peer, std::strerror(errno));
  }
  port_ = ntohs(bound.sin_port);
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
    std::vector<pollfd> waiting = {{signals, POLLIN, 0}, {listener_, POLLIN, 0}};
    for (const int client : clients_) waiting.push_back({client, POLLIN, 0});
    if (::poll(waiting.data(), waiting.size(), kTickMilliseconds) < 0 && errno != EINTR) {
      return PeerUnavailable("virtual cell", std::strerror(errno));
    }
    AdvanceMachines();
    if (waiting[0].revents != 0 && !TakeSignal(signals)) return absl::OkStatus();
    std::vector<int> kept;
    for (std::size_t i = 2; i < waiting.size(); ++i) {
      if (waiting[i].revents == 0 || Serve(waiting[i].fd)) {
        kept.push_back(waiting[i].fd);
      } else {
        ::close(waiting[i].fd);
      }
    }
    clients_ = std::move(kept);
    if (waiting[1].revents != 0) {
      const int client = ::accept(listener_, nullptr, nullptr);
      if (client >= 0 && clients_.size() < kMaximumClients)
        clients_.push_back(client);
      else if (client >= 0)
        ::close(client);
    }
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

// Reads one request and answers it. Returns false when the client is gone.
bool CellServer::Serve(int client) {
  modbus_set_socket(context_.get(), client);
  Request request;
  request.bytes.resize(MODBUS_TCP_MAX_ADU_LENGTH);
  const int length = modbus_receive(context_.get(), request.bytes.data());
  if (length < 0) return false;
  if (length <= kTcpHeader) return true;
  request.bytes.resize(static_cast<std::size_t>(length));
  request.unit = request.bytes[kTcpHeader - 1];
  request.function = request.bytes[kTcpHeader];
  if (request.unit < 1 || request.unit > static_cast<int>(machines_.size())) {
    return Reply(request, MODBUS_EXCEPTION_GATEWAY_TARGET);
  }
  Machine& machine = *machines_[static_cast<std::size_t>(request.unit - 1)];
  int exception = 0;
  switch (request.function) {
    case MODBUS_FC_READ_DISCRETE_INPUTS:
    case MODBUS_FC_READ_HOLDING_REGISTERS:
    case MODBUS_FC_READ_INPUT_REGISTERS:
      break;
    case MODBUS_FC_WRITE_SINGLE_REGISTER:
    case MODBUS_FC_WRITE_MULTIPLE_REGISTERS:
      exception = WriteRegisters(machine, request);
      break;
    default:
      exception = MODBUS_EXCEPTION_ILLEGAL_FUNCTION;
  }
  Publish(machine);
  return Reply(request, exception);
}

// Returns the Modbus exception, 0 if the machine took the values.
int CellServer::WriteRegisters(Machine& machine, const Request& request) {
  const auto& bytes = request.bytes;
  constexpr std::size_t kBody = kTcpHeader + 1;
  if (bytes.size() < kBody + 4) return MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE;
  const int address = Word(bytes, kBody);
  std::vector<std::uint16_t> values;
  if (request.function == MODBUS_FC_WRITE_SINGLE_REGISTER) {
    values.push_back(static_cast<std::uint16_t>(Word(bytes, kBody + 2)));
  } else {
    const std::size_t count = static_cast<std::size_t>(Word(bytes, kBody + 2));
    if (count < 1 || count > MODBUS_MAX_WRITE_REGISTERS || bytes.size() < kBody + 5 + 2 * count ||
        bytes[kBody + 4] != 2 * count) {
      return MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE;
    }
    for (std::size_t i = 0; i < count; ++i) {
      values.push_back(static_cast<std::uint16_t>(Word(bytes, kBody + 5 + 2 * i)));
    }
  }
  return static_cast<int>(machine.Write(address, values));
}

// Lays the machine's registers out for libmodbus to answer from.
void CellServer::Publish(const Machine& machine) {
  const auto held = machine.HoldingRegisters();
  std::copy(held.begin(), held.end(), mapping_->tab_registers);
  const MachineStatus status = machine.Status();
  const StatusRegisters registers = EncodeStatus(status);
  std::copy(registers.begin(), registers.end(), mapping_->tab_input_registers);
  mapping_->tab_input_bits[0] = status.emergency_stop ? 1 : 0;
}

bool CellServer::Reply(const Request& request, int exception) {
  if (options_.delay > 0.0) {
    std::this_thread::sleep_for(std::chrono::duration<double>(options_.delay));
  }
  ++answers_;
  if (options_.drop_response_every > 0 && answers_ % options_.drop_response_every == 0) return true;
  const int length = static_cast<int>(request.bytes.size());
  const int sent = exception != 0
                       ? modbus_reply_exception(context_.get(), request.bytes.data(),
                                                static_cast<unsigned>(exception))
                       : modbus_reply(context_.get(), request.bytes.data(), length, mapping_.get());
  return sent >= 0;
}

}  // namespace mortise::hwbridge
