// Answers of evaluators while a map is built: kept, read again, forgotten.
#include "services/interpolator/records/kept_answers.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "common/base/errors.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/services/interpolator/records/kept_versions.h"

namespace mortise::interpolator {
namespace {

class KeptAnswersTest : public ::testing::Test {
 protected:
  KeptAnswersTest() {
    KnownAnswers answers;
    answers[{0, 5}] = {absl::OkStatus(), Eigen::Vector2d(1.5, -2), "abc"};
    answers[{0, 6}] = {PreconditionFailed("RIGID_MOTION", "it can turn"), {}};
    const absl::Status put = store_->Transact([&](store::Transaction& transaction) {
      return PutAnswers(transaction, "build", answers, [](const std::string&) {
        return Eigen::VectorXd(Eigen::Vector3d(7, 8, 9));
      });
    });
    EXPECT_TRUE(put.ok()) << put;
  }

  const mortise::testing::TemporaryFolder folder_;
  const std::unique_ptr<store::Store> store_ =
      store::OpenStore({.url = "sqlite:" + (folder_.path() / "store.db").string()}).value();
};

TEST_F(KeptAnswersTest, ComeBackAsTheyWereGiven) {
  const auto kept = LoadAnswers(*store_, "build");
  ASSERT_TRUE(kept.ok()) << kept.status();
  ASSERT_EQ(kept->answers.size(), 2u);
  EXPECT_EQ(kept->answers.at({0, 5}).values, Eigen::Vector2d(1.5, -2));
  EXPECT_EQ(kept->answers.at({0, 5}).file, "abc");
  EXPECT_EQ(DetailOf(kept->answers.at({0, 6}).status).reason, "RIGID_MOTION");
  EXPECT_EQ(kept->designs.at("abc"), Eigen::Vector3d(7, 8, 9));
  EXPECT_TRUE(LoadAnswers(*store_, "buil")->answers.empty());
}

TEST_F(KeptAnswersTest, AreNotThoseOfAnotherVersionButGoWithThem) {
  testing::MakeOld(*store_, "mapAnswers", "build");
  EXPECT_EQ(testing::RecordsOf(*store_, "mapAnswers", "build").size(), 2u);
  EXPECT_TRUE(LoadAnswers(*store_, "build")->answers.empty());
  const absl::Status dropped = store_->Transact(
      [](store::Transaction& transaction) { return DropAnswers(transaction, "build"); });
  ASSERT_TRUE(dropped.ok()) << dropped;
  EXPECT_TRUE(testing::RecordsOf(*store_, "mapAnswers", "build").empty());
}

}  // namespace
}  // namespace mortise::interpolator
