// Stress recovered at the rims of curved bodies, beside the mean of elements and what is known.
#include <gtest/gtest.h>

#include <vector>

#include "curved_bodies.h"

namespace mortise::simulator {
namespace {

// Plane cylinders, a ball, and a bored plate whose rim has sharp edges; five to fifteen elements to
// a quarter turn.
std::vector<CurvedBody> Bodies() {
  return {PressedRing(0.004),    PressedRing(0.002),    PressedBall(0.005), PressedBall(0.003),
          PlateWithAHole(0.005), PlateWithAHole(0.003), BoredPlate(0.006),  BoredPlate(0.004)};
}

class RimStress : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Elements, RimStress, ::testing::Bool(),
                         [](const auto& which) { return which.param ? "Quadratic" : "Linear"; });

TEST_P(RimStress, IsNearerThanTheMeanOfElements) {
  for (const CurvedBody& body : Bodies()) {
    const auto errors = MeasureRim(body, GetParam());
    ASSERT_TRUE(errors.ok()) << body.name << ": " << errors.status();
    EXPECT_GT(errors->nodes, 10) << body.name;
    EXPECT_LT(errors->recovered.stress, errors->mean.stress)
        << body.name << ", " << errors->elements << " elements";
    EXPECT_LE(errors->recovered.at_edges, errors->mean.at_edges) << body.name;
    EXPECT_LT(errors->recovered.traction, errors->mean.traction) << body.name;
    // Traction is balanced up to how facets of linear elements turn.
    EXPECT_LT(errors->recovered.traction, (GetParam() ? 0.01 : 0.1) * body.largest) << body.name;
  }
}

TEST(RimStressOfABore, IsThatOfTheFineMesh) {
  const auto errors = MeasureRim(BoredPlate(0.004), true);
  ASSERT_TRUE(errors.ok()) << errors.status();
  const double largest = BoredPlate(0.004).largest;
  EXPECT_LT(errors->recovered.stress, 0.03 * largest);
  EXPECT_NEAR(errors->recovered.largest, largest, 0.03 * largest);
}

}  // namespace
}  // namespace mortise::simulator
