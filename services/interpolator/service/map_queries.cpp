#include "services/interpolator/service/map_queries.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/strip.h"
#include "common/base/errors.h"
#include "common/base/names/offered_names.h"
#include "common/base/string_views.h"

namespace mortise::interpolator {
namespace {

// How far beyond an end of a range a number may lie, over the range: rounding of who computed it.
constexpr double kRounding = 1e-9;
// Points that are interpolated at once: a map's metrics are all computed, asked for or not.
constexpr std::size_t kBlock = 1000;

// Which structure has these values of whole parameters.
std::map<std::vector<double>, std::size_t> StructuresByValues(const v1::DesignMap& map) {
  std::map<std::vector<double>, std::size_t> structures;
  for (int s = 0; s < map.structures_size(); ++s) {
    std::vector<double> values;
    for (const v1::ParameterValue& value : map.structures(s).values()) {
      values.push_back(value.value());
    }
    structures.emplace(std::move(values), static_cast<std::size_t>(s));
  }
  return structures;
}

absl::Status CheckNumber(const v1::MapParameter& parameter, double value, Eigen::Index point) {
  const double slack =
      parameter.whole() ? 0 : kRounding * (parameter.maximum() - parameter.minimum());
  if (value >= parameter.minimum() - slack && value <= parameter.maximum() + slack) {
    return absl::OkStatus();
  }
  return InvalidField(
      absl::StrCat("points[", point, "]"),
      absl::StrCat("'", parameter.name(), "' is ", value, ", beyond ", parameter.minimum(), " to ",
                   parameter.maximum(), ", the range of the map"));
}

absl::Status NoStructure(const v1::DesignMap& map, const std::vector<double>& values,
                         Eigen::Index point) {
  std::vector<std::string> parts;
  std::size_t whole = 0;
  for (const v1::MapParameter& parameter : map.parameters()) {
    if (parameter.whole()) parts.push_back(absl::StrCat(parameter.name(), " = ", values[whole++]));
  }
  return InvalidField(absl::StrCat("points[", point, "]"),
                      absl::StrCat("the map has no structure with ", absl::StrJoin(parts, ", ")));
}

absl::Status CheckAnswerSize(std::size_t points, std::size_t metrics, std::size_t parameters,
                             bool gradients) {
  const std::size_t each = metrics * (2 + (gradients ? parameters : 0));
  if (points * each <= kMaxNumbersOfMessage) return absl::OkStatus();
  return InvalidField("points",
                      absl::StrCat("the answer would have ", points * each, " numbers, of at most ",
                                   kMaxNumbersOfMessage, ": ask for ", kMaxNumbersOfMessage / each,
                                   " points at a time, or for fewer metrics"));
}

// Which points are of a structure.
std::vector<Eigen::Index> PointsOf(const MapPoints& points, std::size_t structure) {
  std::vector<Eigen::Index> numbers;
  for (std::size_t i = 0; i < points.structures.size(); ++i) {
    if (points.structures[i] == structure) numbers.push_back(static_cast<Eigen::Index>(i));
  }
  return numbers;
}

// Where an answer has its numbers.
class Answer {
 public:
  Answer(const v1::DesignMap& map, std::vector<int> columns, Eigen::Index points, bool gradients,
         v1::EvaluateMapResponse& response)
      : map_(map), columns_(std::move(columns)), response_(response) {
    const auto count = static_cast<int>(columns_.size());
    for (const v1::MapParameter& parameter : map.parameters())
      numbers_ += parameter.whole() ? 0 : 1;
    for (const int column : columns_) {
      response_.add_metrics(map.metrics(column).name());
      response_.add_units(map.metrics(column).unit());
    }
    response_.mutable_values()->Resize(static_cast<int>(points) * count, 0);
    response_.mutable_errors()->Resize(static_cast<int>(points) * count, 0);
    if (gradients) {
      response_.mutable_gradients()->Resize(
          static_cast<int>(points) * count * map.parameters_size(), 0);
    }
  }

