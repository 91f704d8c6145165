// Meshes as assemblies: their parts, and what automatic parametrisation makes of them.
#include "services/catalog/exchange/mesh_drawing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "common/assembly/codec/parametrization_codec.h"
#include "common/base/errors.h"
#include "common/mesh/scenes/scene.h"
#include "services/catalog/exchange/assembly_import.h"
#include "services/catalog/records/shape_records.h"
#include "tests/support/box_scenes.h"

namespace mortise::catalog {
namespace {

using testing::Box;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::OneComponent;
using testing::OpenBox;
using testing::TableParts;

constexpr double kMetre = 1;

mesh::Scene Table() { return OneComponent(TableParts()); }

absl::StatusOr<v1::AssemblyBundle> BundleOf(const cad::StepAssembly& drawing) {
  v1::AssemblyAnnotations annotations;
  annotations.set_name("assemblies/mesh");
  annotations.set_tolerance(ToleranceOfMesh(drawing));
  const DrawnAssembly drawn = MakeAssembly(drawing, annotations, {});
  MORTISE_RETURN_IF_ERROR(AtRequest(drawn, annotations, absl::OkStatus()));
  v1::AssemblyBundle bundle;
  *bundle.mutable_assembly() = drawn.assembly;
  for (const mesh::DrawnShape& shape : drawing.shapes) *bundle.add_shapes() = NamedShape(shape);
  return bundle;
}

absl::StatusOr<std::shared_ptr<const parametric::ParametricAssembly>> ParametricOf(
    mesh::Scene scene, const MeshDrawingOptions& options = {.unit = kMetre}) {
  MORTISE_ASSIGN_OR_RETURN(const cad::StepAssembly drawing,
                           DrawingOfScene(std::move(scene), "mesh", options));
  MORTISE_ASSIGN_OR_RETURN(const v1::AssemblyBundle bundle, BundleOf(drawing));
  return parametric::Parametrize(bundle);
}

std::ptrdiff_t Count(const parametric::ParametricAssembly& assembly,
                     parametric::RelationshipKind kind) {
  const auto& all = assembly.relationships();
  return std::count_if(all.begin(), all.end(),
                       [&](const parametric::Relationship& each) { return each.kind == kind; });
}

TEST(DrawingOfScene, PlacesPartsWithTheirShapes) {
  const auto drawing = DrawingOfScene(Table(), "Table", {.unit = kMetre});
  ASSERT_TRUE(drawing.ok()) << drawing.status();
  EXPECT_EQ(drawing->name, "Table");
  ASSERT_EQ(drawing->parts.size(), 5u);
  EXPECT_EQ(drawing->parts[0].name, "part 1");
  EXPECT_EQ(drawing->parts[0].shape, -1);  // the top fills its box
  ASSERT_EQ(drawing->shapes.size(), 1u);   // that all legs have
  for (std::size_t leg = 1; leg < 5; ++leg) {
    EXPECT_EQ(drawing->parts[leg].shape, 0);
    EXPECT_TRUE((drawing->parts[leg].maximum - drawing->parts[leg].minimum)
                    .isApprox(Eigen::Vector3d(0.05, 0.05, 0.7), 1e-9));
  }
  EXPECT_FALSE(drawing->shapes[0].is_solid);
  EXPECT_THAT(drawing->notes, Contains(HasSubstr("only a surface")));
}

TEST(DrawingOfScene, TakesUnitAndUpAsSaidOrGuessesThem) {
  const auto table = [] { return mesh::Scaled(Table(), 100); };
  const auto guessed = DrawingOfScene(table(), "t");
  ASSERT_TRUE(guessed.ok()) << guessed.status();
  EXPECT_THAT(guessed->notes, ::testing::Each(::testing::Not(HasSubstr("guess"))));
  mesh::Scene unknown = table();
  unknown.unit.reset();
  const auto centimetres = DrawingOfScene(unknown, "t");
  ASSERT_TRUE(centimetres.ok()) << centimetres.status();
  EXPECT_THAT(centimetres->notes, Contains(HasSubstr("centimetres")));
  EXPECT_NEAR(centimetres->parts[0].maximum.z(), 0.74, 1e-9);
  const auto turned = DrawingOfScene(unknown, "t", {.up = mesh::UpAxis::kY, .unit = 0.01});
  ASSERT_TRUE(turned.ok()) << turned.status();
  EXPECT_NEAR(turned->parts[0].maximum.z(), 0.7, 1e-9);
}

TEST(DrawingOfScene, MakesGroupsOfComponentsOfSeveralParts) {
  mesh::Scene scene;
  const auto parts = TableParts();
  scene.components = {parts[0], OneComponent({parts.begin() + 1, parts.end()}).components[0]};
  scene.components[1].name = "legs";
  const auto drawing = DrawingOfScene(scene, "Table", {.unit = kMetre});
  ASSERT_TRUE(drawing.ok()) << drawing.status();
  ASSERT_EQ(drawing->groups.size(), 2u);
  EXPECT_EQ(drawing->groups[1].name, "legs");
  EXPECT_EQ(drawing->parts[0].name, "top");
  EXPECT_EQ(drawing->parts[1].name, "legs 1");
  EXPECT_EQ(drawing->parts[1].group, 1);
  const auto assembly = ParametricOf(scene);
  ASSERT_TRUE(assembly.ok()) << assembly.status();
}

// What a table needs to stay one: its legs are found to be mirror images, and grow with it.
TEST(MeshAssembly, KeepsTheLegsOfATable) {
  const auto made = ParametricOf(Table());
  ASSERT_TRUE(made.ok()) << made.status();
  const parametric::ParametricAssembly& table = **made;
  EXPECT_GT(Count(table, parametric::RelationshipKind::kSymmetric), 0);
  EXPECT_GT(Count(table, parametric::RelationshipKind::kCoplanar), 0);
  const auto wider = table.Adjust(
      table.drawn(),
      {{{"part 1", parametric::Axis::kX}, 1.8}, {{"part 2", parametric::Axis::kZ}, 0.5}},
      parametric::DemandPolicy::kStrict);
  ASSERT_TRUE(wider.ok()) << wider.status();
  const auto faults = table.FaultsAt(wider->q);
  ASSERT_TRUE(faults.ok()) << faults.status();
  EXPECT_THAT(*faults, IsEmpty());
  for (const parametric::PlacedPart& part : table.PartsAt(wider->q)) {
    if (part.name == "part 1") continue;
    EXPECT_NEAR(part.box.size().z(), 0.5, 1e-6) << part.name;
  }
}

// A bench of seven open slats on two bearers: more of them where it is longer.
TEST(MeshAssembly, FindsRowsOfPartsThatAreAlike) {
  std::vector<mesh::SceneComponent> parts = {Box("", {0, 0.05, 0.36}, {1.4, 0.05, 0.04}),
                                             Box("", {0, 0.35, 0.36}, {1.4, 0.05, 0.04})};
  for (int slat = 0; slat < 7; ++slat) {
    parts.push_back(OpenBox("", {0.2 * slat, 0, 0.4}, {0.15, 0.45, 0.02}));
  }
  const auto made = ParametricOf(OneComponent(parts));
  ASSERT_TRUE(made.ok()) << made.status();
  const auto& elements = (*made)->elements();
  const auto row = std::find_if(elements.begin(), elements.end(),
                                [](const auto& element) { return element.pattern.has_value(); });
  ASSERT_NE(row, elements.end());
  EXPECT_EQ(row->parts.size(), 7u);
}

// The same bench, with a lath that only the first slat comes near.
TEST(MeshAssembly, FindsRowsOfWhichOnePartAloneHasAGap) {
  std::vector<mesh::SceneComponent> parts = {Box("", {0, 0.05, 0.36}, {1.4, 0.05, 0.04}),
                                             Box("", {0, 0.35, 0.36}, {1.4, 0.05, 0.04}),
                                             Box("", {-0.051, 0, 0.36}, {0.05, 0.45, 0.06})};
  for (int slat = 0; slat < 7; ++slat) {
    parts.push_back(OpenBox("", {0.2 * slat, 0, 0.4}, {0.15, 0.45, 0.02}));
  }
  const auto drawing = DrawingOfScene(OneComponent(parts), "bench", {.unit = kMetre});
  ASSERT_TRUE(drawing.ok()) << drawing.status();
  for (std::size_t slat = 4; slat < 10; ++slat) {
    const Eigen::Vector3d size = drawing->parts[slat].maximum - drawing->parts[slat].minimum;
    EXPECT_TRUE(size.isApprox(drawing->parts[3].maximum - drawing->parts[3].minimum, 1e-12));
  }
}

// A post with a bow at its side, every triangle of which is drawn twice, to be seen from both
// sides.
TEST(MeshAssembly, HasASheetOfTwoSidesAsOnePart) {
  constexpr int kPieces = 12;
  mesh::SceneComponent bow{"", Eigen::Matrix3Xd(3, 2 * kPieces + 2),
                           Eigen::Matrix3Xi(3, 4 * kPieces)};
  for (int i = 0; i <= kPieces; ++i) {
    const double angle = 0.5 * std::numbers::pi * i / kPieces;
    const Eigen::Vector3d at(0.1 + 0.5 * std::sin(angle), 0.55 - 0.5 * std::cos(angle), 0.5);
    bow.vertices.middleCols<2>(2 * i) << at, at + Eigen::Vector3d(0, 0, 0.2);
  }
  for (int i = 0; i < kPieces; ++i) {
    bow.triangles.middleCols<4>(4 * i) << 0, 1, 0, 1, 2, 2, 1, 3, 1, 3, 2, 2;
    bow.triangles.middleCols<4>(4 * i).array() += 2 * i;
  }
  const mesh::Scene scene = OneComponent({Box("", {0, 0, 0}, {0.1, 0.1, 1}), bow});
  const auto drawing = DrawingOfScene(scene, "bow", {.unit = kMetre});
  ASSERT_TRUE(drawing.ok()) << drawing.status();
  EXPECT_EQ(drawing->parts.size(), 2u);
  const auto made = ParametricOf(scene);
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_EQ((*made)->contacts().size(), 1u);
}

TEST(MeshAssembly, GoesOnTouchingWhatItNearlyTouches) {
  std::vector<mesh::SceneComponent> parts = TableParts();
  for (std::size_t leg = 1; leg < parts.size(); ++leg) {
    parts[leg] = testing::Moved(parts[leg], {0, 0, -0.0005});
  }
  const auto made = ParametricOf(OneComponent(parts));
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_EQ((*made)->contacts().size(), 4u);
}

// Solids in a row, each of which has one corner in common with the next. Their sides lie nearly in
// planes of each other, which become one plane and take the corners along.
TEST(MeshAssembly, GoesOnTouchingWhereCornersDo) {
  std::mt19937 random(5);
  const auto near = [&](int low, int high) {
    const double jitter = 6e-6 * std::uniform_real_distribution<double>(-1, 1)(random);
    return 0.1 * std::uniform_int_distribution<int>(low, high)(random) + jitter;
  };
  for (int round = 0; round < 20; ++round) {
    constexpr int kSolids = 5;
    std::vector<Eigen::Vector3d> joints;
    for (int i = 0; i <= kSolids; ++i) joints.emplace_back(0.3 * i, near(1, 4), near(1, 4));
    std::vector<mesh::SceneComponent> solids;
    for (int i = 0; i < kSolids; ++i) {
      mesh::SceneComponent solid{"", Eigen::Matrix3Xd(3, 4), Eigen::Matrix3Xi(3, 4)};
      solid.vertices << joints[static_cast<std::size_t>(i)],
          joints[static_cast<std::size_t>(i) + 1],
          Eigen::Vector3d(0.3 * i + 0.1, near(0, 0), near(0, 1)),
          Eigen::Vector3d(0.3 * i + 0.2, near(4, 5), near(5, 5));
      solid.triangles << 0, 0, 0, 1, 2, 1, 3, 2, 1, 3, 2, 3;
      solids.push_back(std::move(solid));
    }
    const auto made = ParametricOf(OneComponent(solids));
    ASSERT_TRUE(made.ok()) << "round " << round << ": " << made.status();
    const auto& contacts = (*made)->contacts();
    for (int i = 0; i + 1 < kSolids; ++i) {
      EXPECT_THAT(contacts, Contains(std::pair(i, i + 1))) << "round " << round;
    }
  }
}

TEST(DrawingOfScene, SaysWhatIsWrongWithAMesh) {
  const auto refusal = [](const mesh::Scene& scene, const MeshDrawingOptions& options = {}) {
    const auto drawing = DrawingOfScene(scene, "t", options);
    EXPECT_EQ(DetailOf(drawing.status()).field, options.most_parts == 0 ? "most_parts" : "file");
    return std::string(drawing.status().message());
  };
  EXPECT_THAT(refusal({}), HasSubstr("no triangle"));
  EXPECT_THAT(refusal(mesh::Scaled(Table(), 1e-5)), HasSubstr("unit"));
  EXPECT_THAT(refusal(mesh::Scaled(Table(), 1e5)), HasSubstr("unit"));
  EXPECT_THAT(refusal(Table(), {.most_parts = 0}), HasSubstr("1 to 200"));
  mesh::Scene flat = OneComponent({Box("", {0, 0, 0}, {1, 1, 0})});
  EXPECT_THAT(refusal(flat), HasSubstr("flat"));
}

// Whatever triangles there are becomes an assembly, or is refused with the file's name.
TEST(MeshAssembly, IsMadeOfAnyBoxes) {
  std::mt19937 random(11);
  const auto number = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  for (int round = 0; round < 25; ++round) {
    std::vector<mesh::SceneComponent> parts;
    const int count = number(1, 9);
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d low = 0.1 * Eigen::Vector3d(number(0, 9), number(0, 9), number(0, 9));
      const Eigen::Vector3d size = 0.1 * Eigen::Vector3d(number(0, 4), number(1, 4), number(1, 4));
      parts.push_back(OpenBox("", low, size, number(0, 3)));
    }
    const auto drawing = DrawingOfScene(OneComponent(parts), "t", {.unit = kMetre});
    if (!drawing.ok()) {
      EXPECT_EQ(DetailOf(drawing.status()).field, "file") << drawing.status();
      continue;
    }
    const auto bundle = BundleOf(*drawing);
    ASSERT_TRUE(bundle.ok()) << bundle.status();
    const auto assembly = parametric::Parametrize(*bundle);
    EXPECT_TRUE(assembly.ok()) << "round " << round << ": " << assembly.status();
  }
}

}  // namespace
}  // namespace mortise::catalog
