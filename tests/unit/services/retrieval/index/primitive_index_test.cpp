// The index against looking at every primitive.
#include "services/retrieval/index/primitive_index.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "tests/support/status_assertions.h"
#include "tests/unit/services/retrieval/index/random_covers.h"

namespace mortise::retrieval {
namespace {

using Eigen::VectorXd;
using testing::CoverLook;
using testing::RandomCovers;
using testing::RandomDescriptor;

void ExpectSame(const std::vector<IndexMatch>& a, const std::vector<IndexMatch>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].family, b[i].family);
    EXPECT_EQ(a[i].primitive, b[i].primitive);
    EXPECT_EQ(a[i].turn, b[i].turn);
    EXPECT_EQ(a[i].distance, b[i].distance);
  }
}

// By the definition: each family's nearest primitive, with the distances of primitive.h.
std::vector<std::pair<double, int>> NearestFamilies(const std::vector<FamilyCover>& covers,
                                                    const IndexQuery& query) {
  std::vector<std::pair<double, int>> nearest;
  for (const FamilyCover& cover : covers) {
    double least = std::numeric_limits<double>::infinity();
    for (const Primitive& primitive : cover.primitives)
      for (const VectorXd& x : query.descriptors) least = std::min(least, Distance(primitive, x));
    if (!query.allowed || query.allowed(cover.family)) nearest.emplace_back(least, cover.family);
  }
  std::sort(nearest.begin(), nearest.end());
  nearest.resize(std::min(nearest.size(), static_cast<std::size_t>(query.count)));
  return nearest;
}

class EveryLook : public ::testing::TestWithParam<CoverLook> {};

