// Assemblies through the catalog as a process: parametrised, dragged, sampled, exported, imported.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>

#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/cad/step_reader.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/assembly.grpc.pb.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "mortise/v1/events.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/service_under_test.h"

namespace mortise::catalog {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using Stub = v1::AssemblyService::Stub;

std::filesystem::path ShippedCollection() {
  const char* source = std::getenv("MORTISE_SOURCE_DIR");
  return std::filesystem::path(source == nullptr ? "." : source) / "collection";
}

class AssemblyServiceTest : public ::testing::Test {
 protected:
  AssemblyServiceTest() { Connect(); }

  void Connect() { stub_ = v1::AssemblyService::NewStub(process_.channel()); }

  template <typename Request, typename Response>
  absl::StatusOr<Response> Call(grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&,
                                                             Response*),
                                const Request& request) {
    return testing::Call(*stub_, method, request);
  }

  template <typename Reader>
  static absl::StatusOr<std::vector<v1::AdjustedAssembly>> ReadAll(const Reader& reader) {
    std::vector<v1::AdjustedAssembly> designs;
    v1::AdjustedAssembly design;
    while (reader->Read(&design)) designs.push_back(design);
    const absl::Status status = rpc::FromGrpc(reader->Finish());
    if (!status.ok()) return status;
    return designs;
  }

  absl::StatusOr<std::vector<v1::AdjustedAssembly>> Sample(int count, uint64_t seed) {
    v1::SampleAssemblyRequest request;
    request.set_name(kShelf);
    request.set_count(count);
    request.set_seed(seed);
    grpc::ClientContext context;
    testing::Prepare(context);
    return ReadAll(stub_->SampleAssembly(&context, request));
  }

  absl::StatusOr<std::vector<v1::AdjustedAssembly>> Evaluate(
      const v1::EvaluateAssemblyRequest& request) {
    grpc::ClientContext context;
    testing::Prepare(context);
    return ReadAll(stub_->EvaluateAssembly(&context, request));
  }

  v1::Parametrization Parametrized() {
    v1::ParametrizeAssemblyRequest request;
    request.set_name(kShelf);
    const auto found = Call(&Stub::ParametrizeAssembly, request);
    EXPECT_TRUE(found.ok()) << found.status();
    return found.ok() ? *found : v1::Parametrization();
  }

  v1::Assembly Get(const std::string& name, int64_t revision = 0) {
    v1::GetAssemblyRequest request;
    request.set_name(name);
    request.set_revision(revision);
    const auto found = Call(&Stub::GetAssembly, request);
    EXPECT_TRUE(found.ok()) << found.status();
    return found.ok() ? *found : v1::Assembly();
  }

  absl::StatusOr<v1::Assembly> Import(const v1::Assembly& assembly, int64_t expected) {
    v1::ImportAssemblyRequest request;
    request.set_request_id("import-" + std::to_string(++requests_));
    *request.mutable_assembly() = assembly;
    request.set_expected_revision(expected);
    return Call(&Stub::ImportAssembly, request);
  }

  std::string Export(const std::string& name) {
    v1::ExportAssemblyRequest request;
    request.set_name(name);
    request.set_format(v1::ExportDesignRequest::STEP);
    grpc::ClientContext context;
    testing::Prepare(context);
    const auto bytes = testing::ReadChunks(*stub_->ExportAssembly(&context, request));
    EXPECT_TRUE(bytes.ok()) << bytes.status();
    return bytes.value_or("");
  }

  absl::StatusOr<v1::ImportAssemblyStepResponse> ImportStep(
      const std::string& step, const v1::AssemblyAnnotations& annotations, int64_t expected = 0) {
    v1::ImportAssemblyStepRequest request;
    request.set_request_id("import-" + std::to_string(++requests_));
    request.set_step(step);
    *request.mutable_annotations() = annotations;
    request.set_expected_revision(expected);
    return Call(&Stub::ImportAssemblyStep, request);
  }

