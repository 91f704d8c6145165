#include "services/pareto/service/front_queries.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/names/offered_names.h"
#include "services/pareto/service/front_limits.h"

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;

constexpr int kMaxSteps = 1000;

VectorXd ToVector(const google::protobuf::RepeatedField<double>& values) {
  return VectorXd::Map(values.data(), values.size());
}

// Fronts that were stored without them: as far as the front reaches.
VectorXd ParameterRanges(const v1::Front& message, const Eigen::MatrixXd& parameters) {
  if (message.parameter_maxima_size() == message.parameter_names_size()) {
    return ToVector(message.parameter_maxima()) - ToVector(message.parameter_minima());
  }
  if (parameters.cols() == 0) return VectorXd::Zero(parameters.rows());
  return parameters.rowwise().maxCoeff() - parameters.rowwise().minCoeff();
}

FrontPoints PointsOf(const v1::Front& message) {
  const Eigen::Index count = message.points_size(), d = message.metric_names_size();
  FrontPoints points;
  points.parameters.resize(message.parameter_names_size(), count);
  points.metrics.resize(d, count);
  points.embedding.resize(std::max<Eigen::Index>(d - 1, 0), count);
  for (int i = 0; i < message.points_size(); ++i) {
    const v1::FrontPoint& point = message.points(i);
    points.parameters.col(i) = ToVector(point.parameters());
    points.metrics.col(i) = ToVector(point.metrics());
    points.embedding.col(i) = ToVector(point.embedding());
    points.piece.push_back(point.piece());
  }
  points.signs = VectorXd::Ones(d);
  for (int k = 0; k < message.specification().objectives_size() && k < d; ++k) {
    if (message.specification().objectives(k).maximize()) points.signs[k] = -1;
  }
  points.ranges = ParameterRanges(message, points.parameters);
  return points;
}

// The number of `name` in `names`; -1 if it is not there.
int IndexOf(const std::string& name, const google::protobuf::RepeatedPtrField<std::string>& names) {
  const auto at = std::ranges::find(names, name);
  return at == names.end() ? -1 : static_cast<int>(at - names.begin());
}

absl::StatusOr<int> MetricOf(const v1::Front& front, const std::string& name,
                             const std::string& field) {
  const int metric = IndexOf(name, front.metric_names());
  if (metric >= 0) return metric;
  const std::vector<std::string> names(front.metric_names().begin(), front.metric_names().end());
  return InvalidField(
      field, absl::StrCat("the front has no metric '", name, "'", NamesOffered(name, names)));
}

absl::StatusOr<int> AtMetric(const OpenFront& front, const v1::Metric& asked) {
  MORTISE_ASSIGN_OR_RETURN(const int metric, MetricOf(front.message, asked.name(), "metric.name"));
  const std::string& unit = front.message.metric_units(metric);
  if (!asked.unit().empty() && asked.unit() != unit) {
    return InvalidField("metric.unit",
                        absl::StrCat("the front's unit of '", asked.name(), "' is '", unit, "'"));
  }
  return front.exploration.AtMetric(metric, asked.value());
}

absl::StatusOr<int> StartOf(const OpenFront& front, const v1::PickPointRequest& request) {
  if (request.has_index()) MORTISE_RETURN_IF_ERROR(front.exploration.At(request.index()).status());
  const int ways = (request.embedding_size() > 0 ? 1 : 0) + (request.has_metric() ? 1 : 0) +
                   (request.has_index() ? 1 : 0);
  if (ways != 1) {
    return InvalidField("embedding",
                        "give either a position of the embedding, a metric or an index");
  }
  if (request.has_metric()) return AtMetric(front, request.metric());
  if (request.has_index()) return front.exploration.At(request.index());
  return front.exploration.AtEmbedding(ToVector(request.embedding()));
}

absl::StatusOr<std::vector<int>> PathFrom(int start, const OpenFront& front,
                                          const v1::PickPointRequest& request) {
  if (request.steps() < 0 || request.steps() > kMaxSteps) {
    return InvalidField("steps", absl::StrCat("must lie between 1 and ", kMaxSteps));
  }
  if (request.improve().empty()) {
    if (request.steps() > 0) return InvalidField("improve", "must name a metric to walk");
    return std::vector<int>();
  }
  MORTISE_ASSIGN_OR_RETURN(const int metric, MetricOf(front.message, request.improve(), "improve"));
  return front.exploration.Walk(start, metric, std::max(request.steps(), 1));
}

