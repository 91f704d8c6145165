// What a server says to somebody who begins to speak TLS. gRPC tells only that a connection ended,
// and not whether the server speaks another way, or takes no more connections.
#pragma once

#include <chrono>
#include <string>

namespace mortise::cli {

enum class TlsAnswer {
  kTls,     // it speaks TLS
  kOther,   // it answers in another way
  kNothing  // it ends the connection, or stays silent
};

// Asks `address` (host:port) once; takes no longer than `patience`.
TlsAnswer AskForTls(const std::string& address, std::chrono::milliseconds patience);

}  // namespace mortise::cli
