#include "services/interpolator/shapes/compressed_file.h"

#include <zstd.h>

#include <bit>
#include <cstring>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "common/base/errors.h"

namespace mortise::interpolator {
namespace {

// Numbers are copied as they lie in memory.
static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kVersionAt = 8;
constexpr std::size_t kContentSizeAt = 16;
constexpr std::size_t kFileSizeAt = 24;
constexpr std::size_t kChecksumAt = 32;
constexpr std::size_t kHeaderSize = 64;
constexpr std::uint32_t kVersion = 1;
// A tenth smaller than at the usual level, 3, and as quick to expand.
constexpr int kLevel = 9;

template <typename Number>
void Put(Number number, std::size_t at, std::string& bytes) {
  std::memcpy(bytes.data() + at, &number, sizeof number);
}

template <typename Number>
Number Get(std::string_view bytes, std::size_t at) {
  Number number;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

std::string ChecksumOf(std::string_view bytes) {
  std::string whole(bytes.substr(0, kChecksumAt));
  whole += bytes.substr(kHeaderSize);
  return absl::HexStringToBytes(Sha256Hex(whole));
}

}  // namespace

absl::StatusOr<std::string> Compress(std::string_view letters, std::string_view content) {
  std::string bytes(kHeaderSize + ZSTD_compressBound(content.size()), '\0');
  const std::size_t size = ZSTD_compress(bytes.data() + kHeaderSize, bytes.size() - kHeaderSize,
                                         content.data(), content.size(), kLevel);
  if (ZSTD_isError(size) != 0) {
    return absl::InternalError(absl::StrCat("zstd: ", ZSTD_getErrorName(size)));
  }
  bytes.resize(kHeaderSize + size);
  bytes.shrink_to_fit();
  std::memcpy(bytes.data(), letters.data(), kVersionAt);
  Put(kVersion, kVersionAt, bytes);
  Put(std::uint64_t{content.size()}, kContentSizeAt, bytes);
  Put(std::uint64_t{bytes.size()}, kFileSizeAt, bytes);
  const std::string checksum = ChecksumOf(bytes);
  std::memcpy(bytes.data() + kChecksumAt, checksum.data(), checksum.size());
  return bytes;
}

absl::StatusOr<std::string> Expand(std::string_view letters, std::string_view bytes,
                                   std::int64_t limit, const std::string& field) {
  const std::string header = absl::StrCat(field, ".header");
  if (bytes.size() < kHeaderSize || bytes.substr(0, kVersionAt) != letters) {
    return InvalidField(header, "is no file of this kind");
  }
  if (Get<std::uint32_t>(bytes, kVersionAt) != kVersion) {
    return InvalidField(header, "is of a version that is not known");
  }
  if (Get<std::uint64_t>(bytes, kFileSizeAt) != bytes.size()) {
    return InvalidField(header, "says another size: the file is cut short or damaged");
  }
  if (bytes.substr(kChecksumAt, kHeaderSize - kChecksumAt) != ChecksumOf(bytes)) {
    return InvalidField(absl::StrCat(field, ".checksum"), "does not match: the file is damaged");
  }
  const auto content_size = Get<std::uint64_t>(bytes, kContentSizeAt);
  if (content_size > static_cast<std::uint64_t>(limit)) {
    return TooLarge(absl::StrCat(field, " of ", content_size, " bytes"),
                    absl::StrCat(limit, " bytes"));
  }
  std::string content(content_size, '\0');
  const std::string_view compressed = bytes.substr(kHeaderSize);
  const std::size_t size =
      ZSTD_decompress(content.data(), content.size(), compressed.data(), compressed.size());
  if (ZSTD_isError(size) != 0 || size != content_size) {
    return InvalidField(header, "says another size of the content");
  }
  return content;
}

}  // namespace mortise::interpolator
