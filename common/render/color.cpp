// Colours: mixtures, the part palette and the field colour map.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "common/render/image.h"

namespace mortise::render {

Color Mix(const Color& a, const Color& b, double amount) {
  return {a.red + amount * (b.red - a.red), a.green + amount * (b.green - a.green),
          a.blue + amount * (b.blue - a.blue)};
}

Color PartColor(int index) {
  static constexpr std::array<Color, 12> kPalette{{{0.85, 0.68, 0.45},
                                                   {0.45, 0.62, 0.78},
                                                   {0.56, 0.72, 0.47},
                                                   {0.83, 0.50, 0.42},
                                                   {0.63, 0.55, 0.76},
                                                   {0.90, 0.80, 0.42},
                                                   {0.40, 0.70, 0.68},
                                                   {0.87, 0.62, 0.70},
                                                   {0.66, 0.56, 0.46},
                                                   {0.62, 0.70, 0.83},
                                                   {0.75, 0.78, 0.50},
                                                   {0.64, 0.66, 0.68}}};
  const int count = static_cast<int>(kPalette.size());
  return kPalette[((index % count) + count) % count];
}

Color FieldColor(double value) {
  // Brightness rises evenly along the stops, so the picture still reads in grey.
  static constexpr std::array<Color, 6> kStops{{{0.13, 0.12, 0.38},
                                                {0.15, 0.32, 0.57},
                                                {0.12, 0.50, 0.56},
                                                {0.25, 0.68, 0.46},
                                                {0.63, 0.82, 0.27},
                                                {0.99, 0.91, 0.20}}};
  if (std::isnan(value)) return {0.6, 0.6, 0.6};
  const double position = std::clamp(value, 0.0, 1.0) * (kStops.size() - 1);
  const int lower = std::min<int>(static_cast<int>(position), kStops.size() - 2);
  return Mix(kStops[lower], kStops[lower + 1], position - lower);
}

std::string HexColor(const Color& color) {
  const auto byte = [](double channel) {
    return static_cast<int>(std::lround(std::clamp(channel, 0.0, 1.0) * 255));
  };
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", byte(color.red), byte(color.green),
                byte(color.blue));
  return text;
}

}  // namespace mortise::render
