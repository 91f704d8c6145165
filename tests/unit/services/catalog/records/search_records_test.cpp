// What searches came to, kept in the store: found again after a restart, anew where it is of
// before.
#include "services/catalog/records/search_records.h"

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/assembly/codec/assembly_codec.h"
#include "services/catalog/records/parametrization_cache.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

namespace mortise::catalog {
namespace {

constexpr std::size_t kCapacity = std::size_t{64} << 20;

bool Stays() { return false; }

v1::AssemblyBundle Trestle() {
  v1::AssemblyBundle bundle;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(
      "name: 'assemblies/trestle' "
      "parts { name: 'left' size { x: 0.02 y: 0.3 z: 0.5 } } "
      "parts { name: 'right' position { x: 0.6 } size { x: 0.02 y: 0.3 z: 0.5 } } "
      "parts { name: 'top' position { z: 0.5 } size { x: 0.62 y: 0.3 z: 0.02 } }",
      bundle.mutable_assembly()));
  bundle.mutable_assembly()->set_digest(parametric::BundleDigest(bundle));
  return bundle;
}

class SearchRecordsTest : public ::testing::Test {
 protected:
  // Parametrises as a process does that has just begun; what it searched.
  std::vector<std::string> StagesOfANewProcess() {
    ParametrizationCache cache(kCapacity, store_.get());
    std::vector<std::string> stages;
    const auto made =
        cache.Get(bundle_, Stays, "",
                  [&](const char* stage, std::int64_t, std::int64_t) { stages.push_back(stage); });
    EXPECT_OK(made.status());
    return stages;
  }

  const v1::AssemblyBundle bundle_ = Trestle();
  const Searched searched_{bundle_.assembly().digest(), ""};
  testing::TemporaryFolder folder_;
  absl::Time now_ = absl::FromUnixSeconds(1'700'000'000);
  std::unique_ptr<store::Store> store_ =
      store::OpenStore({.url = absl::StrCat("sqlite:", (folder_.path() / "store.db").string()),
                        .clock = [this] { return now_; }})
          .value();
};

TEST_F(SearchRecordsTest, NothingIsSearchedAgainAfterARestart) {
  EXPECT_FALSE(FindSearchOutcome(*store_, searched_));
  EXPECT_FALSE(StagesOfANewProcess().empty());
  const auto kept = FindSearchOutcome(*store_, searched_);
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->touching, parametric::TouchingParts({{0, 2}, {1, 2}}));
  EXPECT_TRUE(StagesOfANewProcess().empty());
  EXPECT_FALSE(FindSearchOutcome(*store_, {searched_.digest, "legs"})) << "of another sub-tree";
}

TEST_F(SearchRecordsTest, WhatAnEarlierVersionFoundIsFoundAnew) {
  ASSERT_OK(store_->Transact([&](store::Transaction& transaction) {
    return transaction.Put("searches", searched_.digest, "{\"version\":0}", {.keep_history = false})
        .status();
  }));
  EXPECT_FALSE(StagesOfANewProcess().empty());
  EXPECT_TRUE(FindSearchOutcome(*store_, searched_));
  EXPECT_TRUE(StagesOfANewProcess().empty());
}

TEST_F(SearchRecordsTest, WhatIsFoundWithinATransactionIsKeptAfterIt) {
  ParametrizationCache cache(kCapacity, store_.get());
  ASSERT_OK(
      store_->Transact([&](store::Transaction&) { return cache.Get(bundle_, Stays).status(); }));
  cache.KeepWhatWasFound();
  EXPECT_TRUE(FindSearchOutcome(*store_, searched_));
}

TEST_F(SearchRecordsTest, WhoeverLeavesLeavesNothing) {
  ParametrizationCache cache(kCapacity, store_.get());
  EXPECT_TRUE(absl::IsCancelled(cache.Get(bundle_, [] { return true; }).status()));
  EXPECT_FALSE(FindSearchOutcome(*store_, searched_));
}

TEST_F(SearchRecordsTest, WhatNobodyAsksForGoesInTheEnd) {
  EXPECT_FALSE(StagesOfANewProcess().empty());
  // Whoever asks keeps it for longer.
  for (int month = 0; month < 4; ++month) {
    now_ += absl::Hours(24 * 40);
    ASSERT_TRUE(FindSearchOutcome(*store_, searched_));
    EXPECT_EQ(SweepSearches(*store_).value_or(-1), 0);
  }
  now_ += absl::Hours(24 * 61);
  EXPECT_EQ(SweepSearches(*store_).value_or(-1), 1);
  EXPECT_FALSE(FindSearchOutcome(*store_, searched_));
}

}  // namespace
}  // namespace mortise::catalog
