#include "services/interpolator/mapping/path_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace mortise::interpolator {
namespace {

std::vector<double> RandomShares(std::mt19937& random, int count) {
  std::uniform_real_distribution<double> share(0, 1);
  std::vector<double> shares = {0, 1};
  for (int i = 0; i < count; ++i) shares.push_back(share(random));
  std::sort(shares.begin(), shares.end());
  return shares;
}

TEST(PathSamplesTest, KeepsTheSamplesOfBothInOrder) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    const std::vector<double> first = RandomShares(random, static_cast<int>(seed % 7));
    const std::vector<double> second = RandomShares(random, static_cast<int>(seed % 11));
    const std::vector<CommonSample> samples = CommonSamples(first, second);
    std::size_t in_first = 0, in_second = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (i > 0) {
        EXPECT_LT(samples[i - 1].share, samples[i].share);
      }
      if (samples[i].is_in_first) {
        EXPECT_EQ(samples[i].share, first[in_first++]);
      }
      if (samples[i].is_in_second) {
        EXPECT_NEAR(samples[i].share, second[in_second++], 0.01);
      }
    }
    EXPECT_EQ(in_first, first.size());
    EXPECT_EQ(in_second, second.size());
  }
}

TEST(PathSamplesTest, TakesSamplesThatAlmostMeetAsOne) {
  const std::vector<CommonSample> samples = CommonSamples({0, 0.5, 1}, {0, 0.2, 0.501, 1});
  ASSERT_EQ(samples.size(), 4U);
  EXPECT_FALSE(samples[1].is_in_first);
  EXPECT_TRUE(samples[2].is_in_first && samples[2].is_in_second);
  EXPECT_EQ(CommonSamples({0, 0.5, 1}, {0, 0.51, 1}).size(), 4U);
  EXPECT_EQ(CommonSamples({0, 1}, {0, 1}).size(), 2U);
}

}  // namespace
}  // namespace mortise::interpolator
