#include "services/retrieval/descriptors/silhouette.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace mortise::retrieval {
namespace {

constexpr int kColumnsARow = 2;  // columns as wide as half a row is high
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
      first_column_(static_cast<std::size_t>(rows), rows * kColumnsARow),
      last_column_(static_cast<std::size_t>(rows), -1) {}

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
    int& first_column = first_column_[static_cast<std::size_t>(row)];
    int& last_column = last_column_[static_cast<std::size_t>(row)];
    first_column = std::min(first_column, column);
    last_column = std::max(last_column, column);
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
    const int last = std::exchange(last_column_[static_cast<std::size_t>(row)], -1);
    const int first = std::exchange(first_column_[static_cast<std::size_t>(row)], columns);
    for (int column = first; column <= last; ++column) {
      Cell& touched = cells_[static_cast<std::size_t>(row * columns + column)];
      if (touched.begin == kFarRight) continue;
      const Cell cell = std::exchange(touched, Cell{kFarRight, kFarLeft});
      if (cell.begin > open.end) {
        close();
        open = cell;
      }
      open.end = std::max(open.end, cell.end);
    }
    close();
  }
  return silhouette;
}

}  // namespace mortise::retrieval
