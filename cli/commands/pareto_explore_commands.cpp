// mortise pareto pick|restrict: questions about a front.
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "cli/client/command_flags.h"
#include "cli/client/requests.h"
#include "cli/client/session.h"
#include "cli/commands/commands.h"
#include "common/base/decimal_number.h"
#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/pareto.grpc.pb.h"

namespace mortise::cli {
namespace {

constexpr double kSmallStep = 0.01;    // of a metric's value, for people
constexpr double kNamedShare = 0.005;  // parameters with less part in a change are not named

struct PickOptions {
  std::string front;
  std::string at;
  std::optional<int> index;
  std::string improve;
  int steps = 0;
};

struct RestrictOptions {
  std::string front;
  std::vector<std::string> range;
};

absl::Status AddPlace(const std::string& at, v1::PickPointRequest& request) {
  const std::size_t split = at.find('=');
  if (split != std::string::npos) {
    MORTISE_ASSIGN_OR_RETURN(const double value, ParseMetricValue(at.substr(split + 1), "--at"));
    request.mutable_metric()->set_name(at.substr(0, split));
    request.mutable_metric()->set_value(value);
    return absl::OkStatus();
  }
  for (const absl::string_view coordinate : absl::StrSplit(at, ',')) {
    const absl::string_view digits = absl::StripAsciiWhitespace(coordinate);
    const auto value = DecimalNumber(std::string_view(digits.data(), digits.size()));
    if (!value) {
      return InvalidField("--at", absl::StrCat("'", at, "' is neither METRIC=VALUE nor numbers"));
    }
    request.add_embedding(*value);
  }
  return absl::OkStatus();
}

std::string Signed(const std::string& text) {
  return text.starts_with('-') ? text : absl::StrCat("+", text);
}

// "mass -0.18 kg: max_displacement +0.03 mm; by length 83 %, width 17 %", for a hundredth of the
// metric's value.
std::string ImprovementText(const v1::PickPointResponse& response,
                            const v1::FrontImprovement& improvement) {
  double size = 1;
  for (const v1::Metric& metric : response.metrics()) {
    if (metric.name() == improvement.metric() && metric.value() != 0) {
      size = kSmallStep * std::abs(metric.value());
    }
  }
  std::string own;
  std::vector<std::string> others;
  for (v1::Metric change : improvement.metrics()) {
    change.set_value(change.value() * size);
    const std::string text = absl::StrCat(change.name(), " ", Signed(MetricText(change)));
    if (change.name() == improvement.metric()) {
      own = text;
    } else {
      others.push_back(text);
    }
  }
  std::vector<const v1::FrontImprovement::ParameterChange*> changes;
  for (const auto& change : improvement.parameters()) {
    if (change.share() >= kNamedShare) changes.push_back(&change);
  }
  std::ranges::stable_sort(changes, [](auto* a, auto* b) { return a->share() > b->share(); });
  const std::string parameters =
      absl::StrJoin(changes, ", ", [](std::string* out, const auto* change) {
        absl::StrAppendFormat(out, "%s %.0f %%", change->name(), 100 * change->share());
      });
  return absl::StrCat(own, ": ", absl::StrJoin(others, ", "),
                      parameters.empty() ? "" : absl::StrCat("; by ", parameters));
}

void PrintPick(const v1::PickPointResponse& response, const Output& output) {
  std::vector<std::vector<std::string>> rows;
  for (const v1::Metric& metric : response.metrics()) {
    rows.push_back({metric.name(), MetricText(metric)});
  }
  for (int i = 0; i < response.parameters_size(); ++i) {
    const v1::ParameterValue& value = response.parameters(i);
    const bool is_choice =
        i < response.point().choices_size() && !response.point().choices(i).empty();
    rows.push_back({value.name(), is_choice ? response.point().choices(i)
                                            : absl::StrFormat("%.6g", value.value())});
  }
  output.Table({"name", "value"}, rows);
  output.Line(absl::StrCat("Point ", response.index(), " on piece ", response.point().piece(),
                           ", next to ", absl::StrJoin(response.neighbours(), ", ")));
  if (response.improvements().empty()) return;
  output.Line("To improve by a hundredth:");
  for (const v1::FrontImprovement& improvement : response.improvements()) {
    output.Line(absl::StrCat("  ", ImprovementText(response, improvement)));
  }
}

absl::Status Pick(const PickOptions& options, Session& session, Output& output) {
  v1::PickPointRequest request;
  request.set_name(ResourceName("fronts", options.front));
  if (options.at.empty() == !options.index) {
    return InvalidField("--at", "give either --at or --index");
  }
  if (options.index) {
    request.set_index(*options.index);
  } else {
    MORTISE_RETURN_IF_ERROR(AddPlace(options.at, request));
  }
  request.set_improve(options.improve);
  request.set_steps(options.steps);
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::ParetoService::NewStub(client->channel());
  v1::PickPointResponse response;
  MORTISE_RETURN_IF_ERROR(client->Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc(stub->PickPoint(&context, request, &response));
  }));
  PrintPick(response, output);
  output.DocumentOf(response);
  return absl::OkStatus();
}