  v1::Parametrization ParametrizationOf(const std::string& name) {
    v1::ParametrizeAssemblyRequest request;
    request.set_name(name);
    const auto found = Call(&Stub::ParametrizeAssembly, request);
    EXPECT_TRUE(found.ok()) << found.status();
    return found.value_or(v1::Parametrization());
  }

  static constexpr char kShelf[] = "assemblies/bookshelf";

  int requests_ = 0;
  testing::ServiceUnderTest process_{"mortise-catalog",
                                     {"--collection=" + ShippedCollection().string()}};
  std::unique_ptr<Stub> stub_;
};

double Extent(const v1::AdjustedAssembly& design, const std::string& element, v1::Axis axis) {
  for (const v1::PlacedPart& part : design.parts()) {
    if (part.element() != element) continue;
    if (axis == v1::X) return part.maximum().x() - part.minimum().x();
    if (axis == v1::Y) return part.maximum().y() - part.minimum().y();
    return part.maximum().z() - part.minimum().z();
  }
  ADD_FAILURE() << "no part of " << element;
  return 0;
}

// A size of an element of one part, that can be changed.
v1::MeasureRange SizeOfOnePart(const v1::Parametrization& parametrization) {
  for (const v1::MeasureRange& range : parametrization.sizes()) {
    for (const v1::ParametricElement& element : parametrization.elements()) {
      if (element.name() == range.measure().element() && element.parts_size() == 1) return range;
    }
  }
  ADD_FAILURE() << "no size can be changed";
  return {};
}

TEST_F(AssemblyServiceTest, ShipsAssembliesInPages) {
  v1::ListAssembliesRequest request;
  request.set_page_size(2);
  std::vector<std::string> names;
  do {
    const auto page = Call(&Stub::ListAssemblies, request);
    ASSERT_TRUE(page.ok()) << page.status();
    for (const v1::Assembly& listed : page->assemblies()) {
      names.push_back(listed.name());
      EXPECT_FALSE(listed.title().empty());
      EXPECT_EQ(listed.parts_size(), 0);
      EXPECT_EQ(listed.revision(), 1);
    }
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty());
  EXPECT_GE(names.size(), 3u);
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
  EXPECT_THAT(names, Contains(kShelf));
  const v1::Assembly shelf = Get(kShelf);
  EXPECT_GT(shelf.parts_size(), 3);
  EXPECT_EQ(shelf.digest().size(), 64u);
  EXPECT_GT(shelf.create_time().seconds(), 0);
}

TEST_F(AssemblyServiceTest, TellsWhatParametrisationFinds) {
  const v1::Parametrization found = Parametrized();
  EXPECT_EQ(found.assembly(), kShelf);
  EXPECT_EQ(found.revision(), 1);
  EXPECT_GT(found.tolerance(), 0);
  EXPECT_LT(found.tolerance(), 1e-4);
  ASSERT_GT(found.nodes_size(), 0);
  EXPECT_EQ(found.nodes(0).group(), "");
  EXPECT_EQ(found.nodes(0).elements(), found.elements_size());
  EXPECT_EQ(found.nodes(0).degrees_of_freedom(), found.degrees_of_freedom() + 3);
  EXPECT_EQ(found.q_size(), 6 * found.elements_size());
  EXPECT_GT(found.contacts_size(), 3);
  EXPECT_GT(found.relationships_size(), 10);
  EXPECT_GE(found.sizes_size(), 3);
  for (const v1::MeasureRange& range : found.sizes()) {
    EXPECT_LE(range.minimum(), range.drawn() + 1e-9);
    EXPECT_GE(range.maximum(), range.drawn() - 1e-9);
    EXPECT_LT(range.minimum(), range.maximum());
  }
  int parts = 0;
  for (const v1::ParametricElement& element : found.elements()) parts += element.parts_size();
  EXPECT_GE(parts, Get(kShelf).parts_size());
}

