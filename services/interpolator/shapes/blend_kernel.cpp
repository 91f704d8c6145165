#include "services/interpolator/shapes/blend_kernel.h"

#include <cstring>
#include <utility>

namespace mortise::interpolator {
namespace {

// Vectors as GCC and clang have them, whatever the processor's registers hold. The compilers only
// make them of loops on their own at levels of optimisation that this project does not use.
using Numbers = std::uint16_t __attribute__((vector_size(16)));
using Wholes = std::int32_t __attribute__((vector_size(32)));
using Floats = float __attribute__((vector_size(32)));

constexpr std::size_t kLanes = 8;
constexpr std::size_t kBlock = 3 * kLanes;  // after which scales come round

#define MORTISE_INLINE __attribute__((always_inline)) inline

// Three vectors after another: the scales of a block.
struct Pattern {
  Floats part[3];
};

Pattern PatternOf(const std::array<float, 3>& numbers) {
  Pattern pattern{};
  for (std::size_t i = 0; i < kBlock; ++i) pattern.part[i / kLanes][i % kLanes] = numbers[i % 3];
  return pattern;
}

MORTISE_INLINE void AddPart(const std::uint16_t* numbers, const Floats& scale, Floats& sum) {
  Numbers loaded;
  std::memcpy(&loaded, numbers, sizeof loaded);
  const Wholes wholes = __builtin_convertvector(loaded, Wholes);
  const Floats product = scale * __builtin_convertvector(wholes, Floats);
  sum += product;
}

// The sums of a block.
struct Sums {
  Floats first, second, third;
};

MORTISE_INLINE void AddBlock(const std::uint16_t* numbers, const Pattern& scale, Sums& sums) {
  AddPart(numbers, scale.part[0], sums.first);
  AddPart(numbers + kLanes, scale.part[1], sums.second);
  AddPart(numbers + 2 * kLanes, scale.part[2], sums.third);
}

// Blends whole blocks, and returns how many numbers these are.
template <std::size_t... kAt>
MORTISE_INLINE std::size_t BlendBlocks(std::index_sequence<kAt...>, const BlendStream* streams,
                                       const Pattern& offset, bool is_continued,
                                       std::span<float> out) {
  const Pattern scales[] = {PatternOf(streams[kAt].scale)...};
  const std::uint16_t* const numbers[] = {streams[kAt].numbers...};
  const std::size_t end = out.size() / kBlock * kBlock;
  for (std::size_t i = 0; i < end; i += kBlock) {
    Sums sums = {offset.part[0], offset.part[1], offset.part[2]};
    static_assert(sizeof sums == kBlock * sizeof(float));
    if (is_continued) std::memcpy(&sums, &out[i], sizeof sums);
    (AddBlock(numbers[kAt] + i, scales[kAt], sums), ...);
    std::memcpy(&out[i], &sums, sizeof sums);
  }
  return end;
}

using Blending = std::size_t (*)(const BlendStream*, const Pattern&, bool, std::span<float>);

template <std::size_t kCount>
std::size_t BlendPlainly(const BlendStream* streams, const Pattern& offset, bool is_continued,
                         std::span<float> out) {
  return BlendBlocks(std::make_index_sequence<kCount>(), streams, offset, is_continued, out);
}

#if defined(__x86_64__)
template <std::size_t kCount>
__attribute__((target("avx2"))) std::size_t BlendWide(const BlendStream* streams,
                                                      const Pattern& offset, bool is_continued,
                                                      std::span<float> out) {
  return BlendBlocks(std::make_index_sequence<kCount>(), streams, offset, is_continued, out);
}

bool IsWide() { return __builtin_cpu_supports("avx2") != 0; }

template <std::size_t kCount>
Blending Choose() {
  return IsWide() ? BlendWide<kCount> : BlendPlainly<kCount>;
}
#else
template <std::size_t kCount>
Blending Choose() {
  return BlendPlainly<kCount>;
}
#endif

template <std::size_t... kCounts>
Blending ChooseFor(std::size_t count, std::index_sequence<kCounts...>) {
  Blending chosen = nullptr;
  ((count == kCounts + 1 ? static_cast<void>(chosen = Choose<kCounts + 1>()) : void()), ...);
  return chosen;
}

}  // namespace

void BlendStreams(std::span<const BlendStream> streams, const std::array<float, 3>& offset,
                  bool is_continued, std::span<float> out) {
  const Blending blending = ChooseFor(streams.size(), std::make_index_sequence<kMostStreams>());
  const std::size_t end = blending(streams.data(), PatternOf(offset), is_continued, out);
  for (std::size_t i = end; i < out.size(); ++i) {
    float sum = is_continued ? out[i] : offset[i % 3];
    for (const BlendStream& stream : streams) {
      const float product = stream.scale[i % 3] * static_cast<float>(stream.numbers[i]);
      sum += product;
    }
    out[i] = sum;
  }
}

}  // namespace mortise::interpolator
