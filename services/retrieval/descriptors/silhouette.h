// The silhouette of triangles in a plane, row by row.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace mortise::retrieval {

// A piece of a row that the silhouette covers.
struct Span {
  double y = 0;      // of the row's middle
  double begin = 0;  // x
  double end = 0;
};

struct Silhouette {
  std::vector<Span> spans;  // apart from each other, by rows and from left to right
  double row_height = 0;
};

// Finds silhouettes in a square window. It keeps its tables between silhouettes, so each thread
// needs its own.
//
// common/render draws coloured pictures with depths, pixel by pixel, which is much more work and
// leaves ends of rows that jump by whole pixels as a shape changes. Here a row is exact: it ends
// where the middle of the row crosses the edge of a triangle, so that areas and moments are
// continuous in the vertices. Only gaps within a row that are narrower than a column (of which
// there are twice as many as rows) may be closed. O(T · rows crossed), memory O(rows²).
class SilhouetteRaster {
 public:
  // `corner`: the window's lower left corner; `size` > 0: of its sides.
  SilhouetteRaster(int rows, const Eigen::Vector2d& corner, double size);

  // Of triangles, 3 × T, with corners at `points`, 2 × V, within the window. Orientation means
  // nothing.
  Silhouette Draw(const Eigen::Matrix2Xd& points, const Eigen::Matrix3Xi& triangles);

 private:
  // All spans that begin in one column of one row, taken for one.
  struct Cell {
    float begin;
    float end;
  };

  void Fill(Eigen::Vector2d a, Eigen::Vector2d b, Eigen::Vector2d c);

  int rows_;
  Eigen::Vector2d corner_;
  double row_height_;
  std::vector<Cell> cells_;  // rows × columns; empty between silhouettes
  int words_;                // of a row of columns
  // The columns in which something begins, one bit each, rows × words: most rows have few.
  std::vector<std::uint64_t> touched_;
};

}  // namespace mortise::retrieval
