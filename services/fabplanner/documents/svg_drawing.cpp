#include "services/fabplanner/documents/svg_drawing.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/text_escapes.h"

namespace mortise::fabplanner {
namespace {

std::string Number(double value) { return absl::StrFormat("%.2f", value + 0.0); }

constexpr char kStyle[] =
    "text{font-family:Helvetica,Arial,'Liberation Sans',sans-serif;fill:#222}"
    ".heading{font-weight:bold}.quiet{fill:#666}"
    ".stock{fill:#fffdf7;stroke:#222;stroke-width:1.4}"
    ".part{stroke:#333;stroke-width:1}"
    ".waste{fill:url(#hatch);stroke:#888;stroke-width:0.8}"
    ".edge{fill:none;stroke:#aaa;stroke-width:0.8;stroke-dasharray:5 4}"
    ".hidden{stroke:#333;stroke-width:0.8;stroke-dasharray:3 3}"
    ".dimension{stroke:#555;stroke-width:0.8}"
    ".visible{stroke:#222;stroke-width:1.1}.behind{stroke:#bbb;stroke-width:0.7}";

}  // namespace

std::string SvgDrawing::Escape(const std::string& text) {
  std::string clean;
  for (char c : text) clean += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  return EscapeXml(clean);
}

double SvgDrawing::TextWidth(const std::string& text, double size) {
  double characters = 0;
  for (char c : text) characters += (static_cast<unsigned char>(c) & 0xc0) != 0x80 ? 1 : 0;
  return 0.56 * size * characters;
}

void SvgDrawing::Rectangle(double x, double y, double width, double height,
                           const std::string& style_class) {
  absl::StrAppend(&body_, "<rect class=\"", style_class, "\" x=\"", Number(x), "\" y=\"", Number(y),
                  "\" width=\"", Number(std::fmax(width, 0)), "\" height=\"",
                  Number(std::fmax(height, 0)), "\"/>\n");
}

void SvgDrawing::Polygon(const std::vector<Eigen::Vector2d>& points, const std::string& style_class,
                         const std::string& fill) {
  absl::StrAppend(&body_, "<polygon class=\"", style_class, "\" fill=\"", fill, "\" points=\"");
  for (const Eigen::Vector2d& point : points) {
    absl::StrAppend(&body_, Number(point.x()), ",", Number(point.y()), " ");
  }
  body_.back() = '"';
  body_ += "/>\n";
}

void SvgDrawing::Line(double x0, double y0, double x1, double y1, const std::string& style_class) {
  absl::StrAppend(&body_, "<line class=\"", style_class, "\" x1=\"", Number(x0), "\" y1=\"",
                  Number(y0), "\" x2=\"", Number(x1), "\" y2=\"", Number(y1), "\"/>\n");
}

void SvgDrawing::Text(double x, double y, double size, TextAnchor anchor, const std::string& text,
                      const std::string& style_class, bool turned) {
  const char* names[] = {"start", "middle", "end"};
  absl::StrAppend(&body_, "<text class=\"", style_class, "\" x=\"", Number(x), "\" y=\"", Number(y),
                  "\" font-size=\"", Number(size), "\" text-anchor=\"",
                  names[static_cast<int>(anchor)], "\"");
  if (turned) {
    absl::StrAppend(&body_, " transform=\"rotate(-90 ", Number(x), " ", Number(y), ")\"");
  }
  absl::StrAppend(&body_, ">", Escape(text), "</text>\n");
}

void SvgDrawing::Dimension(double x0, double x1, double y, const std::string& text) {
  Line(x0, y, x1, y, "dimension");
  for (double x : {x0, x1}) {
    Line(x, y - 5, x, y + 5, "dimension");
    const double inwards = x == x0 ? 6 : -6;
    if (std::abs(x1 - x0) < 16) continue;
    Polygon({{x, y}, {x + inwards, y - 2.2}, {x + inwards, y + 2.2}}, "", "#555");
  }
  Text((x0 + x1) / 2, y - 4, 11, TextAnchor::kMiddle, text);
}

void SvgDrawing::DimensionUpright(double y0, double y1, double x, const std::string& text) {
  Line(x, y0, x, y1, "dimension");
  for (double y : {y0, y1}) {
    Line(x - 5, y, x + 5, y, "dimension");
    const double inwards = y == y0 ? 6 : -6;
    if (std::abs(y1 - y0) < 16) continue;
    Polygon({{x, y}, {x - 2.2, y + inwards}, {x + 2.2, y + inwards}}, "", "#555");
  }
  Text(x - 4, (y0 + y1) / 2, 11, TextAnchor::kMiddle, text, "", true);
}

std::string SvgDrawing::Finish(double width, double height, const std::string& title) const {
  return absl::StrCat(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
      "viewBox=\"0 0 ",
      Number(width), " ", Number(height), "\" width=\"", Number(width), "\" height=\"",
      Number(height), "\">\n<title>", Escape(title), "</title>\n<style>", kStyle,
      "</style>\n<defs><pattern id=\"hatch\" width=\"7\" height=\"7\" "
      "patternUnits=\"userSpaceOnUse\" patternTransform=\"rotate(45)\"><rect width=\"7\" "
      "height=\"7\" fill=\"#f1efe9\"/><line x1=\"0\" y1=\"0\" x2=\"0\" y2=\"7\" stroke=\"#bbb\" "
      "stroke-width=\"1.2\"/></pattern></defs>\n<rect width=\"100%\" height=\"100%\" "
      "fill=\"white\"/>\n",
      body_, "</svg>\n");
}

}  // namespace mortise::fabplanner
