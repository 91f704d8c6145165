// Says which process has a port of this machine, to somebody who cannot have it.
#pragma once

#include <string>

namespace mortise::cli {

// Returns "mortise-gateway (process 4711)", which listens on a TCP port of this machine: on
// loopback or everywhere. Empty where nobody does, or where it is somebody's whose processes the
// caller may not look at. Source: /proc/net/tcp, /proc/net/tcp6 and /proc/PID/fd of Linux.
std::string PortHolder(int port);

}  // namespace mortise::cli
