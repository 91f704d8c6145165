// Shape and fields of designs as files that results name: of templates by our workers, of
// evaluators by their own; kept, computed again when they are gone, and refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/fields/fields_file.h"
#include "tests/integration/services/simulator/evaluator_fixture.h"

namespace mortise::simulator {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class DesignFieldsTest : public EvaluatorTest {
 protected:
  // The table as it is drawn.
  v1::EvaluateBatchRequest Table(const std::vector<std::string>& metrics,
                                 const std::vector<std::string>& fields,
                                 v1::GeometryKind geometry = v1::TETRAHEDRA) {
    v1::EvaluateBatchRequest request = Batch(0, metrics, "templates/table");
    v1::DesignPoint& point = *request.add_points();
    for (const v1::Parameter& parameter : catalog_.table().parameters()) {
      point.add_parameters(parameter.default_value());
    }
    request.mutable_design_fields()->set_geometry(geometry);
    for (const std::string& field : fields) request.mutable_design_fields()->add_fields(field);
    return request;
  }

  // The beam with a shape and two fields on it.
  static v1::Evaluator MeshedBeam() {
    v1::Evaluator beam = Beam();
    v1::Evaluator fields;
    EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(
        R"(space { geometry: TETRAHEDRA fields { name: 'sag' unit: 'm' components: 3 }
                   fields { name: 'load' unit: 'N' components: 1 of_elements: true } })",
        &fields));
    beam.MergeFrom(fields);
    return beam;
  }

  // What a batch that asks for one point gives.
  v1::EvaluationResult EvaluateOne(const v1::EvaluateBatchRequest& request) {
    const auto results = Evaluate(request);
    EXPECT_TRUE(results.ok()) << results.status();
    if (!results.ok() || !results->contains(0)) return {};
    EXPECT_FALSE(results->at(0).has_error()) << results->at(0).error().message();
    return results->at(0);
  }

  std::string Download(const std::string& sha256) const {
    v1::DownloadBlobRequest request;
    request.set_sha256(sha256);
    const auto context = Context();
    const auto stub = Simulator();
    const auto reader = stub->DownloadBlob(context.get(), request);
    const auto bytes = testing::ReadChunks(*reader);
    EXPECT_TRUE(bytes.ok()) << bytes.status();
    return bytes.value_or("");
  }

  std::string Upload(const std::string& bytes) const {
    const auto context = Context();
    v1::UploadBlobResponse response;
    const auto stub = Simulator();
    const auto writer = stub->UploadBlob(context.get(), &response);
    v1::Chunk chunk;
    chunk.set_data(bytes);
    chunk.set_total_size(static_cast<int64_t>(bytes.size()));
    writer->Write(chunk);
    writer->WritesDone();
    EXPECT_TRUE(writer->Finish().ok());
    return response.sha256();
  }

  // Removes every file of the service, as its upkeep does when they are old.
  void RemoveFiles() const {
    std::vector<std::filesystem::path> files;
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(service_.folder() / "blobs")) {
      if (entry.is_regular_file()) files.push_back(entry.path());
    }
    EXPECT_FALSE(files.empty());
    for (const std::filesystem::path& file : files) std::filesystem::remove(file);
  }
};

double ValueOf(const v1::EvaluationResult& result, const std::string& name) {
  for (const v1::Metric& metric : result.metrics()) {
    if (metric.name() == name) return metric.value();
  }
  ADD_FAILURE() << "there is no " << name;
  return 0;
}

double Volume(const fields::DesignFields& design) {
  double volume = 0;
  for (Eigen::Index e = 0; e < design.tetrahedra.cols(); ++e) {
    Eigen::Matrix3d edges;
    for (int k = 0; k < 3; ++k) {
      edges.col(k) =
          design.nodes.col(design.tetrahedra(k + 1, e)) - design.nodes.col(design.tetrahedra(0, e));
    }
    volume += edges.determinant() / 6;
  }
  return volume;
}