TEST_F(AssemblyServiceTest, DragsAPart) {
  const v1::MeasureRange range = SizeOfOnePart(Parametrized());
  v1::AdjustAssemblyRequest request;
  request.set_name(kShelf);
  *request.add_demands()->mutable_measure() = range.measure();
  std::vector<double> last;
  for (const double share : {0.2, 0.5, 0.8}) {
    const double wanted = range.minimum() + share * (range.maximum() - range.minimum());
    request.mutable_demands(0)->set_value(wanted);
    request.set_strict(true);
    const auto design = Call(&Stub::AdjustAssembly, request);
    ASSERT_TRUE(design.ok()) << design.status();
    ASSERT_EQ(design->reached_size(), 1);
    EXPECT_NEAR(design->reached(0), wanted, 1e-9);
    EXPECT_NEAR(Extent(*design, range.measure().element(), range.measure().axis()), wanted, 1e-9);
    EXPECT_EQ(design->faults_size(), 0);
    EXPECT_EQ(design->revision(), 1);
    *request.mutable_q() = design->q();
  }
}

TEST_F(AssemblyServiceTest, ComesAsNearAsItCanOrRefuses) {
  const v1::MeasureRange range = SizeOfOnePart(Parametrized());
  v1::AdjustAssemblyRequest request;
  request.set_name(kShelf);
  *request.add_demands()->mutable_measure() = range.measure();
  request.mutable_demands(0)->set_value(range.maximum() + 0.5);
  const auto near = Call(&Stub::AdjustAssembly, request);
  ASSERT_TRUE(near.ok()) << near.status();
  EXPECT_NEAR(near->reached(0), range.maximum(), 1e-7);
  EXPECT_EQ(near->faults_size(), 0);

  request.set_strict(true);
  const absl::Status refused = Call(&Stub::AdjustAssembly, request).status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(DetailOf(refused).reason, "DEMANDS_CONFLICT");
  EXPECT_THAT(std::string(refused.message()), HasSubstr(range.measure().element()));
}

TEST_F(AssemblyServiceTest, SamplesAndEvaluatesAlike) {
  const auto samples = Sample(20, 7);
  ASSERT_TRUE(samples.ok()) << samples.status();
  ASSERT_EQ(samples->size(), 20u);
  const auto again = Sample(20, 7);
  ASSERT_TRUE(again.ok()) << again.status();
  const auto other = Sample(20, 8);
  ASSERT_TRUE(other.ok()) << other.status();
  v1::EvaluateAssemblyRequest request;
  request.set_name(kShelf);
  for (std::size_t i = 0; i < samples->size(); ++i) {
    EXPECT_EQ((*samples)[i].SerializeAsString(), (*again)[i].SerializeAsString());
    EXPECT_NE((*samples)[i].SerializeAsString(), (*other)[i].SerializeAsString());
    EXPECT_EQ((*samples)[i].faults_size(), 0);
    *request.add_points()->mutable_q() = (*samples)[i].q();
  }
  const auto evaluated = Evaluate(request);
  ASSERT_TRUE(evaluated.ok()) << evaluated.status();
  ASSERT_EQ(evaluated->size(), 20u);
  for (std::size_t i = 0; i < samples->size(); ++i) {
    EXPECT_EQ((*evaluated)[i].SerializeAsString(), (*samples)[i].SerializeAsString());
  }
}

TEST_F(AssemblyServiceTest, SaysWhatIsWrongWithADesignThatBreaksARelationship) {
  const v1::Parametrization found = Parametrized();
  v1::EvaluateAssemblyRequest request;
  request.set_name(kShelf);
  *request.add_points()->mutable_q() = found.q();
  *request.add_points()->mutable_q() = found.q();
  // The last element leaves all it touches.
  request.mutable_points(1)->set_q(6 * (found.elements_size() - 1),
                                   found.q(6 * (found.elements_size() - 1)) + 5);
  const auto designs = Evaluate(request);
  ASSERT_TRUE(designs.ok()) << designs.status();
  ASSERT_EQ(designs->size(), 2u);
  EXPECT_EQ((*designs)[0].faults_size(), 0);
  ASSERT_GT((*designs)[1].faults_size(), 0);
  EXPECT_THAT((*designs)[1].faults(0), HasSubstr("has lost"));
}

