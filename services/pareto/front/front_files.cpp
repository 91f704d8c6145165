// CSV, JSON, SVG and PNG of fronts.
#include "services/pareto/front/front_files.h"

#include <google/protobuf/util/json_util.h>

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/base/text_escapes.h"
#include "common/render/drawing.h"
#include "mortise/v1/pareto.pb.h"
#include "services/pareto/front/front_picture.h"

namespace mortise::pareto {
namespace {

std::string Label(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : absl::StrCat(name, " (", unit, ")");
}

std::string MetricLabel(const v1::Front& front, int index) {
  return Label(front.metric_names(index), front.metric_units(index));
}

std::string ConstraintLabel(const v1::Front& front, int index) {
  return Label(front.specification().constraints(index).metric(), front.constraint_units(index));
}

bool IsChoice(const v1::Front& front, int parameter) {
  return parameter < front.parameter_choices_size() &&
         !front.parameter_choices(parameter).names().empty();
}

Eigen::VectorXd Numbers(const google::protobuf::RepeatedField<double>& values) {
  return Eigen::VectorXd::Map(values.data(), values.size());
}

absl::StatusOr<render::Drawing> DrawingOf(const v1::Front& front) {
  if (front.points().empty()) {
    return PreconditionFailed("FRONT_EMPTY", "the front has no points to draw", front.name());
  }
  const Eigen::Index count = front.points_size(), D = front.parameter_names_size(),
                     d = front.metric_names_size();
  FrontPicture picture;
  picture.title = absl::StrCat("Trade-offs of ", front.specification().subject());
  picture.parameter_names.assign(front.parameter_names().begin(), front.parameter_names().end());
  picture.metric_names.assign(front.metric_names().begin(), front.metric_names().end());
  picture.metric_units.assign(front.metric_units().begin(), front.metric_units().end());
  picture.metric_units.resize(picture.metric_names.size());
  picture.parameters.resize(D, count);
  picture.metrics.resize(d, count);
  picture.embedding.resize(d - 1, count);
  picture.jump.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const v1::FrontPoint& point = front.points(static_cast<int>(i));
    picture.parameters.col(i) = Numbers(point.parameters());
    picture.metrics.col(i) = Numbers(point.metrics());
    picture.embedding.col(i) = Numbers(point.embedding());
    picture.piece.push_back(point.piece());
    picture.jump[i] = point.jump();
  }
  // Fronts of old do not say how far parameters could be varied.
  picture.parameter_ranges =
      front.parameter_maxima_size() == D
          ? Eigen::VectorXd(Numbers(front.parameter_maxima()) - Numbers(front.parameter_minima()))
          : Eigen::VectorXd(picture.parameters.rowwise().maxCoeff() -
                            picture.parameters.rowwise().minCoeff());
  picture.signs = Eigen::VectorXd::Ones(d);
  for (int k = 0; k < std::min<int>(front.specification().objectives_size(), d); ++k) {
    if (front.specification().objectives(k).maximize()) picture.signs[k] = -1;
  }
  return DrawFront(picture);
}

}  // namespace

std::string FrontAsCsv(const v1::Front& front) {
  std::string csv;
  for (int i = 0; i < front.parameter_names_size(); ++i) {
    const std::string& name = front.parameter_names(i);
    absl::StrAppend(&csv, CsvField(name), ",");
    if (IsChoice(front, i)) absl::StrAppend(&csv, CsvField(Label(name, "choice")), ",");
  }
  for (int i = 0; i < front.metric_names_size(); ++i) {
    absl::StrAppend(&csv, CsvField(MetricLabel(front, i)), ",");
  }
  for (int i = 0; i < front.specification().constraints_size(); ++i) {
    absl::StrAppend(&csv, CsvField(ConstraintLabel(front, i)), ",");
  }
  const bool robust = front.specification().tolerances_size() > 0;
  for (int i = 0; robust && i < front.metric_names_size(); ++i) {
    const std::string &name = front.metric_names(i), &unit = front.metric_units(i);
    absl::StrAppend(&csv, CsvField(Label(absl::StrCat("mean ", name), unit)), ",",
                    CsvField(Label(absl::StrCat("deviation of ", name), unit)), ",");
  }
  csv += "piece\r\n";
  for (const v1::FrontPoint& point : front.points()) {
    for (int i = 0; i < point.parameters_size(); ++i) {
      absl::StrAppendFormat(&csv, "%.17g,", point.parameters(i));
      if (IsChoice(front, i)) absl::StrAppend(&csv, CsvField(point.choices(i)), ",");
    }
    for (const double value : point.metrics()) absl::StrAppendFormat(&csv, "%.17g,", value);
    for (const double value : point.constraint_metrics()) {
      absl::StrAppendFormat(&csv, "%.17g,", value);
    }
    for (int i = 0; robust && i < point.metric_means_size(); ++i) {
      absl::StrAppendFormat(&csv, "%.17g,%.17g,", point.metric_means(i),
                            point.metric_deviations(i));
    }
    absl::StrAppend(&csv, point.piece(), "\r\n");
  }
  return csv;
}

absl::StatusOr<std::string> FrontAsJson(const v1::Front& front) {
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = true;
  std::string json;
  const auto status = google::protobuf::util::MessageToJsonString(front, &json, options);
  if (!status.ok()) {
    return absl::InternalError(absl::StrCat("the front as JSON: ", std::string(status.message())));
  }
  return json;
}

absl::StatusOr<std::string> FrontAsSvg(const v1::Front& front) {
  MORTISE_ASSIGN_OR_RETURN(const render::Drawing drawing, DrawingOf(front));
  return render::DrawingSvg(drawing);
}

absl::StatusOr<std::string> FrontAsPng(const v1::Front& front) {
  MORTISE_ASSIGN_OR_RETURN(const render::Drawing drawing, DrawingOf(front));
  MORTISE_ASSIGN_OR_RETURN(const render::Image image, render::DrawingImage(drawing));
  return render::EncodePng(image);
}

}  // namespace mortise::pareto
