// The main program of a worker process.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "common/host/worker_program.h"
#include "services/simulator/worker/worker.h"

namespace mortise::simulator {
namespace {

struct WorkerFlags {
  int threads = 1;
  double memory_limit = 8;   // GB
  double time_limit = 7200;  // s
};

void AddFlags(CLI::App& app, WorkerFlags& flags) {
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

}  // namespace

int WorkerMain(int argc, char** argv) {
  WorkerFlags flags;
  rpc::WorkerProgram program;
  program.name = "simulator";
  program.title = "A simulator worker: leases evaluation tasks and computes them.";
  program.peers = {"simulator", "catalog"};
  program.add_flags = [&flags](CLI::App& app) { AddFlags(app, flags); };
  program.work = [&flags](const rpc::WorkerEnvironment& environment, const std::stop_token& stop) {
    WorkerOptions worker;
    worker.name = environment.name;
    worker.simulator = environment.channels.at("simulator");
    worker.catalog = environment.channels.at("catalog");
    worker.signer = environment.signer;
    worker.lease = environment.lease;
    worker.drain_time = environment.drain_time;
    worker.break_off = environment.break_off;
    worker.threads = flags.threads;
    worker.time_limit = absl::Seconds(flags.time_limit);
    const double wanted = 1e9 * flags.memory_limit;
    worker.memory_limit = std::min(wanted, PhysicalMemory(wanted));
    RunWorker(worker, stop);
    return absl::OkStatus();
  };
  return rpc::RunWorkerProgram(argc, argv, program);
}

}  // namespace mortise::simulator