TEST_P(EveryLook, NearestIsExact) {
  Random random(4);
  const auto covers = RandomCovers(GetParam(), &random);
  ASSERT_OK_AND_ASSIGN(const PrimitiveIndex index, PrimitiveIndex::Build(covers));
  for (int i = 0; i < 100; ++i) {
    IndexQuery query{.descriptors = {}, .count = 1 + i % 12};
    for (int turn = 0; turn <= i % 4; ++turn)
      query.descriptors.push_back(RandomDescriptor(GetParam().dimension, &random));
    if (i % 3 == 0) query.allowed = [](int family) { return family % 2 == 1; };
    ASSERT_OK_AND_ASSIGN(const auto matches, index.Nearest(query));
    ASSERT_OK_AND_ASSIGN(const auto scanned, index.LinearScan(query));
    ExpectSame(matches, scanned);
    const auto defined = NearestFamilies(covers, query);
    ASSERT_EQ(matches.size(), defined.size());
    for (std::size_t k = 0; k < matches.size(); ++k) {
      EXPECT_EQ(matches[k].family, defined[k].second);
      EXPECT_NEAR(matches[k].distance, defined[k].first, 1e-5);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    PrimitiveIndex, EveryLook,
    ::testing::Values(CoverLook{}, CoverLook{.families = 300, .primitives = 3},
                      CoverLook{.families = 5, .primitives = 200, .radius = 1},
                      CoverLook{.families = 20, .dimension = 64, .spread = 0.1},
                      CoverLook{.families = 40, .dimension = 5, .extent = 5},
                      CoverLook{.families = 1, .primitives = 1, .dimension = 4}));

TEST(PrimitiveIndex, QueriesOnAPrimitiveFindItAtNoDistance) {
  Random random(6);
  const auto covers = RandomCovers({}, &random);
  ASSERT_OK_AND_ASSIGN(const PrimitiveIndex index, PrimitiveIndex::Build(covers));
  for (const FamilyCover& cover : covers) {
    const Primitive& primitive = cover.primitives[3];
    VectorXd x = primitive.center;
    if (primitive.axes.cols() > 0) x += 0.5 * primitive.radii[0] * primitive.axes.col(0);
    ASSERT_OK_AND_ASSIGN(const auto matches, index.Nearest({.descriptors = {x}}));
    EXPECT_EQ(matches[0].family, cover.family);
    EXPECT_LT(matches[0].distance, 1e-6);
  }
}

TEST(PrimitiveIndex, TiesGoToTheSmallerFamilyPrimitiveAndTurn) {
  Random random(7);
  std::vector<FamilyCover> covers;
  const Primitive one = RandomCovers({.families = 1}, &random)[0].primitives[0];
  for (const int family : {90, 7, 33, 12, 61}) {
    covers.push_back({.family = family, .primitives = std::vector<Primitive>(30, one)});
  }
  ASSERT_OK_AND_ASSIGN(const PrimitiveIndex index, PrimitiveIndex::Build(covers));
  const VectorXd x = RandomDescriptor(24, &random);
  ASSERT_OK_AND_ASSIGN(const auto matches, index.Nearest({.descriptors = {x, x, x}, .count = 4}));
  ASSERT_EQ(matches.size(), 4u);
  const std::vector<int> expected = {7, 12, 33, 61};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(matches[i].family, expected[i]);
    EXPECT_EQ(matches[i].primitive, 0);
    EXPECT_EQ(matches[i].turn, 0);
  }
}

TEST(PrimitiveIndex, AsksForEachFamilyOnceAndReturnsOnlyWhatIsAllowed) {
  Random random(8);
  ASSERT_OK_AND_ASSIGN(const PrimitiveIndex index,
                       PrimitiveIndex::Build(RandomCovers({}, &random)));
  std::map<int, int> asked;
  const IndexQuery query{
      .descriptors = {RandomDescriptor(24, &random)}, .count = 100, .allowed = [&](int family) {
        ++asked[family];
        return family < 9;
      }};
  ASSERT_OK_AND_ASSIGN(const auto matches, index.Nearest(query));
  EXPECT_EQ(matches.size(), 9u);
  for (const auto& [family, times] : asked) EXPECT_EQ(times, 1) << family;
  const IndexQuery none{.descriptors = {RandomDescriptor(24, &random)},
                        .allowed = [](int) { return false; }};
  ASSERT_OK_AND_ASSIGN(const auto nothing, index.Nearest(none));
  EXPECT_TRUE(nothing.empty());
}

TEST(PrimitiveIndex, LooksAtFewPrimitivesOfMany) {
  Random random(9);
  const auto covers = testing::Jittered(RandomCovers({}, &random), 30, 0.02, &random);
  ASSERT_OK_AND_ASSIGN(const PrimitiveIndex index, PrimitiveIndex::Build(covers));
  const VectorXd x = covers[17].primitives[2].center + 0.02 * RandomDescriptor(24, &random);
  IndexEffort effort;
  ASSERT_OK_AND_ASSIGN(const auto matches,
                       index.Nearest({.descriptors = {x}, .count = 10}, &effort));
  EXPECT_EQ(matches.size(), 10u);
  EXPECT_LT(effort.distances * 10, index.primitives());
}

// Copies of families that are moved, a little turned and a little larger or smaller.
std::vector<FamilyCover> NearlyTheSame(const CoverLook& look, int copies, double jitter,
                                       Random* random) {
  auto covers = testing::Jittered(RandomCovers(look, random), copies, jitter, random);
  for (FamilyCover& cover : covers) {
    for (Primitive& primitive : cover.primitives) {
      const Eigen::Index size = primitive.axes.rows(), axes = primitive.axes.cols();
      if (axes == 0) continue;
      for (auto axis : primitive.axes.colwise()) axis += 0.02 * random->UnitVector(size);
      const Eigen::HouseholderQR<Eigen::MatrixXd> turned(primitive.axes);
      primitive.axes = turned.householderQ() * Eigen::MatrixXd::Identity(size, axes);
      for (double& radius : primitive.radii) radius *= 0.97 + 0.06 * random->Uniform();
    }
  }
  return covers;
}

TEST(PrimitiveIndex, TellsFamiliesApartThatAreNearlyTheSame) {
  Random random(13);
  for (const double jitter : {0.0, 0.01, 0.1}) {
    for (const Eigen::Index dimension : {5, 24, 90}) {
      const CoverLook look{.families = 6, .dimension = dimension, .radius = 0.3};
      const auto covers = NearlyTheSame(look, 40, jitter, &random);
      ASSERT_OK_AND_ASSIGN(const PrimitiveIndex index, PrimitiveIndex::Build(covers));
      for (int i = 0; i < 60; ++i) {
        const Primitive& near = covers[static_cast<std::size_t>(4 * i)].primitives[2];
        VectorXd x = RandomDescriptor(dimension, &random);
        if (i % 3 > 0) x = near.center + (i % 3 == 1 ? 0.001 : 0.1) * x;
        if (i % 2 > 0 && near.axes.cols() > 0) x += 0.9 * near.radii[0] * near.axes.col(0);
        IndexQuery query{.descriptors = {x}, .count = 1 + i % 15};
        if (i % 4 == 0) query.descriptors.push_back(RandomDescriptor(dimension, &random));
        ASSERT_OK_AND_ASSIGN(const auto matches, index.Nearest(query));
        ASSERT_OK_AND_ASSIGN(const auto scanned, index.LinearScan(query));
        ExpectSame(matches, scanned);
      }
    }
  }
}

TEST(PrimitiveIndex, GivesBackWhatWasPutIn) {
  Random random(10);
  const auto covers = RandomCovers({}, &random);
  ASSERT_OK_AND_ASSIGN(const PrimitiveIndex index, PrimitiveIndex::Build(covers));
  const Primitive& original = covers[8].primitives[5];
  ASSERT_OK_AND_ASSIGN(const auto matches, index.Nearest({.descriptors = {original.center}}));
  ASSERT_EQ(matches[0].family, 8);
  const Primitive& expected = covers[8].primitives[static_cast<std::size_t>(matches[0].primitive)];
  const Primitive found = index.PrimitiveOf(matches[0]);
  EXPECT_EQ(found.parameters, expected.parameters);
  EXPECT_EQ(found.radii, expected.radii);
  EXPECT_EQ(found.structure, expected.structure);
  ASSERT_EQ(found.axes.cols(), expected.axes.cols());
  EXPECT_LT((found.center - expected.center).norm(), 1e-6);
  EXPECT_LT((found.axes - expected.axes).norm(), 1e-6);
}

TEST(PrimitiveIndex, RefusesCoversThatMakeNoSense) {
  Random random(11);
  const auto good = RandomCovers({.families = 2, .primitives = 5}, &random);
  const auto code = [](std::vector<FamilyCover> covers) {
    return PrimitiveIndex::Build(std::move(covers)).status().code();
  };
  EXPECT_EQ(code({}), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code({{.family = 1, .primitives = {}}}), absl::StatusCode::kInvalidArgument);
  auto covers = good;
  covers[1].family = 0;
  EXPECT_EQ(code(covers), absl::StatusCode::kInvalidArgument);
  covers = good;
  covers[1].family = -1;
  EXPECT_EQ(code(covers), absl::StatusCode::kInvalidArgument);
  covers = good;
  covers[1].primitives[2].center = VectorXd::Zero(23);
  EXPECT_EQ(code(covers), absl::StatusCode::kInvalidArgument);
  covers = good;
  covers[0].primitives[4].center[7] = std::nan("");
  EXPECT_EQ(code(covers), absl::StatusCode::kInvalidArgument);
  covers = good;
  covers[0].primitives[0].axes = Eigen::MatrixXd::Identity(24, 1);
  covers[0].primitives[0].radii = VectorXd::Zero(1);
  EXPECT_EQ(code(covers), absl::StatusCode::kInvalidArgument);
  covers[0].primitives[0].radii.resize(0);
  EXPECT_EQ(code(covers), absl::StatusCode::kInvalidArgument);
}

TEST(PrimitiveIndex, RefusesQueriesThatMakeNoSense) {
  Random random(12);
  ASSERT_OK_AND_ASSIGN(const PrimitiveIndex index,
                       PrimitiveIndex::Build(RandomCovers({}, &random)));
  const VectorXd x = VectorXd::Zero(24);
  VectorXd infinite = x;
  infinite[3] = std::numeric_limits<double>::infinity();
  for (const IndexQuery& query : {IndexQuery{}, IndexQuery{.descriptors = {x}, .count = 0},
                                  IndexQuery{.descriptors = std::vector<VectorXd>(5, x)},
                                  IndexQuery{.descriptors = {x, VectorXd::Zero(23)}},
                                  IndexQuery{.descriptors = {infinite}}}) {
    EXPECT_EQ(index.Nearest(query).status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_EQ(index.LinearScan(query).status().code(), absl::StatusCode::kInvalidArgument);
  }
}

}  // namespace
}  // namespace mortise::retrieval