// A tetrahedron with the fields of the beam.
fields::DesignFields SmallDesign() {
  fields::DesignFields design;
  design.nodes.resize(3, 4);
  design.nodes << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  design.tetrahedra.resize(4, 1);
  design.tetrahedra << 0, 1, 2, 3;
  design.tetrahedron_part = Eigen::VectorXi::Zero(1);
  design.triangles.resize(3, 4);
  design.triangles << 0, 0, 0, 1, 2, 1, 3, 2, 1, 3, 2, 3;
  design.triangle_back = Eigen::VectorXi::Zero(4);
  design.triangle_front = Eigen::VectorXi::Constant(4, -1);
  design.parts = {"beam"};
  design.regions = {{"wall", {0, 2}}};
  design.fields = {
      {"sag", "m", "", fields::FieldPlace::kNodes, Eigen::MatrixXd::Constant(3, 4, 1e-3)},
      {"load", "N", "", fields::FieldPlace::kElements, Eigen::MatrixXd::Constant(1, 1, 5)}};
  return design;
}

TEST_F(DesignFieldsTest, TheFileHasTheMeshAndTheFieldsThatTheMetricsAreOf) {
  const auto worker = StartWorker("worker");
  const v1::EvaluationResult result = EvaluateOne(
      Table({"volume", "max_von_mises", "max_displacement"}, {"von_mises", "displacement"}));
  const v1::DesignFields& told = result.design_fields();
  const std::string bytes = Download(told.sha256());
  EXPECT_EQ(told.size(), static_cast<int64_t>(bytes.size()));
  EXPECT_EQ(told.sha256(), Sha256Hex(bytes));
  const auto design = fields::ReadFields(bytes);
  ASSERT_TRUE(design.ok()) << design.status();
  EXPECT_EQ(told.geometry(), v1::TETRAHEDRA);
  EXPECT_EQ(told.nodes(), design->nodes.cols());
  EXPECT_EQ(told.tetrahedra(), design->tetrahedra.cols());
  EXPECT_EQ(told.triangles(), design->triangles.cols());
  EXPECT_THAT(told.fields(), ElementsAre("von_mises", "displacement"));
  for (const v1::BoundaryCondition& condition : catalog_.table().boundary_conditions()) {
    EXPECT_THAT(told.regions(), Contains(condition.name()));
  }
  EXPECT_THAT(told.regions(), Contains("top/cap"));
  EXPECT_GE(told.control_points(), 40);
  EXPECT_EQ(told.control_points(), std::ssize(design->control_points));
  EXPECT_EQ(told.paths(), std::ssize(design->ways));
  ASSERT_EQ(design->fields.size(), 2u);
  EXPECT_EQ(design->fields[0].unit, "Pa");
  EXPECT_EQ(design->fields[0].values.maxCoeff(), ValueOf(result, "max_von_mises"));
  EXPECT_DOUBLE_EQ(design->fields[1].values.colwise().norm().maxCoeff(),
                   ValueOf(result, "max_displacement"));
  const double volume = ValueOf(result, "volume");
  EXPECT_NEAR(Volume(*design), volume, 1e-9 * volume);
}

TEST_F(DesignFieldsTest, StepsAndSinglePrecisionAreAsCloseAsTheySay) {
  const auto worker = StartWorker("worker");
  v1::EvaluateBatchRequest request = Table({"max_von_mises"}, {"von_mises"}, v1::SURFACE);
  const auto exact = fields::ReadFields(Download(EvaluateOne(request).design_fields().sha256()));
  request.mutable_design_fields()->set_position_step(1e-5);
  request.mutable_design_fields()->set_single_precision(true);
  request.mutable_design_fields()->add_regions("load");
  const v1::EvaluationResult result = EvaluateOne(request);
  const auto rounded = fields::ReadFields(Download(result.design_fields().sha256()));
  ASSERT_TRUE(exact.ok() && rounded.ok()) << exact.status() << rounded.status();
  EXPECT_EQ(result.design_fields().geometry(), v1::SURFACE);
  EXPECT_THAT(result.design_fields().regions(), ElementsAre("load"));
  EXPECT_EQ(exact->tetrahedra.cols(), 0);
  EXPECT_EQ(exact->triangles, rounded->triangles);
  const double farthest = (exact->nodes - rounded->nodes).cwiseAbs().maxCoeff();
  EXPECT_GT(farthest, 0);
  EXPECT_LE(farthest, 0.5e-5 * (1 + 1e-9));
  const Eigen::MatrixXd& stress = exact->fields[0].values;
  EXPECT_TRUE(
      ((stress - rounded->fields[0].values).array().abs() <= stress.array().abs() * 6e-8).all());
}

