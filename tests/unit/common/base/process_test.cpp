// Child processes: what they are given.
#include "common/base/process.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>

#include "common/base/files.h"
#include "tests/support/temporary_folder.h"

namespace mortise {
namespace {

TEST(Process, AnEntryTakesThePlaceOfOneOfTheSameName) {
  const testing::TemporaryFolder folder;
  const auto log = folder.path() / "log";
  ::setenv("MORTISE_PROBE", "of the parent", 1);
  ::setenv("MORTISE_PROBE_OTHER", "kept", 1);
  const auto end =
      RunProcess({"/usr/bin/env"}, log, std::chrono::seconds(30), {"MORTISE_PROBE=of the child"});
  ASSERT_TRUE(end.ok()) << end.status();
  const std::string environment = ReadFile(log).value_or("");
  EXPECT_NE(environment.find("MORTISE_PROBE=of the child\n"), std::string::npos) << environment;
  EXPECT_EQ(environment.find("MORTISE_PROBE=of the parent"), std::string::npos);
  EXPECT_NE(environment.find("MORTISE_PROBE_OTHER=kept\n"), std::string::npos);
}

}  // namespace
}  // namespace mortise
