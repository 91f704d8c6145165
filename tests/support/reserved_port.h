// A port on loopback that stays the test's own, for a server that must be known before it runs, or
// that comes back where it was.
#pragma once

#include <string>

#include "common/base/port_reservation.h"

namespace mortise::testing {

class ReservedPort {
 public:
  const std::string& address() const { return reservation_.address(); }  // "127.0.0.1:port"
  std::string port() const { return address().substr(address().rfind(':') + 1); }

 private:
  // Ends the test if there is none.
  const PortReservation reservation_ = PortReservation::Take(0, "port").value();
};

}  // namespace mortise::testing