  // Takes over what a structure's map says of its point `from` as what is said of `point`.
  void Put(const maps::MapValues& interpolated, Eigen::Index from, Eigen::Index point) {
    const auto count = static_cast<int>(columns_.size());
    for (int c = 0; c < count; ++c) {
      const Eigen::Index metric = columns_[static_cast<std::size_t>(c)];
      const int at = static_cast<int>(point) * count + c;
      response_.set_values(at, interpolated.values(metric, from));
      response_.set_errors(at, interpolated.errors(metric, from));
      if (response_.gradients().empty()) continue;
      // Output by output, each by the numbers in their order.
      Eigen::Index row = metric * numbers_;
      for (int p = 0; p < map_.parameters_size(); ++p) {
        const v1::MapParameter& parameter = map_.parameters(p);
        if (parameter.whole()) continue;
        const double range = parameter.maximum() - parameter.minimum();
        response_.set_gradients(at * map_.parameters_size() + p,
                                interpolated.gradients(row++, from) / range);
      }
    }
  }

 private:
  const v1::DesignMap& map_;
  const std::vector<int> columns_;
  Eigen::Index numbers_ = 0;  // parameters that are no whole ones
  v1::EvaluateMapResponse& response_;
};

// Of which points the map has no values: then all metrics are without, if there are any.
void AddUncovered(const LoadedMap& map, const MapPoints& points, const Eigen::MatrixXd& places,
                  v1::EvaluateMapResponse& response) {
  const int metrics = response.metrics_size();
  double unused = 0;
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    const std::size_t structure = points.structures[static_cast<std::size_t>(i)];
    const bool is_covered = metrics > 0
                                ? !std::isnan(response.values(static_cast<int>(i) * metrics))
                                : map.structures[structure].EvaluateOne(places.col(i).data(),
                                                                        &unused, nullptr, nullptr);
    if (!is_covered) response.add_uncovered(static_cast<int>(i));
  }
}

}  // namespace

absl::StatusOr<MapPoints> ReadPoints(const v1::DesignMap& map,
                                     const google::protobuf::RepeatedField<double>& points,
                                     int most) {
  const Eigen::Index parameters = map.parameters_size();
  if (points.empty() || points.size() % parameters != 0) {
    return InvalidField("points",
                        absl::StrCat("must have ", parameters, " numbers for each of 1 to ", most,
                                     " points, not ", points.size(), " in all"));
  }
  const Eigen::Index n = points.size() / parameters;
  if (n > most || points.size() > kMaxNumbersOfMessage) {
    return InvalidField(
        "points", absl::StrCat("are ", n, ", of at most ",
                               std::min<Eigen::Index>(most, kMaxNumbersOfMessage / parameters)));
  }
  MapPoints read;
  read.points = Eigen::Map<const Eigen::MatrixXd>(points.data(), parameters, n);
  const auto structures = StructuresByValues(map);
  std::vector<double> values;
  for (Eigen::Index i = 0; i < n; ++i) {
    values.clear();
    for (Eigen::Index p = 0; p < parameters; ++p) {
      const v1::MapParameter& parameter = map.parameters(static_cast<int>(p));
      MORTISE_RETURN_IF_ERROR(CheckNumber(parameter, read.points(p, i), i));
      if (parameter.whole()) values.push_back(read.points(p, i));
    }
    const auto structure = structures.find(values);
    if (structure == structures.end()) return NoStructure(map, values, i);
    read.structures.push_back(structure->second);
  }
  return read;
}

