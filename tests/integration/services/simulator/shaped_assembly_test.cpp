// Drawings of parts with shapes, from STEP to stresses, through catalog, simulator and worker as
// processes.
#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "mortise/v1/assembly.grpc.pb.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "mortise/v1/evaluator.grpc.pb.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "mortise/v1/simulator.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/filled_catalog.h"
#include "tests/integration/services/service_under_test.h"

namespace mortise::simulator {
namespace {

using testing::Call;
using ::testing::HasSubstr;

std::filesystem::path Sources() {
  const char* folder = std::getenv("MORTISE_SOURCE_DIR");
  return folder == nullptr ? "." : folder;
}

std::string TextOf(const std::string& file) {
  return ReadFile(Sources() / "collection/drawings" / file).value();
}

template <class Message>
Message ParsedFrom(const std::string& file) {
  Message message;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(TextOf(file), &message)) << file;
  return message;
}

// A round disc as a binary STL file, 2 * spokes * (rings + 1) triangles, sizes in millimetres.
std::string DiscStl(double diameter, double height, int rings, int spokes) {
  std::string stl(84, '\0');
  std::uint32_t count = 0;
  using Corner = std::array<float, 3>;
  const auto rim = [&](int ring, int spoke) {
    const double around = 2 * M_PI * (spoke % spokes) / spokes;
    return Corner{static_cast<float>(diameter / 2 * std::cos(around)),
                  static_cast<float>(diameter / 2 * std::sin(around)),
                  static_cast<float>(height * ring / rings)};
  };
  const auto add = [&](const std::array<Corner, 3>& corners) {
    char triangle[50] = {};
    std::memcpy(triangle + 12, corners.data(), 36);
    stl.append(triangle, sizeof triangle);
    ++count;
  };
  const Corner bottom{0, 0, 0}, top{0, 0, static_cast<float>(height)};
  for (int spoke = 0; spoke < spokes; ++spoke) {
    add({bottom, rim(0, spoke + 1), rim(0, spoke)});
    add({top, rim(rings, spoke), rim(rings, spoke + 1)});
    for (int ring = 0; ring < rings; ++ring) {
      add({rim(ring, spoke), rim(ring, spoke + 1), rim(ring + 1, spoke + 1)});
      add({rim(ring, spoke), rim(ring + 1, spoke + 1), rim(ring + 1, spoke)});
    }
  }
  std::memcpy(stl.data() + 80, &count, sizeof count);
  return stl;
}

v1::Vector3 VectorOf(const Eigen::Vector3d& from) {
  v1::Vector3 vector;
  vector.set_x(from.x());
  vector.set_y(from.y());
  vector.set_z(from.z());
  return vector;
}

class ShapedAssemblyTest : public ::testing::Test {
 protected:
  // Imports a drawing and the template that loads it.
  absl::Status Import(const std::string& drawing) {
    v1::ImportAssemblyStepRequest step;
    step.set_request_id(absl::StrCat("step-", drawing));
    step.set_step(TextOf(drawing + ".step"));
    *step.mutable_annotations() = ParsedFrom<v1::AssemblyAnnotations>(drawing + ".textproto");
    MORTISE_RETURN_IF_ERROR(
        Call(*assemblies_, &v1::AssemblyService::Stub::ImportAssemblyStep, step).status());
    v1::ImportTemplateRequest request;
    request.set_request_id(absl::StrCat("template-", drawing));
    *request.mutable_template_() = ParsedFrom<v1::Template>(drawing + "_template.textproto");
    return Call(*catalog_, &v1::CatalogService::Stub::ImportTemplate, request).status();
  }

  absl::StatusOr<v1::EvaluatedDesign> Evaluate(const v1::AnalyzeDesignRequest& asked) {
    v1::EvaluateTemplateRequest request;
    request.set_name(asked.template_());
    *request.mutable_parameters() = asked.parameters();
    request.set_without_triangles(true);
    return Call(*catalog_, &v1::CatalogService::Stub::EvaluateTemplate, request);
  }

