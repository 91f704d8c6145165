// Which files maps name, so that the upkeep leaves them.
#include "services/interpolator/records/map_files.h"

#include <gtest/gtest.h>

#include "common/base/errors.h"
#include "tests/support/temporary_folder.h"

namespace mortise::interpolator {
namespace {

std::string Digest(char digit) { return std::string(64, digit); }

TEST(MapFilesTest, AreNamedUntilTheMapIsGone) {
  const testing::TemporaryFolder folder;
  const auto store =
      store::OpenStore({.url = "sqlite:" + (folder.path() / "store.db").string()}).value();
  StoredShapes first, second;
  first.meshes = {{Digest('a'), {{0, Digest('1')}, {1, Digest('2')}}}};
  second.meshes = {{Digest('b'), {{0, Digest('2')}}}, {Digest('c'), {}}};
  const absl::Status put = store->Transact([&](store::Transaction& transaction) -> absl::Status {
    MORTISE_RETURN_IF_ERROR(PutMapFiles(transaction, "one", {first}));
    return PutMapFiles(transaction, "two", {second, second});
  });
  ASSERT_TRUE(put.ok()) << put;
  const auto named = [&] {
    std::set<std::string> digests;
    const absl::Status read = store->Read([&](store::ReadTransaction& transaction) {
      digests.clear();
      return AddMapFiles(transaction, &digests);
    });
    EXPECT_TRUE(read.ok()) << read;
    return digests;
  };
  EXPECT_EQ(named(), (std::set<std::string>{Digest('a'), Digest('b'), Digest('c'), Digest('1'),
                                            Digest('2')}));
  const absl::Status dropped =
      store->Transact([&](store::Transaction& transaction) -> absl::Status {
        MORTISE_RETURN_IF_ERROR(DropMapFiles(transaction, "one"));
        return DropMapFiles(transaction, "of a map of metrics");
      });
  ASSERT_TRUE(dropped.ok()) << dropped;
  EXPECT_EQ(named(), (std::set<std::string>{Digest('b'), Digest('c'), Digest('2')}));
}

}  // namespace
}  // namespace mortise::interpolator
