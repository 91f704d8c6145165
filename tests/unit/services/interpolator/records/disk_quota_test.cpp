// The disk that maps share: what counts, and what is refused.
#include "services/interpolator/records/disk_quota.h"

#include <gtest/gtest.h>

#include <fstream>
#include <memory>

#include "common/base/errors.h"
#include "tests/support/temporary_folder.h"

namespace mortise::interpolator {
namespace {

TEST(DiskQuotaTest, CountsMapsAndBuildsTogether) {
  std::int64_t of_maps = 400;
  DiskQuota quota(1000, [&] { return of_maps; });
  auto first = std::make_unique<DiskQuota::Build>(&quota);
  DiskQuota::Build second(&quota);
  EXPECT_TRUE(first->Take(300).ok());
  EXPECT_TRUE(second.Take(300).ok());
  const absl::Status refused = second.Take(1);
  EXPECT_TRUE(absl::IsResourceExhausted(refused));
  EXPECT_EQ(DetailOf(refused).reason, "DISK_QUOTA");
  EXPECT_NE(refused.message().find("--map-disk-quota"), absl::string_view::npos) << refused;
  EXPECT_NE(refused.message().find("0.001 MB"), absl::string_view::npos) << refused;
  EXPECT_EQ(second.bytes(), 300);
  // What ends without a map counts no more, nor what was deleted.
  first.reset();
  EXPECT_TRUE(second.Take(300).ok());
  EXPECT_FALSE(second.Take(1).ok());
  of_maps = 0;
  EXPECT_TRUE(second.Take(400).ok());
  EXPECT_FALSE(second.Take(1).ok());
}

TEST(DiskQuotaTest, FailsWhereMapsCannotBeRead) {
  DiskQuota quota(1000, [] { return absl::InternalError("the store is away"); });
  DiskQuota::Build build(&quota);
  EXPECT_EQ(build.Take(1).code(), absl::StatusCode::kInternal);
  EXPECT_EQ(build.bytes(), 0);
}

TEST(DiskQuotaTest, PutsFilesAsTheyAreMeantToBe) {
  const testing::TemporaryFolder folder;
  const auto blobs = store::BlobFolder::Open(folder.path()).value();
  DiskQuota quota(100, [] { return 0; });
  DiskQuota::Build build(&quota);
  const std::string digest = PutFile(*blobs, build, "a shape").value();
  EXPECT_EQ(blobs->Get(digest).value(), "a shape");
  EXPECT_EQ(build.bytes(), 7);
  // One that is damaged by now is mended.
  std::ofstream(blobs->PathOf(digest).value(), std::ios::trunc) << "a shaqe";
  ASSERT_TRUE(absl::IsDataLoss(blobs->Get(digest).status()));
  EXPECT_EQ(PutFile(*blobs, build, "a shape").value(), digest);
  EXPECT_EQ(blobs->Get(digest).value(), "a shape");
  // It counts once, as often as it is put.
  EXPECT_EQ(build.bytes(), 7);
  EXPECT_TRUE(absl::IsResourceExhausted(PutFile(*blobs, build, std::string(94, 'x')).status()));
}

TEST(DiskQuotaTest, CountsFilesOfEarlierRunsOnce) {
  DiskQuota quota(100, [] { return 0; });
  DiskQuota::Build build(&quota);
  EXPECT_TRUE(build.TakeFile("one", 60).ok());
  EXPECT_TRUE(build.TakeFile("one", 60).ok());
  EXPECT_FALSE(build.TakeFile("other", 60).ok());
  // What was refused does not count.
  EXPECT_FALSE(build.TakeFile("other", 60).ok());
  EXPECT_TRUE(build.TakeFile("third", 40).ok());
  EXPECT_EQ(build.bytes(), 100);
}

}  // namespace
}  // namespace mortise::interpolator
