// mortise-virtual-cell: a chop saw and a jigsaw robot that exist only as a Modbus TCP server.
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/logging.h"
#include "hwbridge/virtual_cell/cell_server.h"
#include "hwbridge/virtual_cell/faulty_memory.h"
#include "hwbridge/virtual_cell/machine.h"
#include "hwbridge/virtual_cell/machine_memory.h"

namespace mortise::hwbridge {
namespace {

struct Settings {
  CellServer::Options server;
  FaultyMemory::Options faults;
  double heartbeat_timeout = 5.0;  // s
  std::string state = "virtual-cell";
  std::string journal;
  std::string port_file;
};

void Describe(CLI::App& app, Settings& settings) {
  app.add_option("--address", settings.server.address, "address to listen on");
  app.add_option("--port", settings.server.port, "port to listen on; 0 lets the system choose")
      ->check(CLI::Range(0, 65535));
  app.add_option("--port-file", settings.port_file, "write the port to this file");
  app.add_option("--time-scale", settings.server.time_scale, "simulated seconds in a real one")
      ->check(CLI::Range(1e-3, 1e6));
  app.add_option("--heartbeat-timeout", settings.heartbeat_timeout,
                 "seconds of silence after which a machine holds by itself")
      ->check(CLI::Range(0.01, 60.0));
  app.add_option("--connections", settings.server.connections, "connections at once")
      ->check(CLI::Range(1, 1000));
  app.add_option("--idle-timeout", settings.server.idle_timeout,
                 "seconds without a request after which a connection is closed")
      ->check(CLI::Range(0.01, 3600.0));
  app.add_option("--state", settings.state, "start of the file names of the machines' memory");
  app.add_option("--journal", settings.journal,
                 "file of the cuts really made; STATE.cuts by default");
  app.add_option("--drop-response-every", settings.server.drop_response_every,
                 "fault: lose every n-th answer");
  app.add_option("--delay", settings.server.delay, "fault: seconds before each answer")
      ->check(CLI::Range(0.0, 60.0));
  app.add_flag("--crash-after-accept", settings.faults.crash_after_accept,
               "fault: die once a number is remembered, before it is answered");
  app.add_flag("--crash-after-cut", settings.faults.crash_after_cut,
               "fault: die once the material is cut, before that is remembered");
}

absl::StatusOr<std::unique_ptr<Machine>> StartMachine(const Settings& settings, MachineKind kind) {
  Machine::Options options;
  options.kind = kind;
  options.heartbeat_timeout = settings.heartbeat_timeout;
  const std::string name = MachineKindName(kind);
  const std::string journal =
      settings.journal.empty() ? absl::StrCat(settings.state, ".cuts") : settings.journal;
  auto memory =
      std::make_unique<FileMachineMemory>(name, absl::StrCat(settings.state, ".", name), journal);
  return Machine::Start(options,
                        std::make_unique<FaultyMemory>(std::move(memory), settings.faults));
}

absl::Status PublishPort(const Settings& settings, int port) {
  std::printf("%d\n", port);
  std::fflush(stdout);
  if (settings.port_file.empty()) return absl::OkStatus();
  return WriteFile(settings.port_file, absl::StrCat(port, "\n"));
}

absl::Status Run(const Settings& settings) {
  // Blocked before anything starts, so that no signal finds its default action.
  sigset_t handled;
  sigemptyset(&handled);
  for (const int signal : {SIGTERM, SIGINT, SIGUSR1, SIGUSR2}) sigaddset(&handled, signal);
  sigprocmask(SIG_BLOCK, &handled, nullptr);
  signal(SIGPIPE, SIG_IGN);
  const int signals = signalfd(-1, &handled, SFD_CLOEXEC);

  std::vector<std::unique_ptr<Machine>> machines;
  for (const MachineKind kind : {MachineKind::kChopSaw, MachineKind::kJigsaw}) {
    MORTISE_ASSIGN_OR_RETURN(std::unique_ptr<Machine> machine, StartMachine(settings, kind));
    machines.push_back(std::move(machine));
  }
  MORTISE_ASSIGN_OR_RETURN(std::unique_ptr<CellServer> server,
                           CellServer::Listen(settings.server, std::move(machines)));
  MORTISE_RETURN_IF_ERROR(PublishPort(settings, server->port()));
  Log(LogLevel::kInfo, "the virtual cell listens",
      {{"port", server->port()}, {"time_scale", settings.server.time_scale}});
  const absl::Status status = server->Run(signals);
  ::close(signals);
  return status;
}

}  // namespace
}  // namespace mortise::hwbridge

int main(int argc, char** argv) {
  CLI::App app("A chop saw (unit 1) and a jigsaw robot (unit 2) behind a Modbus TCP port.");
  mortise::hwbridge::Settings settings;
  mortise::hwbridge::Describe(app, settings);
  CLI11_PARSE(app, argc, argv);
  mortise::ConfigureLogging("virtual-cell", mortise::LogLevel::kInfo);
  settings.faults.crash = [] { kill(getpid(), SIGKILL); };
  const absl::Status status = mortise::hwbridge::Run(settings);
  if (status.ok()) return 0;
  mortise::Log(mortise::LogLevel::kError, "the virtual cell ends", {{"error", status.ToString()}});
  return 1;
}
