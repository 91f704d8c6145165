// CSV, JSON and SVG of fronts.
#include "services/pareto/front_files.h"

#include <google/protobuf/util/json_util.h>

#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/render/svg_plot.h"
#include "mortise/v1/pareto.pb.h"

namespace mortise::pareto {
namespace {

constexpr int kListedPieces = 12;

std::string Quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + "\"";
}

std::string Label(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : absl::StrCat(name, " (", unit, ")");
}

std::string MetricLabel(const v1::Front& front, int index) {
  return Label(front.metric_names(index), front.metric_units(index));
}

std::string ConstraintLabel(const v1::Front& front, int index) {
  return Label(front.specification().constraints(index).metric(), front.constraint_units(index));
}

}  // namespace

std::string FrontAsCsv(const v1::Front& front) {
  std::string csv;
  for (const std::string& name : front.parameter_names()) absl::StrAppend(&csv, Quoted(name), ",");
  for (int i = 0; i < front.metric_names_size(); ++i)
    absl::StrAppend(&csv, Quoted(MetricLabel(front, i)), ",");
  for (int i = 0; i < front.specification().constraints_size(); ++i)
    absl::StrAppend(&csv, Quoted(ConstraintLabel(front, i)), ",");
  const bool robust = front.specification().tolerances_size() > 0;
  for (int i = 0; robust && i < front.metric_names_size(); ++i) {
    const std::string &name = front.metric_names(i), &unit = front.metric_units(i);
    absl::StrAppend(&csv, Quoted(Label(absl::StrCat("mean ", name), unit)), ",",
                    Quoted(Label(absl::StrCat("deviation of ", name), unit)), ",");
  }
  csv += "piece\r\n";
  for (const v1::FrontPoint& point : front.points()) {
    for (const double value : point.parameters()) absl::StrAppendFormat(&csv, "%.17g,", value);
    for (const double value : point.metrics()) absl::StrAppendFormat(&csv, "%.17g,", value);
    for (const double value : point.constraint_metrics())
      absl::StrAppendFormat(&csv, "%.17g,", value);
    for (int i = 0; robust && i < point.metric_means_size(); ++i)
      absl::StrAppendFormat(&csv, "%.17g,%.17g,", point.metric_means(i),
                            point.metric_deviations(i));
    absl::StrAppend(&csv, point.piece(), "\r\n");
  }
  return csv;
}

absl::StatusOr<std::string> FrontAsJson(const v1::Front& front) {
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = true;
  std::string json;
  const auto status = google::protobuf::util::MessageToJsonString(front, &json, options);
  if (!status.ok())
    return absl::InternalError(absl::StrCat("the front as JSON: ", std::string(status.message())));
  return json;
}

absl::StatusOr<std::string> FrontAsSvg(const v1::Front& front) {
  if (front.points().empty())
    return PreconditionFailed("FRONT_EMPTY", "the front has no points to draw", front.name());
  std::vector<std::vector<Eigen::Vector2d>> pieces(
      static_cast<std::size_t>(std::max(front.pieces(), 1)));
  for (const v1::FrontPoint& point : front.points())
    pieces[static_cast<std::size_t>(point.piece()) % pieces.size()].emplace_back(point.metrics(0),
                                                                                 point.metrics(1));
  render::Plot plot;
  plot.title = absl::StrCat("Trade-offs of ", front.specification().subject());
  plot.x_label = MetricLabel(front, 0);
  plot.y_label = MetricLabel(front, 1);
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    render::Series series;
    if (pieces.size() > 1 && k < kListedPieces) series.name = absl::StrCat("piece ", k);
    series.points.resize(2, static_cast<Eigen::Index>(pieces[k].size()));
    for (std::size_t i = 0; i < pieces[k].size(); ++i)
      series.points.col(static_cast<Eigen::Index>(i)) = pieces[k][i];
    plot.series.push_back(std::move(series));
  }
  return render::PlotSvg(plot);
}

}  // namespace mortise::pareto