absl::Status AddLimit(const std::string& text, v1::RestrictFrontRequest& request) {
  MORTISE_ASSIGN_OR_RETURN(const NamedRange range, ParseRange(text, "--range"));
  v1::FrontLimit& limit = *request.add_limits();
  limit.set_name(range.name);
  if (range.low) limit.set_minimum(*range.low);
  if (range.high) limit.set_maximum(*range.high);
  return absl::OkStatus();
}

void PrintPart(const v1::RestrictFrontResponse& response, const Output& output) {
  output.Line(
      absl::StrFormat("%d points in %d pieces remain", response.points_size(), response.pieces()));
  for (const std::string& remark : response.remarks()) output.Line(remark);
  std::vector<std::vector<std::string>> rows;
  for (const v1::RestrictFrontResponse::Range& range : response.metrics()) {
    rows.push_back({range.name(), MetricText(MetricOf(range.unit(), range.minimum())),
                    MetricText(MetricOf(range.unit(), range.maximum()))});
  }
  for (const v1::RestrictFrontResponse::Range& range : response.parameters()) {
    rows.push_back({range.name(), absl::StrFormat("%.6g", range.minimum()),
                    absl::StrFormat("%.6g", range.maximum())});
  }
  if (!rows.empty()) output.Table({"name", "from", "to"}, rows);
  for (const v1::RestrictFrontResponse::Conflict& conflict : response.conflicts()) {
    output.Line(absl::StrFormat("%s and %s: correlation %.2f", conflict.first(), conflict.second(),
                                conflict.correlation()));
  }
}

absl::Status Restrict(const RestrictOptions& options, Session& session, Output& output) {
  v1::RestrictFrontRequest request;
  request.set_name(ResourceName("fronts", options.front));
  for (const std::string& range : options.range) MORTISE_RETURN_IF_ERROR(AddLimit(range, request));
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::ParetoService::NewStub(client->channel());
  v1::RestrictFrontResponse response;
  MORTISE_RETURN_IF_ERROR(client->Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc(stub->RestrictFront(&context, request, &response));
  }));
  PrintPart(response, output);
  output.DocumentOf(response);
  return absl::OkStatus();
}

void AddPick(CLI::App& pareto, Session& session) {
  auto options = std::make_shared<PickOptions>();
  CommandFlags flags(*pareto.add_subcommand(
      "pick", "The point of a front at a place, and what improving it costs"));
  flags.Add("front", options->front, "Front")->required();
  flags.Add("--at", options->at, "METRIC=VALUE, or coordinates 0 to 1 of the embedding",
            "embedding");
  flags.AlsoGives("--at", "metric");
  flags.Add("--index", options->index, "The point's place in the front, 0 for the first", "index");
  flags.Add("--improve", options->improve, "Walk from there to better values of a metric",
            "improve");
  flags.Add("--steps", options->steps, "Points to walk; 1 by default", "steps");
  flags.command().footer("Example: mortise pareto pick fronts/0198c1 --at max_displacement=1.5mm");
  flags.Run(session, [options](Session& s, Output& o) { return Pick(*options, s, o); });
}

void AddRestrict(CLI::App& pareto, Session& session) {
  auto options = std::make_shared<RestrictOptions>();
  CommandFlags flags(*pareto.add_subcommand(
      "restrict", "What remains of a front when metrics or parameters keep to limits"));
  flags.Add("front", options->front, "Front")->required();
  flags.Add("--range", options->range,
            "NAME=LOW:HIGH, NAME=LOW: or NAME=:HIGH, of a metric or a parameter", "limits");
  flags.command().footer("Example: mortise pareto restrict fronts/0198c1 --range mass=:18");
  flags.Run(session, [options](Session& s, Output& o) { return Restrict(*options, s, o); });
}

}  // namespace

void AddParetoExploreCommands(CLI::App& pareto, Session& session) {
  AddPick(pareto, session);
  AddRestrict(pareto, session);
}

}  // namespace mortise::cli
