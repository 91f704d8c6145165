#include "common/base/port_reservation.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise {

absl::StatusOr<PortReservation> PortReservation::Take(int wanted, const std::string& field) {
  PortReservation reservation(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (reservation.socket_ < 0) return absl::InternalError(std::strerror(errno));
  const int reuse = 1;
  ::setsockopt(reservation.socket_, SOL_SOCKET, SO_REUSEADDR, &reuse, sizeof reuse);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(wanted));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof address;
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  if (::bind(reservation.socket_, generic, length) != 0 ||
      ::getsockname(reservation.socket_, generic, &length) != 0) {
    return InvalidField(field,
                        absl::StrCat("port ", wanted, " cannot be used: ", std::strerror(errno)));
  }
  reservation.address_ = absl::StrCat("127.0.0.1:", ntohs(address.sin_port));
  return reservation;
}

PortReservation::PortReservation(PortReservation&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)), address_(std::move(other.address_)) {}

PortReservation& PortReservation::operator=(PortReservation&& other) noexcept {
  std::swap(socket_, other.socket_);
  std::swap(address_, other.address_);
  return *this;
}

PortReservation::~PortReservation() {
  if (socket_ >= 0) ::close(socket_);
}

}  // namespace mortise
