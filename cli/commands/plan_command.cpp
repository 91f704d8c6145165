// mortise plan: how a design is made.
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/client/command_flags.h"
#include "cli/client/requests.h"
#include "cli/client/session.h"
#include "cli/client/tag_options.h"
#include "cli/commands/commands.h"
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
  std::string kerf, board_trim, sheet_trim, sheet_spacing;
  std::string mitre_limit, bevel_limit, jigsaw_radius;
  bool no_compound_cuts = false;
  std::string label_address;
  TagOptions tags;
  std::filesystem::path out;
  bool detach = false;
};

std::string PriceText(const v1::Money& money) {
  return money.currency().empty() ? "no price known"
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
    rows.push_back({plan.unpriced_lines() == 0 ? "total" : "total of what has a price", "", "", "",
                    PriceText(total)});
  }
  output.Table({"item", "pieces", "size", "supplier", "price"}, rows);
  if (plan.unpriced_lines() > 0) {
    output.Line(absl::StrCat("the total is incomplete: no price is known of ",
                             plan.unpriced_lines(),
                             plan.unpriced_lines() == 1 ? " line" : " lines"));
  }
  for (const std::string& handwork : plan.handwork()) {
    output.Line(absl::StrCat("by hand: ", handwork));
  }
}

// Rules that are not given keep the fabplanner's defaults.
absl::Status AddRules(const PlanOptions& options, v1::CreatePlanRequest& request) {
  const struct {
    const std::string& text;
    const char* flag;
    ValueParser& parse;
    void (v1::WorkshopRules::*set)(double);
  } rules[] = {
      {options.kerf, "--kerf", ParseLength, &v1::WorkshopRules::set_kerf},
      {options.board_trim, "--board-trim", ParseLength, &v1::WorkshopRules::set_board_trim},
      {options.sheet_trim, "--sheet-trim", ParseLength, &v1::WorkshopRules::set_sheet_trim},
      {options.sheet_spacing, "--sheet-spacing", ParseLength,
       &v1::WorkshopRules::set_sheet_spacing},
      {options.mitre_limit, "--mitre-limit", ParseAngle, &v1::WorkshopRules::set_mitre_limit},
      {options.bevel_limit, "--bevel-limit", ParseAngle, &v1::WorkshopRules::set_bevel_limit},
      {options.jigsaw_radius, "--jigsaw-radius", ParseLength,
       &v1::WorkshopRules::set_jigsaw_radius}};
  for (const auto& [text, flag, parse, set] : rules) {
    if (text.empty()) continue;
    MORTISE_ASSIGN_OR_RETURN(const double quantity, parse(text, flag));
    (request.mutable_rules()->*set)(quantity);
  }
  if (options.no_compound_cuts) request.mutable_rules()->set_compound_cuts(false);
  return absl::OkStatus();
}

absl::Status Plan(const PlanOptions& options, Session& session, Output& output) {
  v1::CreatePlanRequest request;
  request.set_request_id(NewIdentifier());
  request.set_template_(ResourceName("templates", options.subject));
  request.set_quantity(options.quantity);
  request.set_label_address(options.label_address);
  MORTISE_ASSIGN_OR_RETURN(const auto parameters, ParseParameters(options.parameters));
  request.mutable_parameters()->Assign(parameters.begin(), parameters.end());
  MORTISE_RETURN_IF_ERROR(AddRules(options, request));
  MORTISE_RETURN_IF_ERROR(AddTags(options.tags, &request));
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
  CommandFlags flags(*app.add_subcommand("plan", "Plan the fabrication of a design"));
  flags.Add("template", options->subject, "Template, such as table")->required();
  flags.Add("--set", options->parameters,
            "NAME=VALUE, such as length=1500mm (metres without unit) or armrests=both",
            "parameters");
  flags.Add("--quantity", options->quantity, "How many to make", "quantity")->capture_default_str();
  flags.Add("--kerf", options->kerf, "Width of a saw cut; 3mm if absent", "rules.kerf");
  flags.Add("--board-trim", options->board_trim, "Cut off each end of a board; 10mm if absent",
            "rules.board_trim");
  flags.Add("--sheet-trim", options->sheet_trim, "Left off each edge of a sheet; 10mm if absent",
            "rules.sheet_trim");
  flags.Add("--sheet-spacing", options->sheet_spacing,
            "Least distance between outlines on a sheet; 10mm if absent", "rules.sheet_spacing");
  flags.Add("--mitre-limit", options->mitre_limit,
            "How far the chop saw's table turns; 50deg if absent", "rules.mitre_limit");
  flags.Add("--bevel-limit", options->bevel_limit,
            "How far the chop saw's blade tilts; 45deg if absent", "rules.bevel_limit");
  flags.command().add_flag("--no-compound-cuts", options->no_compound_cuts,
                           "The chop saw does not turn and tilt in one cut");
  flags.Add("--jigsaw-radius", options->jigsaw_radius,
            "Least radius of inner arcs that the jigsaw follows; 10mm if absent",
            "rules.jigsaw_radius");
  flags.Add("--label-address", options->label_address,
            "Where codes on labels lead to, such as https://example.com/shop/", "label_address");
  flags.Add("--out", options->out, "Folder for cut list, bill, layouts, assembly guide and labels");
  AddTagOptions(flags, options->tags);
  AddDetach(flags.command(), options->detach)->excludes("--out");
  flags.command().footer("Example: mortise plan table --set length=1500mm --out out/plan");
  flags.Run(session, [options](Session& s, Output& o) { return Plan(*options, s, o); });
}

}  // namespace mortise::cli
