// Maps of shapes and fields: built of files that an evaluator names, asked, followed, verified.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "tests/integration/services/interpolator/shaped_maps_fixture.h"

namespace mortise::interpolator {
namespace {

using testing::BarStress;

TEST_F(ShapedMapsTest, KnowsItsShapesAndHowGoodTheyAre) {
  const v1::DesignMap map = Built(ShapeRequest(60));
  ASSERT_TRUE(map.has_shapes());
  const v1::MapShapes& shapes = map.shapes();
  EXPECT_EQ(shapes.geometry(), v1::TETRAHEDRA);
  EXPECT_EQ(shapes.meshes(), 1);
  EXPECT_GE(shapes.shapes(), map.samples());
  EXPECT_EQ(shapes.nodes(), 16);
  EXPECT_EQ(shapes.tetrahedra(), 18);
  EXPECT_EQ(shapes.inverted_tetrahedra(), 0);
  EXPECT_EQ(shapes.unmapped(), 0);
  EXPECT_EQ(shapes.regions_size(), 1);
  EXPECT_NEAR(shapes.size(), std::sqrt(2 * 2 + 1.2 * 1.2 + 0.2 * 0.2), 1e-3);
  EXPECT_LT(shapes.rounding(), 1e-5 * shapes.size());
  EXPECT_GT(shapes.bytes(), 0);
  EXPECT_GE(map.bytes(), shapes.bytes());
  // Its nodes are linear in both parameters.
  EXPECT_LT(shapes.largest_error(), 1e-4);
  ASSERT_EQ(shapes.fields_size(), 2);
  EXPECT_EQ(shapes.fields(0).name(), "stress");
  EXPECT_EQ(shapes.fields(0).load_case(), "pull");
  EXPECT_EQ(shapes.fields(0).unit(), "Pa");
  EXPECT_NEAR(shapes.fields(0).maximum(), BarStress(1, 12, 1), 1);
  EXPECT_GT(shapes.fields(0).largest_error(), 0);
  EXPECT_GE(shapes.fields(0).largest_error(), shapes.fields(0).largest_99_error());
  EXPECT_LT(shapes.fields(0).largest_error(),
            0.1 * (shapes.fields(0).maximum() - shapes.fields(0).minimum()));
  EXPECT_TRUE(shapes.fields(1).of_elements());
  EXPECT_EQ(Get(map.name()).SerializeAsString(), map.SerializeAsString());
}

TEST_F(ShapedMapsTest, GivesTheShapeOfAnyDesignAtOnce) {
  const v1::DesignMap map = Built(ShapeRequest(80));
  evaluator_.Forget();
  const v1::MapShape shape = Shape(At(map.name(), 0.4, 11.3, v1::TETRAHEDRA));
  EXPECT_EQ(evaluator_.designs(), 0);
  const std::vector<float> positions = NumbersOf<float>(shape.positions());
  const std::vector<float> stress = NumbersOf<float>(shape.fields(0).values());
  ASSERT_EQ(positions.size(), 48u);
  ASSERT_EQ(stress.size(), 16u);
  float longest = 0;
  for (std::size_t i = 0; i < stress.size(); ++i) {
    const double truth = BarStress(0.4, 11.3, positions[3 * i] / 1.4);
    EXPECT_NEAR(stress[i], truth, 0.05 * truth);
    longest = std::max(longest, positions[3 * i]);
  }
  EXPECT_NEAR(longest, 1.4, 1e-3);
  EXPECT_NEAR(shape.volume(), 1.4 * 1.13 * 0.2, 1e-3);
  ASSERT_EQ(shape.metrics_size(), 1);
  EXPECT_EQ(shape.metrics(0), "mass");
  EXPECT_NEAR(shape.values(0), MassOf(0.4, 11.3), 0.05);

  v1::EvaluateMapShapeRequest known = At(map.name(), 0.6, 10.2, v1::TETRAHEDRA);
  known.set_known_structure(shape.structure());
  known.set_known_mesh(shape.mesh());
  EXPECT_FALSE(Shape(known).has_new_mesh());
}

TEST_F(ShapedMapsTest, NeedsNoMetrics) {
  v1::BuildMapRequest request = ShapeRequest(40);
  request.mutable_specification()->clear_metrics();
  const v1::DesignMap map = Built(request);
  EXPECT_EQ(map.metrics_size(), 0);
  EXPECT_EQ(Shape(At(map.name(), 0.5, 11)).values_size(), 0);
  const v1::EvaluateMapResponse answer = Evaluate(map.name(), {0.5, 11});
  EXPECT_EQ(answer.values_size(), 0);
  EXPECT_EQ(answer.uncovered_size(), 0);
}

TEST_F(ShapedMapsTest, RefusesShapesOfMapsWithoutThem) {
  const v1::DesignMap map = Built(Request(40));
  EXPECT_FALSE(map.has_shapes());
  v1::MapShape shape;
  const grpc::Status refused = AskShape(At(map.name(), 0.5, 11), shape);
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
}

TEST_F(ShapedMapsTest, VerifiesShapesAndFields) {
  const v1::DesignMap map = Built(ShapeRequest(60));
  v1::VerifyMapRequest request;
  request.set_request_id(NewIdentifier());
  request.set_name(map.name());
  request.set_random_points(8);
  const v1::MapVerification found = MapOf(Wait(Verify(request).name())).verification();
  EXPECT_EQ(found.points(), 8);
  ASSERT_EQ(found.shapes_size(), 3);
  EXPECT_EQ(found.shapes(0).field(), "");
  EXPECT_LT(found.shapes(0).largest(), 1e-4);
  EXPECT_EQ(found.shapes(1).field(), "stress");
  EXPECT_GT(found.shapes(1).largest(), 0);
  EXPECT_LT(found.shapes(1).largest(), 0.1);
  EXPECT_GE(found.shapes(1).largest(), found.shapes(1).largest_99());
  EXPECT_GE(found.shapes(1).largest_99(), found.shapes(1).mean());
  EXPECT_EQ(found.shapes(2).field(), "heat");
  ASSERT_EQ(found.differences_size(), 1);
}

TEST_F(ShapedMapsTest, CountsUnreadableFilesAsFailedAndGoesOn) {
  const v1::DesignMap map = Built(ShapeRequest(40));
  evaluator_.Fail([](double x, double) { return x > 0.7; },
                  PreconditionFailed("RIGID_MOTION", "it can turn"));
  v1::VerifyMapRequest request;
  request.set_request_id(NewIdentifier());
  request.set_name(map.name());
  for (const double number : {0.2, 11.0, 0.9, 11.0, 0.3, 10.5}) request.add_points(number);
  evaluator_.files().Spoil(0.3);
  const v1::MapVerification found = MapOf(Wait(Verify(request).name())).verification();
  EXPECT_EQ(found.points(), 3);
  EXPECT_EQ(found.failed(), 2);
  EXPECT_EQ(found.unmapped(), 0);
  EXPECT_EQ(found.shapes_size(), 3);
}

TEST_F(ShapedMapsTest, SaysWhyNoDesignIsInAnyMesh) {
  evaluator_.files().SetEachApart();
  const v1::Operation operation = Wait(Build(ShapeRequest(30)).name());
  EXPECT_EQ(operation.state(), v1::Operation::FAILED);
  EXPECT_EQ(operation.error().code(), static_cast<int>(grpc::StatusCode::FAILED_PRECONDITION));
  EXPECT_NE(operation.error().message().find("TOPOLOGY_DIFFERS"), std::string::npos)
      << operation.error().message();
  EXPECT_NE(operation.error().message().find("mesh"), std::string::npos);
  v1::ListMapsResponse listed;
  grpc::ClientContext listing;
  ASSERT_TRUE(maps_->ListMaps(&listing, {}, &listed).ok());
  EXPECT_EQ(listed.maps_size(), 0);
}

TEST_F(ShapedMapsTest, HasMetricsWhereTopologyChanges) {
  evaluator_.files().SetOtherBeyond(0.6);
  const v1::DesignMap map = Built(ShapeRequest(120));
  EXPECT_EQ(map.cut_off_elements(), 0);
  EXPECT_GT(map.shapeless_elements(), 0);
  EXPECT_LT(map.shapeless_elements(), map.elements());
  EXPECT_EQ(map.structures(0).shapeless_elements(), map.shapeless_elements());
  EXPECT_GT(map.shapes().unmapped(), 0);
  EXPECT_EQ(map.shapes().meshes(), 2);
  const v1::EvaluateMapResponse metrics = Evaluate(map.name(), {0.6, 11, 0.2, 11});
  EXPECT_EQ(metrics.uncovered_size(), 0);
  EXPECT_NEAR(metrics.values(0), MassOf(0.6, 11), 0.05);
  const v1::MapShape shapeless = Shape(At(map.name(), 0.6, 11));
  EXPECT_TRUE(shapeless.shapeless());
  EXPECT_FALSE(shapeless.uncovered());
  EXPECT_EQ(shapeless.values(0), metrics.values(0));
  EXPECT_TRUE(shapeless.positions().empty());
  EXPECT_FALSE(Shape(At(map.name(), 0.2, 11)).shapeless());
  EXPECT_FALSE(Shape(At(map.name(), 0.95, 11)).shapeless());

  Following following = Follow(map.name());
  following.To(1, 0.6, 11);
  const v1::MapShape followed = following.Next();
  EXPECT_TRUE(followed.shapeless());
  EXPECT_FALSE(followed.has_new_mesh());
  following.End();
  EXPECT_TRUE(following.Finish().ok());

  v1::VerifyMapRequest request;
  request.set_request_id(NewIdentifier());
  request.set_name(map.name());
  for (const double number : {0.6, 11.0, 0.2, 11.0}) request.add_points(number);
  const v1::MapVerification found = MapOf(Wait(Verify(request).name())).verification();
  EXPECT_EQ(found.uncovered(), 0);
  EXPECT_EQ(found.shapeless(), 1);
  EXPECT_EQ(found.differences_size(), 1);
  EXPECT_EQ(found.shapes_size(), 3);
}

TEST_F(ShapedMapsTest, FollowsTheNewestPointAndSendsTheMeshOnce) {
  const v1::DesignMap map = Built(ShapeRequest(40));
  Following following = Follow(map.name());
  following.To(3, 0.2, 11);
  v1::MapShape first = following.Next();
  EXPECT_EQ(first.sequence(), 3);
  EXPECT_TRUE(first.has_new_mesh());
  EXPECT_FALSE(first.new_mesh().more());
  std::int64_t last = 3;
  for (int i = 0; i < 200; ++i) following.To(4 + i, 0.2 + 0.003 * i, 11);
  following.End();
  int answers = 0;
  while (last < 203) {
    const v1::MapShape next = following.Next();
    ASSERT_GT(next.sequence(), last);
    EXPECT_FALSE(next.has_new_mesh());
    EXPECT_EQ(next.positions().size(), first.positions().size());
    last = next.sequence();
    ++answers;
  }
  EXPECT_LE(answers, 200);
  EXPECT_TRUE(following.Finish().ok());
}

TEST_F(ShapedMapsTest, NamesWhatIsWrongInAStream) {
  const v1::DesignMap map = Built(ShapeRequest(40));
  const auto ends_with = [](Following following, const std::string& field) {
    following.End();
    const grpc::Status status = following.Finish();
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << field;
    EXPECT_NE(status.error_message().find(field), std::string::npos) << status.error_message();
  };
  Following beyond = Follow(map.name());
  beyond.To(1, 2, 11);
  ends_with(std::move(beyond), "point");
  Following backwards = Follow(map.name());
  backwards.To(5, 0.5, 11);
  backwards.To(5, 0.5, 11);
  ends_with(std::move(backwards), "sequence");
  Following early = Open();
  early.To(1, 0.5, 11);
  ends_with(std::move(early), "begin");
}

TEST_F(ShapedMapsTest, EvaluatesAgainWhatWasLostMeanwhile) {
  const v1::DesignMap reference = Built(ShapeRequest(40));
  evaluator_.files().Lose();
  evaluator_.files().LoseEach();
  v1::VerifyMapRequest request;
  request.set_request_id(NewIdentifier());
  request.set_name(reference.name());
  request.set_random_points(3);
  EXPECT_EQ(MapOf(Wait(Verify(request).name())).verification().shapes_size(), 3);
  EXPECT_EQ(Built(ShapeRequest(40)).sha256(), reference.sha256());
}

TEST_F(ShapedMapsTest, NamesTheFieldOfAShapeThatIsWrong) {
  using Change = std::function<void(v1::MapSpecification&)>;
  const std::vector<std::pair<std::string, Change>> wrong = {
      {"specification.shape.geometry",
       [](auto& s) { s.mutable_shape()->set_geometry(v1::GEOMETRY_KIND_UNSPECIFIED); }},
      {"specification.basis", [](auto& s) { s.set_basis(v1::MapSpecification::CUBIC); }},
      {"specification.shape.noise_floor", [](auto& s) { s.mutable_shape()->set_noise_floor(1.5); }},
      {"specification.shape.modes", [](auto& s) { s.mutable_shape()->set_modes(-1); }},
      {"specification.shape.fields[0].name",
       [](auto& s) { s.mutable_shape()->mutable_fields(0)->set_name("strain"); }},
      {"specification.shape.fields[1].name",
       [](auto& s) { s.mutable_shape()->mutable_fields(1)->set_name("stress"); }},
      {"specification.shape.fields[1].name",
       [](auto& s) { s.mutable_shape()->set_geometry(v1::SURFACE); }},
      {"specification.shape.fields[1].noise_floor",
       [](auto& s) { s.mutable_shape()->mutable_fields(1)->set_noise_floor(-0.1); }},
      {"specification.shape.regions[0]", [](auto& s) { s.mutable_shape()->add_regions(""); }},
  };
  for (const auto& [field, change] : wrong) {
    const grpc::Status status = Refused([&change = change](v1::MapSpecification& specification) {
      specification = ShapeRequest(50).specification();
      change(specification);
    });
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << field;
    EXPECT_NE(status.error_message().find(field), std::string::npos) << status.error_message();
  }
  evaluator_.geometry_ = v1::SURFACE;
  const grpc::Status status = Refused([](auto& s) { s = ShapeRequest(50).specification(); });
  EXPECT_NE(status.error_message().find("specification.shape.geometry"), std::string::npos);
}

}  // namespace
}  // namespace mortise::interpolator
