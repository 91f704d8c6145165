// mortise pareto describe: what can be varied and asked of a template or an evaluator.
#include <CLI/CLI.hpp>

#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "cli/client/command_flags.h"
#include "cli/client/requests.h"
#include "cli/client/session.h"
#include "cli/commands/commands.h"
#include "cli/files/metric_evaluation.h"
#include "common/base/errors.h"
#include "mortise/v1/evaluator.pb.h"

namespace mortise::cli {
namespace {

// "0.2 to 1.5 by 0.001", "oak, birch".
std::string ValuesText(const v1::DesignSpace::DesignParameter& parameter) {
  if (!parameter.choices().empty()) return absl::StrJoin(parameter.choices(), ", ");
  std::string text = absl::StrFormat("%.6g to %.6g", parameter.minimum(), parameter.maximum());
  if (parameter.step() > 0) absl::StrAppendFormat(&text, " by %.6g", parameter.step());
  return text;
}

std::string DefaultText(const v1::DesignSpace::DesignParameter& parameter) {
  const auto value = static_cast<int>(parameter.default_value());
  if (value >= 0 && value < parameter.choices_size()) return parameter.choices(value);
  return absl::StrFormat("%.6g", parameter.default_value());
}

absl::Status Describe(const std::string& subject, Session& session, Output& output) {
  v1::DescribeDesignSpaceRequest request;
  request.set_subject(ResourceName("templates", subject));
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  MORTISE_ASSIGN_OR_RETURN(const v1::DesignSpace space, DescribeDesignSpace(request, *client));
  std::vector<std::vector<std::string>> rows;
  for (const auto& parameter : space.parameters()) {
    rows.push_back(
        {parameter.name(), parameter.unit(), ValuesText(parameter), DefaultText(parameter)});
  }
  output.Table({"parameter", "unit", "values", "default"}, rows);
  rows.clear();
  for (const auto& metric : space.metrics()) {
    rows.push_back({metric.name(), metric.unit(), metric.description()});
  }
  output.Table({"metric", "unit", "description"}, rows);
  output.DocumentOf(space);
  return absl::OkStatus();
}

}  // namespace

void AddParetoDescribeCommand(CLI::App& pareto, Session& session) {
  auto subject = std::make_shared<std::string>();
  CommandFlags flags(
      *pareto.add_subcommand("describe", "What can be varied of a subject, and what can be asked"));
  flags.Add("subject", *subject, "Template, or evaluators/NAME", "subject")->required();
  flags.command().footer("Example: mortise pareto describe table");
  flags.Run(session, [subject](Session& s, Output& o) { return Describe(*subject, s, o); });
}

}  // namespace mortise::cli
