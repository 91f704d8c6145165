// Line and scatter plots as SVG text, for reports: trade-off fronts, histories, comparisons.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/render/image.h"

namespace mortise::render {

// One curve or cloud. Non-finite points are left out (a line breaks there).
struct Series {
  std::string name;         // in the legend; an empty name is not listed
  Eigen::Matrix2Xd points;  // 2 × n: x and y in the units of the axes
  bool markers = true;
  bool line = false;
  Color color{-1, 0, 0};  // a negative channel: the next of the plot's palette
  double size = 3.5;      // marker radius, px
};

// A text beside a point of the plot, such as the chosen design.
struct Callout {
  double x = 0;
  double y = 0;
  std::string text;
};

struct Plot {
  std::string title;
  std::string x_label;  // with unit: "mass (kg)"
  std::string y_label;
  std::vector<Series> series;
  std::vector<Callout> callouts;
  bool logarithmic_x = false;  // needs positive values; others are left out
  bool logarithmic_y = false;
  int width = 760;   // px
  int height = 520;  // px
};

// A standalone SVG document. INVALID_ARGUMENT if a size is not within 100 to 10000 or no point is
// finite.
absl::StatusOr<std::string> PlotSvg(const Plot& plot);

// Round numbers that divide [minimum, maximum] into about `count` steps, all within it.
std::vector<double> NiceTicks(double minimum, double maximum, int count);

// A number as an axis writes it: at most `digits` significant digits, "1.2e6" outside 1e-4 to 1e6.
std::string ShortNumber(double value, int digits = 4);

// The numbers of one axis: as ShortNumber, in as many more digits as it takes for different ones to
// be written differently. On a narrow range both ends would look alike.
std::vector<std::string> ShortNumbers(const std::vector<double>& values, int digits = 4);

}  // namespace mortise::render
