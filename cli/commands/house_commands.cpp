// mortise up, down, keys: a house on this machine; status: that, or what runs behind a gateway.
#include <grpcpp/grpcpp.h>
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "cli/client/ending_signals.h"
#include "cli/client/flag_checks.h"
#include "cli/client/gateway_client.h"
#include "cli/client/session.h"
#include "cli/commands/commands.h"
#include "cli/launcher/house.h"
#include "cli/launcher/launcher.h"
#include "cli/launcher/start_patience.h"
#include "cli/launcher/state_folder.h"
#include "common/base/decimal_number.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/base/process.h"
#include "common/bus/key_folder.h"
#include "common/rpc/identity.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/gateway.grpc.pb.h"

namespace mortise::cli {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr milliseconds kSuperviseEvery{20};
constexpr milliseconds kStopPatience{10000};

// Programs stand beside this one; the collection in the source tree or the installed share folder.
void FillFolders(HouseOptions& options) {
  std::error_code ignored;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", ignored);
  if (options.binaries.empty()) options.binaries = self.parent_path();
  if (options.collection.empty()) {
    for (const char* candidate : {"../../../collection", "../share/mortise/collection"}) {
      const std::filesystem::path folder = (self.parent_path() / candidate).lexically_normal();
      if (std::filesystem::is_directory(folder, ignored)) {
        options.collection = folder;
        break;
      }
    }
  }
  options.state = std::filesystem::absolute(options.state);
}

// The keys of every process that signs identities or uses the bus, where they are missing.
absl::Status EnsureKeys(const std::filesystem::path& folder) {
  std::vector<std::string> names = HouseServices();
  names.push_back("gateway");
  for (const std::string& name : names) {
    for (const absl::Status& status :
         {rpc::CreateIdentityKey(folder, name), bus::CreateCurveKey(folder, name)}) {
      if (!status.ok() && !absl::IsAlreadyExists(status)) return status;
    }
  }
  return absl::OkStatus();
}

nlohmann::ordered_json HouseDocument(const RunningHouse& house) {
  nlohmann::ordered_json document = {{"launcher", house.launcher},
                                     {"gateway_grpc", house.gateway_grpc},
                                     {"gateway_http", house.gateway_http},
                                     {"processes", nlohmann::ordered_json::array()}};
  for (const RunningProcess& process : house.processes) {
    document["processes"].push_back({{"name", process.name},
                                     {"pid", process.pid},
                                     {"address", process.address},
                                     {"restarts", process.restarts},
                                     {"serving", process.serving}});
  }
  return document;
}

void PrintHouse(const RunningHouse& house, Output& output) {
  std::vector<std::vector<std::string>> rows;
  for (const RunningProcess& process : house.processes) {
    rows.push_back({process.name, process.serving ? "serving" : "starting",
                    process.address.empty() ? "-" : process.address, absl::StrCat(process.pid),
                    absl::StrCat(process.restarts)});
  }
  output.Table({"process", "state", "address", "pid", "restarts"}, rows);
  output.Line(absl::StrCat("gateway: gRPC ", house.gateway_grpc, ", HTTP http",
                           house.plain_text ? "" : "s", "://", house.gateway_http));
  output.Document(HouseDocument(house));
}

void PrintPlan(const HousePlan& plan, Output& output) {
  nlohmann::ordered_json document = {{"gateway_grpc", plan.gateway_grpc},
                                     {"gateway_http", plan.gateway_http},
                                     {"processes", nlohmann::ordered_json::array()}};
  std::vector<std::vector<std::string>> rows;
  for (const HouseProcess& process : plan.processes) {
    document["processes"].push_back(
        {{"name", process.name}, {"address", process.address}, {"command", process.command}});
    rows.push_back(
        {process.name, process.address.empty() ? "-" : process.address, process.command.front()});
  }
  output.Table({"process", "address", "program"}, rows);
  output.Document(document);
}

// Whether a house that starts is waited for any longer; says so where that takes long.
absl::Status AwaitStart(const HouseOptions& options, const Launcher& launcher,
                        StartPatience& patience, Output& output) {
  using Verdict = StartPatience::Verdict;
  const Verdict verdict = patience.Look(Clock::now(), launcher.StartProgress());
  if (verdict == Verdict::kWait) return absl::OkStatus();
  const std::string starting = absl::StrJoin(launcher.Starting(), ", ");
  if (verdict == Verdict::kTell) {
    output.Note(absl::StrCat("still starting: ", starting,
                             "; as long as they get on they have five minutes in all"));
    return absl::OkStatus();
  }
  return absl::DeadlineExceededError(absl::StrCat(
      "not all processes serve: nothing moved for a minute, or five minutes are over; ", starting,
      " did not get ready; their logs are in ", (options.state / "logs").string()));
}

absl::Status Up(HouseOptions options, bool dry_run, Output& output) {
  FillFolders(options);
  MORTISE_ASSIGN_OR_RETURN(HousePlan plan, PlanHouse(options));
  if (dry_run) {
    PrintPlan(plan, output);
    return absl::OkStatus();
  }
  ConfigureLogging("launcher", LogLevel::kInfo);
  MORTISE_ASSIGN_OR_RETURN(const StateFolderLock lock, StateFolderLock::Take(options.state));
  MORTISE_RETURN_IF_ERROR(EnsureKeys(options.state / "keys"));

  std::atomic<int> asked = 0;  // how often somebody asked it to stop
  const EndingSignals signals([&](int, int count) {
    asked = count;
    if (count == 1) output.Note("stopping; Ctrl-C again ends the processes at once");
  });
  const Clock::time_point begin = Clock::now();
  StartPatience patience(begin);
  Launcher launcher(options, std::move(plan), [](const RunningHouse&) {});
  MORTISE_RETURN_IF_ERROR(launcher.Start());
  bool announced = false;
  while (asked == 0) {
    MORTISE_RETURN_IF_ERROR(launcher.Supervise());
    if (!announced && launcher.Serving()) {
      announced = true;
      PrintHouse(launcher.house(), output);
      if (options.collection.empty()) {
        output.Note(
            "no collection was found beside the programs: the catalog has only what is imported "
            "into it; --collection FOLDER names one");
      }
      output.Line(absl::StrFormat("all serving after %.1f s; Ctrl-C or `mortise down` stops them",
                                  std::chrono::duration<double>(Clock::now() - begin).count()));
    }
    if (!announced) MORTISE_RETURN_IF_ERROR(AwaitStart(options, launcher, patience, output));
    std::this_thread::sleep_for(kSuperviseEvery);
  }
  launcher.Stop(kStopPatience, [&] { return asked > 1; });
  output.Line("stopped; operations under way go on when the house is started again");
  return absl::OkStatus();
}

absl::StatusOr<RunningHouse> HouseThatRuns(const std::filesystem::path& state) {
  absl::StatusOr<RunningHouse> house = ReadRunningHouse(state);
  if (!house.ok() || !ProcessExists(house->launcher)) {
    return WithDetail(absl::NotFoundError(absl::StrCat("no house runs on ", state.string())),
                      {"HOUSE_NOT_RUNNING", "--state"});
  }
  return house;
}

// Only launchers of houses on this machine are known by their state folders.
absl::Status Down(const GatewayOptions& gateway, Output& output) {
  if (!gateway.address.empty()) {
    return InvalidField("--gateway",
                        "is not for down, which stops a house on this machine: name "
                        "its folder with --state");
  }
  const std::filesystem::path& state = gateway.state;
  MORTISE_ASSIGN_OR_RETURN(const RunningHouse house, HouseThatRuns(state));
  ::kill(house.launcher, SIGTERM);
  const Clock::time_point deadline = Clock::now() + 2 * kStopPatience;
  while (ProcessExists(house.launcher)) {
    if (Clock::now() > deadline) {
      return absl::DeadlineExceededError(
          absl::StrCat("the launcher (pid ", house.launcher, ") does not end"));
    }
    std::this_thread::sleep_for(kSuperviseEvery);
  }
  output.Line("stopped");
  output.Document({{"stopped", true}});
  return absl::OkStatus();
}

// Prints what the gateway of a house says of it, wherever that house runs.
absl::Status RemoteStatus(Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::GatewayService::NewStub(client->channel());
  v1::House house;
  MORTISE_RETURN_IF_ERROR(client->Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc(stub->GetHouse(&context, {}, &house));
  }));
  nlohmann::ordered_json document = {{"gateway_grpc", client->address()},
                                     {"version", house.version()},
                                     {"processes", nlohmann::ordered_json::array()}};
  std::vector<std::vector<std::string>> rows;
  for (const v1::House::Service& service : house.services()) {
    rows.push_back(
        {service.name(), service.healthy() ? "serving" : "not serving", service.address()});
    document["processes"].push_back(
        {{"name", service.name()}, {"address", service.address()}, {"serving", service.healthy()}});
  }
  output.Table({"service", "state", "address"}, rows);
  output.Line(absl::StrCat("gateway: gRPC ", client->address(), ", version ", house.version()));
  output.Document(document);
  return absl::OkStatus();
}

