// Counts the polygons of a file before anybody divides them into triangles.
#pragma once

#include <cstdint>
#include <string_view>

#include "absl/status/status.h"

namespace mortise::mesh {

class PolygonCount {
 public:
  // A face of so many corners comes next. `where` it is, for people: "line 7"; may be empty.
  // RESOURCE_EXHAUSTED, "file", naming the face, counted from 1: past kMaxSceneTriangles, for more
  // corners than kMaxPolygonCorners, and where the faces up to this one take too long to divide, as
  // each corner is compared with all others of its face (kMaxCornerPairs).
  absl::Status Add(std::uint64_t corners, std::string_view where);

  std::int64_t faces() const { return faces_; }  // also those of fewer than three corners
  std::int64_t triangles() const { return triangles_; }

 private:
  std::int64_t faces_ = 0;
  std::int64_t triangles_ = 0;
  std::int64_t pairs_ = 0;
};

}  // namespace mortise::mesh
