// `mortise map explore` against a gateway that the test plays: what it asks for, and what it
// writes.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/commands/command_line.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "mortise/v1/interpolator.grpc.pb.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/cli/explore/vase_map.h"

namespace mortise::cli {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;

// A map of two structures with shapes.
class PlayedInterpolator final : public v1::InterpolatorService::Service {
 public:
  grpc::Status GetMap(grpc::ServerContext*, const v1::GetMapRequest*,
                      v1::DesignMap* response) override {
    *response = VaseMap();
    response->add_structures();
    *response->mutable_shapes() = VaseShapes();
    if (!has_shapes) response->clear_shapes();
    return grpc::Status::OK;
  }

  grpc::Status ExportMap(grpc::ServerContext*, const v1::ExportMapRequest* request,
                         grpc::ServerWriter<v1::MapExportPart>* writer) override {
    asked.push_back(*request);
    ExportedStructure structure = OneElement();
    if (request->geometry() == v1::SURFACE) AddVases(structure);
    v1::MapExportPart part;
    *part.mutable_tree() = structure.tree;
    writer->Write(part);
    for (const v1::MapMesh& mesh : structure.meshes) {
      *part.mutable_mesh() = mesh;
      writer->Write(part);
    }
    for (const v1::MapExportPart::Sample& sample : structure.samples) {
      *part.mutable_sample() = sample;
      writer->Write(part);
    }
    return grpc::Status::OK;
  }

  bool has_shapes = true;
  std::vector<v1::ExportMapRequest> asked;
};

class ExploreCommand : public ::testing::Test {
 protected:
  ExploreCommand() {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&interpolator_);
    server_ = builder.BuildAndStart();
    session_.gateway.address = "127.0.0.1:" + std::to_string(port);
  }
  ~ExploreCommand() override { server_->Shutdown(std::chrono::system_clock::now()); }

  std::filesystem::path page() const { return folder_.path() / "new" / "page.html"; }

  absl::Status Run(std::vector<std::string> more, Output& output) {
    std::vector<std::string> arguments = {"map", "explore", "vase", "--output", page().string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunCommandLine(arguments, session_, output);
  }

  Json Explore(const std::vector<std::string>& more) {
    interpolator_.asked.clear();
    Output output(Output::Form::kSilent);
    const absl::Status status = Run(more, output);
    EXPECT_TRUE(status.ok()) << status;
    Json document = Json::parse(output.last_document(), nullptr, /*allow_exceptions=*/false);
    EXPECT_EQ(document["bytes"], ReadFile(page()).value_or("").size());
    return document;
  }

  std::string FieldOfRefusal(const std::vector<std::string>& more) {
    Output output(Output::Form::kSilent);
    return DetailOf(Run(more, output)).field;
  }

  PlayedInterpolator interpolator_;

 private:
  std::unique_ptr<grpc::Server> server_;
  Session session_;
  testing::TemporaryFolder folder_;
};

TEST_F(ExploreCommand, WritesAllStructuresWithTheirShapes) {
  const Json document = Explore({});
  EXPECT_EQ(document["structures"], 2);
  EXPECT_EQ(document["shapes"], 8);
  ASSERT_EQ(interpolator_.asked.size(), 2u);
  EXPECT_EQ(interpolator_.asked[1].name(), "maps/vase");
  EXPECT_EQ(interpolator_.asked[1].structure(), 1);
  EXPECT_EQ(interpolator_.asked[1].geometry(), v1::SURFACE);
  EXPECT_THAT(ReadFile(page()).value(), HasSubstr("von_mises"));
}

TEST_F(ExploreCommand, WritesWhatIsAskedForAlone) {
  EXPECT_EQ(Explore({"--structure", "1", "--field", "temperature"})["structures"], 1);
  ASSERT_EQ(interpolator_.asked.size(), 1u);
  EXPECT_EQ(interpolator_.asked[0].structure(), 1);
  EXPECT_EQ(interpolator_.asked[0].fields(0), "temperature");
  EXPECT_EQ(Explore({"--metrics-only"})["shapes"], 0);
  EXPECT_EQ(interpolator_.asked[0].geometry(), v1::GEOMETRY_KIND_UNSPECIFIED);
  interpolator_.has_shapes = false;
  EXPECT_EQ(Explore({})["shapes"], 0);
  EXPECT_EQ(interpolator_.asked[0].geometry(), v1::GEOMETRY_KIND_UNSPECIFIED);
}

TEST_F(ExploreCommand, FaultsNameTheFlag) {
  EXPECT_EQ(FieldOfRefusal({"--structure", "2"}), "--structure");
  EXPECT_EQ(FieldOfRefusal({"--field", "beauty"}), "--field");
  EXPECT_EQ(FieldOfRefusal({"--field", "temperature", "--metrics-only"}), "--field");
  interpolator_.has_shapes = false;
  EXPECT_EQ(FieldOfRefusal({"--field", "temperature"}), "--field");
  EXPECT_FALSE(std::filesystem::exists(page()));
}

}  // namespace
}  // namespace mortise::cli
