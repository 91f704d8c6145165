#include "cli/explore/number_pack.h"

#include <google/protobuf/io/gzip_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"

namespace mortise::cli {
namespace {

// Pages are read on machines like those that they are made on; all that there are, are of this
// kind.
static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kAlignment = 8;
// A text in a browser has at most some 2^29 letters.
constexpr std::size_t kMostLetters = 500'000'000;

}  // namespace

void NumberPack::Add(const std::string& name, std::span<const double> numbers) {
  AddBytes(name, "f64", std::as_bytes(numbers), numbers.size());
}

void NumberPack::Add(const std::string& name, std::span<const std::int32_t> numbers) {
  AddBytes(name, "i32", std::as_bytes(numbers), numbers.size());
}

void NumberPack::Add(const std::string& name, std::span<const std::uint32_t> numbers) {
  AddBytes(name, "u32", std::as_bytes(numbers), numbers.size());
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
  std::string packed;
  {
    google::protobuf::io::StringOutputStream sink(&packed);
    google::protobuf::io::GzipOutputStream::Options options;
    options.compression_level = 9;
    google::protobuf::io::GzipOutputStream gzip(&sink, options);
    for (std::size_t at = 0; at < bytes_.size();) {
      void* room = nullptr;
      int size = 0;
      if (!gzip.Next(&room, &size)) return absl::InternalError("numbers cannot be packed");
      const std::size_t count = std::min(static_cast<std::size_t>(size), bytes_.size() - at);
      std::memcpy(room, bytes_.data() + at, count);
      gzip.BackUp(size - static_cast<int>(count));
      at += count;
    }
    if (!gzip.Close()) return absl::InternalError("numbers cannot be packed");
  }
  if (packed.size() / 3 * 4 > kMostLetters) {
    return absl::ResourceExhaustedError(
        absl::StrCat("packed, the numbers of one structure take ", packed.size() >> 20,
                     " MB, more than browsers read; ask for fewer fields"));
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

}  // namespace mortise::cli
