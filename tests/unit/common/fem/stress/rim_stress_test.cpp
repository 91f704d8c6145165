// Stress recovered at the rims of curved bodies, beside the mean of elements and what is known.
#include <gtest/gtest.h>

#include <vector>

#include "tests/unit/common/fem/problems/curved_bodies.h"

namespace mortise::simulator {
namespace {

// Plane cylinders, a ball, and a bored plate whose rim has sharp edges: five to fifteen elements to
// a quarter turn.
std::vector<CurvedBody> CoarseBodies() {
  return {PressedRing(0.004),    PressedRing(0.002),    PressedBall(0.005), PressedBall(0.003),
          PlateWithAHole(0.005), PlateWithAHole(0.003), BoredPlate(0.006),  BoredPlate(0.004)};
}

// The same with twelve and more where surfaces turn both ways or have edges: facets of linear
// elements that turn by more leave the displacements themselves that far off.
std::vector<CurvedBody> FineBodies() {
  return {PressedRing(0.004),    PressedRing(0.002),    PressedBall(0.002),
          PlateWithAHole(0.005), PlateWithAHole(0.003), BoredPlate(0.0025)};
}

// `unbalanced`: what of the largest stress the recovered one may leave of the traction.
void ExpectNearerThanTheMean(const CurvedBody& body, bool quadratic, double unbalanced) {
  const auto errors = MeasureRim(body, quadratic);
  ASSERT_TRUE(errors.ok()) << body.name << ": " << errors.status();
  EXPECT_GT(errors->nodes, 10) << body.name;
  EXPECT_LT(errors->recovered.stress, errors->mean.stress)
      << body.name << ", " << errors->elements << " elements";
  EXPECT_LE(errors->recovered.at_edges, errors->mean.at_edges) << body.name;
  EXPECT_LT(errors->recovered.traction, errors->mean.traction) << body.name;
  EXPECT_LT(errors->recovered.traction, unbalanced * body.largest) << body.name;
}

TEST(RimStress, OfQuadraticElementsIsNearerThanTheirMean) {
  for (const CurvedBody& body : CoarseBodies()) ExpectNearerThanTheMean(body, true, 0.01);
}

// Where sides are straight, each face and each edge has the stress along its own facet or chord.
// Elements are as large as facets: smaller ones divide these, and the bore stays a polygon.
TEST(RimStress, OfStraightSidedElementsIsNearerThanTheirMean) {
  for (const double size : {0.008, 0.006}) {
    const CurvedBody body = BoredPlate(size);
    const auto errors = MeasureFacetedRim(body);
    ASSERT_TRUE(errors.ok()) << errors.status();
    EXPECT_LT(errors->recovered.stress, errors->mean.stress) << errors->elements << " elements";
    EXPECT_LT(errors->recovered.at_edges, errors->mean.at_edges) << errors->elements << " elements";
    EXPECT_LT(errors->recovered.traction, errors->mean.traction) << errors->elements << " elements";
  }
}

// Traction is balanced up to how facets of linear elements turn.
TEST(RimStress, OfLinearElementsIsNearerThanTheirMean) {
  for (const CurvedBody& body : FineBodies()) ExpectNearerThanTheMean(body, false, 0.1);
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
