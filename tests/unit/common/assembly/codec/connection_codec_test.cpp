// Connections as messages.
#include "common/assembly/codec/connection_codec.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/assembly/codec/parametrization_codec.h"
#include "tests/unit/common/assembly/connections/connection_assemblies.h"

namespace mortise::parametric {
namespace {

TEST(ConnectionCodec, SaysWhatIsInAConnection) {
  const ParametricAssembly boards = ParametrizedDesign(DowelledBoards());
  const auto parametrization = ToProto(boards);
  ASSERT_TRUE(parametrization.ok()) << parametrization.status();
  ASSERT_EQ(parametrization->connections_size(), 1);
  const v1::ElementConnection& connection = parametrization->connections(0);
  EXPECT_EQ(connection.name(), "'bottom' with 'wall'");
  EXPECT_EQ(connection.group(), "") << "the root";
  ASSERT_EQ(connection.principals_size(), 2);
  EXPECT_EQ(connection.principals(0), "bottom");
  EXPECT_EQ(connection.principals(1), "wall");
  ASSERT_EQ(connection.connecting_size(), 1);
  EXPECT_EQ(connection.connecting(0), "dowel 1");
  ASSERT_EQ(connection.patches_size(), 1);
  const v1::ConnectionPatch& patch = connection.patches(0);
  EXPECT_EQ(patch.kind(), v1::ConnectionPatch::CONTACT);
  EXPECT_EQ(patch.first(), "bottom");
  EXPECT_EQ(patch.second(), "wall");
  EXPECT_EQ(patch.normal(), v1::Z);
  ASSERT_EQ(patch.pieces_size(), 1);
  EXPECT_NEAR(patch.pieces(0).maximum().x(), 0.6, 1e-12);
  EXPECT_NEAR(patch.region().minimum().y(), 0.04, 1e-12);
  EXPECT_NEAR(patch.area(), 0.012, 1e-12);
  EXPECT_EQ(connection.soft_size(), 6);
  EXPECT_TRUE(std::any_of(
      connection.hard().begin(), connection.hard().end(), [](const v1::HardRelationship& hard) {
        return hard.equality() && hard.description() == "'dowel 1' z size fixed at 0.03 m";
      }));
  EXPECT_EQ(connection.degrees_of_freedom(), 2) << "how long the row is, and how deep it sits";
}

TEST(ConnectionCodec, NamesGroupsAndGaps) {
  const auto corner = ToProto(ParametrizedDesign(BoltedCorner()));
  ASSERT_TRUE(corner.ok()) << corner.status();
  EXPECT_EQ(corner->connections(0).group(), "frame");

  Assembly apart;
  apart.name = "apart";
  apart.groups = {{"apart", -1}};
  apart.parts = {ResizablePart("left", {0, 0, 0}, {0.1, 0.1, 0.1}),
                 ResizablePart("right", {0.2, 0, 0}, {0.3, 0.1, 0.1}),
                 Fastener("strap", {0.05, 0.1, 0.04}, {0.25, 0.102, 0.06})};
  const auto held = ToProto(ParametrizedDesign(std::move(apart)));
  ASSERT_TRUE(held.ok()) << held.status();
  ASSERT_EQ(held->connections_size(), 1);
  ASSERT_EQ(held->connections(0).patches_size(), 1);
  const v1::ConnectionPatch& gap = held->connections(0).patches(0);
  EXPECT_EQ(gap.kind(), v1::ConnectionPatch::GAP);
  EXPECT_EQ(gap.pieces_size(), 0);
  EXPECT_NEAR(gap.region().minimum().x(), 0.1, 1e-12);
  EXPECT_NEAR(gap.region().maximum().x(), 0.2, 1e-12);
}

}  // namespace
}  // namespace mortise::parametric
