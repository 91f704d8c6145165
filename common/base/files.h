// Whole files, read and written so that nobody ever sees half of one.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace mortise {

// Returns the bytes of a file. NOT_FOUND or PERMISSION_DENIED with the path; INVALID_ARGUMENT for a
// folder; RESOURCE_EXHAUSTED past `limit` bytes.
absl::StatusOr<std::string> ReadFile(const std::filesystem::path& path,
                                     std::size_t limit = std::size_t{1} << 30);

// ".csv" of "Items.CSV": extensions mean the same in either case.
std::string LowerCaseExtension(const std::filesystem::path& path);

// Writes beside the file, flushes to disk, then renames over it; creates missing folders.
absl::Status WriteFile(const std::filesystem::path& path, std::string_view bytes);

}  // namespace mortise
