#include "common/mesh/length_unit.h"

#include <gtest/gtest.h>

#include "common/base/errors.h"

namespace mortise::mesh {
namespace {

TEST(LengthUnitTest, KnowsTheUnitsThatMeshesAreDrawnIn) {
  EXPECT_EQ(MetresOf("m", "unit").value(), 1);
  EXPECT_EQ(MetresOf("mm", "unit").value(), 0.001);
  EXPECT_DOUBLE_EQ(12 * MetresOf("in", "unit").value(), MetresOf("ft", "unit").value());
}

TEST(LengthUnitTest, NamesTheFieldOfAnotherOne) {
  for (const char* unit : {"", "cubit", "MM"}) {
    const absl::Status refused = MetresOf(unit, "case.length_unit").status();
    EXPECT_TRUE(absl::IsInvalidArgument(refused)) << unit;
    EXPECT_EQ(DetailOf(refused).field, "case.length_unit") << unit;
  }
}

}  // namespace
}  // namespace mortise::mesh
