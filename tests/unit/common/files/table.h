// The shipped table, for tests.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "common/design/evaluation.h"
#include "common/files/collection.h"
#include "common/files/template_codec.h"

namespace mortise::parametric {

inline Collection ShippedCollection() {
  const char* source = std::getenv("MORTISE_SOURCE_DIR");
  const std::filesystem::path root = source == nullptr ? "." : source;
  auto collection = ReadCollection(root / "collection");
  EXPECT_TRUE(collection.ok()) << collection.status();
  return collection.ok() ? *std::move(collection) : Collection{};
}

inline TemplateBundle TableBundle() {
  auto bundle = BundleOf(ShippedCollection(), "templates/table");
  EXPECT_TRUE(bundle.ok()) << bundle.status();
  return bundle.ok() ? *std::move(bundle) : TemplateBundle{};
}

}  // namespace mortise::parametric
