// Axes, what stands on them, and the legend.
#include "common/render/chart.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/render/axis_numbers.h"

namespace mortise::render {
namespace {

using Eigen::Vector2d;

constexpr double kFont = 13, kSmallFont = 11;
constexpr double kMargin = 0.03;  // of an axis, free at either end
constexpr Color kInk{0.125, 0.137, 0.165}, kGrid{0.86, 0.87, 0.89};
constexpr double kTitleHeight = 24, kLegendRow = 20, kLegendMargin = 14;

void Write(Drawing& drawing, const Vector2d& at, const std::string& text, double size = kFont,
           Drawing::Anchor anchor = Drawing::Anchor::kStart) {
  drawing.Add(Drawing::Text{at, text, size, anchor, kInk});
}

// The powers of ten of the span; between them twice and five times these, where it is short.
std::vector<double> LogarithmicTicks(const AxisSpan& span) {
  constexpr double kRounding = 1e-9;
  const double decades = std::log10(span.most / span.least);
  std::vector<double> factors{1};
  if (decades < 2.5) factors = {1, 2, 5};
  std::vector<double> ticks;
  for (double power = std::floor(std::log10(span.least)); power <= std::log10(span.most); ++power) {
    for (const double factor : factors) {
      const double tick = factor * std::pow(10, power);
      if (tick >= span.least * (1 - kRounding) && tick <= span.most * (1 + kRounding)) {
        ticks.push_back(tick);
      }
    }
  }
  return ticks.size() >= 2 ? ticks : std::vector<double>{span.least, span.most};
}

std::vector<double> Ticks(const AxisSpan& span, int count) {
  return span.logarithmic ? LogarithmicTicks(span) : NiceTicks(span.least, span.most, count);
}

// Whether the panel's axes can show a point.
bool IsShown(const ChartPanel& panel, double x, double y) {
  return std::isfinite(x) && std::isfinite(y) && (!panel.x_logarithmic || x > 0) &&
         (!panel.y_logarithmic || y > 0);
}

void DrawSeries(Drawing& drawing, const Axes& axes, const ChartPanel& panel,
                const ChartSeries& series) {
  Drawing::Line line{{}, series.color, series.line_width};
  const auto end_line = [&] {
    if (series.line_width > 0 && line.points.size() > 1) drawing.Add(line);
    line.points.clear();
  };
  for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i) {
    if (!IsShown(panel, series.x[i], series.y[i])) {
      end_line();
      continue;
    }
    const Vector2d place = axes.At(series.x[i], series.y[i]);
    line.points.push_back(place);
    if (series.dot_radius > 0) drawing.Add(Drawing::Disc{place, series.dot_radius, series.color});
  }
  end_line();
}

void DrawPanel(Drawing& drawing, const Frame& frame, const ChartPanel& panel) {
  std::vector<double> x = panel.x_shown, y = panel.y_shown;
  for (const ChartSeries& series : panel.series) {
    for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i) {
      if (!IsShown(panel, series.x[i], series.y[i])) continue;
      x.push_back(series.x[i]);
      y.push_back(series.y[i]);
    }
  }
  Write(drawing, frame.At(0.5, 1) + Vector2d(0, 14), Shortened(panel.title, kFont + 1, frame.width),
        kFont + 1, Drawing::Anchor::kMiddle);
  const Axes axes(frame.Within(8, 8, kTitleHeight, 4), SpanOf(x, panel.x_logarithmic),
                  SpanOf(y, panel.y_logarithmic));
  axes.Draw(drawing, panel.x_name, panel.y_name);
  for (const ChartSeries& series : panel.series) DrawSeries(drawing, axes, panel, series);
}

// The series that the legend names, each once.
std::vector<ChartSeries> Named(const std::vector<ChartPanel>& panels) {
  std::vector<ChartSeries> named;
  for (const ChartPanel& panel : panels) {
    for (const ChartSeries& series : panel.series) {
      const bool known = std::ranges::any_of(
          named, [&](const ChartSeries& each) { return each.name == series.name; });
      if (!series.name.empty() && !known) named.push_back(series);
    }
  }
  return named;
}

constexpr double kKeyWidth = 30;  // of a legend's line

double LegendWidth(const ChartSeries& series) {
  return kKeyWidth + TextWidth(0.72 * kFont, series.name) + 26;
}

// The names in rows as long as the drawing is wide.
std::vector<std::vector<ChartSeries>> LegendRows(const std::vector<ChartPanel>& panels,
                                                 double width) {
  std::vector<std::vector<ChartSeries>> rows;
  double used = width;
  for (ChartSeries& series : Named(panels)) {
    const double room = LegendWidth(series);
    if (rows.empty() || used + room > width) {
      rows.emplace_back();
      used = 0;
    }
    used += room;
    rows.back().push_back(std::move(series));
  }
  return rows;
}

}  // namespace

