// mortise fab release|watch|show|hold|resume: plans on their way through the machines.
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/client/command_flags.h"
#include "cli/client/requests.h"
#include "cli/client/session.h"
#include "cli/client/tag_options.h"
#include "cli/commands/commands.h"
#include "cli/commands/list_command.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/fabplanner.grpc.pb.h"

namespace mortise::cli {
namespace {

// "saw of plant-2 is HELD: the line was down".
std::string MachineText(const v1::Machine& machine, const std::string& bridge) {
  return absl::StrCat(machine.name(), " of ", bridge,
                      machine.alarm() ? " raised the alarm and" : "", " is ", machine.state(),
                      machine.held_because().empty() ? "" : ": ", machine.held_because());
}

void PrintWorkOrder(const v1::WorkOrder& order, const Output& output) {
  output.Line(absl::StrFormat("%s: %s, %d of %d cuts done", order.name(),
                              v1::WorkOrder::State_Name(order.state()), order.cuts_done(),
                              order.cuts_total()));
  for (const v1::HeldMachine& held : order.held_machines()) {
    output.Line(absl::StrCat("  ", MachineText(held.machine(), held.bridge())));
  }
  for (const std::string& handwork : order.handwork()) {
    output.Line(absl::StrCat("  by hand: ", handwork));
  }
  std::vector<std::vector<std::string>> rows;
  for (const v1::WorkOrder::Cut& cut : order.cuts()) {
    const v1::CutCommand& command = cut.command();
    rows.push_back({command.machine(), absl::StrCat(command.sequence()), command.part(),
                    command.has_crosscut() ? Millimetres(command.crosscut().length()) : "outline",
                    v1::WorkOrder::Cut::State_Name(cut.state()),
                    absl::StrFormat("%.1f s", cut.seconds())});
  }
  output.Table({"machine", "number", "part", "cut", "state", "duration"}, rows);
}

// Machines never stop because somebody's terminal closes: who leaves learns how to hold them.
std::string HowOrderGoesOn(const GatewayClient& client, const v1::Operation& operation) {
  const std::string& command = client.command();
  const std::string& order = operation.subject();
  return absl::StrCat(
      order, " goes on, its machines cut without this command\n  watch it with:   ", command,
      " fab watch ", order, "\n  hold it with:    ", command, " fab hold ", order,
      "\n  give it up with: ", command, " operations cancel ", operation.name());
}

LongWork CuttingWork(const Session& session, bool detach) {
  LongWork work = session.Work(detach);
  if (work.when_left == WhenLeft::kIsCancelled) work.when_left = WhenLeft::kGoesOn;
  work.how_to_go_on = HowOrderGoesOn;
  return work;
}

void PrintCutOrder(const v1::WorkOrder& order, Output& output) {
  PrintWorkOrder(order, output);
  output.DocumentOf(order);
}

struct ReleaseOptions {
  std::string plan;
  TagOptions tags;
  bool detach = false;
};

absl::Status Release(const ReleaseOptions& options, Session& session, Output& output) {
  v1::ReleaseWorkOrderRequest request;
  request.set_request_id(NewIdentifier());
  request.set_plan(ResourceName("plans", options.plan));
  MORTISE_RETURN_IF_ERROR(AddTags(options.tags, &request));
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::FabPlannerService::NewStub(client->channel());
  MORTISE_ASSIGN_OR_RETURN(
      const std::optional<v1::WorkOrder> order,
      RunTo<v1::WorkOrder>(
          *client, CuttingWork(session, options.detach),
          [&](grpc::ClientContext& context, v1::Operation* operation) {
            return rpc::FromGrpc(stub->ReleaseWorkOrder(&context, request, operation));
          },
          output));
  if (order) PrintCutOrder(*order, output);
  return absl::OkStatus();
}

absl::StatusOr<v1::WorkOrder> GetOrder(const std::string& name, Session& session) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::FabPlannerService::NewStub(client->channel());
  v1::GetWorkOrderRequest request;
  request.set_name(ResourceName("workOrders", name));
  v1::WorkOrder order;
  MORTISE_RETURN_IF_ERROR(client->Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc(stub->GetWorkOrder(&context, request, &order));
  }));
  return order;
}

