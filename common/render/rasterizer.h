// The sample grid with its depth buffer: fills triangles, strokes lines. Internal to the renderer.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/render/image.h"
#include "common/render/projection.h"

namespace mortise::render {

// One corner of a triangle to fill.
struct Corner {
  Projected point;
  double light = 1;   // brightness, 0 to 1
  double scalar = 0;  // colour by FieldColor where the fill asks for it
};

// How a line is drawn where it is visible and where it is hidden.
struct Stroke {
  Color color;
  double width = 1;  // samples
  bool dashed_where_hidden = false;
  bool on_top = false;
  double dash = 10;  // samples
};

class Rasterizer {
 public:
  Rasterizer(int width, int height, const Color& background);

  // Fills a triangle. `color` null means by the corners' scalars.
  void FillTriangle(const std::array<Corner, 3>& corners, const Color* color);

  // Strokes a segment against the depths drawn so far.
  void DrawLine(const Projected& start, const Projected& end, const Stroke& stroke);

  // From now on everything stands before what has been drawn so far.
  void ClearDepth();

  // Averages squares of `factor` × `factor` samples into pixels.
  Image Reduce(int factor) const;

 private:
  bool IsHidden(int x, int y, double depth) const;
  void StampDisc(double x, double y, double radius, const std::array<std::uint8_t, 3>& color);

  int width_, height_;
  std::vector<float> depth_;
  std::vector<std::array<std::uint8_t, 3>> color_;
  double nearest_, farthest_;  // range of the depths drawn, for the tolerance of lines
};

}  // namespace mortise::render
