#include "common/base/temporary_folder.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include "tests/support/environment.h"
#include "tests/support/temporary_folder.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

class TemporaryFolderTest : public ::testing::Test {
 protected:
  static void WrittenAnHourAgo(const fs::path& folder) {
    fs::last_write_time(folder, fs::file_time_type::clock::now() - std::chrono::hours(1));
  }

  const testing::TemporaryFolder root_;
  const testing::Environment temporary_{"TMPDIR", root_.path().string()};
};

TEST_F(TemporaryFolderTest, IsForThisUserAloneAndGoesWithAllInIt) {
  fs::path place;
  {
    const TemporaryFolder folder("mesh");
    place = folder.path();
    EXPECT_EQ(place.parent_path(), root_.path());
    EXPECT_EQ(fs::status(place).permissions(), fs::perms::owner_all);
    std::ofstream(place / "file") << "text";
  }
  EXPECT_FALSE(fs::exists(place));
}

TEST_F(TemporaryFolderTest, TakesAwayWhatAKilledProcessLeft) {
  const fs::path left = root_.path() / "mortise-mesh-0198c1";
  const fs::path of_another_kind = root_.path() / "mortise-air-0198c1";
  for (const fs::path& folder : {left, of_another_kind}) {
    fs::create_directory(folder);
    std::ofstream(folder / "file") << "text";
    WrittenAnHourAgo(folder);
  }
  const TemporaryFolder folder("mesh");
  EXPECT_FALSE(fs::exists(left));
  EXPECT_TRUE(fs::exists(of_another_kind));
}

TEST_F(TemporaryFolderTest, LeavesWhatIsInUse) {
  const TemporaryFolder in_use("mesh");
  WrittenAnHourAgo(in_use.path());
  const fs::path just_made = root_.path() / "mortise-mesh-0198c2";
  fs::create_directory(just_made);
  const TemporaryFolder folder("mesh");
  EXPECT_TRUE(fs::exists(in_use.path()));
  EXPECT_TRUE(fs::exists(just_made));
}

}  // namespace
}  // namespace mortise