TEST_F(AssemblyServiceTest, ExportsEveryPart) {
  const auto samples = Sample(1, 3);
  ASSERT_TRUE(samples.ok()) << samples.status();
  v1::ExportAssemblyRequest request;
  request.set_name(kShelf);
  *request.mutable_q() = samples->front().q();
  std::map<v1::ExportDesignRequest::Format, std::string> files;
  for (const auto format : {v1::ExportDesignRequest::STEP, v1::ExportDesignRequest::GLB}) {
    request.set_format(format);
    grpc::ClientContext context;
    testing::Prepare(context);
    const auto reader = stub_->ExportAssembly(&context, request);
    v1::Chunk chunk;
    while (reader->Read(&chunk)) files[format] += chunk.data();
    const grpc::Status status = reader->Finish();
    ASSERT_TRUE(status.ok()) << status.error_message();
  }
  EXPECT_EQ(files[v1::ExportDesignRequest::GLB].substr(0, 4), "glTF");
  const auto step = cad::ReadStep(files[v1::ExportDesignRequest::STEP]);
  ASSERT_TRUE(step.ok()) << step.status();
  ASSERT_EQ(step->parts.size(), static_cast<std::size_t>(samples->front().parts_size()));
  for (const v1::PlacedPart& placed : samples->front().parts()) {
    const auto found = std::find_if(step->parts.begin(), step->parts.end(),
                                    [&](const auto& part) { return part.name == placed.name(); });
    ASSERT_NE(found, step->parts.end()) << placed.name();
    const cad::StepPart& read = *found;
    const Eigen::Vector3d middle =
        0.5 * Eigen::Vector3d(placed.minimum().x() + placed.maximum().x(),
                              placed.minimum().y() + placed.maximum().y(),
                              placed.minimum().z() + placed.maximum().z());
    EXPECT_LT(((read.minimum + read.maximum) / 2 - middle).norm(), 1e-6) << placed.name();
  }
}

// What a person would write beside the STEP file of an assembly to get it back.
v1::AssemblyAnnotations AnnotationsFor(const v1::Assembly& assembly,
                                       const cad::StepAssembly& drawing, const std::string& name) {
  v1::AssemblyAnnotations annotations;
  annotations.set_name(name);
  annotations.set_title(assembly.title());
  *annotations.mutable_joints() = assembly.joints();
  for (const v1::AssemblyPart& part : assembly.parts()) {
    v1::PartAnnotation& annotation = *annotations.add_parts();
    for (const cad::StepPart& drawn : drawing.parts) {
      // "post", or "post 1.2" of a part that is repeated.
      const bool is_repetition =
          part.repeat_size() > 0 && drawn.name.starts_with(part.name() + " ") &&
          drawn.name.find_first_not_of("0123456789.", part.name().size() + 1) == std::string::npos;
      if (drawn.name == part.name() || is_repetition) annotation.add_parts(drawn.name);
    }
    annotation.set_item(part.item());
    annotation.set_role(part.role());
    annotation.set_length_axis(part.length_axis() == v1::AXIS_UNSPECIFIED ? v1::X
                                                                          : part.length_axis());
    annotation.set_thickness_axis(
        part.thickness_axis() == v1::AXIS_UNSPECIFIED ? v1::Z : part.thickness_axis());
    if (annotation.parts_size() == 1) {
      *annotation.mutable_prominent_planes() = part.prominent_planes();
    }
  }
  return annotations;
}