// Follows by the name of an operation, or of a work order.
absl::Status WatchByName(const std::string& name, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  v1::Operation operation;
  if (absl::StartsWith(name, "operations/")) {
    MORTISE_ASSIGN_OR_RETURN(operation, GetOperation(*client, name));
  } else {
    MORTISE_ASSIGN_OR_RETURN(const v1::WorkOrder order, GetOrder(name, session));
    operation.set_name(order.operation());
    operation.set_subject(order.name());
  }
  MORTISE_ASSIGN_OR_RETURN(const v1::Operation done,
                           Follow(*client, CuttingWork(session, false), operation, output));
  MORTISE_ASSIGN_OR_RETURN(const v1::WorkOrder order, ResultOf<v1::WorkOrder>(done));
  PrintCutOrder(order, output);
  return absl::OkStatus();
}

absl::Status Show(const std::string& name, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(const v1::WorkOrder order, GetOrder(name, session));
  PrintWorkOrder(order, output);
  output.DocumentOf(order);
  return absl::OkStatus();
}

// All machines, also those that no work order waits for.
absl::Status ShowMachines(Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::FabPlannerService::NewStub(client->channel());
  v1::ListBridgesResponse bridges;
  MORTISE_RETURN_IF_ERROR(client->Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc(stub->ListBridges(&context, {}, &bridges));
  }));
  for (const v1::ListBridgesResponse::Bridge& bridge : bridges.bridges()) {
    for (const v1::Machine& machine : bridge.machines()) {
      output.Line(absl::StrCat(MachineText(machine, bridge.name()),
                               bridge.attached() ? "" : " (as last told, its bridge is away)"));
      if (!machine.alarm()) continue;
      output.Line(absl::StrCat("  once you have looked at it: ", client->command(),
                               " fab resume --machine ", machine.name(), " --bridge ",
                               bridge.name()));
    }
  }
  if (bridges.bridges().empty()) output.Line("no bridge has ever attached");
  output.DocumentOf(bridges);
  return absl::OkStatus();
}

// A person has looked at a machine; orders that are held stay so.
absl::Status ClearAlarm(const std::string& machine, const std::string& bridge, Session& session,
                        Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::FabPlannerService::NewStub(client->channel());
  v1::ResumeWorkOrderRequest request;
  request.set_request_id(NewIdentifier());
  request.set_machine(machine);
  request.set_bridge(bridge);
  v1::WorkOrder answer;
  MORTISE_RETURN_IF_ERROR(client->Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc(stub->ResumeWorkOrder(&context, request, &answer));
  }));
  for (const v1::HeldMachine& held : answer.held_machines()) {
    output.Line(absl::StrCat(held.bridge(), " is told to clear the alarm of ",
                             held.machine().name(), " (", held.machine().held_because(),
                             "); see it with: ", client->command(), " fab show"));
  }
  output.DocumentOf(answer);
  return absl::OkStatus();
}

// Pauses a work order, or lets it go on.
template <typename Request, typename Method>
absl::Status Change(const std::string& name, Method method, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::FabPlannerService::NewStub(client->channel());
  Request request;
  request.set_request_id(NewIdentifier());
  request.set_name(ResourceName("workOrders", name));
  v1::WorkOrder order;
  MORTISE_RETURN_IF_ERROR(client->Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc(method(*stub, &context, request, &order));
  }));
  PrintWorkOrder(order, output);
  output.DocumentOf(order);
  return absl::OkStatus();
}

absl::Status Hold(const std::string& name, Session& session, Output& output) {
  return Change<v1::HoldWorkOrderRequest>(
      name, [](auto& stub, auto... a) { return stub.HoldWorkOrder(a...); }, session, output);
}

