// Writes a few elements of SVG, enough for dimensioned drawings. Internal to layout_svg.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace mortise::fabplanner {

enum class TextAnchor { kStart, kMiddle, kEnd };

// Collects elements in pixels, y downwards, and closes them into a document.
class SvgDrawing {
 public:
  // Returns text as SVG and HTML need it.
  static std::string Escape(const std::string& text);

  // Returns the width that `text` takes, about; the fonts of viewers differ.
  static double TextWidth(const std::string& text, double size);

  void Rectangle(double x, double y, double width, double height, const std::string& style_class);
  void Polygon(const std::vector<Eigen::Vector2d>& points, const std::string& style_class,
               const std::string& fill);
  void Line(double x0, double y0, double x1, double y1, const std::string& style_class);
  // Adds a text, which reads upwards if it is `turned`. `style_class` may be empty.
  void Text(double x, double y, double size, TextAnchor anchor, const std::string& text,
            const std::string& style_class = "", bool turned = false);
  // Adds a dimension line with arrow heads between x0 and x1 at height y, and the text above it.
  void Dimension(double x0, double x1, double y, const std::string& text);
  // Adds the same along y at x, with the text to the left, reading upwards.
  void DimensionUpright(double y0, double y1, double x, const std::string& text);

  // Returns the document, `width` × `height` pixels.
  std::string Finish(double width, double height, const std::string& title) const;

 private:
  std::string body_;
};

}  // namespace mortise::fabplanner
