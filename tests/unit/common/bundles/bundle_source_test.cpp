#include "common/bundles/bundle_source.h"

#include <gtest/gtest.h>

#include "mortise/v1/catalog.pb.h"

namespace mortise::bundles {
namespace {

v1::TemplateBundle Table() {
  v1::TemplateBundle bundle;
  bundle.mutable_template_()->set_digest("of the table");
  v1::Item* board = bundle.add_items();
  board->set_name("items/board");
  board->set_revision(3);
  v1::Material* pine = bundle.add_materials();
  pine->set_name("materials/pine");
  pine->set_density(500);
  return bundle;
}

TEST(ContentDigestTest, SeesWhatResultsDependOn) {
  const std::string digest = ContentDigest(Table());
  v1::TemplateBundle other = Table();
  other.mutable_template_()->set_digest("of another table");
  EXPECT_NE(ContentDigest(other), digest);
  other = Table();
  other.mutable_materials(0)->set_density(501);
  EXPECT_NE(ContentDigest(other), digest);
  other = Table();
  other.mutable_items(0)->set_revision(4);
  EXPECT_NE(ContentDigest(other), digest);
}

TEST(ContentDigestTest, DoesNotSeeTagsAndCreators) {
  const std::string digest = ContentDigest(Table());
  v1::TemplateBundle tagged = Table();
  for (int i = 0; i < 20; ++i) {
    (*tagged.mutable_items(0)->mutable_labels())[std::to_string(i)] = "x";
    (*tagged.mutable_materials(0)->mutable_labels())[std::to_string(i)] = "x";
  }
  tagged.mutable_items(0)->add_external_ids("100-4711/A");
  tagged.mutable_items(0)->set_creator("users/ada");
  tagged.mutable_items(0)->mutable_create_time()->set_seconds(7);
  tagged.mutable_materials(0)->set_creator("users/ada");
  (*tagged.mutable_template_()->mutable_labels())["line"] = "A";
  EXPECT_EQ(ContentDigest(tagged), digest);
}

TEST(PassingFailureTest, IsOneThatTheCatalogMayNotHaveLater) {
  for (const absl::Status& passing :
       {absl::UnavailableError("gone"), absl::ResourceExhaustedError("too much to do"),
        absl::DeadlineExceededError("too slow"), absl::AbortedError("meanwhile")}) {
    EXPECT_TRUE(IsPassingFailure(passing)) << passing;
  }
  for (const absl::Status& lasting :
       {absl::OkStatus(), absl::NotFoundError("x"), absl::InvalidArgumentError("x"),
        absl::FailedPreconditionError("x")}) {
    EXPECT_FALSE(IsPassingFailure(lasting)) << lasting;
  }
}

}  // namespace
}  // namespace mortise::bundles