// What is exported and imported again is the same design, and can be changed to the same.
TEST_F(AssemblyServiceTest, ImportsTheStepItExports) {
  for (const char* name : {kShelf, "assemblies/toy-chest", "assemblies/planter"}) {
    const std::string step = Export(name);
    const auto drawing = cad::ReadStep(step);
    ASSERT_TRUE(drawing.ok()) << drawing.status();
    const std::string copy = std::string(name) + "-copy";
    const auto imported = ImportStep(step, AnnotationsFor(Get(name), *drawing, copy));
    ASSERT_TRUE(imported.ok()) << imported.status();
    EXPECT_EQ(imported->assembly().revision(), 1);
    const v1::Parametrization drawn = ParametrizationOf(name);
    const v1::Parametrization again = ParametrizationOf(copy);
    EXPECT_EQ(again.elements_size(), drawn.elements_size()) << name;
    EXPECT_EQ(again.contacts_size(), drawn.contacts_size()) << name;
    EXPECT_EQ(again.nodes_size(), drawn.nodes_size()) << name;
    EXPECT_EQ(again.degrees_of_freedom(), drawn.degrees_of_freedom()) << name;
    EXPECT_EQ(again.rest_poses_size(), drawn.rest_poses_size()) << name;
    ASSERT_EQ(again.sizes_size(), drawn.sizes_size()) << name;
    std::map<std::string, v1::MeasureRange> ranges;
    const auto key = [](const v1::Measure& measure) {
      return measure.element() + "." + std::to_string(measure.axis());
    };
    for (const v1::MeasureRange& range : drawn.sizes()) ranges[key(range.measure())] = range;
    for (const v1::MeasureRange& range : again.sizes()) {
      const v1::MeasureRange& before = ranges[key(range.measure())];
      EXPECT_NEAR(range.drawn(), before.drawn(), 1e-6) << key(range.measure());
      EXPECT_NEAR(range.minimum(), before.minimum(), 1e-6) << key(range.measure());
      EXPECT_NEAR(range.maximum(), before.maximum(), 1e-6) << key(range.measure());
    }
    // The tree, too, goes the same way again.
    const auto twice = cad::ReadStep(Export(copy));
    ASSERT_TRUE(twice.ok()) << twice.status();
    ASSERT_EQ(twice->parts.size(), drawing->parts.size()) << name;
    std::map<std::string, const cad::StepPart*> parts;
    for (const cad::StepPart& part : drawing->parts) {
      parts[cad::PathOf(*drawing, part.group, part.name)] = &part;
    }
    for (const cad::StepPart& part : twice->parts) {
      const auto before = parts.find(cad::PathOf(*twice, part.group, part.name));
      ASSERT_NE(before, parts.end()) << part.name;
      EXPECT_LT((part.minimum - before->second->minimum).norm(), 1e-6) << part.name;
      EXPECT_LT((part.maximum - before->second->maximum).norm(), 1e-6) << part.name;
      EXPECT_NEAR(part.volume, before->second->volume, 1e-6 * part.volume) << part.name;
    }
  }
}

TEST_F(AssemblyServiceTest, ImportsStepWithoutAnnotationsAndRepeatsItself) {
  v1::AssemblyAnnotations annotations;
  annotations.set_name("assemblies/bare");
  const std::string step = Export(kShelf);
  const auto imported = ImportStep(step, annotations);
  ASSERT_TRUE(imported.ok()) << imported.status();
  EXPECT_EQ(imported->assembly().title(), "bookshelf");
  EXPECT_THAT(imported->notes(), Contains(HasSubstr("without an item")));
  EXPECT_GT(ParametrizationOf("assemblies/bare").sizes_size(), 0);
  EXPECT_EQ(ImportStep(step, annotations).status().code(), absl::StatusCode::kAborted);
  const auto same = ImportStep(step, annotations, 1);
  ASSERT_TRUE(same.ok()) << same.status();
  EXPECT_EQ(same->assembly().revision(), 1) << "nothing has changed";
}

