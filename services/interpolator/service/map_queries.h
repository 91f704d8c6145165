// Questions of clients about a map, by the names they know.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "mortise/v1/interpolator.pb.h"
#include "services/interpolator/service/loaded_maps.h"

namespace mortise::interpolator {

inline constexpr int kMaxPoints = 100'000;
// Of a request's points and of an answer: so many doubles are as much as a message may hold.
inline constexpr int kMaxNumbersOfMessage = 500'000;

// Points of a map, and which structure each is of.
struct MapPoints {
  Eigen::MatrixXd points;               // P x n
  std::vector<std::size_t> structures;  // n
};

// Returns the points that a request has one after the other. INVALID_ARGUMENT naming "points" that
// are none, too many (`most`) or no whole points, and "points[17]", a number beyond the range of
// its parameter or of no structure of the map.
absl::StatusOr<MapPoints> ReadPoints(const v1::DesignMap& map,
                                     const google::protobuf::RepeatedField<double>& points,
                                     int most);

// Returns the one point that a request has. INVALID_ARGUMENT naming "point", as above.
absl::StatusOr<MapPoints> ReadPoint(const v1::DesignMap& map,
                                    const google::protobuf::RepeatedField<double>& point);

// Returns the K numbers of each point, as places in the unit box: K x n.
Eigen::MatrixXd UnitPlaces(const v1::DesignMap& map, const Eigen::MatrixXd& points);

// Returns which of the map's metrics are asked for by name, as places among them; all where none
// is. INVALID_ARGUMENT naming "metrics[0]" that the map lacks, or that is given twice.
absl::StatusOr<std::vector<int>> MetricColumns(
    const v1::DesignMap& map, const google::protobuf::RepeatedPtrField<std::string>& asked);

// INVALID_ARGUMENT as ReadPoints, and naming "metrics[0]" that the map lacks; CANCELLED soon after
// `is_given_up` says so.
absl::StatusOr<v1::EvaluateMapResponse> Evaluate(const LoadedMap& map,
                                                 const v1::EvaluateMapRequest& asked,
                                                 const std::function<bool()>& is_given_up);

}  // namespace mortise::interpolator