TEST_F(DesignFieldsTest, WhatIsKnownWithItsFileIsGivenAgainAndElseComputedAgain) {
  const auto worker = StartWorker("worker");
  const v1::EvaluateBatchRequest with = Table({"mass"}, {"temperature"}, v1::SURFACE);
  // A table has no heat: that the design lacks it is told as of metrics.
  const auto cold = Evaluate(with);
  ASSERT_TRUE(cold.ok()) << cold.status();
  EXPECT_EQ(DetailOf(rpc::FromProto(cold->at(0).error())).reason, "NO_HEAT");

  v1::EvaluateBatchRequest request = Table({"mass"}, {}, v1::SURFACE);
  v1::EvaluateBatchRequest without = request;
  without.clear_design_fields();
  EXPECT_FALSE(EvaluateOne(without).has_design_fields());
  const v1::EvaluationResult first = EvaluateOne(request);
  EXPECT_FALSE(first.cached());  // what was computed had no file
  for (const bool restart : {false, true}) {
    if (restart) {
      service_.Kill();
      service_.Start();
    }
    const v1::EvaluationResult again = EvaluateOne(request);
    EXPECT_TRUE(again.cached());
    EXPECT_EQ(again.design_fields().sha256(), first.design_fields().sha256());
    // Once its file is gone the result does not count, neither in memory nor in the store.
    RemoveFiles();
    const v1::EvaluationResult renewed = EvaluateOne(request);
    EXPECT_FALSE(renewed.cached());
    EXPECT_EQ(renewed.design_fields().sha256(), first.design_fields().sha256());
    EXPECT_EQ(Sha256Hex(Download(first.design_fields().sha256())), first.design_fields().sha256());
  }
  EXPECT_TRUE(EvaluateOne(without).cached());
}

// As on a full disk: it is no fault of the design's, and the next who asks gets it.
TEST_F(DesignFieldsTest, AFileThatCannotBeStoredIsNoResult) {
  const auto worker = StartWorker("worker");
  const v1::EvaluateBatchRequest request = Table({"mass"}, {}, v1::SURFACE);
  const std::filesystem::path blobs = service_.folder() / "blobs";
  const std::filesystem::path away = service_.folder() / "away";
  std::filesystem::rename(blobs, away);
  std::ofstream(blobs) << "in the way";
  const auto results = Evaluate(request);
  ASSERT_TRUE(results.ok()) << results.status();
  const absl::Status failure = rpc::FromProto(results->at(0).error());
  EXPECT_TRUE(absl::IsUnavailable(failure)) << failure;
  EXPECT_THAT(std::string(failure.message()), HasSubstr("could not be stored"));
  std::filesystem::remove(blobs);
  std::filesystem::rename(away, blobs);
  const v1::EvaluationResult stored = EvaluateOne(request);
  EXPECT_TRUE(fields::ReadFields(Download(stored.design_fields().sha256())).ok());
}

TEST_F(DesignFieldsTest, DesignsBesideAPointHaveNoFile) {
  ASSERT_TRUE(Create(MeshedBeam()).ok());
  v1::EvaluateBatchRequest request = Batch(1, {"cost"});
  request.set_gradients(true);
  request.set_difference_step(0.05);
  request.mutable_design_fields()->set_geometry(v1::SURFACE);
  int files = 0;
  const std::string sha256 = Upload(*fields::WriteFields([] {
    fields::DesignFields design = SmallDesign();
    design.fields.clear();
    return design;
  }()));
  const absl::Status outcome = OutcomeOf(request, [&] {
    for (int i = 0; i < 5; ++i) {
      const v1::Task task = LeaseOne();
      v1::EvaluationResult answer = Answer(task);
      if (task.has_design_fields()) {
        ++files;
        answer.mutable_design_fields()->set_sha256(sha256);
      }
      EXPECT_EQ(Report(task, answer), absl::OkStatus());
    }
  });
  EXPECT_EQ(outcome, absl::OkStatus());
  EXPECT_EQ(files, 1);
}

