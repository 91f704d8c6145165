#include "common/host/worker_program.h"

#include <grpcpp/grpcpp.h>
#include <linux/close_range.h>
#include <semaphore.h>
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <thread>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/logging.h"
#include "common/rpc/token_channel.h"

namespace mortise::rpc {
namespace {

struct WorkerFlags {
  bool worker = true;
  std::string name;
  std::string token_file;
  double lease_seconds = 30;
};

void AddFlags(CLI::App& app, WorkerFlags& flags) {
  app.add_flag("--worker", flags.worker, "work on tasks instead of serving");
  app.add_option("--worker-name", flags.name, "unique name; made up if empty")
      ->envname("MORTISE_WORKER_NAME");
  app.add_option("--token-file", flags.token_file,
                 "file with a bearer token of a designer, for the gateway; read for each call")
      ->envname("MORTISE_TOKEN_FILE");
  app.add_option("--lease-seconds", flags.lease_seconds, "how long a task is lent at a time")
      ->check(CLI::Range(1.0, 3600.0))
      ->envname("MORTISE_LEASE_SECONDS");
}

// A worker is known by a key of the house's or, at the gateway, by a token.
absl::Status CheckAccess(const ServiceOptions& options, const WorkerFlags& flags) {
  const int ways = (options.insecure_development ? 1 : 0) + (options.keys.empty() ? 0 : 1) +
                   (flags.token_file.empty() ? 0 : 1);
  if (ways != 1) {
    return InvalidField("keys",
                        "give one of --keys, --token-file (with --gateway) and, on loopback, "
                        "--insecure-development");
  }
  if (flags.token_file.empty() || options.peers.empty()) return absl::OkStatus();
  return InvalidField("peer", "services take no tokens; --token-file goes with --gateway only");
}

// A peer given by --peer, else the gateway, which knows the way to every service.
absl::StatusOr<std::shared_ptr<grpc::Channel>> ChannelTo(const ServiceOptions& options,
                                                         const WorkerFlags& flags,
                                                         const std::string& peer) {
  if (!flags.token_file.empty() && !options.gateway.empty()) {
    return MakeTokenChannel(options.gateway, options.security, flags.token_file);
  }
  const auto found = options.peers.find(peer);
  const std::string& address = found == options.peers.end() ? options.gateway : found->second;
  if (!address.empty()) return MakeChannel(address, options.security);
  return InvalidField("peer", absl::StrCat("give --peer ", peer, "=ADDRESS, or --gateway ADDRESS"));
}

// Posted by every signal that asks the worker to end: nothing else reaches a signal's handler.
sem_t asked_to_end;

extern "C" void AskToEnd(int) { sem_post(&asked_to_end); }

// Takes SIGTERM and SIGINT, in whatever thread they come and as often as they do: schedulers send
// some twice, and libraries (OpenBLAS) have threads from before main() that no mask of ours
// reaches.
void TakeEndingSignals() {
  sem_init(&asked_to_end, 0, 0);
  struct sigaction action = {};
  action.sa_handler = AskToEnd;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGINT, &action, nullptr);
}

void AwaitEndingSignal() {
  while (sem_wait(&asked_to_end) != 0) {
  }
}

// This program from its beginning, in the place and under the id of this process, so that whoever
// supervises it (a launcher, Slurm, Kubernetes) sees no end.
void BeginAnew(char** argv) {
  ::close_range(3, ~0U, CLOSE_RANGE_CLOEXEC);  // connections and files
  ::execv("/proc/self/exe", argv);
  Log(LogLevel::kError, "the worker cannot begin anew", {{"error", std::strerror(errno)}});
  ::_exit(1);
}

// Ends when TakeEndingSignals has seen one, or the work has failed.
absl::Status Run(const WorkerProgram& program, const ServiceOptions& options,
                 const WorkerFlags& flags, char** argv) {
  MORTISE_RETURN_IF_ERROR(CheckAccess(options, flags));
  WorkerEnvironment environment;
  environment.name = flags.name.empty() ? absl::StrCat("worker-", NewIdentifier()) : flags.name;
  environment.lease = absl::Seconds(flags.lease_seconds);
  environment.drain_time = options.drain_time;
  std::atomic<bool> ending = false;
  environment.break_off = [&ending, argv] { ending ? ::_exit(0) : BeginAnew(argv); };
  for (const std::string& peer : program.peers) {
    MORTISE_ASSIGN_OR_RETURN(environment.channels[peer], ChannelTo(options, flags, peer));
  }
  std::unique_ptr<IdentitySigner> signer;
  if (!options.keys.empty()) {
    MORTISE_ASSIGN_OR_RETURN(signer, IdentitySigner::Load(options.keys, options.name));
    environment.signer = signer.get();
  }
  Log(LogLevel::kInfo, "working", {{"worker", environment.name}});
  absl::Status result;
  std::jthread work([&](const std::stop_token& stop) {
    result = program.work(environment, stop);
    if (!result.ok()) sem_post(&asked_to_end);
  });
  AwaitEndingSignal();
  ending = true;
  Log(LogLevel::kInfo, "asked to end, once the task at hand is finished or given back", {});
  work.request_stop();
  work.join();
  return result;
}

}  // namespace

int RunWorkerProgram(int argc, char** argv, const WorkerProgram& program) {
  WorkerFlags flags;
  const auto options = ParseServiceOptions(argc, argv,
                                           {.name = program.name,
                                            .title = program.title,
                                            .add_flags =
                                                [&](CLI::App& app) {
                                                  AddFlags(app, flags);
                                                  if (program.add_flags) program.add_flags(app);
                                                },
                                            .only_calls = true});
  if (absl::IsCancelled(options.status())) {
    std::fputs(std::string(options.status().message()).c_str(), stdout);
    return 0;
  }
  const auto fail = [&program](const absl::Status& status, int code) {
    std::fprintf(stderr, "mortise-%s: %s\n", program.name.c_str(),
                 std::string(status.message()).c_str());
    return code;
  };
  if (!options.ok()) return fail(options.status(), 2);
  ConfigureLogging(program.name + "-worker", options->log_level);

  TakeEndingSignals();
  signal(SIGPIPE, SIG_IGN);
  if (const absl::Status status = Run(program, *options, flags, argv); !status.ok()) {
    return fail(status, 1);
  }
  return 0;
}

bool AwaitConnection(grpc::Channel& channel, const std::stop_token& stop) {
  constexpr std::chrono::milliseconds kLookForStop{200};
  while (!stop.stop_requested()) {
    if (channel.WaitForConnected(std::chrono::system_clock::now() + kLookForStop)) return true;
  }
  return false;
}

bool AwaitConnection(grpc::Channel& channel, absl::Duration patience) {
  return channel.WaitForConnected(absl::ToChronoTime(absl::Now() + patience));
}

}  // namespace mortise::rpc
