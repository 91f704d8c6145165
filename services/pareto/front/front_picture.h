// Draws a front in the manner of Figure 7-11: its designs, its performance, and the embedding
// (§7.5.5) side by side.
//
//   - Designs: as points of the parameters that vary, up to three of them, else of their two
//     principal components. A parameter varies if it does by more than a hundredth of its range.
//   - Performance: the curve for two metrics, a view along the diagonal for three, parallel axes
//     (the best at the bottom) for more.
//   - Embedding: a bar for two metrics, a triangle for three, with each metric at its best along an
//     edge; for more a polygon towards whose corners a metric is better.
//
// A point's hue says which piece it is on, its value how far away the design of a neighbour is:
// dark where designs jump. The largest pieces have a colour of their own, the rest are grey.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/render/drawing.h"

namespace mortise::pareto {

// The n points of a front of d metrics and D parameters, a column each.
struct FrontPicture {
  std::string title;
  std::vector<std::string> parameter_names;  // D
  std::vector<std::string> metric_names;     // d
  std::vector<std::string> metric_units;     // d, may be empty
  Eigen::MatrixXd parameters;                // D x n
  Eigen::VectorXd parameter_ranges;          // D, how far each could be varied; 0: fixed
  Eigen::MatrixXd metrics;                   // d x n
  Eigen::VectorXd signs;  // d: 1 for a metric that shall be small, -1 for one that shall be large
  Eigen::MatrixXd embedding;  // d - 1 x n
  std::vector<int> piece;     // n
  Eigen::VectorXd jump;       // n
};

// Draws the picture of at least one point and two metrics.
render::Drawing DrawFront(const FrontPicture& front);

}  // namespace mortise::pareto