TEST_F(DesignFieldsTest, WorkersOfEvaluatorsUploadTheSame) {
  ASSERT_TRUE(Create(MeshedBeam()).ok());
  v1::EvaluateBatchRequest request = Batch(1, {"mass"});
  request.mutable_design_fields()->set_geometry(v1::TETRAHEDRA);
  request.mutable_design_fields()->add_fields("sag");
  request.mutable_design_fields()->add_fields("load");
  request.mutable_design_fields()->add_regions("wall");
  const std::string bytes = *fields::WriteFields(SmallDesign());
  v1::EvaluationResult result;
  std::thread client([&] { result = EvaluateOne(request); });
  const v1::Task task = LeaseOne();
  EXPECT_THAT(task.design_fields().fields(), ElementsAre("sag", "load"));
  v1::EvaluationResult answer = Answer(task);
  answer.mutable_design_fields()->set_sha256(Upload(bytes));
  answer.mutable_design_fields()->set_nodes(-7);  // the service looks for itself
  EXPECT_EQ(Report(task, answer), absl::OkStatus());
  client.join();
  EXPECT_EQ(result.design_fields().nodes(), 4);
  EXPECT_EQ(result.design_fields().size(), static_cast<int64_t>(bytes.size()));
  EXPECT_THAT(result.design_fields().fields(), ElementsAre("sag", "load"));
  EXPECT_EQ(Download(result.design_fields().sha256()), bytes);
}

TEST_F(DesignFieldsTest, FilesThatAreNotWhatWasAskedForFailTheirTask) {
  ASSERT_TRUE(Create(MeshedBeam()).ok());
  const auto uploaded = [&](const std::function<void(fields::DesignFields&)>& change) {
    fields::DesignFields design = SmallDesign();
    change(design);
    return Upload(*fields::WriteFields(design));
  };
  std::string damaged = *fields::WriteFields(SmallDesign());
  damaged[damaged.size() / 2] ^= 1;
  struct Fault {
    std::string field;    // below result.design_fields
    std::string message;  // a part of it
    std::string sha256;
  };
  const std::vector<Fault> faults = {
      {"", "must name the file", ""},
      {".sha256", "has not been uploaded", std::string(64, 'a')},
      {".sha256", "hexadecimal digits", "nonsense"},
      {".sha256", "cannot be read: header.checksum", Upload(damaged)},
      {".sha256", "is not that of a file of shape and fields", Upload("solid beam")},
      {".geometry", "has no tetrahedra", uploaded([](auto& design) {
         design.tetrahedra.resize(4, 0);
         design.tetrahedron_part.resize(0);
         design.fields.pop_back();
       })},
      {".fields", "are 'sag'; asked for were 'sag, load'",
       uploaded([](auto& design) { design.fields.pop_back(); })},
      {".fields", "must be in 'm'", uploaded([](auto& design) { design.fields[0].unit = "mm"; })},
      {".fields", "has 1 components; it must be 3",
       uploaded([](auto& design) { design.fields[0].values = Eigen::MatrixXd::Zero(1, 4); })},
      {".fields", "must be of elements", uploaded([](auto& design) {
         design.fields[1].place = fields::FieldPlace::kNodes;
         design.fields[1].values = Eigen::MatrixXd::Zero(1, 4);
       })},
      {".regions", "lack 'wall'", uploaded([](auto& design) { design.regions.clear(); })},
  };
  v1::EvaluateBatchRequest batch = Batch(1, {"mass"});
  batch.mutable_design_fields()->set_geometry(v1::TETRAHEDRA);
  batch.mutable_design_fields()->add_fields("sag");
  batch.mutable_design_fields()->add_fields("load");
  batch.mutable_design_fields()->add_regions("wall");
  for (std::size_t i = 0; i < faults.size(); ++i) {
    SCOPED_TRACE(faults[i].message);
    batch.mutable_points(0)->set_parameters(0, 1 + 0.1 * static_cast<double>(i));
    const absl::Status outcome = OutcomeOf(batch, [&] {
      const v1::Task task = LeaseOne();
      v1::EvaluationResult answer = Answer(task);
      if (!faults[i].sha256.empty()) {
        answer.mutable_design_fields()->set_sha256(faults[i].sha256);
      }
      const absl::Status refused = Report(task, answer);
      EXPECT_TRUE(absl::IsInvalidArgument(refused)) << refused;
      EXPECT_EQ(DetailOf(refused).field, "result.design_fields" + faults[i].field);
    });
    EXPECT_EQ(DetailOf(outcome).reason, "RESULT_UNUSABLE");
    EXPECT_THAT(std::string(outcome.message()), HasSubstr(faults[i].message));
  }
}

