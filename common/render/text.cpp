// The built-in stroke font: each character is a few pen strokes, drawn anti-aliased at any size.
//
// A stroke is a run of points, two characters each: a digit for x and a letter for y, on a grid
// where 'e' is the baseline, 'm' the height of small letters, 'q' the height of capitals (12 grid
// units above the baseline) and 'a' the depth of descenders. A space lifts the pen.
#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include "common/render/image.h"

namespace mortise::render {
namespace {

constexpr double kCapitalUnits = 12;
constexpr double kLetterGap = 3;   // grid units between characters
constexpr double kSpaceWidth = 4;  // grid units

struct Glyph {
  char32_t code;
  std::string_view strokes;
};

constexpr Glyph kGlyphs[] = {
    {'!', "0q0i 0f0e"},
    {'"', "0q0n 2q2n"},
    {'#', "1e2q 4e5q 0i6i 0m6m"},
    {'$', "6o5p1p0o0l1k5k6j6g5f1f0g 3r3d"},
    {'%', "0e7q 0q2q2n0n0q 5h7h7e5e5h"},
    {'&', "6e1m1p2q3q4p4n0i0f1e4e6h"},
    {'\'', "0q0n"},
    {'(', "2r0o0g2d"},
    {')', "0r2o2g0d"},
    {'*', "3o3g 0m6i 6m0i"},
    {'+', "3m3g 0j6j"},
    {',', "1f1e0c"},
    {'-', "0j4j"},
    {'.', "0e0f"},
    {'/', "0d5r"},
    {'0', "1e0g0o1q5q6o6g5e1e"},
    {'1', "1o3q3e 1e5e"},
    {'2', "0o1q5q6o6l0f0e6e"},
    {'3', "0p1q5q6p6l5k2k 5k6j6f5e1e0f"},
    {'4', "4e4q0h6h"},
    {'5', "6q0q0k5k6j6f5e1e0f"},
    {'6', "5q2q0n0f1e5e6f6j5k0k"},
    {'7', "0q6q2e"},
    {'8', "1k0l0p1q5q6p6l5k1k0j0f1e5e6f6j5k"},
    {'9', "6k1k0l0p1q5q6p6h4e1e"},
    {':', "0e0f 0l0m"},
    {';', "1f1e0c 1l1m"},
    {'<', "5n0j5f"},
    {'=', "0l6l 0h6h"},
    {'>', "0n5j0f"},
    {'?', "0o1q4q5o5m2j2h 2f2e"},
    {'@', "6h4h3i3m4n6n6h7g8i8o6q2q0o0g2e6e"},
    {'A', "0e3q6e 1i5i"},
    {'B', "0e0q4q5p5l4k0k 4k6j6f5e0e"},
    {'C', "6o4q2q0o0g2e4e6g"},
    {'D', "0e0q3q6n6h3e0e"},
    {'E', "6q0q0e6e 0k4k"},
    {'F', "6q0q0e 0k4k"},
    {'G', "6o4q2q0o0g2e4e6g6k3k"},
    {'H', "0e0q 6e6q 0k6k"},
    {'I', "0e0q"},
    {'J', "4q4g3e1e0g"},
    {'K', "0e0q 6q0i 2k6e"},
    {'L', "0q0e5e"},
    {'M', "0e0q3j6q6e"},
    {'N', "0e0q6e6q"},
    {'O', "2e0g0o2q4q6o6g4e2e"},
    {'P', "0e0q5q6p6k5j0j"},
    {'Q', "2e0g0o2q4q6o6g4e2e 4h6d"},
    {'R', "0e0q5q6p6k5j0j 3j6e"},
    {'S', "6o5q1q0o0m1k5k6i6g5e1e0g"},
    {'T', "0q6q 3q3e"},
    {'U', "0q0g2e4e6g6q"},
    {'V', "0q3e6q"},
    {'W', "0q2e4m6e8q"},
    {'X', "0e6q 0q6e"},
    {'Y', "0q3k6q 3k3e"},
    {'Z', "0q6q0e6e"},
    {'[', "2r0r0d2d"},
    {'\\', "0r5d"},
    {']', "0r2r2d0d"},
    {'^', "0m3q6m"},
    {'_', "0d6d"},
    {'`', "0q2o"},
    {'a', "0l1m4m5l5e 5j1j0i0f1e4e5f"},
    {'b', "0q0e 0l1m4m5k5g4e1e0f"},
    {'c', "5l4m1m0l0f1e4e5f"},
    {'d', "5q5e 5l4m1m0k0g1e4e5f"},
    {'e', "0i5i5l4m1m0l0f1e4e5f"},
    {'f', "1e1p2q4q 0m3m"},
    {'g', "5m5b4a1a0b 5l4m1m0k0g1e4e5f"},
    {'h', "0q0e 0l1m4m5l5e"},
    {'i', "0e0m 0p0q"},
    {'j', "2m2b1a0a 2p2q"},
    {'k', "0q0e 4m0i 1j5e"},
    {'l', "0q0f1e2e"},
    {'m', "0m0e 0l1m3m4l4e 4l5m7m8l8e"},
    {'n', "0m0e 0l1m4m5l5e"},
    {'o', "1e0f0l1m4m5l5f4e1e"},
    {'p', "0m0a 0l1m4m5k5g4e1e0f"},
    {'q', "5m5a 5l4m1m0k0g1e4e5f"},
    {'r', "0m0e 0k2m4m"},
    {'s', "5l4m1m0l0k1j4i5h5f4e1e0f"},
    {'t', "1p1f2e4e 0m3m"},
    {'u', "0m0f1e4e5f 5m5e"},
    {'v', "0m3e6m"},
    {'w', "0m2e4m6e8m"},
    {'x', "0e5m 0m5e"},
    {'y', "0m3e 6m3e2b1a0a"},
    {'z', "0m5m0e5e"},
    {'{', "3r2q2k0j2i2e3d"},
    {'|', "0r0d"},
    {'}', "0r1q1k3j1i1e0d"},
    {'~', "0j1l2l4i5i6k"},
    {U'°', "1m0n0p1q2q3p3n2m1m"},
    {U'²', "0p1q2q3p3o0k3k"},
    {U'³', "0q3q1o3n3l2k0k"},
    {U'µ', "0m0a 0f1e4e5f 5m5e"},
    {U'·', "1j1k"},
    {U'×', "0g5l 0l5g"},
    {U'−', "0j6j"},
    {U'–', "0j6j"},
};

const std::map<char32_t, std::string_view>& Glyphs() {
  static const std::map<char32_t, std::string_view> glyphs = [] {
    std::map<char32_t, std::string_view> map;
    for (const Glyph& glyph : kGlyphs) map[glyph.code] = glyph.strokes;
    return map;
  }();
  return glyphs;
}

// Code points of UTF-8 text; a malformed byte stands for itself.
std::u32string Decode(const std::string& text) {
  std::u32string codes;
  for (std::size_t i = 0; i < text.size();) {
    const unsigned char lead = text[i];
    const int extra = lead >= 0xF0 ? 3 : lead >= 0xE0 ? 2 : lead >= 0xC0 ? 1 : 0;
    if (extra == 0 || i + extra >= text.size()) {
      codes.push_back(lead);
      ++i;
      continue;
    }
    char32_t code = lead & (0x3F >> extra);
    for (int k = 1; k <= extra; ++k) code = (code << 6) | (text[i + k] & 0x3F);
    codes.push_back(code);
    i += extra + 1;
  }
  return codes;
}

// The strokes of a character; a box for one that the font lacks.
std::string_view StrokesOf(char32_t code) {
  const auto found = Glyphs().find(code);
  return found == Glyphs().end() ? std::string_view("0e0q6q6e0e") : found->second;
}

double WidthUnits(char32_t code) {
  if (code == ' ') return kSpaceWidth;
  double width = 0;
  const std::string_view strokes = StrokesOf(code);
  for (std::size_t i = 0; i + 1 < strokes.size(); i += 2) {
    if (strokes[i] == ' ') ++i;
    width = std::max(width, static_cast<double>(strokes[i] - '0'));
  }
  return width;
}

double SegmentDistance(double px, double py, double ax, double ay, double bx, double by) {
  const double dx = bx - ax, dy = by - ay;
  const double length2 = dx * dx + dy * dy;
  const double t =
      length2 > 0 ? std::clamp(((px - ax) * dx + (py - ay) * dy) / length2, 0.0, 1.0) : 0.0;
  return std::hypot(px - ax - t * dx, py - ay - t * dy);
}

// Blends one pen stroke into the image, by the share of each pixel that it covers.
void DrawSegment(Image& image, double ax, double ay, double bx, double by, double half_width,
                 const Color& color) {
  const double reach = half_width + 1;
  const int left = std::max(0, static_cast<int>(std::floor(std::min(ax, bx) - reach)));
  const int right = std::min(image.width - 1, static_cast<int>(std::max(ax, bx) + reach));
  const int top = std::max(0, static_cast<int>(std::floor(std::min(ay, by) - reach)));
  const int bottom = std::min(image.height - 1, static_cast<int>(std::max(ay, by) + reach));
  for (int y = top; y <= bottom; ++y) {
    for (int x = left; x <= right; ++x) {
      const double distance = SegmentDistance(x + 0.5, y + 0.5, ax, ay, bx, by);
      const double cover = std::clamp(half_width + 0.5 - distance, 0.0, 1.0);
      if (cover > 0) image.Set(x, y, Mix(image.Get(x, y), color, cover));
    }
  }
}

}  // namespace

double TextWidth(double height, const std::string& text) {
  double units = 0;
  for (const char32_t code : Decode(text)) units += WidthUnits(code) + kLetterGap;
  return std::max(0.0, units - kLetterGap) * height / kCapitalUnits;
}

void DrawText(Image& image, double x, double y, double height, const Color& color,
              const std::string& text) {
  const double unit = height / kCapitalUnits;
  const double half_width = std::max(0.45, 0.055 * height);
  const double baseline = y + height;
  for (const char32_t code : Decode(text)) {
    if (code != ' ') {
      const std::string_view strokes = StrokesOf(code);
      for (std::size_t i = 0; i + 3 < strokes.size(); i += 2) {
        if (strokes[i + 2] == ' ') {
          ++i;
          continue;
        }
        DrawSegment(image, x + (strokes[i] - '0') * unit, baseline - (strokes[i + 1] - 'e') * unit,
                    x + (strokes[i + 2] - '0') * unit, baseline - (strokes[i + 3] - 'e') * unit,
                    half_width, color);
      }
    }
    x += (WidthUnits(code) + kLetterGap) * unit;
  }
}

}  // namespace mortise::render
