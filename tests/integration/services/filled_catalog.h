// The catalog with the collection that ships, as a process of its own for each test that needs not
// wait until it has taken the collection.
#pragma once

#include <gtest/gtest.h>
#include <signal.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/integration/services/service_under_test.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"

namespace mortise::testing {

inline std::filesystem::path ShippedCollection() {
  const char* source = std::getenv("MORTISE_SOURCE_DIR");
  return std::filesystem::path(source == nullptr ? "." : source) / "collection";
}

// The state of a catalog that has taken the collection: taking it lasts seconds, copying what came
// of it does not. Made once in a program of tests, by the catalog itself.
inline const std::filesystem::path& FilledState() {
  static const TemporaryFolder folder;
  static const int result = [] {
    ServiceProcess catalog(BuiltProgram("mortise-catalog"),
                           {"--collection=" + ShippedCollection().string(),
                            "--insecure-development", "--log-level=warning", "--listen=127.0.0.1:0",
                            "--store=sqlite:" + (folder.path() / "store.db").string(),
                            "--blobs=" + (folder.path() / "blobs").string()},
                           folder.path() / "address.json");
    return catalog.End(SIGTERM);
  }();
  EXPECT_EQ(result, 0);
  return folder.path();
}

// A catalog that has taken the collection.
class FilledCatalog : public ServiceUnderTest {
 public:
  FilledCatalog()
      : ServiceUnderTest("mortise-catalog", {"--collection=" + ShippedCollection().string()}, {},
                         FilledState()) {}
};

}  // namespace mortise::testing
