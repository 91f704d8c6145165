// Whether a set covers a point, against a look at every primitive.
#include "services/retrieval/cover/cover_set.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>

#include "common/base/random.h"

namespace mortise::retrieval {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

Primitive RandomPrimitive(Random* random) {
  const auto axes = static_cast<Eigen::Index>(3 * random->Uniform());
  MatrixXd span(6, std::max<Eigen::Index>(axes, 1));
  for (auto column : span.colwise()) column = random->UnitVector(6);
  const MatrixXd full = Eigen::HouseholderQR<MatrixXd>(span).householderQ();
  Primitive primitive{.parameters = VectorXd(0),
                      .center = 2 * random->UnitVector(6),
                      .axes = full.leftCols(axes),
                      .radii = VectorXd(axes),
                      .structure = random->Uniform() < 0.5 ? 0 : 1};
  for (double& radius : primitive.radii) radius = 0.2 + random->Uniform();
  return primitive;
}

TEST(CoverSet, AnswersAsALookAtEveryPrimitiveWould) {
  Random random(8);
  CoverSet set;
  int covered = 0;
  for (int i = 0; i < 300; ++i) {
    set.Add(RandomPrimitive(&random));
    const VectorXd x = 2 * random.UnitVector(6);
    const std::size_t from = i % 3 == 0 ? set.size() / 2 : 0;
    const bool expected = std::any_of(
        set.primitives().begin() + static_cast<std::ptrdiff_t>(from), set.primitives().end(),
        [&](const Primitive& each) { return each.structure == 1 && Distance(each, x) <= 1; });
    EXPECT_EQ(set.Covers(x, 1, 1, from), expected);
    covered += expected ? 1 : 0;
  }
  EXPECT_GT(covered, 50);
  EXPECT_LT(covered, 250);
}

TEST(CoverSet, CostIsTheSumOfItsPrimitives) {
  Random random(9);
  CoverSet set;
  long cost = 0;
  for (int i = 0; i < 20; ++i) {
    set.Add(RandomPrimitive(&random));
    cost += Cost(set.primitives().back());
  }
  EXPECT_EQ(set.cost(), cost);
}

}  // namespace
}  // namespace mortise::retrieval
