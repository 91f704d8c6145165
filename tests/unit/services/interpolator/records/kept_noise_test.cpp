// Noise that a build has estimated: kept, read again, forgotten.
#include "services/interpolator/records/kept_noise.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "tests/support/temporary_folder.h"
#include "tests/unit/services/interpolator/records/kept_versions.h"

namespace mortise::interpolator {
namespace {

TEST(KeptNoiseTest, ComesBackAsItWasEstimated) {
  const mortise::testing::TemporaryFolder folder;
  const auto store =
      store::OpenStore({.url = "sqlite:" + (folder.path() / "store.db").string()}).value();
  EXPECT_FALSE(LoadNoise(*store, "build")->has_value());
  const MeshNoise noise{.evaluations = 1,
                        .metrics = {0.5, std::nullopt, 0.0},
                        .shape = 1e-4,
                        .fields = {{"stress", "pull", 2e4}}};
  absl::Status done = store->Transact(
      [&](store::Transaction& transaction) { return PutNoise(transaction, "build", noise); });
  ASSERT_TRUE(done.ok()) << done;
  const std::optional<MeshNoise> read = LoadNoise(*store, "build").value();
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->evaluations, 1);
  EXPECT_EQ(read->metrics, noise.metrics);
  EXPECT_EQ(read->shape, noise.shape);
  EXPECT_EQ(read->OfFieldNamed("stress", "pull"), 2e4);
  EXPECT_EQ(read->OfFieldNamed("stress", "push"), std::nullopt);
  testing::MakeOld(*store, "mapNoise", "build");
  EXPECT_FALSE(LoadNoise(*store, "build")->has_value());
  done = store->Transact(
      [](store::Transaction& transaction) { return DropNoise(transaction, "build"); });
  ASSERT_TRUE(done.ok()) << done;
  EXPECT_TRUE(testing::RecordsOf(*store, "mapNoise", "build").empty());
}

}  // namespace
}  // namespace mortise::interpolator