TEST_F(DesignFieldsTest, AFileThatNobodyAskedForIsRefused) {
  ASSERT_TRUE(Create(MeshedBeam()).ok());
  const std::string sha256 = Upload(*fields::WriteFields(SmallDesign()));
  const absl::Status outcome = OutcomeOf(Batch(1, {"mass"}), [&] {
    const v1::Task task = LeaseOne();
    v1::EvaluationResult answer = Answer(task);
    answer.mutable_design_fields()->set_sha256(sha256);
    EXPECT_EQ(DetailOf(Report(task, answer)).field, "result.design_fields");
  });
  EXPECT_THAT(std::string(outcome.message()), HasSubstr("were not asked for"));
}

TEST_F(DesignFieldsTest, RequestsThatCannotBeMetAreRefusedWithWhatThereIs) {
  ASSERT_TRUE(Create(Beam()).ok());
  struct Fault {
    std::string field;    // below design_fields
    std::string message;  // a part of it
    std::function<void(v1::DesignFieldsRequest&)> make;
  };
  const std::vector<Fault> faults = {
      {".geometry", "must be SURFACE or TETRAHEDRA", [](auto& wanted) { wanted.Clear(); }},
      {".fields[1]", "'torsion' is not offered; there are displacement, von_mises, stress, ",
       [](auto& wanted) { wanted.add_fields("torsion"); }},
      {".fields[1]", "'von_mises' is there twice",
       [](auto& wanted) { wanted.add_fields("von_mises"); }},
      {".fields[1]", "geometry must be TETRAHEDRA",
       [](auto& wanted) { wanted.add_fields("heat_flux"); }},
      {".regions[0]", "must not be empty", [](auto& wanted) { wanted.add_regions(""); }},
      {".position_step", "must be within 1e-09 to 0.01",
       [](auto& wanted) { wanted.set_position_step(0.1); }},
      {".modes", "must be within 0 to 100", [](auto& wanted) { wanted.set_modes(101); }},
  };
  for (const Fault& fault : faults) {
    v1::EvaluateBatchRequest request = Table({"mass"}, {"von_mises"}, v1::SURFACE);
    fault.make(*request.mutable_design_fields());
    const absl::Status status = Evaluate(request).status();
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << status;
    EXPECT_EQ(DetailOf(status).field, "design_fields" + fault.field);
    EXPECT_THAT(std::string(status.message()), HasSubstr(fault.message));
  }
  v1::EvaluateBatchRequest request = Batch(1, {"mass"});
  request.mutable_design_fields()->set_geometry(v1::SURFACE);
  EXPECT_THAT(std::string(Evaluate(request).status().message()),
              HasSubstr("evaluators/beam offers no geometry and fields"));
}

