#include "cli/files/metric_definitions.h"

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "common/base/errors.h"

namespace mortise::cli {
namespace {

constexpr char kDefine[] = "--define";
constexpr char kPoint[] = "--point";

std::string Trimmed(const std::string& text) {
  return std::string(absl::StripAsciiWhitespace(text));
}

absl::Status ParseMetric(const std::string& text, v1::MetricExpression& metric) {
  const std::vector<std::string> halves = absl::StrSplit(text, absl::MaxSplits('=', 1));
  if (halves.size() != 2) {
    return InvalidField(kDefine,
                        absl::StrCat("'", text, "' is not of the form NAME [UNIT] = EXPRESSION"));
  }
  std::string name = Trimmed(halves[0]);
  metric.set_unit("1");
  if (const std::size_t bracket = name.find('[');
      bracket != std::string::npos && absl::EndsWith(name, "]")) {
    metric.set_unit(Trimmed(name.substr(bracket + 1, name.size() - bracket - 2)));
    name = Trimmed(name.substr(0, bracket));
  }
  metric.set_name(name);
  metric.set_expression(Trimmed(halves[1]));
  return absl::OkStatus();
}

absl::Status ParsePoint(const std::string& text, v1::NamedPoint& point) {
  const std::vector<std::string> halves = absl::StrSplit(text, absl::MaxSplits('=', 1));
  const std::vector<std::string> coordinates =
      halves.size() == 2 ? absl::StrSplit(halves[1], ',') : std::vector<std::string>();
  if (coordinates.size() != 3) {
    return InvalidField(kPoint, absl::StrCat("'", text, "' is not of the form NAME = X, Y, Z"));
  }
  point.set_name(Trimmed(halves[0]));
  point.set_x(Trimmed(coordinates[0]));
  point.set_y(Trimmed(coordinates[1]));
  point.set_z(Trimmed(coordinates[2]));
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<v1::MetricDefinitions> ParseMetricDefinitions(const MetricDefinitionFlags& flags) {
  v1::MetricDefinitions definitions;
  for (const std::string& text : flags.define) {
    MORTISE_RETURN_IF_ERROR(ParseMetric(text, *definitions.add_expressions()));
  }
  for (const std::string& text : flags.point) {
    MORTISE_RETURN_IF_ERROR(ParsePoint(text, *definitions.add_points()));
  }
  return definitions;
}

void AddMetricDefinitionFlags(CommandFlags& flags, MetricDefinitionFlags& options,
                              const std::string& more) {
  flags.Add(kDefine, options.define,
            absl::StrCat("A metric of your own, \"NAME [UNIT] = EXPRESSION\"", more));
  flags.Add(kPoint, options.point, "A point that --define speaks of, \"NAME = X, Y, Z\" (metres)");
}

void AddSources(const MetricDefinitionFlags& flags, const std::string& field,
                FieldSources& sources) {
  sources.AddEach(field + ".expressions", kDefine, flags.define);
  sources.AddEach(field + ".points", kPoint, flags.point);
}

}  // namespace mortise::cli
