// Which files of retrieval go, and when.
#include "services/retrieval/service/file_upkeep.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "absl/time/clock.h"
#include "common/base/errors.h"
#include "common/operations/operations.h"
#include "common/store/blob_folder.h"
#include "services/retrieval/service/index_records.h"
#include "services/retrieval/service/uploaded_meshes.h"
#include "tests/support/temporary_folder.h"

namespace mortise::retrieval {
namespace {

class FileUpkeepTest : public ::testing::Test {
 protected:
  FileUpkeepTest() {
    store::StoreOptions options;
    options.url = "sqlite:" + (folder_.path() / "store.db").string();
    options.service = "retrieval";
    options.blob_folder = blob_folder_;
    options.clock = [this] { return absl::Now() + ahead_; };
    store_ = store::OpenStore(options).value();
    blobs_ = store_->Blobs().value();
    operations_ = operations::Operations::Create({.service = "retrieval"}, store_.get()).value();
    // Without Resume none ever runs.
    operations_->Register("build", [](operations::OperationContext&) { return ""; });
  }

  std::string File(const std::string& bytes) { return blobs_->Put(bytes).value(); }
  bool Exists(const std::string& digest) { return blobs_->Size(digest).ok(); }

  void InTransaction(const std::function<absl::Status(store::Transaction&)>& change) {
    const absl::Status changed = store_->Transact(change);
    EXPECT_TRUE(changed.ok()) << changed;
  }

  static v1::ShapeIndex Cover(const std::string& sha256) {
    v1::ShapeIndex cover;
    cover.set_name("indexes/voxel");
    cover.set_sha256(sha256);
    cover.add_families()->set_template_("templates/table");
    return cover;
  }

  int RemoveFiles() {
    const auto removed = RemoveUnusedFiles(*store_, *operations_, blob_folder_);
    EXPECT_TRUE(removed.ok()) << removed.status();
    return removed.ok() ? removed->count : -1;
  }

  const testing::TemporaryFolder folder_;
  const std::filesystem::path blob_folder_ = folder_.path() / "blobs";
  absl::Duration ahead_ = absl::ZeroDuration();  // of the store's clock
  std::unique_ptr<store::Store> store_;
  store::BlobFolder* blobs_ = nullptr;
  std::unique_ptr<operations::Operations> operations_;
};

TEST_F(FileUpkeepTest, WhatNothingNamesGoesAfterADay) {
  const std::string reported_late = File("a cover whose report was refused");
  ahead_ = absl::Hours(23);
  EXPECT_EQ(RemoveFiles(), 0);
  ahead_ = absl::Hours(25);
  EXPECT_EQ(RemoveFiles(), 1);
  EXPECT_FALSE(Exists(reported_late));
}

TEST_F(FileUpkeepTest, CoversIndexesAndMeshesKeepTheirs) {
  const std::string old = File("an earlier cover"), cover = File("cover"), index = File("index"),
                    mesh = File("mesh");
  InTransaction([&](store::Transaction& transaction) -> absl::Status {
    MORTISE_RETURN_IF_ERROR(PutCover(transaction, "voxel", Cover(old)));
    MORTISE_RETURN_IF_ERROR(PutCover(transaction, "voxel", Cover(cover)));
    MORTISE_RETURN_IF_ERROR(PutIndex(transaction, Cover(index), ""));
    return transaction.Put(kMeshRecords, mesh, "").status();
  });
  ahead_ = absl::Hours(25);
  EXPECT_EQ(RemoveFiles(), 1);
  EXPECT_FALSE(Exists(old));
  EXPECT_TRUE(Exists(cover));
  EXPECT_TRUE(Exists(index));
  EXPECT_TRUE(Exists(mesh));
}

TEST_F(FileUpkeepTest, WhatABuildHasMadeStaysWhileItGoesOn) {
  std::string name;
  InTransaction([&](store::Transaction& transaction) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(const operations::Operation operation,
                             operations_->Start(transaction, {.kind = "build"}));
    name = operation.name;
    return absl::OkStatus();
  });
  File("a cover that is not reported yet");
  ahead_ = absl::Hours(48);
  EXPECT_EQ(RemoveFiles(), 0);
  EXPECT_TRUE(operations_->Cancel(name).ok());
  EXPECT_EQ(RemoveFiles(), 1);
}

}  // namespace
}  // namespace mortise::retrieval
