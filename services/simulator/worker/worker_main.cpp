// The main program of a worker process.
#include <linux/close_range.h>
#include <semaphore.h>
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <thread>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/logging.h"
#include "common/host/service_options.h"
#include "common/rpc/token_channel.h"
#include "services/simulator/worker/worker.h"

namespace mortise::simulator {
namespace {

struct WorkerFlags {
  bool worker = true;
  std::string name;
  std::string token_file;
  double lease_seconds = 30;
  int threads = 1;
  double memory_limit = 8;   // GB
  double time_limit = 7200;  // s
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
  app.add_option("--solver-threads", flags.threads, "threads that solve one task")
      ->check(CLI::Range(1, 256))
      ->envname("MORTISE_SOLVER_THREADS");
  app.add_option("--memory-limit", flags.memory_limit,
                 "GB that one task may take, at most what the machine has; larger ones are refused")
      ->check(CLI::Range(0.01, 1e6))
      ->envname("MORTISE_MEMORY_LIMIT");
  app.add_option("--time-limit", flags.time_limit, "seconds that one task may take")
      ->check(CLI::Range(1.0, 1e7))
      ->envname("MORTISE_TIME_LIMIT");
}

// Bytes that this machine has; `otherwise` where it does not tell.
double PhysicalMemory(double otherwise) {
  const double bytes =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  return bytes > 0 ? bytes : otherwise;
}

// A worker is known by a key of the house's or, at the gateway, by a token.
absl::Status CheckAccess(const rpc::ServiceOptions& options, const WorkerFlags& flags) {
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
absl::StatusOr<std::shared_ptr<grpc::Channel>> ChannelTo(const rpc::ServiceOptions& options,
                                                         const WorkerFlags& flags,
                                                         const std::string& peer) {
  if (!flags.token_file.empty() && !options.gateway.empty()) {
    return rpc::MakeTokenChannel(options.gateway, options.security, flags.token_file);
  }
  const auto found = options.peers.find(peer);
  const std::string& address = found == options.peers.end() ? options.gateway : found->second;
  if (!address.empty()) return rpc::MakeChannel(address, options.security);
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

// Ends when TakeEndingSignals has seen one.
absl::Status Run(const rpc::ServiceOptions& options, const WorkerFlags& flags, char** argv) {
  MORTISE_RETURN_IF_ERROR(CheckAccess(options, flags));
  WorkerOptions worker;
  worker.name = flags.name.empty() ? absl::StrCat("worker-", NewIdentifier()) : flags.name;
  worker.lease = absl::Seconds(flags.lease_seconds);
  worker.threads = flags.threads;
  worker.time_limit = absl::Seconds(flags.time_limit);
  worker.drain_time = options.drain_time;
  std::atomic<bool> ending = false;
  worker.break_off = [&ending, argv] { ending ? ::_exit(0) : BeginAnew(argv); };
  const double wanted = 1e9 * flags.memory_limit;
  worker.memory_limit = std::min(wanted, PhysicalMemory(wanted));
  MORTISE_ASSIGN_OR_RETURN(worker.simulator, ChannelTo(options, flags, "simulator"));
  MORTISE_ASSIGN_OR_RETURN(worker.catalog, ChannelTo(options, flags, "catalog"));
  std::unique_ptr<rpc::IdentitySigner> signer;
  if (!options.keys.empty()) {
    MORTISE_ASSIGN_OR_RETURN(signer, rpc::IdentitySigner::Load(options.keys, options.name));
    worker.signer = signer.get();
  }
  Log(LogLevel::kInfo, "working", {{"worker", worker.name}});
  std::jthread work([&](const std::stop_token& stop) { RunWorker(worker, stop); });
  AwaitEndingSignal();
  ending = true;
  Log(LogLevel::kInfo, "asked to end, once the task at hand is finished or given back", {});
  work.request_stop();
  work.join();
  return absl::OkStatus();
}

}  // namespace

int WorkerMain(int argc, char** argv) {
  WorkerFlags flags;
  const auto options = rpc::ParseServiceOptions(
      argc, argv,
      {.name = "simulator",
       .title = "A simulator worker: leases evaluation tasks and computes them.",
       .add_flags = [&flags](CLI::App& app) { AddFlags(app, flags); },
       .only_calls = true});
  if (absl::IsCancelled(options.status())) {
    std::fputs(std::string(options.status().message()).c_str(), stdout);
    return 0;
  }
  const auto fail = [](const absl::Status& status, int code) {
    std::fprintf(stderr, "mortise-simulator: %s\n", std::string(status.message()).c_str());
    return code;
  };
  if (!options.ok()) return fail(options.status(), 2);
  ConfigureLogging("simulator-worker", options->log_level);

  TakeEndingSignals();
  signal(SIGPIPE, SIG_IGN);
  if (const absl::Status status = Run(*options, flags, argv); !status.ok()) {
    return fail(status, 1);
  }
  return 0;
}

}  // namespace mortise::simulator