double AxisSpan::Share(double value) const {
  return logarithmic ? std::log(value / least) / std::log(most / least)
                     : (value - least) / (most - least);
}

AxisSpan SpanOf(const std::vector<double>& values, bool logarithmic) {
  AxisSpan span{0, 1, logarithmic};
  bool any = false;
  for (const double value : values) {
    if (!std::isfinite(value) || (logarithmic && value <= 0)) continue;
    span.least = any ? std::min(span.least, value) : value;
    span.most = any ? std::max(span.most, value) : value;
    any = true;
  }
  if (!any) return {logarithmic ? 0.1 : 0, 1, logarithmic};
  const double size = std::max(std::abs(span.least), std::abs(span.most));
  if (span.most - span.least > 1e-9 * size) return span;
  if (logarithmic) return {span.least / 1.1, span.most * 1.1, true};
  const double room = size > 0 ? 0.1 * size : 1;
  return {span.least - room, span.most + room, false};
}

Axes::Axes(const Frame& whole, const AxisSpan& x, const AxisSpan& y)
    : whole_(whole), inner_(whole.Within(58, 10, 22, 40)), x_(x), y_(y) {}

Vector2d Axes::At(double x, double y) const {
  return inner_.At(kMargin + (1 - 2 * kMargin) * x_.Share(x),
                   kMargin + (1 - 2 * kMargin) * y_.Share(y));
}

void Axes::Draw(Drawing& drawing, const std::string& x_name, const std::string& y_name) const {
  const std::vector<double> x_ticks = Ticks(x_, 4);
  const std::vector<std::string> x_texts = ShortNumbers(x_ticks);
  for (std::size_t i = 0; i < x_ticks.size(); ++i) {
    const double at = At(x_ticks[i], y_.least).x();
    drawing.Add(Drawing::Line{{{at, inner_.top}, {at, inner_.top + inner_.height}}, kGrid, 1});
    Write(drawing, {at, inner_.top + inner_.height + 16}, x_texts[i], kSmallFont,
          Drawing::Anchor::kMiddle);
  }
  const std::vector<double> y_ticks = Ticks(y_, 5);
  const std::vector<std::string> y_texts = ShortNumbers(y_ticks);
  for (std::size_t i = 0; i < y_ticks.size(); ++i) {
    const double at = At(x_.least, y_ticks[i]).y();
    drawing.Add(Drawing::Line{{{inner_.left, at}, {inner_.left + inner_.width, at}}, kGrid, 1});
    Write(drawing, {inner_.left - 6, at + 4}, y_texts[i], kSmallFont, Drawing::Anchor::kEnd);
  }
  drawing.Add(Drawing::Line{{inner_.At(0, 1), inner_.At(0, 0), inner_.At(1, 0)}, kInk, 1});
  Write(drawing, {whole_.left, whole_.top + 12}, Shortened(y_name, kFont, whole_.width));
  Write(drawing, {inner_.left + inner_.width, whole_.top + whole_.height - 4},
        Shortened(x_name, kFont, inner_.width), kFont, Drawing::Anchor::kEnd);
}

Drawing DrawChart(const std::vector<ChartPanel>& panels, const ChartLayout& layout) {
  const int count = static_cast<int>(panels.size());
  const int columns = std::max(1, std::min(layout.columns, count));
  const int rows = (count + columns - 1) / columns;
  const int width = columns * layout.panel_width;
  const auto legend = LegendRows(panels, width - 2 * kLegendMargin);
  const int panels_height = rows * layout.panel_height;
  Drawing drawing(width, panels_height + static_cast<int>(kLegendRow * double(legend.size()) + 10));
  for (int i = 0; i < count; ++i) {
    DrawPanel(drawing,
              {double(i % columns * layout.panel_width), double(i / columns * layout.panel_height),
               double(layout.panel_width), double(layout.panel_height)},
              panels[static_cast<std::size_t>(i)]);
  }
  double y = panels_height + kLegendRow - 4;
  for (const std::vector<ChartSeries>& row : legend) {
    double x = kLegendMargin;
    for (const ChartSeries& series : row) {
      const Vector2d begin(x, y - 4), end(x + kKeyWidth - 8, y - 4);
      if (series.line_width > 0) {
        drawing.Add(Drawing::Line{{begin, end}, series.color, series.line_width});
      }
      if (series.dot_radius > 0) {
        drawing.Add(Drawing::Disc{(begin + end) / 2, series.dot_radius, series.color});
      }
      Write(drawing, {x + kKeyWidth, y}, series.name);
      x += LegendWidth(series);
    }
    y += kLegendRow;
  }
  return drawing;
}

}  // namespace mortise::render
