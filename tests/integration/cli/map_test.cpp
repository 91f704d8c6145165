// The commands of maps against a gateway that the test plays: what they ask for, what they print,
// and how faults are named.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <chrono>
#include <initializer_list>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "cli/commands/command_line.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/evaluator.grpc.pb.h"
#include "mortise/v1/interpolator.grpc.pb.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "tests/support/temporary_folder.h"

namespace mortise::cli {
namespace {

using Json = nlohmann::json;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr char kBuilding[] = "operations/interpolator/1";

// A map of two parameters: "sum" is their sum, "first" the first, each off by a hundredth; it has
// no values where the second is above 4.
v1::DesignMap KnownMap() {
  v1::DesignMap map;
  map.set_name("maps/m");
  map.mutable_specification()->set_subject("templates/table");
  map.mutable_specification()->set_revision(3);
  for (const char* const name : {"a", "b"}) {
    auto& parameter = *map.add_parameters();
    parameter.set_name(name);
    parameter.set_unit("m");
    parameter.set_maximum(5);
  }
  for (const char* const name : {"sum", "first"}) {
    auto& metric = *map.add_metrics();
    metric.set_name(name);
    metric.set_unit("kg");
  }
  map.mutable_metrics(0)->set_noise_floor(0.5);
  map.mutable_metrics(0)->set_noise_estimated(true);
  map.mutable_shapes()->set_noise_floor(0.001);
  map.mutable_shapes()->set_noise_estimated(true);
  map.set_stop_reason("BUDGET");
  map.mutable_shapes()->set_geometry(v1::SURFACE);
  map.mutable_shapes()->set_meshes(1);
  map.mutable_shapes()->set_shapes(9);
  map.set_elements(8);
  map.set_cut_off_elements(3);
  map.mutable_shapes()->set_unmapped(2);
  auto& unmapped = *map.mutable_shapes()->add_unmapped_failures();
  unmapped.set_reason("TOPOLOGY");
  unmapped.set_count(4);
  unmapped.set_message("it has a hole more");
  map.mutable_verification()->set_unmapped(6);
  auto& field = *map.mutable_shapes()->add_fields();
  field.set_name("stress");
  field.set_unit("Pa");
  field.set_load_case("pull");
  field.set_components(1);
  field.set_noise_floor(0.05);
  auto& difference = *map.mutable_verification()->add_shapes();
  difference.set_field("stress");
  difference.set_load_case("pull");
  difference.set_largest(0.0625);
  return map;
}

template <typename Number>
std::string Bytes(const std::vector<Number>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)};
}

class PlayedInterpolator final : public v1::InterpolatorService::Service {
 public:
  grpc::Status BuildMap(grpc::ServerContext*, const v1::BuildMapRequest* request,
                        v1::Operation* response) override {
    builds.push_back(*request);
    const auto& metrics = request->specification().metrics();
    for (int i = 0; i < metrics.size(); ++i) {
      if (metrics[i].name() != "unknown") continue;
      return rpc::ToGrpc(
          InvalidField(absl::StrCat("specification.metrics[", i, "].name"), "is no metric"));
    }
    response->set_name(kBuilding);
    return grpc::Status::OK;
  }

  grpc::Status GetMap(grpc::ServerContext*, const v1::GetMapRequest* request,
                      v1::DesignMap* response) override {
    *response = KnownMap();
    if (request->name() == "maps/shapeless") {
      response->set_cut_off_elements(0);
      response->set_shapeless_elements(3);
      response->mutable_verification()->set_shapeless(2);
      return grpc::Status::OK;
    }
    return request->name() == "maps/m" ? grpc::Status::OK
                                       : rpc::ToGrpc(ResourceNotFound(request->name()));
  }

  grpc::Status ListMaps(grpc::ServerContext*, const v1::ListMapsRequest* request,
                        v1::ListMapsResponse* response) override {
    if (request->subject() == "templates/table") *response->add_maps() = KnownMap();
    return grpc::Status::OK;
  }

