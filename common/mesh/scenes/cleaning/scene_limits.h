// How much of a mesh file is read.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace mortise::mesh {

inline constexpr std::size_t kMaxSceneBytes = std::size_t{64} << 20;  // of the file as it comes
inline constexpr std::int64_t kMaxSceneTriangles = 2'000'000;   // polygons count as their triangles
inline constexpr std::int64_t kMaxPolygonCorners = 10'000;      // of one face
inline constexpr std::int64_t kMaxCornerPairs = 1'000'000'000;  // within polygons, of all together
inline constexpr std::size_t kMaxSceneComponents = 10'000;      // with more, all become one
inline constexpr std::size_t kMaxSceneNameBytes = 200;          // longer names are cut
inline constexpr int kMaxSceneDepth = 256;  // nodes within nodes, and values within JSON

// What the process that reads may take: addresses beside those of its program, processor time, and
// time by the clock.
inline constexpr std::size_t kMaxSceneMemory = std::size_t{1} << 30;  // bytes
inline constexpr std::chrono::seconds kMaxSceneProcessorTime{60};
inline constexpr std::chrono::seconds kMaxSceneTime{180};

}  // namespace mortise::mesh
