// Where the published instances of cutting and packing are.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace mortise::fabplanner {

// Returns the path of a file of tests/data/cutting.
inline std::filesystem::path DataFile(const std::string& name) {
  const char* source = std::getenv("MORTISE_SOURCE_DIR");
  return std::filesystem::path(source == nullptr ? "." : source) / "tests/data/cutting" / name;
}

}  // namespace mortise::fabplanner
