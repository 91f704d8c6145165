// mortise-hwbridge: the bridge between the fabplanner and the machines of a plant. It dials out.
#include <signal.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <memory>
#include <optional>
#include <regex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/logging.h"
#include "hwbridge/client/bridge_client.h"
#include "hwbridge/cutting/modbus_link.h"

namespace mortise::hwbridge {
namespace {

struct Settings {
  BridgeClient::Options client;
  std::string journal = "state/hwbridge.journal";
  std::string ready_file;
  std::vector<std::string> machines;
  double scan_period = 0.05;        // s
  double answer_timeout = 0.5;      // s
  double machine_lost_after = 3.0;  // s
  double online_patience = 5.0;     // s
  std::optional<double> cut_patience;
  bool adopt_numbers = false;
};

void Describe(CLI::App& app, Settings& settings) {
  BridgeClient::Options& client = settings.client;
  app.add_option("--bridge", client.bridge, "name of this bridge")->default_val("plant");
  app.add_option("--gateway", client.gateway, "HOST:PORT to dial")
      ->envname("MORTISE_GATEWAY")
      ->required();
  app.add_option("--machine", settings.machines,
                 "NAME=KIND@ADDRESS:PORT/UNIT, KIND chop-saw or jigsaw; repeatable")
      ->required();
  app.add_option("--journal", settings.journal, "file of the journal");
  app.add_option("--token-file", client.token_file, "file with a bearer token of an operator");
  app.add_option("--tls-certificate", client.security.certificate, "chain of this process, PEM");
  app.add_option("--tls-key", client.security.key, "private key, PEM");
  app.add_option("--tls-authority", client.security.authority, "whom to trust, PEM");
  app.add_option("--line-lost-after", client.line_lost_after,
                 "seconds without the fabplanner after which no cut begins")
      ->check(CLI::Range(0.0, 3600.0));
  app.add_option("--machine-lost-after", settings.machine_lost_after,
                 "seconds without a machine's answer after which its cuts are held")
      ->check(CLI::Range(0.05, 60.0));
  app.add_option("--cut-patience", settings.cut_patience,
                 "seconds a machine may take for a cut before it raises the alarm; by default five "
                 "times what a slow machine takes for it, at least 300")
      ->check(CLI::Range(1.0, 86400.0));
  app.add_option("--answer-timeout", settings.answer_timeout, "seconds to wait for an answer")
      ->check(CLI::Range(0.01, 10.0));
  app.add_option("--scan-period", settings.scan_period, "seconds between two scans of a machine")
      ->check(CLI::Range(0.001, 1.0));
  app.add_option("--ready-file", settings.ready_file,
                 "written each time the fabplanner has answered");
  app.add_flag("--adopt-machine-numbers", settings.adopt_numbers,
               "go on from the numbers the machines have, after somebody looked at the material");
  app.footer(
      "mortise-hwbridge --gateway 127.0.0.1:7000 --machine saw=chop-saw@127.0.0.1:1502/1 "
      "--machine robot=jigsaw@127.0.0.1:1502/2");
}

int ToInt(const std::string& digits) {
  int value = -1;  // what does not fit stays out of every range
  std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return value;
}

absl::StatusOr<WorkOrderRunner::MachineSetup> ParseMachine(const std::string& text,
                                                           const Settings& settings) {
  static const std::regex form(
      R"(([a-z0-9][a-z0-9-]*)=(chop-saw|jigsaw)@([0-9.]+):([0-9]{1,5})/([0-9]{1,3}))");
  std::smatch match;
  if (!std::regex_match(text, match, form)) {
    return InvalidField("--machine",
                        absl::StrCat("'", text, "' is not NAME=KIND@ADDRESS:PORT/UNIT"));
  }
  ModbusLink::Options link;
  link.address = match[3];
  link.port = ToInt(match[4]);
  link.unit = ToInt(match[5]);
  link.answer_timeout = settings.answer_timeout;
  if (link.port < 1 || link.port > 65535 || link.unit < 1 || link.unit > 247) {
    return InvalidField("--machine", absl::StrCat("'", text, "': port or unit out of range"));
  }
  WorkOrderRunner::MachineSetup setup;
  setup.worker.name = match[1];
  setup.worker.kind = match[2] == "chop-saw" ? MachineKind::kChopSaw : MachineKind::kJigsaw;
  setup.worker.line_lost_after = settings.machine_lost_after;
  setup.worker.cut_patience = settings.cut_patience;
  setup.link = std::make_unique<ModbusLink>(link);
  return setup;
}

absl::StatusOr<std::vector<WorkOrderRunner::MachineSetup>> ParseMachines(const Settings& settings) {
  std::vector<WorkOrderRunner::MachineSetup> machines;
  for (const std::string& text : settings.machines) {
    MORTISE_ASSIGN_OR_RETURN(WorkOrderRunner::MachineSetup setup, ParseMachine(text, settings));
    for (const auto& other : machines) {
      if (other.worker.name != setup.worker.name) continue;
      return InvalidField("--machine", absl::StrCat("'", setup.worker.name, "' is there twice"));
    }
    machines.push_back(std::move(setup));
  }
  return machines;
}

absl::Status Run(Settings settings) {
  // Blocked before any thread starts, so that only the wait below takes them.
  sigset_t ending;
  sigemptyset(&ending);
  sigaddset(&ending, SIGTERM);
  sigaddset(&ending, SIGINT);
  pthread_sigmask(SIG_BLOCK, &ending, nullptr);
  signal(SIGPIPE, SIG_IGN);

  MORTISE_ASSIGN_OR_RETURN(auto machines, ParseMachines(settings));
  MORTISE_ASSIGN_OR_RETURN(const std::unique_ptr<Journal> journal, Journal::Open(settings.journal));
  if (!settings.ready_file.empty()) {
    settings.client.on_attached = [path = settings.ready_file] {
      const absl::Status written = WriteFile(path, "attached\n");
      if (!written.ok()) Log(LogLevel::kError, "ready file", {{"error", written.ToString()}});
    };
  }
  MORTISE_ASSIGN_OR_RETURN(const std::unique_ptr<BridgeClient> client,
                           BridgeClient::Create(settings.client, *journal));
  const MonotonicClock clock;
  WorkOrderRunner runner({.scan_period = settings.scan_period}, std::move(machines), *journal,
                         clock, [&client] { client->NotifyChange(); });
  // A Resume that comes before the machines have answered would be refused.
  if (!runner.WaitUntilOnline(settings.online_patience)) {
    Log(LogLevel::kWarning, "not every machine answers; dialling all the same");
  }
  if (settings.adopt_numbers) MORTISE_RETURN_IF_ERROR(runner.AdoptNumbers());
  std::jthread dialling([&](std::stop_token stop) { client->Run(runner, stop); });
  int signal_number = 0;
  sigwait(&ending, &signal_number);
  Log(LogLevel::kInfo, "the bridge ends; its machines hold by themselves");
  return absl::OkStatus();
}

}  // namespace
}  // namespace mortise::hwbridge

int main(int argc, char** argv) {
  CLI::App app("Carries out work orders of the fabplanner on the machines of a plant.");
  mortise::hwbridge::Settings settings;
  mortise::hwbridge::Describe(app, settings);
  CLI11_PARSE(app, argc, argv);
  mortise::ConfigureLogging("hwbridge", mortise::LogLevel::kInfo);
  const absl::Status status = mortise::hwbridge::Run(std::move(settings));
  if (status.ok()) return 0;
  mortise::Log(mortise::LogLevel::kError, "the bridge ends", {{"error", status.ToString()}});
  return 1;
}
