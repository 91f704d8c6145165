// Colours and raster pictures, and their way out as PNG.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace mortise::render {

// A colour in sRGB, each channel from 0 to 1.
struct Color {
  double red = 0;
  double green = 0;
  double blue = 0;

  friend bool operator==(const Color&, const Color&) = default;
};

// Returns a mixture: `amount` 0 is `a`, 1 is `b`.
Color Mix(const Color& a, const Color& b, double amount);

// Returns the i-th of twelve well-distinguishable soft colours, repeating: one for each part of a
// design.
Color PartColor(int index);

// Returns the perceptually even map of scalars to colours used for fields, dark blue (0) over teal
// and green to yellow (1). Values outside [0, 1] are clamped; NaN is grey.
Color FieldColor(double value);

// "#rrggbb", for SVG and HTML.
std::string HexColor(const Color& color);

// Rows from the top, three bytes (red, green, blue) a pixel.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;  // 3 · width · height

  Image() = default;
  Image(int width_in, int height_in, const Color& fill);

  void Set(int x, int y, const Color& color);  // ignores pixels outside
  Color Get(int x, int y) const;
};

// Returns the PNG file of an image. INVALID_ARGUMENT if it is empty or its sizes disagree.
absl::StatusOr<std::string> EncodePng(const Image& image);

// Writes `text` in the built-in stroke font with its top left corner at (x, y); `height` is the
// height of a capital letter in pixels. UTF-8; characters beyond ASCII known: ° ² ³ µ · × − –.
void DrawText(Image& image, double x, double y, double height, const Color& color,
              const std::string& text);

// Returns the width in pixels that DrawText would use.
double TextWidth(double height, const std::string& text);

// Puts pictures of any sizes side by side in rows of `columns`, each over its caption (which may be
// empty), on white. INVALID_ARGUMENT without pictures, or if the captions are not as many.
absl::StatusOr<Image> ContactSheet(const std::vector<Image>& pictures,
                                   const std::vector<std::string>& captions, int columns);

}  // namespace mortise::render
