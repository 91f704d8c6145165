// Fronts that are kept in memory: which, and what of them.
#include "services/pareto/service/front_cache.h"

#include <gtest/gtest.h>

#include <string>

#include "absl/status/status.h"

namespace mortise::pareto {
namespace {

v1::Front Found(const std::string& name) {
  v1::Front front;
  front.set_name(name);
  front.set_stop_reason("BUDGET");
  front.add_metric_names("mass");
  front.add_metric_names("cost");
  front.add_external_ids("100-4711/A");
  (*front.mutable_labels())["project"] = "kitchen";
  front.set_creator("users/ada");
  return front;
}

TEST(FrontCache, LoadsAFrontOnceWhileItIsKept) {
  FrontCache cache(2);
  int loads = 0;
  const auto ask = [&](const std::string& name) {
    const auto front = cache.Find(name, [&] {
      ++loads;
      return Found(name);
    });
    ASSERT_TRUE(front.ok()) << front.status();
    EXPECT_EQ((*front)->message.name(), name);
  };
  ask("fronts/a");
  ask("fronts/b");
  ask("fronts/a");
  EXPECT_EQ(loads, 2);
  ask("fronts/c");  // in the place of b, which was asked for before a
  ask("fronts/a");
  EXPECT_EQ(loads, 3);
  ask("fronts/b");
  EXPECT_EQ(loads, 4);
}

TEST(FrontCache, KeepsNothingThatChanges) {
  FrontCache cache(1);
  const auto front = cache.Find("fronts/a", [] { return Found("fronts/a"); });
  ASSERT_TRUE(front.ok()) << front.status();
  EXPECT_EQ((*front)->message.stop_reason(), "BUDGET");
  EXPECT_TRUE((*front)->message.external_ids().empty());
  EXPECT_TRUE((*front)->message.labels().empty());
}

TEST(FrontCache, KeepsNoFailure) {
  FrontCache cache(1);
  EXPECT_TRUE(absl::IsNotFound(
      cache.Find("fronts/a", [] { return absl::NotFoundError("not yet"); }).status()));
  EXPECT_TRUE(cache.Find("fronts/a", [] { return Found("fronts/a"); }).ok());
}

}  // namespace
}  // namespace mortise::pareto
