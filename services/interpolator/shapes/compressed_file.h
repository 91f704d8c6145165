// Files that are compressed behind a header with a checksum. Private to this folder.
//
//   bytes  0–7   what it is, 8 letters
//          8–11  u32 version, 1
//         12–15  u32 0
//         16–23  u64 bytes before compression
//         24–31  u64 bytes of the file
//         32–63  SHA-256 of bytes 0–31 and of all bytes from 64 on
//         64–    zstd
//
// All numbers are little-endian.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace mortise::interpolator {

// Returns the file. `letters`: 8. The same content gives the same bytes.
absl::StatusOr<std::string> Compress(std::string_view letters, std::string_view content);

// Returns the content. INVALID_ARGUMENT naming "`field`.header" or "`field`.checksum" for what is
// no such file, is cut short or changed, or of another version; RESOURCE_EXHAUSTED where its
// content is larger than `limit`, bytes, before anything is expanded.
absl::StatusOr<std::string> Expand(std::string_view letters, std::string_view bytes,
                                   std::int64_t limit, const std::string& field);

}  // namespace mortise::interpolator