TEST_F(AssemblyServiceTest, RefusesStepThatIsDamagedAndLives) {
  const std::string step = Export(kShelf);
  v1::AssemblyAnnotations annotations;
  annotations.set_name("assemblies/damaged");
  EXPECT_EQ(DetailOf(ImportStep("", annotations).status()).field, "step");
  EXPECT_EQ(DetailOf(ImportStep(step.substr(0, step.size() / 2), annotations).status()).field,
            "step");
  EXPECT_EQ(DetailOf(ImportStep("\x1f\x8b no gzip", annotations).status()).field, "step");
  // References to what is not there, over which the kernel crashes.
  std::string dangling = step;
  const std::size_t last = dangling.rfind("CARTESIAN_POINT");
  const std::size_t line = dangling.rfind('\n', last) + 1;
  dangling.erase(line, dangling.find(';', line) + 1 - line);
  const absl::Status refused = ImportStep(dangling, annotations).status();
  if (!refused.ok()) {
    EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument) << refused;
    EXPECT_EQ(DetailOf(refused).field, "step");
  }
  annotations.add_parts()->add_parts("nobody");
  annotations.mutable_parts(0)->set_item("items/none");
  annotations.add_joints()->set_group("nowhere");
  annotations.set_tolerance(-1);
  std::vector<std::string> fields;
  for (const FieldViolation& violation : ViolationsOf(ImportStep(step, annotations).status())) {
    fields.push_back(violation.field);
  }
  for (const char* field : {"annotations.parts[0].parts[0]", "annotations.joints[0].group",
                            "annotations.joints[0].kind", "annotations.tolerance"}) {
    EXPECT_THAT(fields, Contains(field));
  }
  EXPECT_GT(Get(kShelf).parts_size(), 3) << "the catalog still serves";
}

TEST_F(AssemblyServiceTest, KeepsRevisionsAndTellsOfThem) {
  v1::Assembly shelf = Get(kShelf);
  const auto same = Import(shelf, 1);
  ASSERT_TRUE(same.ok()) << same.status();
  EXPECT_EQ(same->revision(), 1) << "nothing has changed";
  shelf.set_title("Another bookshelf");
  const auto second = Import(shelf, 1);
  ASSERT_TRUE(second.ok()) << second.status();
  EXPECT_EQ(second->revision(), 2);
  const absl::Status stale = Import(shelf, 1).status();
  EXPECT_EQ(stale.code(), absl::StatusCode::kAborted);
  EXPECT_EQ(DetailOf(stale).reason, "STALE_REVISION");

  process_.Kill();
  process_.Start();
  Connect();
  EXPECT_EQ(Get(kShelf).title(), "Another bookshelf");
  EXPECT_NE(Get(kShelf, 1).title(), "Another bookshelf");

  const auto events = v1::EventService::NewStub(process_.channel());
  v1::FollowEventsRequest follow;
  follow.add_type_prefixes("assembly.imported");
  grpc::ClientContext context;
  testing::Prepare(context);
  const auto reader = events->FollowEvents(&context, follow);
  v1::Event event;
  bool told = false;
  while (!told && reader->Read(&event)) {
    told = event.subject() == kShelf && event.data().find("\"revision\":2") != std::string::npos;
  }
  EXPECT_TRUE(told);
  context.TryCancel();
}