  absl::StatusOr<v1::Analysis> Analyze(const v1::AnalyzeDesignRequest& request) {
    const auto simulator = v1::SimulatorService::NewStub(service_.channel());
    MORTISE_ASSIGN_OR_RETURN(const v1::Operation started,
                             Call(*simulator, &v1::SimulatorService::Stub::AnalyzeDesign, request));
    const auto operations = v1::OperationService::NewStub(service_.channel());
    v1::WaitOperationRequest wait;
    wait.set_name(started.name());
    wait.set_timeout_seconds(90);
    v1::Operation done = started;
    for (int round = 0; round < 2 && done.state() != v1::Operation::SUCCEEDED; ++round) {
      MORTISE_ASSIGN_OR_RETURN(done,
                               Call(*operations, &v1::OperationService::Stub::WaitOperation, wait));
      if (done.has_error()) return absl::InternalError(done.error().message());
    }
    v1::Analysis analysis;
    if (!done.result().UnpackTo(&analysis)) return absl::InternalError(done.ShortDebugString());
    return analysis;
  }

  static double ValueOf(const v1::Analysis& analysis, const std::string& name) {
    for (const v1::Metric& metric : analysis.metrics()) {
      if (metric.name() == name) return metric.value();
    }
    ADD_FAILURE() << "there is no " << name;
    return 0;
  }

  testing::FilledCatalog catalog_process_;
  testing::ServiceUnderTest service_{"mortise-simulator",
                                     {"--peer=catalog=" + catalog_process_.address()}};
  testing::ChildProcess worker_{{testing::BuiltProgram("mortise-simulator"), "--worker",
                                 "--worker-name=only", "--insecure-development",
                                 "--log-level=warning", "--peer=simulator=" + service_.address(),
                                 "--peer=catalog=" + catalog_process_.address()}};
  std::unique_ptr<v1::CatalogService::Stub> catalog_ =
      v1::CatalogService::NewStub(catalog_process_.channel());
  std::unique_ptr<v1::AssemblyService::Stub> assemblies_ =
      v1::AssemblyService::NewStub(catalog_process_.channel());
};

TEST_F(ShapedAssemblyTest, ADrawnShelfBearsItsBooksAtAnyLength) {
  const absl::Status imported = Import("wall_shelf");
  ASSERT_TRUE(imported.ok()) << imported;
  for (const double length : {0.8, 0.95}) {
    SCOPED_TRACE(length);
    v1::AnalyzeDesignRequest request;
    request.set_request_id(absl::StrCat("shelf-", length));
    request.set_template_("templates/wall-shelf");
    request.add_parameters()->set_name("length");
    request.mutable_parameters(0)->set_value(length);
    request.mutable_mesh()->set_linear(true);
    const auto design = Evaluate(request);
    ASSERT_TRUE(design.ok()) << design.status();
    double mass = 0;
    for (const v1::EvaluatedPart& part : design->parts()) {
      EXPECT_EQ(part.faceted().triangles_size(), 0);
      if (!part.connecting()) mass += part.mass();
    }
    const auto analysis = Analyze(request);
    ASSERT_TRUE(analysis.ok()) << analysis.status();
    EXPECT_NEAR(ValueOf(*analysis, "mass"), mass, 0.005 * mass);
    EXPECT_GT(ValueOf(*analysis, "max_displacement"), 1e-5);
    const double load = 35 * 9.81 * length;
    EXPECT_NEAR(analysis->total_load().z(), -load, 1e-6 * load);
    EXPECT_NEAR(analysis->total_reaction().z(), load, 1e-6 * load);
    EXPECT_NEAR(analysis->total_reaction().x(), 0, 1e-6 * load);
    EXPECT_EQ(analysis->artifacts_size(), 2);
  }
  // Without supports nothing is queued.
  v1::AnalyzeDesignRequest bench;
  bench.set_request_id("bench");
  bench.set_template_("templates/garden-bench");
  const absl::Status status = Analyze(bench).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition) << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr("FIXED"));
}

