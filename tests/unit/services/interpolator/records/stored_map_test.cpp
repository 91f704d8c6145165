// Files of maps: written, read, and damaged.
#include "services/interpolator/records/stored_map.h"

#include <gtest/gtest.h>

#include "common/maps/map_sampling.h"

namespace mortise::interpolator {
namespace {

maps::MapContent Sampled(maps::Basis basis) {
  maps::MapSamplingOptions options;
  options.basis = basis;
  options.budget = 40;
  maps::MapSampling sampling = maps::MapSampling::Create(2, 1, options).value();
  while (!sampling.Done()) {
    for (const maps::AskedPoint& point : sampling.Ask(4)) {
      const double x = point.position[0], y = point.position[1];
      const absl::Status told =
          x > 0.9 && y > 0.9
              ? sampling.TellFailure(point.number, absl::InternalError("it fails"))
              : sampling.Tell(point.number, Eigen::VectorXd::Constant(1, std::exp(x) * y * y));
      EXPECT_TRUE(told.ok()) << told;
    }
  }
  return sampling.Content().value();
}

TEST(StoredMapTest, ReadsWhatWasWritten) {
  const std::vector<maps::MapContent> contents = {Sampled(maps::Basis::kLinear),
                                                  Sampled(maps::Basis::kCubic)};
  const std::string bytes = SerializeMap(contents);
  EXPECT_EQ(bytes, SerializeMap(contents));
  const auto read = ParseMap(bytes);
  ASSERT_TRUE(read.ok()) << read.status();
  ASSERT_EQ(read->size(), 2u);
  for (std::size_t s = 0; s < 2; ++s) {
    const maps::MapContent& content = (*read)[s].content();
    EXPECT_EQ(content.basis, contents[s].basis);
    EXPECT_EQ(content.options, contents[s].options);
    EXPECT_EQ(content.splits, contents[s].splits);
    EXPECT_EQ(content.values, contents[s].values);
    EXPECT_EQ(content.errors, contents[s].errors);
    EXPECT_EQ(content.cut_off, contents[s].cut_off);
  }
}

TEST(StoredMapTest, RefusesWhatIsNone) {
  const std::string bytes = SerializeMap({Sampled(maps::Basis::kLinear)});
  for (std::size_t length = 0; length < bytes.size(); length += 7) {
    const auto read = ParseMap(bytes.substr(0, length));
    EXPECT_TRUE(absl::IsDataLoss(read.status())) << length;
  }
  // Any byte that is changed is either noticed or leaves a map that can be asked: the digest of the
  // file tells the rest.
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 0x55);
    const auto read = ParseMap(changed);
    if (!read.ok()) {
      EXPECT_TRUE(absl::IsDataLoss(read.status())) << read.status();
    }
  }
}

}  // namespace
}  // namespace mortise::interpolator
