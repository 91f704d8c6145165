// The file of a design's shape and fields (design_fields.h), which docs/design-fields.md describes
// byte by byte: a header with a SHA-256 checksum, a table of sections, the sections; little-endian.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "common/fields/design_fields.h"

namespace mortise::fields {

inline constexpr std::uint32_t kFormatVersion = 1;
inline constexpr std::int64_t kMaximumFileSize = std::int64_t{256} << 20;  // bytes

struct WriteOptions {
  // m: positions are rounded to the nearest multiple of it from the lowest corner of the design,
  // and each coordinate takes 4 bytes; 0 for exact ones of 8 bytes.
  double position_step = 0;
  bool single_precision = false;  // values of fields in 4 bytes, of 24 bits, instead of 8
  std::int64_t size_limit = kMaximumFileSize;  // bytes
};

// Returns the file. The same design and options give the same bytes. INVALID_ARGUMENT where Check
// fails, naming "position_step" where the design is more than 2^32 steps long, or a field whose
// values single precision does not hold; RESOURCE_EXHAUSTED past the limit, before it is written.
absl::StatusOr<std::string> WriteFields(const DesignFields& design,
                                        const WriteOptions& options = {});

// Returns how many bytes WriteFields makes of a design that Check finds good.
std::int64_t FileSize(const DesignFields& design, const WriteOptions& options = {});

// Reads a file that anybody may have written. What it returns passes Check. INVALID_ARGUMENT naming
// the place, "header.checksum", "sections[2]" or as Check, for what is no such file, is cut short,
// changed or of a version that is not known; RESOURCE_EXHAUSTED past `size_limit`. It takes no more
// memory than a small multiple of the file.
absl::StatusOr<DesignFields> ReadFields(std::string_view bytes,
                                        std::int64_t size_limit = kMaximumFileSize);

}  // namespace mortise::fields