TEST_F(AssemblyServiceTest, ReportsEverythingThatIsWrongAndStoresNothing) {
  v1::Assembly broken = Get(kShelf);
  broken.set_name("assemblies/broken");
  broken.mutable_parts(0)->set_item("items/nothing-like-it");
  broken.mutable_parts(1)->set_group("nowhere");
  broken.mutable_parts(2)->set_name("");
  const absl::Status refused = Import(broken, 0).status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument);
  std::vector<std::string> fields;
  for (const FieldViolation& violation : ViolationsOf(refused)) {
    fields.push_back(violation.field);
  }
  for (const char* field :
       {"assembly.parts[0].item", "assembly.parts[1].group", "assembly.parts[2].name"}) {
    EXPECT_THAT(fields, Contains(field));
  }

  v1::Assembly loose = Get(kShelf);
  loose.set_name("assemblies/loose");
  v1::AssemblyPart& lamp = *loose.add_parts();
  lamp = loose.parts(0);
  lamp.set_name("lamp");
  lamp.clear_repeat();
  lamp.mutable_position()->set_z(10);
  const absl::Status unbounded = Import(loose, 0).status();
  EXPECT_EQ(DetailOf(unbounded).reason, "FEASIBLE_SET_UNBOUNDED") << unbounded;
  EXPECT_THAT(std::string(unbounded.message()), HasSubstr("'lamp'"));

  for (const char* name : {"assemblies/broken", "assemblies/loose"}) {
    v1::GetAssemblyRequest request;
    request.set_name(name);
    EXPECT_EQ(Call(&Stub::GetAssembly, request).status().code(), absl::StatusCode::kNotFound);
  }
}

TEST_F(AssemblyServiceTest, NamesTheFieldAtFault) {
  const auto field = [](const absl::Status& status) {
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
    return DetailOf(status).field;
  };
  EXPECT_EQ(field(Sample(0, 1).status()), "count");
  EXPECT_EQ(field(Sample(1001, 1).status()), "count");
  v1::EvaluateAssemblyRequest evaluate;
  evaluate.set_name(kShelf);
  EXPECT_EQ(field(Evaluate(evaluate).status()), "points");
  *evaluate.add_points()->mutable_q() = Parametrized().q();
  evaluate.add_points()->add_q(1);
  EXPECT_EQ(field(Evaluate(evaluate).status()), "points[1].q");
  *evaluate.mutable_points(1)->mutable_q() = evaluate.points(0).q();
  evaluate.mutable_points(1)->set_q(3, -1);
  EXPECT_EQ(field(Evaluate(evaluate).status()), "points[1].q");

  v1::AdjustAssemblyRequest adjust;
  adjust.set_name(kShelf);
  adjust.add_demands()->mutable_measure()->set_element("nothing");
  EXPECT_EQ(field(Call(&Stub::AdjustAssembly, adjust).status()), "demands[0].measure.element");
  adjust.mutable_demands(0)->set_value(std::numeric_limits<double>::infinity());
  EXPECT_EQ(field(Call(&Stub::AdjustAssembly, adjust).status()), "demands[0].value");
  adjust.clear_demands();
  adjust.add_q(1);
  EXPECT_EQ(field(Call(&Stub::AdjustAssembly, adjust).status()), "q");
  v1::ParametrizeAssemblyRequest parametrize;
  parametrize.set_name("bookshelf");
  EXPECT_EQ(field(Call(&Stub::ParametrizeAssembly, parametrize).status()), "name");
  v1::ExportAssemblyRequest format;
  format.set_name(kShelf);
  grpc::ClientContext context;
  testing::Prepare(context);
  const auto reader = stub_->ExportAssembly(&context, format);
  v1::Chunk chunk;
  EXPECT_FALSE(reader->Read(&chunk));
  EXPECT_EQ(field(rpc::FromGrpc(reader->Finish())), "format");
}

TEST_F(AssemblyServiceTest, ItemsOfAssembliesStay) {
  const auto catalog = v1::CatalogService::NewStub(process_.channel());
  v1::DeleteItemRequest request;
  request.set_request_id("delete-1");
  request.set_name(Get(kShelf).parts(0).item());
  request.set_revision(1);
  v1::DeleteItemResponse response;
  grpc::ClientContext context;
  testing::Prepare(context);
  const absl::Status kept = rpc::FromGrpc(catalog->DeleteItem(&context, request, &response));
  EXPECT_EQ(DetailOf(kept).reason, "ITEM_IN_USE") << kept;
}

}  // namespace
}  // namespace mortise::catalog
