// The methods that a collection gives: found by name, listed by filters, changed in their tags
// alone.
#include "common/resources/collection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "mortise/v1/evaluator.pb.h"
#include "tests/support/temporary_folder.h"

namespace mortise::resources {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const Collection<v1::Evaluator> kEvaluators{
    .names = "evaluators", .kind = "solvers", .event = "evaluator"};

constexpr auto kAll = [](const v1::Evaluator&) { return true; };

class CollectionTest : public ::testing::Test {
 protected:
  void SetUp() override {
    for (int i = 0; i < 4; ++i) {
      v1::Evaluator evaluator;
      evaluator.set_name(absl::StrCat("evaluators/e", i));
      evaluator.set_title(absl::StrCat("Solver ", i));
      evaluator.add_external_ids(absl::StrCat("100-", i));
      (*evaluator.mutable_labels())["parity"] = i % 2 == 0 ? "even" : "odd";
      Put(absl::StrCat("e", i), evaluator.SerializeAsString());
    }
  }

  void Put(const std::string& key, const std::string& payload) {
    const absl::Status stored = store_->Transact([&](store::Transaction& transaction) {
      return transaction.Put("solvers", key, payload).status();
    });
    ASSERT_TRUE(stored.ok()) << stored;
  }

  absl::StatusOr<v1::Evaluator> Update(const v1::Evaluator& changes,
                                       const google::protobuf::FieldMask& mask = {}) {
    absl::StatusOr<v1::Evaluator> updated = absl::UnknownError("not done");
    const absl::Status stored = store_->Transact([&](store::Transaction& transaction) {
      updated = kEvaluators.UpdateTags(transaction, changes, mask, "evaluator",
                                       {.user = "users/ada", .trace_id = "t-1"});
      return updated.status();
    });
    return stored.ok() ? updated : stored;
  }

  std::vector<std::string> NamesOf(const absl::StatusOr<Page<v1::Evaluator>>& page) {
    EXPECT_TRUE(page.ok()) << page.status();
    std::vector<std::string> names;
    if (!page.ok()) return names;
    for (const v1::Evaluator& evaluator : page->entries) names.push_back(evaluator.name());
    return names;
  }

  testing::TemporaryFolder folder_;
  std::unique_ptr<store::Store> store_ =
      store::OpenStore({.url = "sqlite:" + (folder_.path() / "store.db").string()}).value();
};

TEST_F(CollectionTest, FindsAResourceByItsName) {
  const auto found = kEvaluators.Get(*store_, "evaluators/e2");
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ(found->title(), "Solver 2");
}

TEST_F(CollectionTest, TellsWhyThereIsNone) {
  EXPECT_TRUE(absl::IsNotFound(kEvaluators.Get(*store_, "evaluators/other").status()));
  const absl::Status misnamed = kEvaluators.Get(*store_, "fronts/e2", "front").status();
  EXPECT_TRUE(absl::IsInvalidArgument(misnamed));
  EXPECT_EQ(DetailOf(misnamed).field, "front");
  Put("damaged", "\xff\xff");
  EXPECT_EQ(DetailOf(kEvaluators.Get(*store_, "evaluators/damaged").status()).reason,
            "STORAGE_FAILED");
}

TEST_F(CollectionTest, ListsThoseThatMeetTheFilter) {
  v1::ListEvaluatorsRequest request;
  EXPECT_THAT(NamesOf(kEvaluators.List(*store_, request, kAll)),
              ElementsAre("evaluators/e3", "evaluators/e2", "evaluators/e1", "evaluators/e0"));
  (*request.mutable_filter()->mutable_labels())["parity"] = "odd";
  EXPECT_THAT(NamesOf(kEvaluators.List(*store_, request, kAll)),
              ElementsAre("evaluators/e3", "evaluators/e1"));
  request.mutable_filter()->set_external_id("100-1");
  EXPECT_THAT(NamesOf(kEvaluators.List(*store_, request, kAll)), ElementsAre("evaluators/e1"));
  request.mutable_filter()->set_external_id("100-2");
  EXPECT_THAT(NamesOf(kEvaluators.List(*store_, request, kAll)), IsEmpty());
}

TEST_F(CollectionTest, ListsAPageAtATime) {
  v1::ListEvaluatorsRequest request;
  request.set_page_size(1);
  (*request.mutable_filter()->mutable_labels())["parity"] = "even";
  const auto first = kEvaluators.List(*store_, request, kAll);
  EXPECT_THAT(NamesOf(first), ElementsAre("evaluators/e2"));
  request.set_page_token(first->next_page_token);
  EXPECT_THAT(NamesOf(kEvaluators.List(*store_, request, kAll)), ElementsAre("evaluators/e0"));
}

TEST_F(CollectionTest, TellsEverythingThatIsWrongWithARequest) {
  v1::ListEvaluatorsRequest request;
  request.set_page_size(-1);
  request.mutable_filter()->set_external_id("a\tb");
  const absl::Status refused = kEvaluators.List(*store_, request, kAll).status();
  EXPECT_THAT(std::string(refused.message()), HasSubstr("page_size"));
  EXPECT_THAT(std::string(refused.message()), HasSubstr("filter.external_id"));
}

TEST_F(CollectionTest, ChangesTagsAndNothingElse) {
  v1::Evaluator changes;
  changes.set_name("evaluators/e1");
  changes.set_title("Another");
  changes.add_external_ids("PLM 7");
  google::protobuf::FieldMask mask;
  mask.add_paths("external_ids");
  const auto updated = Update(changes, mask);
  ASSERT_TRUE(updated.ok()) << updated.status();
  const auto found = kEvaluators.Get(*store_, "evaluators/e1");
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(found->title(), "Solver 1");
  EXPECT_THAT(found->external_ids(), ElementsAre("PLM 7"));
  EXPECT_EQ(found->labels().at("parity"), "odd");
}

TEST_F(CollectionTest, ChangesNothingWhereARequestIsWrong) {
  v1::Evaluator changes;
  changes.set_name("evaluators/e1");
  changes.add_external_ids("");
  google::protobuf::FieldMask mask;
  mask.add_paths("title");
  const absl::Status refused = Update(changes, mask).status();
  EXPECT_THAT(std::string(refused.message()), HasSubstr("update_mask"));
  EXPECT_THAT(std::string(refused.message()), HasSubstr("evaluator.external_ids[0]"));
  EXPECT_THAT(kEvaluators.Get(*store_, "evaluators/e1")->external_ids(), ElementsAre("100-1"));
  changes.set_name("evaluators/none");
  changes.clear_external_ids();
  EXPECT_TRUE(absl::IsNotFound(Update(changes).status()));
}

}  // namespace
}  // namespace mortise::resources