// Only the design tells which regions there are, and how large its file is.
TEST_F(DesignFieldsTest, APointThatLacksARegionOrIsTooLargeFailsByItself) {
  const auto worker = StartWorker("worker");
  v1::EvaluateBatchRequest request = Table({"mass"}, {}, v1::SURFACE);
  request.mutable_design_fields()->add_regions("lid");
  auto results = Evaluate(request);
  ASSERT_TRUE(results.ok()) << results.status();
  const absl::Status region = rpc::FromProto(results->at(0).error());
  EXPECT_EQ(DetailOf(region).field, "design_fields.regions[0]") << region;
  EXPECT_THAT(std::string(region.message()), HasSubstr("there are foot_front_left, "));

  request = Table({"mass"}, {});
  request.mutable_mesh()->set_element_size(1e-3);
  results = Evaluate(request);
  ASSERT_TRUE(results.ok()) << results.status();
  const absl::Status too_large = rpc::FromProto(results->at(0).error());
  EXPECT_TRUE(absl::IsResourceExhausted(too_large)) << too_large;
  EXPECT_EQ(DetailOf(too_large).reason, "TOO_LARGE");
}

// Told by their number, of the default size and of one that is said.
TEST_F(DesignFieldsTest, ElementsAreScaledFromWhateverSizeTheyHave) {
  const auto worker = StartWorker("worker");
  for (const double size : {0.0, 0.05}) {
    v1::EvaluateBatchRequest request = Table({"max_displacement"}, {});
    request.mutable_mesh()->set_element_size(size);
    request.mutable_mesh()->set_linear(true);
    const v1::EvaluationResult plain = EvaluateOne(request);
    request.mutable_mesh()->set_size_scale(0.5);
    const v1::EvaluationResult finer = EvaluateOne(request);
    EXPECT_GT(finer.design_fields().tetrahedra(), plain.design_fields().tetrahedra());
    EXPECT_NE(ValueOf(finer, "max_displacement"), ValueOf(plain, "max_displacement"));
    EXPECT_NEAR(ValueOf(finer, "max_displacement"), ValueOf(plain, "max_displacement"),
                0.5 * ValueOf(plain, "max_displacement"));
  }
  v1::EvaluateBatchRequest wrong = Table({"mass"}, {}, v1::SURFACE);
  wrong.mutable_mesh()->set_size_scale(0.1);
  EXPECT_EQ(DetailOf(Evaluate(wrong).status()).field, "mesh.size_scale");
}

TEST_F(DesignFieldsTest, WhatEvaluatorsOfferIsChecked) {
  struct Fault {
    std::string field;
    std::function<void(v1::DesignSpace&)> make;
  };
  const std::vector<Fault> faults = {
      {"fields", [](auto& space) { space.clear_geometry(); }},
      {"geometry", [](auto& space) { space.set_geometry(static_cast<v1::GeometryKind>(9)); }},
      {"fields[1].of_elements", [](auto& space) { space.set_geometry(v1::SURFACE); }},
      {"fields[0].name", [](auto& space) { space.mutable_fields(0)->set_name("a b"); }},
      {"fields[1].name", [](auto& space) { space.mutable_fields(1)->set_name("sag"); }},
      {"fields[0].components", [](auto& space) { space.mutable_fields(0)->set_components(0); }},
      {"fields[0].unit",
       [](auto& space) { space.mutable_fields(0)->set_unit(std::string(60, 'm')); }},
  };
  for (const Fault& fault : faults) {
    v1::Evaluator beam = MeshedBeam();
    fault.make(*beam.mutable_space());
    const absl::Status status = Create(beam).status();
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << fault.field;
    EXPECT_EQ(DetailOf(status).field, "evaluator.space." + fault.field) << status;
  }
  ASSERT_TRUE(Create(MeshedBeam()).ok());
  v1::DescribeDesignSpaceRequest describe;
  describe.set_subject("evaluators/beam");
  const auto space = testing::Call(*Evaluators(), &Service::DescribeDesignSpace, describe);
  ASSERT_TRUE(space.ok()) << space.status();
  EXPECT_EQ(space->geometry(), v1::TETRAHEDRA);
  EXPECT_EQ(space->fields_size(), 2);
}

}  // namespace
}  // namespace mortise::simulator