absl::StatusOr<MapPoints> ReadPoint(const v1::DesignMap& map,
                                    const google::protobuf::RepeatedField<double>& point) {
  if (point.size() != map.parameters_size()) {
    return InvalidField(
        "point", absl::StrCat("must have ", map.parameters_size(),
                              " numbers, one for each parameter of the map, not ", point.size()));
  }
  absl::StatusOr<MapPoints> read = ReadPoints(map, point, 1);
  if (read.ok()) return read;
  const absl::string_view message = read.status().message();
  return InvalidField("point", StandardView(absl::StripPrefix(message, "points[0]: ")));
}

Eigen::MatrixXd UnitPlaces(const v1::DesignMap& map, const Eigen::MatrixXd& points) {
  Eigen::MatrixXd places(points.rows(), points.cols());
  Eigen::Index row = 0;
  for (Eigen::Index p = 0; p < points.rows(); ++p) {
    const v1::MapParameter& parameter = map.parameters(static_cast<int>(p));
    if (parameter.whole()) continue;
    places.row(row++) = ((points.row(p).array() - parameter.minimum()) /
                         (parameter.maximum() - parameter.minimum()))
                            .cwiseMax(0.0)
                            .cwiseMin(1.0);
  }
  return places.topRows(row);
}

absl::StatusOr<std::vector<int>> MetricColumns(
    const v1::DesignMap& map, const google::protobuf::RepeatedPtrField<std::string>& asked) {
  std::vector<int> columns;
  std::set<std::string> names;
  for (int i = 0; i < asked.size(); ++i) {
    const std::string field = absl::StrCat("metrics[", i, "]");
    const auto at = std::ranges::find_if(
        map.metrics(), [&](const auto& metric) { return metric.name() == asked[i]; });
    if (at == map.metrics().end()) {
      return InvalidField(
          field, absl::StrCat("the map has no metric '", asked[i], "'",
                              NamesOffered(asked[i], map.metrics(), &v1::MapMetric::name)));
    }
    if (!names.insert(asked[i]).second) return InvalidField(field, "is given twice");
    columns.push_back(static_cast<int>(at - map.metrics().begin()));
  }
  if (columns.empty()) {
    for (int i = 0; i < map.metrics_size(); ++i) columns.push_back(i);
  }
  return columns;
}

absl::StatusOr<v1::EvaluateMapResponse> Evaluate(const LoadedMap& map,
                                                 const v1::EvaluateMapRequest& asked,
                                                 const std::function<bool()>& is_given_up) {
  const v1::DesignMap& record = map.record;
  MORTISE_ASSIGN_OR_RETURN(std::vector<int> columns, MetricColumns(record, asked.metrics()));
  MORTISE_ASSIGN_OR_RETURN(const MapPoints points, ReadPoints(record, asked.points(), kMaxPoints));
  MORTISE_RETURN_IF_ERROR(CheckAnswerSize(points.structures.size(), columns.size(),
                                          static_cast<std::size_t>(record.parameters_size()),
                                          asked.gradients()));
  v1::EvaluateMapResponse response;
  Answer answer(record, std::move(columns), points.points.cols(), asked.gradients(), response);
  const Eigen::MatrixXd places = UnitPlaces(record, points.points);
  for (std::size_t s = 0; s < map.structures.size(); ++s) {
    const std::vector<Eigen::Index> numbers = PointsOf(points, s);
    for (std::size_t first = 0; first < numbers.size(); first += kBlock) {
      if (is_given_up()) return absl::CancelledError("given up");
      const std::vector<Eigen::Index> block(
          numbers.begin() + static_cast<std::ptrdiff_t>(first),
          numbers.begin() + static_cast<std::ptrdiff_t>(std::min(first + kBlock, numbers.size())));
      const maps::MapValues interpolated =
          map.structures[s].Evaluate(places(Eigen::all, block).eval(), asked.gradients());
      for (std::size_t i = 0; i < block.size(); ++i) {
        answer.Put(interpolated, static_cast<Eigen::Index>(i), block[i]);
      }
    }
  }
  AddUncovered(map, points, places, response);
  return response;
}

}  // namespace mortise::interpolator