// A folder that somebody names is meant, whatever gateway the environment has.
absl::Status Status(Session& session, bool names_folder, Output& output) {
  const bool is_remote =
      !session.gateway.address.empty() || (!names_folder && !GatewayOfEnvironment().empty());
  if (is_remote) return RemoteStatus(session, output);
  MORTISE_ASSIGN_OR_RETURN(const RunningHouse house, HouseThatRuns(session.gateway.state));
  PrintHouse(house, output);
  return absl::OkStatus();
}

// Takes ports of listeners as they are chosen on the command line.
void ReadPorts(const std::vector<std::string>& texts, HouseOptions& options) {
  constexpr std::int64_t kMostPort = 65535;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    const auto port = equals == std::string::npos
                          ? std::nullopt
                          : DecimalInteger(std::string_view(text).substr(equals + 1));
    if (!port || *port < 0 || *port > kMostPort || equals == 0) {
      throw CLI::ValidationError(
          "--port", absl::StrCat("'", text,
                                 "' is not of the form LISTENER=PORT, with a port of 0 "
                                 "(any that is free) to 65535"));
    }
    options.ports[text.substr(0, equals)] = static_cast<int>(*port);
  }
}

}  // namespace

void AddHouseCommands(CLI::App& app, Session& session) {
  auto options = std::make_shared<HouseOptions>();
  auto dry_run = std::make_shared<bool>(false);
  CLI::App* up = app.add_subcommand("up", "Start every service of a house on this machine");
  up->add_option("--state", options->state, "Folder for stores, blobs, keys and logs")
      ->capture_default_str();
  up->add_option(
      "--collection", options->collection,
      "Items and designs that the catalog has from the start, and takes up as they change");
  up->add_flag("--any-ports", options->any_ports, "Any free ports instead of the usual ones");
  up->add_option_function<std::vector<std::string>>(
        "--port", [options](const std::vector<std::string>& texts) { ReadPorts(texts, *options); },
        "LISTENER=PORT instead of its usual one, such as gateway=8700; again for more")
      ->allow_extra_args(false);
  up->add_option("--workers", options->workers, "Simulator workers; 0 for one a core")
      ->check(CLI::NonNegativeNumber);
  up->add_option("--retrieval-workers", options->retrieval_workers,
                 "Workers that cover families for indexes, beside one a core in the service itself")
      ->check(CLI::NonNegativeNumber);
  up->add_flag("--virtual-cell", options->virtual_cell, "Also a virtual cell and a bridge to it");
  up->add_option("--time-scale", options->time_scale, "Speed of the virtual cell")
      ->check(PositiveFinite());
  up->add_flag("--insecure-development", options->insecure_development,
               "Plain text and no tokens, on loopback only");
  up->add_option("--tls-certificate", options->tls_certificate, "PEM certificate of the gateway");
  up->add_option("--tls-key", options->tls_key, "PEM key of the gateway");
  up->add_option("--tls-authority", options->tls_authority,
                 "PEM certificate of who signed it; the certificate itself if absent");
  up->add_option("--jwt-keys", options->jwt_keys,
                 "Public keys of bearer tokens: JSON Web Key Set or PEM");
  up->add_option("--jwks-url", options->jwks_url,
                 "Address that more of them are fetched from, a JSON Web Key Set");
  up->add_option("--jwks-authority", options->jwks_authority,
                 "PEM file of who signed that address's certificate, where that is nobody public");
  up->add_option("--cors-origin", options->cors_origins,
                 "Origin whose pages may call over HTTP, as https://plm.example; repeat for each");
  up->add_option("--bridge-token-file", options->bridge_token_file,
                 "Bearer token of an operator, for the bridge of --virtual-cell");
  up->add_option("--log-megabytes", options->log_megabytes,
                 "Size at which a process begins a new log file; five older ones are kept")
      ->check(PositiveFinite())
      ->capture_default_str();
  up->add_flag("--dry-run", *dry_run, "Only print what would be started");
  up->footer("Example: mortise up --insecure-development");
  up->callback([&session, options, dry_run] {
    session.command = [options, dry_run](Session&, Output& output) {
      return Up(*options, *dry_run, output);
    };
  });

  CLI::App* down = app.add_subcommand("down", "Stop the house that runs on a state folder");
  down->add_option("--state", session.gateway.state, "Its state folder")->capture_default_str();
  down->footer("Example: mortise down --state .mortise");
  down->callback([&session] {
    session.command = [](Session& s, Output& output) { return Down(s.gateway, output); };
  });

  auto folder = std::make_shared<std::filesystem::path>();
  CLI::App* keys = app.add_subcommand("keys", "Make the keys of a house's processes");
  keys->add_option("folder", *folder, "Folder; what is there is kept")->required();
  keys->footer("Example: mortise keys deploy/secrets/keys");
  keys->callback([&session, folder] {
    session.command = [folder](Session&, Output& output) -> absl::Status {
      MORTISE_RETURN_IF_ERROR(EnsureKeys(*folder));
      output.Line(absl::StrCat("keys are in ", folder->string()));
      output.Document({{"folder", folder->string()}});
      return absl::OkStatus();
    };
  });

  CLI::App* status = app.add_subcommand(
      "status",
      "What runs where: of a house on this machine, or behind --gateway or MORTISE_GATEWAY");
  const CLI::Option* const folder_named =
      status->add_option("--state", session.gateway.state, "State folder")->capture_default_str();
  status->footer(
      "Example: mortise status --json, or elsewhere mortise --gateway 127.0.0.1:7700 status");
  const CLI::Option* const house = app.get_option("--house");
  status->callback([&session, folder_named, house] {
    const bool names_folder = !folder_named->empty() || !house->empty();
    session.command = [names_folder](Session& s, Output& output) {
      return Status(s, names_folder, output);
    };
  });
}

}  // namespace mortise::cli