  grpc::Status EvaluateMap(grpc::ServerContext*, const v1::EvaluateMapRequest* request,
                           v1::EvaluateMapResponse* response) override {
    evaluations.push_back(*request);
    for (const char* const name : {"sum", "first"}) {
      response->add_metrics(name);
      response->add_units("kg");
    }
    for (int i = 0; i + 1 < request->points_size(); i += 2) {
      const double a = request->points(i), b = request->points(i + 1);
      if (b > 4) response->add_uncovered(i / 2);
      for (const double value : {a + b, a}) {
        response->add_values(value);
        response->add_errors(0.01 * value);
      }
      if (!request->gradients()) continue;
      for (const double slope : {1, 1, 1, 0}) response->add_gradients(slope);
    }
    return grpc::Status::OK;
  }

  // Answers with a triangle, whose mesh comes in two parts.
  grpc::Status FollowMapShape(
      grpc::ServerContext*,
      grpc::ServerReaderWriter<v1::MapShape, v1::FollowMapShapeRequest>* stream) override {
    for (v1::FollowMapShapeRequest request; stream->Read(&request);) {
      followed.push_back(request);
      if (!request.has_to()) continue;
      v1::MapShape shape;
      shape.set_uncovered(request.to().point(1) > 4);
      shape.set_shapeless(request.to().point(0) > 4);
      if (!shape.uncovered() && !shape.shapeless()) {
        shape.mutable_new_mesh()->set_triangles(Bytes<int>({0, 1}));
        shape.mutable_new_mesh()->set_more(true);
        stream->Write(shape);
        shape.mutable_new_mesh()->set_triangles(Bytes<int>({2}));
        shape.mutable_new_mesh()->set_parts(Bytes<int>({0}));
        shape.mutable_new_mesh()->set_more(false);
        shape.set_positions(Bytes<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}));
        shape.add_metrics("sum");
        shape.add_values(7);
        shape.add_metric_errors(0.5);
      }
      stream->Write(shape);
    }
    return grpc::Status::OK;
  }

  grpc::Status VerifyMap(grpc::ServerContext*, const v1::VerifyMapRequest* request,
                         v1::Operation* response) override {
    verifications.push_back(*request);
    response->set_name(kBuilding);
    return grpc::Status::OK;
  }

  grpc::Status DeleteMap(grpc::ServerContext*, const v1::DeleteMapRequest* request,
                         v1::DeleteMapResponse*) override {
    deleted.push_back(request->name());
    return grpc::Status::OK;
  }

  std::vector<v1::BuildMapRequest> builds;
  std::vector<v1::EvaluateMapRequest> evaluations;
  std::vector<v1::VerifyMapRequest> verifications;
  std::vector<v1::FollowMapShapeRequest> followed;
  std::vector<std::string> deleted;
};

// Its one operation has made the map.
class PlayedOperations final : public v1::OperationService::Service {
 public:
  grpc::Status WatchOperation(grpc::ServerContext*, const v1::WatchOperationRequest* request,
                              grpc::ServerWriter<v1::Operation>* writer) override {
    v1::Operation operation;
    operation.set_name(request->name());
    operation.set_state(v1::Operation::SUCCEEDED);
    operation.mutable_result()->PackFrom(KnownMap());
    writer->Write(operation);
    return grpc::Status::OK;
  }
};

class PlayedEvaluator final : public v1::EvaluatorService::Service {
 public:
  grpc::Status DescribeDesignSpace(grpc::ServerContext*, const v1::DescribeDesignSpaceRequest*,
                                   v1::DesignSpace* response) override {
    response->set_subject("templates/table");
    response->add_metrics()->set_name("first");
    response->mutable_metrics(0)->set_unit("kg");
    auto& material = *response->add_parameters();
    material.set_name("material");
    material.add_choices("oak");
    material.add_choices("birch");
    return grpc::Status::OK;
  }
};

class MapCommands : public ::testing::Test {
 protected:
  MapCommands() {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    for (grpc::Service* const service :
         std::initializer_list<grpc::Service*>{&interpolator_, &operations_, &evaluator_}) {
      builder.RegisterService(service);
    }
    server_ = builder.BuildAndStart();
    session_.gateway.address = "127.0.0.1:" + std::to_string(port);
  }
  ~MapCommands() override { server_->Shutdown(std::chrono::system_clock::now()); }

