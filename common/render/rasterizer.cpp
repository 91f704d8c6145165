#include "common/render/rasterizer.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mortise::render {
namespace {

// Lines lie in the surfaces they bound; this share of the depth range lets them win.
constexpr double kDepthTolerance = 1e-3;

std::array<std::uint8_t, 3> ToBytes(const Color& color) {
  const auto byte = [](double channel) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(channel, 0.0, 1.0) * 255));
  };
  return {byte(color.red), byte(color.green), byte(color.blue)};
}

Color Lit(const Color& color, double light) {
  return {color.red * light, color.green * light, color.blue * light};
}

double Cross(const Projected& a, const Projected& b, double x, double y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

}  // namespace

Rasterizer::Rasterizer(int width, int height, const Color& background)
    : width_(width),
      height_(height),
      depth_(std::size_t(width) * height, std::numeric_limits<float>::infinity()),
      color_(std::size_t(width) * height, ToBytes(background)),
      nearest_(std::numeric_limits<double>::infinity()),
      farthest_(-std::numeric_limits<double>::infinity()) {}

void Rasterizer::FillTriangle(const std::array<Corner, 3>& corners, const Color* color) {
  const Projected &a = corners[0].point, &b = corners[1].point, &c = corners[2].point;
  if (!a.visible || !b.visible || !c.visible) return;
  const double area = Cross(a, b, c.x, c.y);
  if (area == 0 || !std::isfinite(area)) return;
  nearest_ = std::min({nearest_, a.depth, b.depth, c.depth});
  farthest_ = std::max({farthest_, a.depth, b.depth, c.depth});
  const auto first = [](double low) { return std::max(0.0, std::ceil(low - 0.5)); };
  const int left = static_cast<int>(std::min(first(std::min({a.x, b.x, c.x})), double(width_)));
  const int top = static_cast<int>(std::min(first(std::min({a.y, b.y, c.y})), double(height_)));
  const int right =
      static_cast<int>(std::clamp(std::floor(std::max({a.x, b.x, c.x}) - 0.5), -1.0, width_ - 1.0));
  const int bottom = static_cast<int>(
      std::clamp(std::floor(std::max({a.y, b.y, c.y}) - 0.5), -1.0, height_ - 1.0));
  const bool flat = corners[0].light == corners[1].light && corners[1].light == corners[2].light;
  const bool uniform = color != nullptr && flat;
  const std::array<std::uint8_t, 3> bytes =
      uniform ? ToBytes(Lit(*color, corners[0].light)) : std::array<std::uint8_t, 3>{};
  for (int y = top; y <= bottom; ++y) {
    for (int x = left; x <= right; ++x) {
      const double px = x + 0.5, py = y + 0.5;
      const double wa = Cross(b, c, px, py) / area;
      const double wb = Cross(c, a, px, py) / area;
      const double wc = 1 - wa - wb;
      if (wa < -1e-12 || wb < -1e-12 || wc < -1e-12) continue;
      const float depth = static_cast<float>(wa * a.depth + wb * b.depth + wc * c.depth);
      const std::size_t index = std::size_t(y) * width_ + x;
      if (depth >= depth_[index]) continue;
      depth_[index] = depth;
      if (uniform) {
        color_[index] = bytes;
        continue;
      }
      const double pa = wa * a.weight, pb = wb * b.weight, pc = wc * c.weight;
      const double sum = pa + pb + pc;
      const auto mean = [&](double va, double vb, double vc) {
        return (pa * va + pb * vb + pc * vc) / sum;
      };
      const double light = mean(corners[0].light, corners[1].light, corners[2].light);
      const Color base =
          color ? *color
                : FieldColor(mean(corners[0].scalar, corners[1].scalar, corners[2].scalar));
      color_[index] = ToBytes(Lit(base, light));
    }
  }
}

bool Rasterizer::IsHidden(int x, int y, double depth) const {
  if (x < 0 || y < 0 || x >= width_ || y >= height_) return true;
  // The farthest of the neighbours decides: an outline then never hides behind its own surface.
  float limit = -std::numeric_limits<float>::infinity();
  for (int v = std::max(0, y - 1); v <= std::min(height_ - 1, y + 1); ++v) {
    for (int u = std::max(0, x - 1); u <= std::min(width_ - 1, x + 1); ++u) {
      limit = std::max(limit, depth_[std::size_t(v) * width_ + u]);
    }
  }
  const double range = farthest_ > nearest_ ? farthest_ - nearest_ : 0;
  return depth > limit + kDepthTolerance * range;
}

void Rasterizer::StampDisc(double x, double y, double radius,
                           const std::array<std::uint8_t, 3>& color) {
  const int left = std::max(0, static_cast<int>(std::ceil(x - radius - 0.5)));
  const int right = std::min(width_ - 1, static_cast<int>(std::floor(x + radius - 0.5)));
  const int top = std::max(0, static_cast<int>(std::ceil(y - radius - 0.5)));
  const int bottom = std::min(height_ - 1, static_cast<int>(std::floor(y + radius - 0.5)));
  for (int v = top; v <= bottom; ++v) {
    for (int u = left; u <= right; ++u) {
      const double dx = u + 0.5 - x, dy = v + 0.5 - y;
      if (dx * dx + dy * dy <= radius * radius) color_[std::size_t(v) * width_ + u] = color;
    }
  }
}

void Rasterizer::DrawLine(const Projected& start, const Projected& end, const Stroke& stroke) {
  if (!start.visible || !end.visible) return;
  const double length = std::hypot(end.x - start.x, end.y - start.y);
  if (!std::isfinite(length)) return;
  // Longer than any diagonal means mostly outside; the cap bounds the work.
  const int steps = static_cast<int>(std::clamp(std::ceil(length), 1.0, 8.0 * (width_ + height_)));
  const auto solid = ToBytes(stroke.color);
  const auto faint = ToBytes(Mix(stroke.color, {1, 1, 1}, 0.35));
  const double radius = std::max(0.5, 0.5 * stroke.width);
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    const double x = start.x + t * (end.x - start.x);
    const double y = start.y + t * (end.y - start.y);
    if (x < -radius || y < -radius || x > width_ + radius || y > height_ + radius) continue;
    const double depth = start.depth + t * (end.depth - start.depth);
    const int column = std::clamp(static_cast<int>(std::floor(x)), 0, width_ - 1);
    const int row = std::clamp(static_cast<int>(std::floor(y)), 0, height_ - 1);
    if (stroke.on_top || !IsHidden(column, row, depth)) {
      StampDisc(x, y, radius, solid);
    } else if (stroke.dashed_where_hidden && std::fmod(t * length, 2 * stroke.dash) < stroke.dash) {
      StampDisc(x, y, std::max(0.5, 0.7 * radius), faint);
    }
  }
}

void Rasterizer::ClearDepth() {
  std::fill(depth_.begin(), depth_.end(), std::numeric_limits<float>::infinity());
}

Image Rasterizer::Reduce(int factor) const {
  Image image(width_ / factor, height_ / factor, {1, 1, 1});
  const int area = factor * factor;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      std::array<int, 3> sum{};
      for (int v = 0; v < factor; ++v) {
        const auto* row = &color_[std::size_t(y * factor + v) * width_ + x * factor];
        for (int u = 0; u < factor; ++u) {
          for (int k = 0; k < 3; ++k) sum[k] += row[u][k];
        }
      }
      for (int k = 0; k < 3; ++k) {
        image.pixels[3 * (std::size_t(y) * image.width + x) + k] =
            static_cast<std::uint8_t>((sum[k] + area / 2) / area);
      }
    }
  }
  return image;
}

}  // namespace mortise::render
