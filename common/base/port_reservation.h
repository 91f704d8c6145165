// Keeps a port on loopback for a process that is yet to start, or starts again.
#pragma once

#include <string>

#include "absl/status/statusor.h"

namespace mortise {

// Holds a port by a bound socket that does not listen: the system then gives the port to nobody who
// asks for any, while a server that asks for this one, with SO_REUSEADDR as servers do, gets it.
class PortReservation {
 public:
  // Port `wanted` of 127.0.0.1, or any that is free for 0. INVALID_ARGUMENT naming `field` if it
  // cannot be had.
  static absl::StatusOr<PortReservation> Take(int wanted, const std::string& field);

  PortReservation(PortReservation&& other) noexcept;
  PortReservation& operator=(PortReservation&& other) noexcept;
  ~PortReservation();

  const std::string& address() const { return address_; }  // "127.0.0.1:port"

 private:
  explicit PortReservation(int socket) : socket_(socket) {}

  int socket_ = -1;
  std::string address_;
};

}  // namespace mortise