  // What `mortise --json map ARGUMENTS` prints; its failure is expected nowhere.
  Json Ask(std::vector<std::string> arguments) {
    Output output(Output::Form::kSilent);
    const absl::Status status = Run(std::move(arguments), output);
    EXPECT_TRUE(status.ok()) << status;
    return Json::parse(output.last_document(), nullptr, /*allow_exceptions=*/false);
  }

  // What it prints for people.
  std::string Print(std::vector<std::string> arguments) {
    Output output(Output::Form::kText);
    ::testing::internal::CaptureStdout();
    const absl::Status status = Run(std::move(arguments), output);
    EXPECT_TRUE(status.ok()) << status;
    return ::testing::internal::GetCapturedStdout();
  }

  absl::Status Refusal(std::vector<std::string> arguments) {
    Output output(Output::Form::kSilent);
    const absl::Status status = Run(std::move(arguments), output);
    EXPECT_FALSE(status.ok());
    return status;
  }

  std::string FieldOfRefusal(std::vector<std::string> arguments) {
    return DetailOf(Refusal(std::move(arguments))).field;
  }

  PlayedInterpolator interpolator_;
  PlayedOperations operations_;
  PlayedEvaluator evaluator_;

 private:
  absl::Status Run(std::vector<std::string> arguments, Output& output) {
    arguments.insert(arguments.begin(), "map");
    return RunCommandLine(arguments, session_, output);
  }

  std::unique_ptr<grpc::Server> server_;
  Session session_;
};

TEST_F(MapCommands, BuildSaysWhatToSampleAndHowLong) {
  const Json map =
      Ask({"build",        "table",       "--metric",       "sum",   "--metric",    "first",
           "--noise",      "first=2g",    "--vary",         "a",     "--vary",      "b=20cm:0.5",
           "--fix",        "height=72cm", "--samples",      "60",    "--tolerance", "0.02",
           "--seconds",    "90",          "--basis",        "cubic", "--seed",      "7",
           "--structures", "3",           "--element-size", "50mm",  "--linear",    "--label",
           "customer=acme"});
  EXPECT_EQ(map["name"], "maps/m");
  ASSERT_EQ(interpolator_.builds.size(), 1u);
  const v1::BuildMapRequest& asked = interpolator_.builds[0];
  EXPECT_EQ(asked.labels().at("customer"), "acme");
  const v1::MapSpecification& specification = asked.specification();
  EXPECT_EQ(specification.subject(), "templates/table");
  ASSERT_EQ(specification.metrics_size(), 2);
  EXPECT_EQ(specification.metrics(1).name(), "first");
  EXPECT_FALSE(specification.metrics(0).has_noise_floor());
  EXPECT_DOUBLE_EQ(specification.metrics(1).noise_floor(), 0.002);
  EXPECT_FALSE(specification.exact_evaluations());
  ASSERT_EQ(specification.variations_size(), 2);
  EXPECT_EQ(specification.variations(0).parameter(), "a");
  EXPECT_FALSE(specification.variations(0).has_minimum());
  EXPECT_DOUBLE_EQ(specification.variations(1).minimum(), 0.2);
  EXPECT_DOUBLE_EQ(specification.variations(1).maximum(), 0.5);
  ASSERT_EQ(specification.fixed_size(), 1);
  EXPECT_DOUBLE_EQ(specification.fixed(0).value(), 0.72);
  EXPECT_EQ(specification.evaluations(), 60);
  EXPECT_EQ(specification.tolerance(), 0.02);
  EXPECT_EQ(specification.seconds(), 90);
  EXPECT_EQ(specification.basis(), v1::MapSpecification::CUBIC);
  EXPECT_EQ(specification.seed(), 7);
  EXPECT_EQ(specification.most_structures(), 3);
  EXPECT_DOUBLE_EQ(specification.mesh().element_size(), 0.05);
  EXPECT_TRUE(specification.mesh().linear());
}

