#include "common/render/svg_plot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "common/base/errors.h"

namespace mortise::render {
namespace {

constexpr const char* kSeriesColors[] = {"#2b5f8c", "#c8553d", "#4f8a4c", "#8a6bb0",
                                         "#c99a2e", "#3f9aa0", "#8c6d53", "#5c6370"};
constexpr const char* kMarkerShapes[] = {"circle", "square", "diamond", "triangle"};

std::string Escaped(const std::string& text) {
  return absl::StrReplaceAll(text,
                             {{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}});
}

// One axis: from values to pixels, and its ticks.
struct Axis {
  double minimum = 0;
  double maximum = 1;
  bool logarithmic = false;
  double first_pixel = 0;
  double last_pixel = 1;
  std::vector<double> ticks;

  bool Shows(double value) const { return std::isfinite(value) && (!logarithmic || value > 0); }
  double Pixel(double value) const {
    const auto map = [this](double v) { return logarithmic ? std::log10(v) : v; };
    const double share = (map(value) - map(minimum)) / (map(maximum) - map(minimum));
    return first_pixel + share * (last_pixel - first_pixel);
  }
};

// Powers of ten, with 2 and 5 between them when there are few.
std::vector<double> LogTicks(double minimum, double maximum) {
  const int low = static_cast<int>(std::floor(std::log10(minimum)));
  const int high = static_cast<int>(std::ceil(std::log10(maximum)));
  const bool between = high - low <= 3;
  const int step = std::max(1, (high - low) / 8);
  std::vector<double> ticks;
  for (int power = low; power <= high; power += step) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double tick = factor * std::pow(10.0, power);
      if (factor > 1 && !between) continue;
      if (tick >= minimum * (1 - 1e-9) && tick <= maximum * (1 + 1e-9)) ticks.push_back(tick);
    }
  }
  return ticks;
}

Axis MakeAxis(double minimum, double maximum, bool logarithmic, double first_pixel,
              double last_pixel, int count) {
  Axis axis{minimum, maximum, logarithmic, first_pixel, last_pixel, {}};
  if (logarithmic) {
    const double room = minimum == maximum ? 2 : std::pow(maximum / minimum, 0.05);
    axis.minimum = minimum / room;
    axis.maximum = maximum * room;
    axis.ticks = LogTicks(axis.minimum, axis.maximum);
    return axis;
  }
  double room = 0.05 * (maximum - minimum);
  // A single value still needs a range to stand in.
  if (!(room > 1e-12 * std::max(std::abs(minimum), std::abs(maximum)))) {
    room = minimum == 0 ? 1 : 0.1 * std::abs(minimum);
  }
  axis.minimum = minimum - room;
  axis.maximum = maximum + room;
  axis.ticks = NiceTicks(axis.minimum, axis.maximum, count);
  return axis;
}

std::string ColorOf(const Series& series, int index) {
  return series.color.red < 0 ? kSeriesColors[index % std::size(kSeriesColors)]
                              : HexColor(series.color);
}

std::string Marker(const char* shape, double x, double y, double size, const std::string& color) {
  const std::string_view kind = shape;
  if (kind == "circle") {
    return absl::StrFormat("<circle cx=\"%.2f\" cy=\"%.2f\" r=\"%.2f\" fill=\"%s\"/>\n", x, y, size,
                           color);
  }
  const double s = 0.9 * size;
  std::string points;
  if (kind == "square") {
    points = absl::StrFormat("%.2f,%.2f %.2f,%.2f %.2f,%.2f %.2f,%.2f", x - s, y - s, x + s, y - s,
                             x + s, y + s, x - s, y + s);
  } else if (kind == "diamond") {
    points = absl::StrFormat("%.2f,%.2f %.2f,%.2f %.2f,%.2f %.2f,%.2f", x, y - 1.3 * s, x + 1.3 * s,
                             y, x, y + 1.3 * s, x - 1.3 * s, y);
  } else {
    points = absl::StrFormat("%.2f,%.2f %.2f,%.2f %.2f,%.2f", x, y - 1.2 * s, x + 1.1 * s,
                             y + 0.9 * s, x - 1.1 * s, y + 0.9 * s);
  }
  return absl::StrFormat("<polygon points=\"%s\" fill=\"%s\"/>\n", points, color);
}

std::string Text(double x, double y, const char* anchor, const std::string& text,
                 const std::string& more = "") {
  return absl::StrFormat("<text x=\"%.2f\" y=\"%.2f\" text-anchor=\"%s\"%s>%s</text>\n", x, y,
                         anchor, more, Escaped(text));
}

