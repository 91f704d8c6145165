// Changes of external ids and labels, as they are typed.
#include "cli/client/tag_changes.h"

#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::cli {
namespace {

const Tags kPresent = {.external_ids = {"1", "2"}, .labels = {{"customer", "acme"}, {"draft", ""}}};

TEST(TagChanges, NothingChangesNothing) {
  EXPECT_TRUE(TagChanges().empty());
  EXPECT_EQ(WithChanges(kPresent, {}).value(), kPresent);
}

TEST(TagChanges, LabelsAreSetAndTakenAway) {
  const auto tags = WithChanges(kPresent, {.labels = {"customer=b&c=d", "draft-", "room=", "x-"}});
  ASSERT_TRUE(tags.ok()) << tags.status();
  EXPECT_EQ(*tags,
            (Tags{.external_ids = {"1", "2"}, .labels = {{"customer", "b&c=d"}, {"room", ""}}}));
}

TEST(TagChanges, ExternalIdsAreAddedOnceAndTakenAway) {
  const auto tags =
      WithChanges(kPresent, {.external_ids = {"3", "2", "3"}, .removed_external_ids = {"1", "4"}});
  ASSERT_TRUE(tags.ok()) << tags.status();
  EXPECT_EQ(tags->external_ids, (std::vector<std::string>{"2", "3"}));
  EXPECT_EQ(tags->labels, kPresent.labels);
}

TEST(TagChanges, OtherFormsAndContradictionsAreRefused) {
  for (const char* const text : {"customer", "=acme", "-", ""}) {
    EXPECT_EQ(WithChanges(kPresent, {.labels = {text}}).status().message(),
              absl::StrCat("change: '", text, "' is neither KEY=VALUE nor KEY-"));
  }
  EXPECT_EQ(WithChanges(kPresent, {.labels = {"a=1", "a-"}}).status().message(),
            "change: 'a' is there twice");
  EXPECT_EQ(
      DetailOf(
          WithChanges(kPresent, {.external_ids = {"3"}, .removed_external_ids = {"3"}}).status())
          .field,
      "--external-id");
}

}  // namespace
}  // namespace mortise::cli