TEST_F(MapCommands, BuildKnowsChoicesByName) {
  Ask({"build", "table", "--metric", "sum", "--vary", "material=oak,birch", "--vary", "a=1..2",
       "--at", "material=birch", "--detach"});
  ASSERT_EQ(interpolator_.builds.size(), 1u);
  const v1::MapSpecification& specification = interpolator_.builds[0].specification();
  EXPECT_THAT(specification.variations(0).choices(), ElementsAre("oak", "birch"));
  EXPECT_EQ(specification.variations(1).maximum(), 2);
  EXPECT_EQ(specification.fixed(0).value(), 1);
  EXPECT_FALSE(specification.has_mesh());
  const absl::Status unknown =
      Refusal({"build", "table", "--metric", "sum", "--fix", "material=pine"});
  EXPECT_EQ(DetailOf(unknown).field, "--fix material");
  EXPECT_THAT(unknown.message(), HasSubstr("oak, birch"));
}

TEST_F(MapCommands, BuildSaysWhatToKnowOfShapes) {
  Ask({"build", "table", "--shape", "surface", "--shape-noise", "0.01", "--field", "stress",
       "--field", "heat", "--field-noise", "heat=0.05", "--region", "cap", "--modes", "2"});
  Ask({"build", "table", "--metric", "sum", "--field", "stress"});
  Ask({"build", "table", "--metric", "sum", "--exact-evaluations"});
  ASSERT_EQ(interpolator_.builds.size(), 3u);
  EXPECT_TRUE(interpolator_.builds[2].specification().exact_evaluations());
  const v1::MapSpecification& specification = interpolator_.builds[0].specification();
  EXPECT_EQ(specification.metrics_size(), 0);
  const v1::MapSpecification::ShapeChoice& shape = specification.shape();
  EXPECT_EQ(shape.geometry(), v1::SURFACE);
  EXPECT_EQ(shape.noise_floor(), 0.01);
  ASSERT_EQ(shape.fields_size(), 2);
  EXPECT_FALSE(shape.fields(0).has_noise_floor());
  EXPECT_EQ(shape.fields(1).name(), "heat");
  EXPECT_EQ(shape.fields(1).noise_floor(), 0.05);
  EXPECT_THAT(shape.regions(), ElementsAre("cap"));
  EXPECT_EQ(shape.modes(), 2);
  EXPECT_EQ(interpolator_.builds[1].specification().shape().geometry(), v1::TETRAHEDRA);
  EXPECT_FALSE(interpolator_.builds[2].specification().has_shape());
  EXPECT_EQ(FieldOfRefusal({"build", "table", "--field", "stress", "--field-noise", "heat=0.1"}),
            "--field-noise heat");
  EXPECT_EQ(FieldOfRefusal({"build", "table", "--field", "heat", "--field-noise", "heat=5K"}),
            "--field-noise heat");
}

TEST_F(MapCommands, ShowPrintsShapesAndHowFarTheyAreOff) {
  const std::string shown = Print({"show", "maps/m"});
  EXPECT_THAT(shown, HasSubstr("9 in 1 mesh"));
  EXPECT_THAT(shown, HasSubstr("stress, pull"));
  EXPECT_THAT(shown, HasSubstr("stress, pull, of its range"));
  EXPECT_THAT(shown, HasSubstr("0.0625"));
  EXPECT_THAT(shown, HasSubstr("6 of them could not be brought into the map's mesh"));
  for (const char* const noise : {"about 0.5 kg", "none", "0.05 of its range", "about 0.001 of"}) {
    EXPECT_THAT(shown, HasSubstr(noise));
  }
}

// Of this map no evaluation failed.
TEST_F(MapCommands, WhereThereAreNoValuesTheyAreSaidToLackForShapes) {
  const std::string shown = Print({"show", "maps/m"});
  EXPECT_THAT(shown, HasSubstr("3 of 8 elements have no values, as shapes could not be brought"));
  EXPECT_THAT(shown, HasSubstr("4 times"));
  EXPECT_THAT(shown, HasSubstr("it has a hole more"));
  EXPECT_THAT(Print({"evaluate", "m", "--at", "a=1,b=4.5"}),
              HasSubstr("they lie where shapes could not be brought"));
  const absl::Status refusal =
      Refusal({"shape", "maps/m", "--at", "a=1,b=5", "--output", "never.stl"});
  EXPECT_EQ(DetailOf(refusal).field, "--at");
  EXPECT_THAT(refusal.message(), HasSubstr("lies where shapes could not be brought"));
}

