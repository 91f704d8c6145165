// The inner loop of blending. Private to this folder.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace mortise::interpolator {

// At most so many streams are read at once, which is what processors fetch ahead of.
inline constexpr std::size_t kMostStreams = 8;

// Numbers that are added, each times a scale that comes round every three numbers.
struct BlendStream {
  const std::uint16_t* numbers = nullptr;
  std::array<float, 3> scale{};
};

// out[i] = start + Σ scale[i mod 3] · numbers[i], in the order of the streams, 1 to kMostStreams.
// `start` is offset[i mod 3], or what out[i] is if `is_continued`. Rounds after each product and
// each sum, so that all processors of one kind give the same.
void BlendStreams(std::span<const BlendStream> streams, const std::array<float, 3>& offset,
                  bool is_continued, std::span<float> out);

}  // namespace mortise::interpolator