std::string DrawAxes(const Plot& plot, const Axis& x, const Axis& y) {
  std::string svg;
  const std::vector<std::string> x_texts = ShortNumbers(x.ticks), y_texts = ShortNumbers(y.ticks);
  for (std::size_t i = 0; i < x.ticks.size(); ++i) {
    const double p = x.Pixel(x.ticks[i]);
    absl::StrAppendFormat(&svg,
                          "<line x1=\"%.2f\" y1=\"%.2f\" x2=\"%.2f\" y2=\"%.2f\" "
                          "stroke=\"#e3e5e9\"/>\n",
                          p, y.first_pixel, p, y.last_pixel);
    svg += Text(p, y.first_pixel + 19, "middle", x_texts[i]);
  }
  for (std::size_t i = 0; i < y.ticks.size(); ++i) {
    const double p = y.Pixel(y.ticks[i]);
    absl::StrAppendFormat(&svg,
                          "<line x1=\"%.2f\" y1=\"%.2f\" x2=\"%.2f\" y2=\"%.2f\" "
                          "stroke=\"#e3e5e9\"/>\n",
                          x.first_pixel, p, x.last_pixel, p);
    svg += Text(x.first_pixel - 8, p + 4.5, "end", y_texts[i]);
  }
  absl::StrAppendFormat(&svg,
                        "<path d=\"M%.2f %.2f V%.2f H%.2f\" fill=\"none\" stroke=\"#3a3f4a\"/>\n",
                        x.first_pixel, y.last_pixel, y.first_pixel, x.last_pixel);
  svg += Text(0.5 * (x.first_pixel + x.last_pixel), plot.height - 12.0, "middle", plot.x_label);
  const double middle = 0.5 * (y.first_pixel + y.last_pixel);
  svg += Text(18, middle, "middle", plot.y_label,
              absl::StrFormat(" transform=\"rotate(-90 18 %.2f)\"", middle));
  if (!plot.title.empty()) {
    svg += Text(x.first_pixel, 24, "start", plot.title, " font-size=\"16\" font-weight=\"600\"");
  }
  return svg;
}

std::string DrawSeries(const Series& series, int index, const Axis& x, const Axis& y) {
  const std::string color = ColorOf(series, index);
  std::string svg, path;
  bool pen_down = false;
  for (Eigen::Index i = 0; i < series.points.cols(); ++i) {
    const double px = series.points(0, i), py = series.points(1, i);
    if (!x.Shows(px) || !y.Shows(py)) {
      pen_down = false;
      continue;
    }
    absl::StrAppendFormat(&path, "%s%.2f %.2f", pen_down ? "L" : "M", x.Pixel(px), y.Pixel(py));
    pen_down = true;
    if (series.markers) {
      svg += Marker(kMarkerShapes[index % std::size(kMarkerShapes)], x.Pixel(px), y.Pixel(py),
                    series.size, color);
    }
  }
  if (!series.line || path.empty()) return svg;
  return absl::StrFormat("<path d=\"%s\" fill=\"none\" stroke=\"%s\" stroke-width=\"1.8\"/>\n",
                         path, color) +
         svg;
}

std::string DrawLegend(const Plot& plot, double right, double top) {
  std::string svg;
  double y = top + 14;
  for (int i = 0; i < static_cast<int>(plot.series.size()); ++i) {
    const Series& series = plot.series[i];
    if (series.name.empty()) continue;
    const std::string color = ColorOf(series, i);
    if (series.line) {
      absl::StrAppendFormat(&svg,
                            "<line x1=\"%.2f\" y1=\"%.2f\" x2=\"%.2f\" y2=\"%.2f\" stroke=\"%s\" "
                            "stroke-width=\"1.8\"/>\n",
                            right - 24, y - 4, right - 4, y - 4, color);
    }
    if (series.markers) {
      svg += Marker(kMarkerShapes[i % std::size(kMarkerShapes)], right - 14, y - 4, series.size,
                    color);
    }
    svg += Text(right - 32, y, "end", series.name,
                " stroke=\"#ffffff\" stroke-width=\"3\" paint-order=\"stroke\"");
    y += 18;
  }
  return svg;
}

std::string DrawCallout(const Callout& callout, const Axis& x, const Axis& y) {
  if (!x.Shows(callout.x) || !y.Shows(callout.y)) return "";
  const double px = x.Pixel(callout.x), py = y.Pixel(callout.y);
  const bool left = px > 0.6 * x.last_pixel;
  const double tx = px + (left ? -16 : 16);
  const double ty = py > y.last_pixel + 40 ? py - 16 : py + 22;
  std::string svg = absl::StrFormat(
      "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"7\" fill=\"none\" stroke=\"#20232a\" "
      "stroke-width=\"1.5\"/>\n",
      px, py);
  return svg + Text(tx, ty, left ? "end" : "start", callout.text,
                    " font-weight=\"600\" stroke=\"#ffffff\" stroke-width=\"3\" "
                    "paint-order=\"stroke\"");
}

}  // namespace