TEST_F(MapCommands, WhereThereAreNoShapesMetricsAreSaidToBeThere) {
  const std::string shown = Print({"show", "maps/shapeless"});
  EXPECT_THAT(shown, Not(HasSubstr("no values")));
  EXPECT_THAT(shown, HasSubstr("3 of 8 elements have metrics and no shapes, as shapes could not"));
  EXPECT_THAT(shown, HasSubstr("it has a hole more"));
  EXPECT_THAT(shown, HasSubstr("the map has no shape of 2 of them: their metrics are compared"));
  const absl::Status refusal =
      Refusal({"shape", "maps/m", "--at", "a=5,b=1", "--output", "never.stl"});
  EXPECT_EQ(DetailOf(refusal).field, "--at");
  EXPECT_THAT(refusal.message(), HasSubstr("the map has metrics there, and no shape"));
}

TEST_F(MapCommands, ShapeWritesOneDesign) {
  const mortise::testing::TemporaryFolder folder;
  const std::string file = (folder.path() / "design.stl").string();
  const Json document = Ask({"shape", "maps/m", "--at", "a=1,b=2", "--output", file});
  EXPECT_EQ(document["metrics"]["sum"], 7);
  EXPECT_EQ(ReadFile(file, 1000)->size(), 80u + 4 + 50);
  ASSERT_EQ(interpolator_.followed.size(), 2u);
  EXPECT_TRUE(interpolator_.followed[0].begin().without_fields());
  EXPECT_THAT(interpolator_.followed[1].to().point(), ElementsAre(1, 2));
  Ask({"shape", "maps/m", "--at", "a=1,b=2", "--output", (folder.path() / "design.vtu").string(),
       "--field", "stress"});
  EXPECT_THAT(interpolator_.followed[2].begin().fields(), ElementsAre("stress"));
  EXPECT_EQ(FieldOfRefusal({"shape", "maps/m", "--at", "a=1,b=5", "--output", file}), "--at");
  EXPECT_EQ(FieldOfRefusal({"shape", "maps/m", "--at", "a=1,b=2", "--output", "design.obj"}),
            "--output");
  EXPECT_EQ(
      FieldOfRefusal({"shape", "maps/m", "--at", "a=1,b=2", "--output", file, "--field", "stress"}),
      "--field");
}

TEST_F(MapCommands, UnitsAreThoseOfTheMetric) {
  EXPECT_EQ(FieldOfRefusal({"build", "table", "--metric", "first", "--noise", "first=3mm"}),
            "--noise first");
  EXPECT_TRUE(interpolator_.builds.empty());
  EXPECT_EQ(FieldOfRefusal({"optimize", "maps/m", "--minimize", "sum", "--limit", "first=:18mm"}),
            "--limit first");
}

TEST_F(MapCommands, BuildNamesTheFlagThatIsAtFault) {
  const std::vector<std::string> build = {"build", "table", "--metric", "sum"};
  const auto with = [&](std::initializer_list<std::string> more) {
    std::vector<std::string> arguments = build;
    arguments.insert(arguments.end(), more);
    return FieldOfRefusal(arguments);
  };
  EXPECT_EQ(with({"--metric", "unknown"}), "--metric unknown");
  EXPECT_EQ(with({"--noise", "first=1g"}), "--noise first");
  EXPECT_EQ(with({"--vary", "a=1:b"}), "--vary a");
  EXPECT_EQ(with({"--fix", "a"}), "--fix");
  EXPECT_EQ(with({"--element-size", "large"}), "--element-size");
}

TEST_F(MapCommands, EvaluateGivesExactlyTheMetricsOfEachPoint) {
  const Json document =
      Ask({"evaluate", "m", "--at", "a=0.5,b=250mm", "--at", "b=3, a=1", "--at", "a=1,b=4.5"});
  EXPECT_EQ(document,
            Json::parse(R"({"points": [{"sum": 0.75, "first": 0.5}, {"sum": 4.0, "first": 1.0},
                                       {"sum": null, "first": null}]})"));
}

