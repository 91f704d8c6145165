// Assemblies to STEP and back through the catalog as a process, and STEP that is damaged.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/cad/step/step_reader.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "tests/integration/services/catalog/assembly_service_fixture.h"

namespace mortise::catalog {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class AssemblyStepTest : public AssemblyServiceTest {
 protected:
  std::string Export(const std::string& name,
                     v1::ExportDesignRequest::Format format = v1::ExportDesignRequest::STEP) {
    v1::ExportAssemblyRequest request;
    request.set_name(name);
    request.set_format(format);
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
};

TEST_F(AssemblyStepTest, ExportsEveryPart) {
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

// What ships with a shape looks like that in every file, and the shape itself can be had.
TEST_F(AssemblyStepTest, ExportsPegsAsPegs) {
  const auto catalog = v1::CatalogService::NewStub(process_.channel());
  v1::GetItemRequest item;
  item.set_name("items/shaker-peg-75");
  const auto peg = testing::Call(*catalog, &v1::CatalogService::Stub::GetItem, item);
  ASSERT_TRUE(peg.ok()) << peg.status();
  v1::DownloadShapeRequest download;
  download.set_name(peg->shape());
  grpc::ClientContext context;
  testing::Prepare(context);
  const auto bytes = testing::ReadChunks(*catalog->DownloadShape(&context, download));
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  v1::Shape shape;
  ASSERT_TRUE(shape.ParseFromString(*bytes));
  EXPECT_TRUE(shape.exact());
  EXPECT_FALSE(shape.brep().empty());
  EXPECT_GT(shape.triangle_count(), 500);

  const auto step = cad::ReadStep(Export("assemblies/coat-rack"));
  ASSERT_TRUE(step.ok()) << step.status();
  int pegs = 0;
  for (const cad::StepPart& part : step->parts) {
    if (!part.name.starts_with("peg ") || part.name.find("dowel") != std::string::npos) continue;
    ++pegs;
    SCOPED_TRACE(part.name);
    EXPECT_NEAR(part.volume, shape.volume(), 1e-6 * shape.volume());
    EXPECT_FALSE(part.is_box);
  }
  EXPECT_EQ(pegs, 6);
  // Three indices of four bytes a triangle, besides the vertices.
  const std::string glb = Export("assemblies/coat-rack", v1::ExportDesignRequest::GLB);
  EXPECT_GT(glb.size(), 6U * 12U * static_cast<std::size_t>(shape.triangle_count()));
}

// "hinge" of "hinge 2": products that would be called alike are numbered.
std::string Unnumbered(const std::string& product) {
  const std::size_t end = product.find_last_not_of("0123456789");
  return end < product.size() - 1 && product[end] == ' ' ? product.substr(0, end) : product;
}

// What is bought is one product under its item's name, however its parts are turned.
TEST_F(AssemblyStepTest, MakesOneProductOfPartsOfOneItem) {
  const auto catalog = v1::CatalogService::NewStub(process_.channel());
  const std::string name = "assemblies/cabinet";
  const auto step = cad::ReadStep(Export(name));
  ASSERT_TRUE(step.ok()) << step.status();
  std::set<std::string> names;
  for (const cad::StepProduct& product : step->products) {
    EXPECT_TRUE(names.insert(product.name).second) << product.name << " twice";
  }
  std::map<std::string, std::string> items;  // by part
  const v1::Parametrization parametrized = ParametrizationOf(name);
  for (const v1::ParametricElement& element : parametrized.elements()) {
    for (const std::string& part : element.parts()) items[part] = element.item();
  }
  std::map<std::string, bool> is_bought;                         // by item
  std::map<std::string, std::vector<Eigen::Matrix3d>> turns_of;  // by product
  for (const cad::StepPart& part : step->parts) {
    const std::string& item = items[part.name];
    const std::string& product = step->products[static_cast<std::size_t>(part.product)].name;
    if (is_bought.count(item) == 0) {
      v1::GetItemRequest request;
      request.set_name(item);
      const auto found = testing::Call(*catalog, &v1::CatalogService::Stub::GetItem, request);
      ASSERT_TRUE(found.ok()) << found.status();
      is_bought[item] = std::all_of(
          found->dimensions().begin(), found->dimensions().end(),
          [](const auto& dimension) { return dimension.process() == v1::PROCESS_UNSPECIFIED; });
    }
    if (is_bought[item]) {
      EXPECT_EQ("items/" + Unnumbered(product), item) << part.name;
    } else if (turns_of.count(product) == 0) {
      EXPECT_THAT(part.name, StartsWith(Unnumbered(product))) << "the first of the product";
    }
    std::vector<Eigen::Matrix3d>& turns = turns_of[product];
    const Eigen::Matrix3d turn = part.placement.linear();
    if (std::none_of(turns.begin(), turns.end(),
                     [&](const auto& other) { return other.isApprox(turn, 1e-9); })) {
      turns.push_back(turn);
    }
  }
  EXPECT_TRUE(std::any_of(turns_of.begin(), turns_of.end(),
                          [](const auto& turns) { return turns.second.size() > 1; }));
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
TEST_F(AssemblyStepTest, ImportsTheStepItExports) {
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

TEST_F(AssemblyStepTest, ImportsStepWithoutAnnotationsAndRepeatsItself) {
  v1::AssemblyAnnotations annotations;
  annotations.set_name("assemblies/bare");
  const std::string step = Export(kShelf);
  const auto imported = ImportStep(step, annotations);
  ASSERT_TRUE(imported.ok()) << imported.status();
  EXPECT_EQ(imported->assembly().title(), Get(kShelf).title());
  EXPECT_THAT(imported->notes(), Contains(HasSubstr("without an item")));
  EXPECT_GT(ParametrizationOf("assemblies/bare").sizes_size(), 0);
  EXPECT_EQ(ImportStep(step, annotations).status().code(), absl::StatusCode::kAborted);
  const auto same = ImportStep(step, annotations, 1);
  ASSERT_TRUE(same.ok()) << same.status();
  EXPECT_EQ(same->assembly().revision(), 1) << "nothing has changed";
}

// Of a design without annotations, STEP keeps how everything is called, whatever the signs.
TEST_F(AssemblyStepTest, KeepsTitlesAndNamesOfGroupsAndParts) {
  const std::vector<std::string> names = {"Größe \"L\" / 桌子", "it's 'quoted'", "naïve\\path\\",
                                          "\\X2\\00E4\\X0\\",   ":#12=",         "3"};
  v1::ImportAssemblyRequest request;
  request.set_request_id("names");
  v1::Assembly& assembly = *request.mutable_assembly();
  assembly.set_name("assemblies/names");
  assembly.set_title("Möbel „Größe \"L\"“, it's \\ 桌子\nfür alle");
  for (std::size_t i = 0; i < names.size(); ++i) {
    v1::AssemblyGroup& group = *assembly.add_groups();
    group.set_name(names[i]);
    if (i > 0) group.set_parent(names[(i - 1) / 2]);
    v1::AssemblyPart& part = *assembly.add_parts();
    part.set_name("part " + names[i]);
    part.set_group(names[i]);
    part.mutable_size()->set_x(1);
    part.mutable_size()->set_y(0.1 * static_cast<double>(i + 1));
    part.mutable_size()->set_z(0.1);
    part.mutable_position()->set_z(0.1 * static_cast<double>(i));
  }
  ASSERT_TRUE(Call(&Stub::ImportAssembly, request).ok());
  v1::AssemblyAnnotations annotations;
  annotations.set_name("assemblies/names-copy");
  const auto imported = ImportStep(Export("assemblies/names"), annotations);
  ASSERT_TRUE(imported.ok()) << imported.status();
  const v1::Assembly copy = Get("assemblies/names-copy");
  EXPECT_EQ(copy.title(), "Möbel „Größe \"L\"“, it's \\ 桌子 für alle");
  std::map<std::string, std::string> parents, groups;
  for (const v1::AssemblyGroup& group : copy.groups()) parents[group.name()] = group.parent();
  for (const v1::AssemblyPart& part : copy.parts()) groups[part.name()] = part.group();
  for (const v1::AssemblyGroup& group : assembly.groups()) {
    ASSERT_EQ(parents.count(group.name()), 1U) << group.name();
    EXPECT_EQ(parents[group.name()], group.parent()) << group.name();
  }
  for (const v1::AssemblyPart& part : assembly.parts()) {
    EXPECT_EQ(groups[part.name()], part.group()) << part.name();
  }
  annotations.set_name("assemblies/names-again");
  ASSERT_TRUE(ImportStep(Export("assemblies/names-copy"), annotations).ok());
  EXPECT_EQ(Get("assemblies/names-again").digest(), copy.digest()) << "only the name differs";
}

TEST_F(AssemblyStepTest, RefusesStepThatIsDamagedAndLives) {
  const std::string step = Export(kShelf);
  v1::AssemblyAnnotations annotations;
  annotations.set_name("assemblies/damaged");
  EXPECT_EQ(DetailOf(ImportStep("", annotations).status()).field, "step");
  EXPECT_EQ(DetailOf(ImportStep(step.substr(0, step.size() / 2), annotations).status()).field,
            "step");
  EXPECT_EQ(DetailOf(ImportStep("\x1f\x8b no gzip", annotations).status()).field, "step");
  // A point that edges refer to is not there.
  std::string dangling = step;
  const std::size_t last = dangling.rfind("CARTESIAN_POINT");
  const std::size_t line = dangling.rfind('\n', last) + 1;
  const std::string number = dangling.substr(line, dangling.find_first_of(" =", line) - line);
  dangling.erase(line, dangling.find(';', line) + 1 - line);
  const absl::Status refused = ImportStep(dangling, annotations).status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument) << refused;
  EXPECT_EQ(DetailOf(refused).field, "step");
  EXPECT_THAT(std::string(refused.message()), HasSubstr(number + " is used by #"));
  annotations.add_parts()->add_parts("nobody");
  annotations.mutable_parts(0)->set_item("items/none");
  annotations.add_joints()->set_group("nowhere");
  annotations.set_tolerance(-1);
  std::vector<std::string> fields;
  for (const FieldViolation& violation : ViolationsOf(ImportStep(step, annotations, -1).status())) {
    fields.push_back(violation.field);
  }
  for (const char* field :
       {"expected_revision", "annotations.parts[0].parts[0]", "annotations.joints[0].group",
        "annotations.joints[0].kind", "annotations.tolerance"}) {
    EXPECT_THAT(fields, Contains(field));
  }
  // Numbers that are none are told with all else.
  annotations.set_tolerance(std::numeric_limits<double>::quiet_NaN());
  annotations.mutable_joints(0)->set_upper(std::numeric_limits<double>::infinity());
  fields.clear();
  for (const FieldViolation& violation : ViolationsOf(ImportStep(step, annotations).status())) {
    fields.push_back(violation.field);
  }
  for (const char* field :
       {"annotations.parts[0].parts[0]", "annotations.parts[0].item", "annotations.joints[0].group",
        "annotations.joints[0].kind", "annotations.joints[0].upper", "annotations.tolerance"}) {
    EXPECT_EQ(std::count(fields.begin(), fields.end(), field), 1) << field;
  }
  EXPECT_GT(Get(kShelf).parts_size(), 3) << "the catalog still serves";
}

}  // namespace
}  // namespace mortise::catalog
