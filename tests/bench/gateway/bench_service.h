// The service behind the gateway in the benchmark: as little work as possible for each call.
#pragma once

#include <memory>
#include <string>

namespace mortise::gateway {

// Serves until standard input ends, after writing "<plain address> <TLS address>" to standard
// output. The TLS port uses the certificate and key in these files.
int RunBenchService(const std::string& certificate, const std::string& key);

}  // namespace mortise::gateway