TEST_F(MapCommands, EvaluateAddsGradientsAndErrorsWhereTheyAreAskedFor) {
  const Json document = Ask({"evaluate", "maps/m", "--at", "a=1,b=1", "--gradients", "--errors"});
  EXPECT_EQ(document["gradients"],
            Json::parse(R"([{"sum": {"a": 1.0, "b": 1.0}, "first": {"a": 1.0, "b": 0.0}}])"));
  EXPECT_EQ(document["errors"], Json::parse(R"([{"sum": 0.02, "first": 0.01}])"));
  EXPECT_EQ(document["points"].size(), 1u);
}

TEST_F(MapCommands, EvaluateTellsPeopleHowFarValuesMayBeOff) {
  const std::string text =
      Print({"evaluate", "m", "--at", "a=1,b=1", "--at", "a=1,b=4.5", "--gradients"});
  EXPECT_THAT(text, HasSubstr("2 kg ± 0.02 kg"));
  EXPECT_THAT(text, HasSubstr("1 without values"));
  EXPECT_THAT(text, HasSubstr("1 kg per m"));
}

TEST_F(MapCommands, EvaluateReadsATableOfAnyLength) {
  const mortise::testing::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "points.csv";
  std::string table = "b,a\n";
  for (int i = 0; i < 250'000; ++i) absl::StrAppend(&table, i % 4, ",", i % 5, "\n");
  ASSERT_TRUE(WriteFile(file, table).ok());
  const Json document = Ask({"evaluate", "m", "--file", file.string()});
  ASSERT_EQ(document["points"].size(), 250'000u);
  EXPECT_EQ(document["points"][249'999]["sum"], 249'999 % 4 + 249'999 % 5);
  EXPECT_EQ(interpolator_.evaluations.size(), 3u);
  for (const v1::EvaluateMapRequest& asked : interpolator_.evaluations) {
    EXPECT_LE(asked.points_size(), 2 * 100'000);
  }
}

TEST_F(MapCommands, EvaluateNamesWhatIsMissingOrUnknown) {
  EXPECT_EQ(FieldOfRefusal({"evaluate", "m"}), "--at");
  EXPECT_EQ(FieldOfRefusal({"evaluate", "m", "--at", "a=1"}), "--at");
  EXPECT_EQ(FieldOfRefusal({"evaluate", "m", "--at", "a=1,b=2,c=3"}), "--at");
  EXPECT_TRUE(absl::IsNotFound(Refusal({"evaluate", "none", "--at", "a=1,b=1"})));
}

TEST_F(MapCommands, VerifyTakesDesignsOrHowManyRandomOnes) {
  Ask({"verify", "m", "--at", "a=1,b=2", "--at", "a=3,b=4"});
  Ask({"verify", "m", "--random", "20", "--seed", "5"});
  ASSERT_EQ(interpolator_.verifications.size(), 2u);
  EXPECT_THAT(interpolator_.verifications[0].points(), ElementsAre(1, 2, 3, 4));
  EXPECT_EQ(interpolator_.verifications[1].random_points(), 20);
  EXPECT_EQ(interpolator_.verifications[1].seed(), 5);
}

TEST_F(MapCommands, ShowListAndDelete) {
  EXPECT_EQ(Ask({"show", "m"})["name"], "maps/m");
  EXPECT_THAT(Print({"show", "m"}), HasSubstr("maps/m of templates/table at revision 3"));
  EXPECT_EQ(Ask({"list", "--subject", "templates/table"}).size(), 1u);
  EXPECT_THAT(Print({"list", "--subject", "templates/table"}),
              AllOf(HasSubstr("shapes"), HasSubstr("surface")));
  EXPECT_EQ(Ask({"delete", "m"})["name"], "maps/m");
  EXPECT_THAT(interpolator_.deleted, ElementsAre("maps/m"));
}

}  // namespace
}  // namespace mortise::cli
