// The main program of a worker: a process that asks a service for tasks and listens nowhere.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "common/host/service_options.h"
#include "common/rpc/channel.h"

namespace mortise::rpc {

// What a worker is given to work with. All of it outlives the work.
struct WorkerEnvironment {
  std::string name;                               // unique among the workers
  absl::Duration lease = absl::Seconds(30);       // --lease-seconds
  absl::Duration drain_time = absl::Seconds(10);  // --drain-seconds
  const IdentitySigner* signer = nullptr;         // null in development, and with tokens
  std::map<std::string, std::shared_ptr<grpc::Channel>> channels = {};  // by peer
  // Ends the process, or begins the program anew in its place where it was not asked to end, with
  // all that it does now.
  std::function<void()> break_off = {};
};

struct WorkerProgram {
  std::string name;                // of the service whose program it is: "simulator"
  std::string title;               // one line for --help
  std::vector<std::string> peers;  // whom it calls
  std::function<void(CLI::App&)> add_flags = nullptr;  // of the worker's own; may be empty
  // Works until a stop is requested.
  std::function<absl::Status(const WorkerEnvironment&, const std::stop_token&)> work;
};

// Reads flags (--worker, --worker-name, --lease-seconds, --token-file, and those of services that
// only call), connects to the peers, by --peer or else through --gateway, and works until SIGTERM
// or SIGINT. Returns the exit code: 0 after an orderly end; 1 with a message on standard error if
// it could not begin; 2 for bad flags.
int RunWorkerProgram(int argc, char** argv, const WorkerProgram& program);

// Waits until the channel is connected; false if a stop is requested. Calls alone would not do: one
// that finds no connection fails at once, and a TLS handshake goes on only while somebody waits.
bool AwaitConnection(grpc::Channel& channel, const std::stop_token& stop);

// The same for so long at most.
bool AwaitConnection(grpc::Channel& channel, absl::Duration patience);

}  // namespace mortise::rpc
