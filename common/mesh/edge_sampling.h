// Puts points on a named edge of a model at shares of its length that stay when the edge grows
// (thesis §6.6.2: hierarchical subdivision).
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

#include "absl/status/status.h"
#include "common/mesh/control_variables.h"

namespace mortise::mesh {

inline constexpr int kMaximumSamples = 100'000;  // points of one model

struct NamedEdge {
  std::string name;        // of one edge of the model only
  double length = 0;       // m
  bool is_closed = false;  // it ends where it begins
  int from = -1, to = -1;  // points where it begins and ends; -1 where none has a name
  // Returns the way along the edge from one share of its length to another, 3 × at least 2, m. The
  // first column is the place of the first share alone.
  std::function<Eigen::Matrix3Xd(double, double)> way;
};

// Halves the edge until no piece is longer than `spacing`, m, and a closed one into four at least;
// adds a point at each half, "NAME at 3/8", and a path for each piece between two points. A closed
// edge without a point where it begins gets one, "NAME at 0/1". Edges without length get none.
// RESOURCE_EXHAUSTED where there would be more points than kMaximumSamples; `variables` are then as
// they were.
absl::Status SampleEdge(const NamedEdge& edge, double spacing, ControlVariables& variables);

// Returns a way along straight lines between points, 3 × at least 2, m, as NamedEdge wants it.
// Points on a straight line between others are left out. `length` becomes that of all of it.
std::function<Eigen::Matrix3Xd(double, double)> WayAlong(const Eigen::Matrix3Xd& points,
                                                         double& length);

}  // namespace mortise::mesh
