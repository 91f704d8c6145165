// A flat drawing of lines, discs, areas and texts that can be written as SVG and as PNG, the same
// in both: for pictures that no standard plot shows.
//
// Coordinates are pixels from the top left corner, x to the right and y down. What is added later
// lies on top; texts lie above all else.
#pragma once

#include <Eigen/Core>
#include <string>
#include <variant>
#include <vector>

#include "absl/status/statusor.h"
#include "common/render/image.h"

namespace mortise::render {

class Drawing {
 public:
  using Points = std::vector<Eigen::Vector2d>;

  // On which side of its position a text lies.
  enum class Anchor { kStart, kMiddle, kEnd };

  struct Line {
    Points points;
    Color color;
    double width = 1;
  };
  struct Disc {
    Eigen::Vector2d centre;
    double radius = 1;
    Color color;
  };
  // A simple polygon.
  struct Area {
    Points corners;
    Color color;
  };
  struct Text {
    Eigen::Vector2d position;  // on the baseline
    std::string text;          // UTF-8
    double size = 12;          // of the font
    Anchor anchor = Anchor::kStart;
    Color color{0.125, 0.137, 0.165};
  };

  Drawing(int width, int height) : width_(width), height_(height) {}

  void Add(Line line) { marks_.emplace_back(std::move(line)); }
  void Add(Disc disc) { marks_.emplace_back(std::move(disc)); }
  void Add(Area area) { marks_.emplace_back(std::move(area)); }
  void Add(Text text) { texts_.push_back(std::move(text)); }

  int width() const { return width_; }
  int height() const { return height_; }
  const std::vector<std::variant<Line, Disc, Area>>& marks() const { return marks_; }
  const std::vector<Text>& texts() const { return texts_; }

 private:
  int width_, height_;
  std::vector<std::variant<Line, Disc, Area>> marks_;
  std::vector<Text> texts_;
};

// Returns a standalone SVG document on white. INVALID_ARGUMENT naming "drawing.width" or
// "drawing.height" if a size is not within 16 to 10000, or "drawing" if a coordinate is not finite.
absl::StatusOr<std::string> DrawingSvg(const Drawing& drawing);

// Returns the picture with `scale` pixels for each of the drawing's, at most 4. INVALID_ARGUMENT as
// above, or naming "scale".
absl::StatusOr<Image> DrawingImage(const Drawing& drawing, int scale = 2);

// `text`, or its beginning and "..", so that it is no wider than `width` pixels at a font size.
std::string Shortened(const std::string& text, double size, double width);

}  // namespace mortise::render