TEST_F(ShapedAssemblyTest, WorkersFetchTheShapesThatDoNotFitIntoAMessage) {
  constexpr int kRings = 14, kSpokes = 1500;
  constexpr double kHeight = 0.05;
  v1::ImportAssemblyRequest assembly;
  assembly.set_request_id("discs");
  assembly.mutable_assembly()->set_name("assemblies/discs");
  assembly.mutable_assembly()->set_title("Discs on a board");
  const auto place = [&](const std::string& name, const Eigen::Vector3d& at,
                         const Eigen::Vector3d& size) -> v1::AssemblyPart& {
    v1::AssemblyPart& part = *assembly.mutable_assembly()->add_parts();
    part.set_name(name);
    *part.mutable_position() = VectorOf(at);
    *part.mutable_size() = VectorOf(size);
    return part;
  };
  place("board", {-0.2, -0.2, -0.02}, {1.6, 0.4, 0.02});
  for (int i = 0; i < 5; ++i) {
    const double diameter = 0.2 - 0.01 * i;
    v1::ImportShapeRequest shape;
    shape.set_request_id(absl::StrCat("disc-", i));
    shape.set_format(v1::ImportShapeRequest::STL);
    shape.set_file(DiscStl(1000 * diameter, 1000 * kHeight, kRings, kSpokes));
    const auto stored = Call(*catalog_, &v1::CatalogService::Stub::ImportShape, shape);
    ASSERT_TRUE(stored.ok()) << stored.status();
    place(absl::StrCat("disc ", i), {0.25 * i, -diameter / 2, 0}, {diameter, diameter, kHeight})
        .set_shape(stored->name());
  }
  const auto imported = Call(*assemblies_, &v1::AssemblyService::Stub::ImportAssembly, assembly);
  ASSERT_TRUE(imported.ok()) << imported.status();
  v1::ImportTemplateRequest request;
  request.set_request_id("discs-template");
  request.mutable_template_()->set_name("templates/discs");
  request.mutable_template_()->mutable_assembly()->set_assembly("assemblies/discs");
  const auto made = Call(*catalog_, &v1::CatalogService::Stub::ImportTemplate, request);
  ASSERT_TRUE(made.ok()) << made.status();

  v1::GetTemplateBundleRequest get;
  get.set_name("templates/discs");
  const auto bundle = Call(*catalog_, &v1::CatalogService::Stub::GetTemplateBundle, get);
  ASSERT_TRUE(bundle.ok()) << bundle.status();
  EXPECT_GT(bundle->shapes_size(), 0);
  EXPECT_GT(bundle->more_shapes_size(), 0);
  EXPECT_EQ(bundle->shapes_size() + bundle->more_shapes_size(), 5);

  const auto evaluator = v1::EvaluatorService::NewStub(service_.channel());
  v1::DescribeDesignSpaceRequest describe;
  describe.set_subject("templates/discs");
  const auto space = Call(*evaluator, &v1::EvaluatorService::Stub::DescribeDesignSpace, describe);
  ASSERT_TRUE(space.ok()) << space.status();
  EXPECT_GT(space->parameters_size(), 0);

  v1::EvaluateTemplateRequest whole;
  whole.set_name("templates/discs");
  const absl::Status large =
      Call(*catalog_, &v1::CatalogService::Stub::EvaluateTemplate, whole).status();
  EXPECT_EQ(large.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(large.message()), HasSubstr("without_triangles"));

  // As a file it comes whole.
  v1::ExportDesignRequest as_file;
  as_file.set_name("templates/discs");
  as_file.set_format(v1::ExportDesignRequest::DESIGN);
  grpc::ClientContext context;
  testing::Prepare(context);
  const auto bytes = testing::ReadChunks(*catalog_->ExportDesign(&context, as_file));
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  EXPECT_GT(bytes->size(), std::size_t{4} << 20);
  v1::EvaluatedDesign design;
  ASSERT_TRUE(design.ParseFromString(*bytes));
  ASSERT_EQ(design.parts_size(), 6);
  for (int i = 1; i < design.parts_size(); ++i) {
    EXPECT_EQ(design.parts(i).faceted().triangles_size(), 3 * 2 * kSpokes * (kRings + 1));
  }
}

}  // namespace
}  // namespace mortise::simulator
