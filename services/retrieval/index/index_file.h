// An index as a file, which is searched where it lies.
//
// A header, with a SHA-256 digest of itself and of each section, and then the arrays of
// index_arrays.h as they are in memory, little-endian, each from a multiple of eight bytes on and
// filled up with zeros to the next: every byte of the file is under a digest. The same index gives
// the same bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "services/retrieval/index/primitive_index.h"

namespace mortise::retrieval {

inline constexpr std::uint32_t kIndexVersion = 2;
inline constexpr std::size_t kMaxDescriptorName = 63;  // bytes

// An index that was read.
struct StoredIndex {
  PrimitiveIndex index;  // holds the mapping; the last copy gives it back
  std::string about;     // what the writer said
};

// Returns the bytes of an index's file. `descriptor` names the descriptor with everything that its
// numbers depend on, "d2/1". `about` is the writer's: which families the numbers stand for.
// INVALID_ARGUMENT for a name that is empty or too long.
absl::StatusOr<std::string> IndexBytes(const PrimitiveIndex& index, std::string_view descriptor,
                                       std::string_view about);

// Writes them to `path`, under another name that is renamed when all is on disk: there is never
// half a file, and who reads the old one goes on reading it. Fails as IndexBytes and as WriteFile
// of common/base/files.h.
absl::Status WriteIndex(const PrimitiveIndex& index, std::string_view descriptor,
                        std::string_view about, const std::filesystem::path& path);

// Maps the index at `path` and checks all of it. DATA_LOSS, INDEX_DAMAGED, for a file that is no
// index, is cut off or changed, and says what is wrong; FAILED_PRECONDITION for an index of another
// version (INDEX_OF_ANOTHER_VERSION) or descriptor (INDEX_OF_ANOTHER_DESCRIPTOR); else as
// MappedFile fails. Whatever is refused is to be built anew.
absl::StatusOr<StoredIndex> ReadIndex(const std::filesystem::path& path,
                                      std::string_view descriptor);

}  // namespace mortise::retrieval
