#include "common/pages/number_pack.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::pages {
namespace {

// Pages are read on machines like those that they are made on; all that there are, are of this
// kind.
static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kAlignment = 8;
// A text in a browser has at most some 2^29 letters.
constexpr std::size_t kMostLetters = 500'000'000;
constexpr int kGzipWindow = 15 + 16;  // the largest window, with gzip's header

absl::StatusOr<std::string> Gzip(const std::string& bytes) {
  constexpr std::size_t kMostAtOnce = std::numeric_limits<uInt>::max();
  z_stream stream = {};
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kGzipWindow, 9, Z_DEFAULT_STRATEGY) !=
      Z_OK) {
    return absl::ResourceExhaustedError("there is no memory to pack numbers in");
  }
  std::string packed;
  std::vector<Bytef> room(1 << 16);
  std::size_t at = 0;
  int state = Z_OK;
  while (state == Z_OK) {
    if (stream.avail_in == 0 && at < bytes.size()) {
      const std::size_t count = std::min(kMostAtOnce, bytes.size() - at);
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + at));
      stream.avail_in = static_cast<uInt>(count);
      at += count;
    }
    stream.next_out = room.data();
    stream.avail_out = static_cast<uInt>(room.size());
    state = deflate(&stream, at == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
    packed.append(reinterpret_cast<const char*>(room.data()), room.size() - stream.avail_out);
  }
  deflateEnd(&stream);
  if (state != Z_STREAM_END) return absl::InternalError("numbers cannot be packed");
  return packed;
}

}  // namespace

void NumberPack::Add(const std::string& name, std::span<const double> numbers) {
  AddBytes(name, "f64", std::as_bytes(numbers), numbers.size());
}

void NumberPack::Add(const std::string& name, std::span<const float> numbers) {
  AddBytes(name, "f32", std::as_bytes(numbers), numbers.size());
}

void NumberPack::Add(const std::string& name, std::span<const std::int32_t> numbers) {
  AddBytes(name, "i32", std::as_bytes(numbers), numbers.size());
}

void NumberPack::Add(const std::string& name, std::span<const std::uint32_t> numbers) {
  AddBytes(name, "u32", std::as_bytes(numbers), numbers.size());
}

void NumberPack::Add(const std::string& name, std::span<const std::uint16_t> numbers) {
  AddBytes(name, "u16", std::as_bytes(numbers), numbers.size());
}

void NumberPack::Add(const std::string& name, std::span<const std::uint8_t> numbers) {
  AddBytes(name, "u8", std::as_bytes(numbers), numbers.size());
}

void NumberPack::AddBytes(const std::string& name, const char* type,
                          std::span<const std::byte> bytes, std::size_t length) {
  bytes_.resize((bytes_.size() + kAlignment - 1) / kAlignment * kAlignment, '\0');
  lists_[name] = {{"type", type}, {"offset", bytes_.size()}, {"length", length}};
  bytes_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

absl::StatusOr<std::string> NumberPack::Text() const {
  MORTISE_ASSIGN_OR_RETURN(const std::string packed, Gzip(bytes_));
  if (packed.size() / 3 * 4 > kMostLetters) {
    return absl::ResourceExhaustedError(absl::StrCat("packed, the numbers of one list take ",
                                                     packed.size() >> 20,
                                                     " MB, more than browsers read"));
  }
  return absl::Base64Escape(packed);
}

void AppendFolded(std::span<const std::uint16_t> steps, std::span<const std::uint16_t> base,
                  std::size_t stride, std::vector<std::uint8_t>& bytes) {
  const std::size_t first = bytes.size();
  bytes.resize(first + 2 * steps.size());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const int from = !base.empty() ? base[i] : i >= stride ? steps[i - stride] : 0;
    // Differences are by 2^16: beyond half of that, the other way round is shorter.
    const auto difference = static_cast<std::int16_t>(steps[i] - from);
    const auto folded = static_cast<std::uint16_t>((static_cast<std::uint16_t>(difference) << 1) ^
                                                   (difference >> 15));
    bytes[first + i] = static_cast<std::uint8_t>(folded & 0xff);
    bytes[first + steps.size() + i] = static_cast<std::uint8_t>(folded >> 8);
  }
}

}  // namespace mortise::pages
