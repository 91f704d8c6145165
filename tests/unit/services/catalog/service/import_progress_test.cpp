// How far an import is, as events: none of quick ones, few of long ones.
#include "services/catalog/service/import_progress.h"

#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "absl/strings/str_cat.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

namespace mortise::catalog {
namespace {

class ImportProgressTest : public ::testing::Test {
 protected:
  std::vector<store::NumberedEvent> Events() {
    EXPECT_OK(numbering_->NumberEvents(100).status());
    std::vector<store::NumberedEvent> events;
    EXPECT_OK(store_->Read([&](store::ReadTransaction& transaction) {
      auto read = transaction.ReadEvents(0, 100);
      if (read.ok()) events = *std::move(read);
      return read.status();
    }));
    return events;
  }

  absl::Time now_ = absl::FromUnixSeconds(1'700'000'000);
  testing::TemporaryFolder folder_;
  std::unique_ptr<store::Store> store_ =
      store::OpenStore({.url = absl::StrCat("sqlite:", (folder_.path() / "store.db").string()),
                        .clock = [this] { return now_; }})
          .value();
  std::unique_ptr<store::EventNumbering> numbering_ = store_->TakeEventNumbering().value();
};

TEST_F(ImportProgressTest, SaysNothingOfQuickImports) {
  ImportProgress progress(store_.get(), "assemblies/cart", "call-1",
                          {.user = "users/ada", .trace_id = ""});
  progress.Tell("reading solids", 1, 7);
  now_ += ImportProgress::kQuietTime - absl::Milliseconds(1);
  progress.Tell("looking for contacts", 7, 7);
  EXPECT_TRUE(Events().empty());
}

TEST_F(ImportProgressTest, SaysNowAndThenHowFarLongOnesAre) {
  ImportProgress progress(store_.get(), "assemblies/cart", "call-1",
                          {.user = "users/ada", .trace_id = ""});
  now_ += ImportProgress::kQuietTime;
  for (int done = 0; done < 100; ++done) {
    progress.Tell("trying designs", done, 100);
    now_ += ImportProgress::kPauseBetweenEvents / 10;
  }
  const std::vector<store::NumberedEvent> events = Events();
  ASSERT_EQ(events.size(), 10U);
  EXPECT_EQ(events[3].type, "assembly.importing");
  EXPECT_EQ(events[3].subject, "assemblies/cart");
  const auto data = nlohmann::json::parse(events[3].payload);
  EXPECT_EQ(data["request_id"], "call-1");
  EXPECT_EQ(data["stage"], "trying designs");
  EXPECT_EQ(data["done"], 30);
  EXPECT_EQ(data["total"], 100);
}

}  // namespace
}  // namespace mortise::catalog
