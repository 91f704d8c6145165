// Charts: lines and dots on two axes, in panels with one legend, as a Drawing, hence SVG and PNG.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/render/drawing.h"
#include "common/render/image.h"

namespace mortise::render {

// A rectangle of a drawing, in its pixels.
struct Frame {
  double left = 0, top = 0, width = 0, height = 0;

  // From (0, 0), the lower left corner, to (1, 1), the upper right one.
  Eigen::Vector2d At(double x, double y) const {
    return {left + x * width, top + (1 - y) * height};
  }
  Eigen::Vector2d Middle() const { return At(0.5, 0.5); }
  // Returns what is left of it inside of margins.
  Frame Within(double on_left, double on_right, double above, double below) const {
    return {left + on_left, top + above, width - on_left - on_right, height - above - below};
  }
};

// What an axis spans.
struct AxisSpan {
  double least = 0;  // > 0 on a logarithmic axis
  double most = 1;   // > least
  bool logarithmic = false;

  // Returns where a value lies between least, 0, and most, 1. On a logarithmic axis values must be
  // positive.
  double Share(double value) const;
};

// Returns the span of the finite values, on a logarithmic axis of the positive ones; a little more
// than nothing where all are the same, and 0 to 1 where there are none.
AxisSpan SpanOf(const std::vector<double>& values, bool logarithmic = false);

// Two axes with numbers, a grid and their names.
class Axes {
 public:
  // All is within `whole`: the name of y above, that of x below on the right. Values are drawn a
  // little inside of the axes' ends.
  Axes(const Frame& whole, const AxisSpan& x, const AxisSpan& y);

  void Draw(Drawing& drawing, const std::string& x_name, const std::string& y_name) const;

  // Returns the place of a point.
  Eigen::Vector2d At(double x, double y) const;

 private:
  Frame whole_, inner_;
  AxisSpan x_, y_;
};

// Points of one kind.
struct ChartSeries {
  std::string name = {};               // in the legend, once for all panels; none where it is empty
  std::vector<double> x = {}, y = {};  // as many; a point that is not finite breaks the line
  Color color = {};
  double line_width = 2;  // pixels; 0 for no line
  double dot_radius = 3;  // pixels; 0 for no dots
};

struct ChartPanel {
  std::string title = {};
  std::string x_name = {}, y_name = {};
  bool x_logarithmic = false, y_logarithmic = false;
  std::vector<ChartSeries> series = {};
  std::vector<double> x_shown = {}, y_shown = {};  // values that the axes reach in any case
};

struct ChartLayout {
  int columns = 3;
  int panel_width = 330, panel_height = 270;  // pixels
};

// Returns the panels in rows, and the legend below. A point that its panel's logarithmic axis
// cannot show is left out, and breaks the line.
Drawing DrawChart(const std::vector<ChartPanel>& panels, const ChartLayout& layout = {});

}  // namespace mortise::render