absl::Status Resume(const std::string& name, Session& session, Output& output) {
  return Change<v1::ResumeWorkOrderRequest>(
      name, [](auto& stub, auto... a) { return stub.ResumeWorkOrder(a...); }, session, output);
}

// A work order, or a machine whose alarm is cleared.
void AddResume(CLI::App& fab, Session& session) {
  auto name = std::make_shared<std::string>();
  auto machine = std::make_shared<std::string>();
  auto bridge = std::make_shared<std::string>();
  CLI::App* resume = fab.add_subcommand("resume", "Let a work order go on, once it is safe");
  CLI::Option* order = resume->add_option("name", *name, "workOrders/…");
  CLI::Option* alarmed = resume->add_option(
      "--machine", *machine, "Clear the alarm of this machine in place of a work order's");
  resume->add_option("--bridge", *bridge, "The bridge it is behind, where several have such a one")
      ->needs(alarmed);
  alarmed->excludes(order);
  resume->footer(
      "Example: mortise fab resume workOrders/0198c1\n"
      "A bridge or machine that lost power or the line waits for this; see docs/machines.md");
  resume->callback([&session, order, alarmed, name, machine, bridge] {
    if (order->empty() && alarmed->empty()) throw CLI::RequiredError("name or --machine");
    session.command = [name, machine, bridge](Session& s, Output& o) {
      return machine->empty() ? Resume(*name, s, o) : ClearAlarm(*machine, *bridge, s, o);
    };
  });
}

void AddRelease(CLI::App& fab, Session& session) {
  auto options = std::make_shared<ReleaseOptions>();
  CommandFlags flags(*fab.add_subcommand("release", "Give a plan to the machines and follow it"));
  flags.Add("plan", options->plan, "Plan, such as plans/0198c1", "plan")->required();
  AddTagOptions(flags, options->tags);
  AddDetach(flags.command(), options->detach);
  flags.command().footer(
      "Example: mortise fab release plans/0198c1\n"
      "Ctrl-C leaves the machines cutting; `mortise fab hold` pauses them");
  flags.Run(session, [options](Session& s, Output& o) { return Release(*options, s, o); });
}

}  // namespace

void AddFabCommands(CLI::App& app, Session& session) {
  CLI::App* fab = app.add_subcommand("fab", "Work orders");
  fab->require_subcommand(1);
  AddRelease(*fab, session);
  AddListOf(*fab->add_subcommand("list", "Work orders, newest first"), "workOrders", session);

  auto name = std::make_shared<std::string>();
  CLI::App* watch = fab->add_subcommand("watch", "Follow a work order to its end");
  watch->add_option("name", *name, "workOrders/… or operations/fabplanner/…")->required();
  watch->footer("Example: mortise fab watch workOrders/0198c1");
  watch->callback([&session, name] {
    session.command = [name](Session& s, Output& o) { return WatchByName(*name, s, o); };
  });

  CLI::App* show = fab->add_subcommand("show", "A work order as it is now, with machines held");
  show->add_option("name", *name, "workOrders/…; all machines if left out");
  show->footer("Example: mortise fab show workOrders/0198c1 --json");
  show->callback([&session, name] {
    session.command = [name](Session& s, Output& o) {
      return name->empty() ? ShowMachines(s, o) : Show(*name, s, o);
    };
  });

  CLI::App* hold = fab->add_subcommand("hold", "Pause a work order: no new cut begins");
  hold->add_option("name", *name, "workOrders/…")->required();
  hold->footer("Example: mortise fab hold workOrders/0198c1");
  hold->callback([&session, name] {
    session.command = [name](Session& s, Output& o) { return Hold(*name, s, o); };
  });

  AddResume(*fab, session);
  // Last: commands would inherit it.
  fab->footer("Example: mortise fab release plans/0198c1");
}

}  // namespace mortise::cli
