// Indexes are read once, and one that is being read keeps nobody from the others. Damaged ones:
// tests/integration/services/retrieval/index_faults_test.cpp.
#include "services/retrieval/service/loaded_indexes.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/synchronization/notification.h"
#include "common/base/errors.h"
#include "services/retrieval/service/index_records.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

namespace mortise::retrieval {
namespace {

class LoadedIndexesTest : public ::testing::Test {
 protected:
  // Stores an index of one family at a point.
  void Store(v1::ShapeDescriptor descriptor, double place) {
    Primitive primitive;
    primitive.parameters = Eigen::VectorXd::Zero(1);
    primitive.center = Eigen::VectorXd::Constant(4, place);
    primitive.axes.resize(4, 0);
    primitive.radii.resize(0);
    ASSERT_OK_AND_ASSIGN(const PrimitiveIndex index, PrimitiveIndex::Build({{0, {primitive}}}));
    const std::string id = IndexIdOf(descriptor);
    ASSERT_OK_AND_ASSIGN(const auto kind, MakeDescriptor(id));
    ASSERT_OK_AND_ASSIGN(const std::string bytes, IndexBytes(index, FormatOf(*kind), ""));
    v1::ShapeIndex record;
    record.set_name(absl::StrCat("indexes/", id));
    record.set_shape_descriptor(descriptor);
    record.set_format_version(kIndexFormat);
    record.set_descriptor_version(kind->properties().version);
    record.add_families()->set_template_("templates/table");
    ASSERT_OK_AND_ASSIGN(*record.mutable_sha256(), blobs_->Put(bytes));
    ASSERT_OK(store_->Transact(
        [&](store::Transaction& transaction) { return PutIndex(transaction, record, ""); }));
  }

  testing::TemporaryFolder folder_;
  std::unique_ptr<store::Store> store_ =
      store::OpenStore({.url = absl::StrCat("sqlite:", (folder_.path() / "store.db").string()),
                        .blob_folder = folder_.path() / "blobs"})
          .value();
  store::BlobFolder* const blobs_ = store_->Blobs().value();
};

TEST_F(LoadedIndexesTest, OneThatIsBeingReadKeepsNobodyFromTheOthers) {
  Store(v1::D2, 1);
  Store(v1::VOXEL, 2);
  absl::Notification begun, go_on;
  LoadedIndexes indexes(store_.get(), blobs_,
                        [&](const std::filesystem::path& path, const std::string& format) {
                          if (format.starts_with("d2")) {
                            begun.Notify();
                            go_on.WaitForNotification();
                          }
                          return ReadIndex(path, format);
                        });
  auto slow = std::async(std::launch::async, [&] { return indexes.Get(v1::D2); });
  ASSERT_TRUE(begun.WaitForNotificationWithTimeout(absl::Minutes(2)));
  auto other = std::async(std::launch::async, [&] { return indexes.Get(v1::VOXEL); });
  const bool is_there = other.wait_for(std::chrono::seconds(60)) == std::future_status::ready;
  EXPECT_TRUE(is_there) << "it waits for the other one";
  go_on.Notify();
  EXPECT_OK(slow.get());
  EXPECT_OK(other.get());
}

TEST_F(LoadedIndexesTest, IsReadOnceAndAgainWhenItIsAnotherOne) {
  Store(v1::D2, 1);
  std::atomic<int> read = 0;
  LoadedIndexes indexes(store_.get(), blobs_,
                        [&](const std::filesystem::path& path, const std::string& id) {
                          ++read;
                          return ReadIndex(path, id);
                        });
  ASSERT_OK_AND_ASSIGN(const auto first, indexes.Get(v1::D2));
  ASSERT_OK_AND_ASSIGN(const auto again, indexes.Get(v1::SHAPE_DESCRIPTOR_UNSPECIFIED));
  EXPECT_EQ(first, again);
  EXPECT_EQ(read, 1);
  Store(v1::D2, 3);
  ASSERT_OK_AND_ASSIGN(const auto other, indexes.Get(v1::D2));
  EXPECT_NE(first->record.sha256(), other->record.sha256());
  EXPECT_EQ(read, 2);
  EXPECT_EQ(DetailOf(indexes.Get(v1::LIGHT_FIELD).status()).reason, "INDEX_MISSING");
}

}  // namespace
}  // namespace mortise::retrieval
