// What tests of mesh files say of one that is refused.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "common/base/errors.h"
#include "common/mesh/scenes/scene_import.h"

namespace mortise::mesh {

// The message of a refusal that names the file; empty, and a failed test, if the file is read.
inline std::string Refusal(std::string_view bytes, std::string_view name = "",
                           absl::StatusCode code = absl::StatusCode::kInvalidArgument) {
  const auto scene = ImportScene(bytes, name);
  EXPECT_EQ(scene.status().code(), code) << scene.status();
  EXPECT_EQ(DetailOf(scene.status()).field, "file");
  return std::string(scene.status().message());
}

}  // namespace mortise::mesh
