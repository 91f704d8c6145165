#include "services/retrieval/descriptors/silhouette.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace mortise::retrieval {
namespace {

constexpr int kColumnsARow = 2;  // columns as wide as half a row is high
constexpr int kBits = 64;        // of a word
constexpr float kFarLeft = std::numeric_limits<float>::lowest();
constexpr float kFarRight = std::numeric_limits<float>::max();

// The first row whose middle lies at y or above, in units of rows.
int FirstRow(double y) { return static_cast<int>(std::ceil(y - 0.5)); }

}  // namespace

SilhouetteRaster::SilhouetteRaster(int rows, const Eigen::Vector2d& corner, double size)
    : rows_(rows),
      corner_(corner),
      row_height_(size / rows),
      cells_(static_cast<std::size_t>(rows) * static_cast<std::size_t>(rows * kColumnsARow),
             Cell{kFarRight, kFarLeft}),
      words_((rows * kColumnsARow + kBits - 1) / kBits),
      touched_(static_cast<std::size_t>(rows) * static_cast<std::size_t>(words_), 0) {}

// Corners in rows and columns.
void SilhouetteRaster::Fill(Eigen::Vector2d a, Eigen::Vector2d b, Eigen::Vector2d c) {
  if (a.y() > b.y()) a.swap(b);
  if (b.y() > c.y()) b.swap(c);
  if (a.y() > b.y()) a.swap(b);
  const int first = std::max(FirstRow(a.y()), 0), last = std::min(FirstRow(c.y()), rows_);
  if (first >= last) return;
  const int columns = rows_ * kColumnsARow;
  const double long_slope = (c.x() - a.x()) / (c.y() - a.y());
  const int knee = FirstRow(b.y());
  const double low_slope = (b.x() - a.x()) / (b.y() - a.y());
  const double high_slope = (c.x() - b.x()) / (c.y() - b.y());
  for (int row = first; row < last; ++row) {
    const double y = row + 0.5;
    const double one = a.x() + (y - a.y()) * long_slope;
    const double other =
        row < knee ? a.x() + (y - a.y()) * low_slope : b.x() + (y - b.y()) * high_slope;
    const auto begin = static_cast<float>(std::min(one, other));
    const auto end = static_cast<float>(std::max(one, other));
    const int column = std::clamp(static_cast<int>(begin), 0, columns - 1);
    Cell& cell = cells_[static_cast<std::size_t>(row * columns + column)];
    cell.begin = std::min(cell.begin, begin);
    cell.end = std::max(cell.end, end);
    touched_[static_cast<std::size_t>(row * words_ + column / kBits)] |= std::uint64_t{1}
                                                                         << column % kBits;
  }
}

Silhouette SilhouetteRaster::Draw(const Eigen::Matrix2Xd& points,
                                  const Eigen::Matrix3Xi& triangles) {
  Silhouette silhouette{{}, row_height_};
  const Eigen::Array2d scale = Eigen::Array2d(kColumnsARow, 1) / row_height_;  // columns and rows
  const auto place = [&](int corner) -> Eigen::Vector2d {
    return (points.col(corner) - corner_).array() * scale;
  };
  for (const auto& corners : triangles.colwise()) {
    Fill(place(corners[0]), place(corners[1]), place(corners[2]));
  }
  const int columns = rows_ * kColumnsARow;
  for (int row = 0; row < rows_; ++row) {
    Cell open{kFarRight, kFarLeft};
    const auto close = [&] {
      if (open.begin >= open.end) return;
      silhouette.spans.push_back({corner_.y() + (row + 0.5) / scale.y(),
                                  corner_.x() + open.begin / scale.x(),
                                  corner_.x() + open.end / scale.x()});
    };
    for (int word = 0; word < words_; ++word) {
      std::uint64_t touched =
          std::exchange(touched_[static_cast<std::size_t>(row * words_ + word)], 0);
      for (; touched != 0; touched &= touched - 1) {
        const int column = word * kBits + std::countr_zero(touched);
        const Cell cell = std::exchange(cells_[static_cast<std::size_t>(row * columns + column)],
                                        Cell{kFarRight, kFarLeft});
        if (cell.begin > open.end) {
          close();
          open = cell;
        }
        open.end = std::max(open.end, cell.end);
      }
    }
    close();
  }
  return silhouette;
}

}  // namespace mortise::retrieval