std::vector<double> NiceTicks(double minimum, double maximum, int count) {
  const double range = maximum - minimum;
  if (!(range > 0) || !std::isfinite(range) || count < 1) return {minimum};
  const double raw = range / count;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double fraction = raw / power;
  const double step = power * (fraction <= 1     ? 1
                               : fraction <= 2   ? 2
                               : fraction <= 2.5 ? 2.5
                               : fraction <= 5   ? 5
                                                 : 10);
  std::vector<double> ticks;
  // Multiples are counted as integers, so that 0 is exactly 0.
  for (double k = std::ceil(minimum / step - 1e-9); k * step <= maximum + 1e-9 * step; ++k) {
    ticks.push_back(k == 0 ? 0.0 : k * step);
    if (ticks.size() > 1000) break;
  }
  return ticks;
}

std::string ShortNumber(double value, int digits) {
  if (value == 0) return "0";
  if (!std::isfinite(value)) return std::isnan(value) ? "NaN" : value > 0 ? "∞" : "−∞";
  const double size = std::abs(value);
  char text[48];
  if (size >= 1e-4 && size < 1e6) {
    const int decimals = std::max(0, digits - 1 - static_cast<int>(std::floor(std::log10(size))));
    std::snprintf(text, sizeof text, "%.*f", decimals, value);
    std::string number = text;
    if (number.find('.') != std::string::npos) {
      number.erase(number.find_last_not_of('0') + 1);
      if (number.back() == '.') number.pop_back();
    }
    return number;
  }
  std::snprintf(text, sizeof text, "%.*e", digits - 1, value);
  std::string number = text;
  const std::size_t e = number.find('e');
  std::string mantissa = number.substr(0, e);
  if (mantissa.find('.') != std::string::npos) {
    mantissa.erase(mantissa.find_last_not_of('0') + 1);
    if (mantissa.back() == '.') mantissa.pop_back();
  }
  return absl::StrCat(mantissa, "e", std::atoi(number.c_str() + e + 1));
}

std::vector<std::string> ShortNumbers(const std::vector<double>& values, int digits) {
  constexpr int kMostDigits = 15;
  const std::size_t different = std::set<double>(values.begin(), values.end()).size();
  std::vector<std::string> texts;
  do {
    texts.clear();
    for (const double value : values) texts.push_back(ShortNumber(value, digits));
  } while (std::set<std::string>(texts.begin(), texts.end()).size() < different &&
           ++digits <= kMostDigits);
  return texts;
}

absl::StatusOr<std::string> PlotSvg(const Plot& plot) {
  if (plot.width < 100 || plot.width > 10000) {
    return InvalidField("plot.width", "must be within 100 to 10000");
  }
  if (plot.height < 100 || plot.height > 10000) {
    return InvalidField("plot.height", "must be within 100 to 10000");
  }
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double low_x = kInfinity, high_x = -kInfinity, low_y = kInfinity, high_y = -kInfinity;
  const auto include = [&](double x, double y) {
    if (!std::isfinite(x) || !std::isfinite(y)) return;
    if ((plot.logarithmic_x && x <= 0) || (plot.logarithmic_y && y <= 0)) return;
    low_x = std::min(low_x, x);
    high_x = std::max(high_x, x);
    low_y = std::min(low_y, y);
    high_y = std::max(high_y, y);
  };
  for (const Series& series : plot.series) {
    for (Eigen::Index i = 0; i < series.points.cols(); ++i) {
      include(series.points(0, i), series.points(1, i));
    }
  }
  for (const Callout& callout : plot.callouts) include(callout.x, callout.y);
  if (low_x > high_x) return InvalidField("plot.series", "no point can be shown on these axes");

  const double top = plot.title.empty() ? 20 : 42;
  const Axis x = MakeAxis(low_x, high_x, plot.logarithmic_x, 84, plot.width - 20.0,
                          std::max(2, plot.width / 95));
  const Axis y = MakeAxis(low_y, high_y, plot.logarithmic_y, plot.height - 58.0, top,
                          std::max(2, plot.height / 70));
  std::string svg = absl::StrFormat(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\" "
      "font-family=\"Helvetica, Arial, sans-serif\" font-size=\"13\" fill=\"#20232a\">\n"
      "<rect width=\"100%%\" height=\"100%%\" fill=\"#ffffff\"/>\n",
      plot.width, plot.height, plot.width, plot.height);
  svg += DrawAxes(plot, x, y);
  for (int i = 0; i < static_cast<int>(plot.series.size()); ++i) {
    svg += DrawSeries(plot.series[i], i, x, y);
  }
  svg += DrawLegend(plot, x.last_pixel, top);
  for (const Callout& callout : plot.callouts) svg += DrawCallout(callout, x, y);
  return svg + "</svg>\n";
}

}  // namespace mortise::render
