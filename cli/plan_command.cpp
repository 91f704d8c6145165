// mortise plan: how a design is made.
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/field_sources.h"
#include "cli/requests.h"
#include "cli/session.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/fabplanner.grpc.pb.h"

namespace mortise::cli {
namespace {

struct PlanOptions {
  std::string subject;
  std::vector<std::string> parameters;
  int quantity = 1;
  std::string kerf;
  std::filesystem::path out;
  bool detach = false;
};

FieldSources SourcesOf(const PlanOptions& options) {
  FieldSources sources;
  sources.AddEach("parameters", "--set", options.parameters);
  sources.Add("quantity", "--quantity");
  sources.Add("rules.kerf", "--kerf");
  return sources;
}

std::string PriceText(const v1::Money& money) {
  return money.currency().empty() ? ""
                                  : absl::StrFormat("%.2f %s", money.amount(), money.currency());
}

void PrintPlan(const v1::Plan& plan, const Output& output) {
  int bought = 0, drawn = 0;
  for (const v1::PlannedPart& part : plan.parts()) {
    bought += part.making() == v1::PlannedPart::BOUGHT ? plan.quantity() : 0;
    drawn += part.making() == v1::PlannedPart::TO_DRAWING ? plan.quantity() : 0;
  }
  output.Line(absl::StrFormat(
      "%s: %d parts from the chop saw, %d from the jigsaw, %d bought, %d made to drawing, %d pegs, "
      "%d steps",
      plan.name(), plan.chop_saw_parts(), plan.jigsaw_parts(), bought, drawn, plan.pegs(),
      plan.steps_size()));
  std::vector<std::vector<std::string>> rows;
  for (const v1::BillLine& line : plan.bill()) {
    rows.push_back({line.title(), absl::StrFormat("%g", line.quantity()), line.dimensions(),
                    line.supplier(), PriceText(line.price())});
  }
  for (const v1::Money& total : plan.totals()) {
    rows.push_back({"total", "", "", "", PriceText(total)});
  }
  output.Table({"item", "pieces", "size", "supplier", "price"}, rows);
  for (const std::string& handwork : plan.handwork()) {
    output.Line(absl::StrCat("by hand: ", handwork));
  }
}

absl::Status Plan(const PlanOptions& options, Session& session, Output& output) {
  v1::CreatePlanRequest request;
  request.set_request_id(NewIdentifier());
  request.set_template_(ResourceName("templates", options.subject));
  request.set_quantity(options.quantity);
  MORTISE_ASSIGN_OR_RETURN(const auto parameters, ParseParameters(options.parameters));
  request.mutable_parameters()->Assign(parameters.begin(), parameters.end());
  if (!options.kerf.empty()) {
    MORTISE_ASSIGN_OR_RETURN(const double kerf, ParseQuantity(options.kerf, "--kerf"));
    request.mutable_rules()->set_kerf(kerf);
  }
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::FabPlannerService::NewStub(client->channel());
  MORTISE_ASSIGN_OR_RETURN(
      const std::optional<v1::Plan> made,
      RunTo<v1::Plan>(
          *client, session.Work(options.detach),
          [&](grpc::ClientContext& context, v1::Operation* operation) {
            return rpc::FromGrpc(stub->CreatePlan(&context, request, operation));
          },
          output));
  if (!made) return absl::OkStatus();
  const v1::Plan& plan = *made;
  PrintPlan(plan, output);
  for (const v1::Artifact& artifact : plan.artifacts()) {
    if (options.out.empty()) break;
    v1::DownloadArtifactRequest wanted;
    wanted.set_name(plan.name());
    wanted.set_file_name(artifact.file_name());
    const std::filesystem::path path = options.out / artifact.file_name();
    MORTISE_RETURN_IF_ERROR(client->Call([&](grpc::ClientContext& context) {
      return Receive(*stub->DownloadArtifact(&context, wanted), path).status();
    }));
    output.Line(absl::StrCat("  ", path.string()));
  }
  output.DocumentOf(plan);
  return absl::OkStatus();
}

}  // namespace

void AddPlanCommand(CLI::App& app, Session& session) {
  auto options = std::make_shared<PlanOptions>();
  CLI::App* plan = app.add_subcommand("plan", "Plan the fabrication of a design");
  plan->add_option("template", options->subject, "Template, such as table")->required();
  plan->add_option("--set", options->parameters,
                   "NAME=VALUE, such as length=1500mm (metres without unit)");
  plan->add_option("--quantity", options->quantity, "How many to make")->capture_default_str();
  plan->add_option("--kerf", options->kerf, "Width of a saw cut; 3mm if absent");
  plan->add_option("--out", options->out, "Folder for cut list, bill, layouts and assembly guide");
  AddDetach(*plan, options->detach)->excludes("--out");
  plan->footer("Example: mortise plan table --set length=1500mm --out out/plan");
  plan->callback([&session, options] {
    session.command = [options](Session& s, Output& output) {
      return SourcesOf(*options).Name(Plan(*options, s, output));
    };
  });
}

}  // namespace mortise::cli
