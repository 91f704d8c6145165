// Small STEP files as people send them, and how tests read them.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_replace.h"
#include "common/base/files.h"
#include "common/cad/step/step_reader.h"

namespace mortise::cad {

inline std::string FieldFile(const std::string& name) {
  const char* source = std::getenv("MORTISE_SOURCE_DIR");
  const std::filesystem::path folder = source == nullptr ? "." : source;
  auto bytes = ReadFile(folder / "tests/data/step" / name);
  EXPECT_TRUE(bytes.ok()) << bytes.status();
  return bytes.value_or("");
}

inline StepAssembly Reading(const std::string& bytes) {
  auto read = ReadStep(bytes);
  EXPECT_TRUE(read.ok()) << read.status();
  return read.ok() ? *std::move(read) : StepAssembly();
}

// With `from`, which must be there, replaced.
inline std::string Changed(const std::string& bytes, const std::string& from,
                           const std::string& to) {
  EXPECT_TRUE(absl::StrContains(bytes, from)) << from;
  return absl::StrReplaceAll(bytes, {{from, to}});
}

}  // namespace mortise::cad