void AddMetrics(const v1::Front& front, const VectorXd& values,
                google::protobuf::RepeatedPtrField<v1::Metric>& metrics) {
  for (int i = 0; i < front.metric_names_size(); ++i) {
    v1::Metric& metric = *metrics.Add();
    metric.set_name(front.metric_names(i));
    metric.set_unit(front.metric_units(i));
    metric.set_value(values[i]);
  }
}

void AddImprovement(const v1::Front& front, const Improvement& improvement,
                    v1::FrontImprovement& message) {
  message.set_metric(front.metric_names(static_cast<int>(improvement.metric)));
  AddMetrics(front, improvement.metrics, *message.mutable_metrics());
  for (int i = 0; i < front.parameter_names_size(); ++i) {
    auto& change = *message.add_parameters();
    change.set_name(front.parameter_names(i));
    change.set_value(improvement.parameters[i]);
    change.set_share(improvement.shares[i]);
  }
}

void AddRanges(const google::protobuf::RepeatedPtrField<std::string>& names, const VectorXd& least,
               const VectorXd& most,
               google::protobuf::RepeatedPtrField<v1::RestrictFrontResponse::Range>& ranges) {
  if (least.size() == 0) return;
  for (int i = 0; i < names.size(); ++i) {
    auto& range = *ranges.Add();
    range.set_name(names[i]);
    range.set_minimum(least[i]);
    range.set_maximum(most[i]);
  }
}

}  // namespace

OpenFront::OpenFront(v1::Front stored)
    : message(std::move(stored)), exploration(PointsOf(message)) {}

absl::StatusOr<v1::PickPointResponse> Pick(const OpenFront& front,
                                           const v1::PickPointRequest& request) {
  MORTISE_ASSIGN_OR_RETURN(const int start, StartOf(front, request));
  MORTISE_ASSIGN_OR_RETURN(const std::vector<int> path, PathFrom(start, front, request));
  const int index = path.empty() ? start : path.back();
  const v1::Front& message = front.message;
  v1::PickPointResponse response;
  *response.mutable_point() = message.points(index);
  response.set_index(index);
  for (int i = 0; i < message.parameter_names_size(); ++i) {
    v1::ParameterValue& parameter = *response.add_parameters();
    parameter.set_name(message.parameter_names(i));
    parameter.set_value(message.points(index).parameters(i));
    if (i < message.points(index).choices_size()) {
      parameter.set_choice(message.points(index).choices(i));
    }
  }
  AddMetrics(message, ToVector(message.points(index).metrics()), *response.mutable_metrics());
  response.mutable_path()->Add(path.begin(), path.end());
  const std::vector<int> neighbours = front.exploration.NeighboursOf(index);
  response.mutable_neighbours()->Add(neighbours.begin(), neighbours.end());
  for (const Improvement& improvement : front.exploration.ImprovementsAt(index)) {
    AddImprovement(message, improvement, *response.add_improvements());
  }
  return response;
}

absl::StatusOr<v1::RestrictFrontResponse> Restrict(const OpenFront& front,
                                                   const v1::RestrictFrontRequest& request) {
  MORTISE_ASSIGN_OR_RETURN(FrontLimits read, ReadLimits(front.message, front.exploration, request));
  const FrontPart part = front.exploration.Within(read.limits);
  v1::RestrictFrontResponse response;
  for (std::size_t i = 0; i < read.limits.size(); ++i) {
    v1::FrontLimit& kept = *response.add_limits();
    kept = request.limits(static_cast<int>(i));
    if (read.limits[i].minimum) kept.set_minimum(*read.limits[i].minimum);
    if (read.limits[i].maximum) kept.set_maximum(*read.limits[i].maximum);
  }
  if (part.points.empty()) {
    for (std::string& why : WhyNothingRemains(front.message, front.exploration, read.limits)) {
      read.remarks.push_back(std::move(why));
    }
  }
  response.mutable_remarks()->Add(read.remarks.begin(), read.remarks.end());
  response.mutable_points()->Add(part.points.begin(), part.points.end());
  response.set_pieces(part.pieces);
  AddRanges(front.message.metric_names(), part.least_metrics, part.most_metrics,
            *response.mutable_metrics());
  for (int i = 0; i < response.metrics_size(); ++i) {
    response.mutable_metrics(i)->set_unit(front.message.metric_units(i));
  }
  AddRanges(front.message.parameter_names(), part.least_parameters, part.most_parameters,
            *response.mutable_parameters());
  for (const MetricConflict& found : part.conflicts) {
    auto& conflict = *response.add_conflicts();
    conflict.set_first(front.message.metric_names(static_cast<int>(found.first)));
    conflict.set_second(front.message.metric_names(static_cast<int>(found.second)));
    conflict.set_correlation(found.correlation);
  }
  return response;
}

}  // namespace mortise::pareto
