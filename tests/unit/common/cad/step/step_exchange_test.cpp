// STEP assemblies: what is written is what is read, by us and by the kernel's plain reader; damaged
// and misleading files are refused, and kill nobody.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepGProp.hxx>
#include <BRep_Builder.hxx>
#include <GProp_GProps.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Pln.hxx>
#include <map>
#include <random>
#include <set>
#include <sstream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "common/base/errors.h"
#include "common/cad/cylinder.h"
#include "common/cad/step/step_document.h"
#include "common/cad/step/step_isolation.h"
#include "common/cad/step/step_reader.h"
#include "common/cad/step/step_writer.h"
#include "tests/unit/common/cad/step/step_samples.h"

namespace mortise::cad {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr StepUnit kUnits[] = {StepUnit::kMillimetre, StepUnit::kMetre, StepUnit::kInch};

std::string Written(const StepAssembly& assembly, StepUnit unit = StepUnit::kMillimetre) {
  const auto bytes = WriteStep(assembly, unit);
  EXPECT_TRUE(bytes.ok()) << bytes.status();
  return bytes.value_or("");
}

StepAssembly ReadBack(const std::string& bytes) {
  auto assembly = ReadStep(bytes);
  EXPECT_TRUE(assembly.ok()) << assembly.status();
  return assembly.ok() ? *std::move(assembly) : StepAssembly();
}

const StepPart& PartOf(const StepAssembly& assembly, const std::string& path) {
  static const StepPart none;
  for (const StepPart& part : assembly.parts) {
    if (PathOf(assembly, part.group, part.name) == path) return part;
  }
  ADD_FAILURE() << "no part " << path;
  return none;
}

std::set<std::string> Paths(const StepAssembly& assembly) {
  std::set<std::string> paths;
  for (const StepPart& part : assembly.parts) {
    paths.insert(PathOf(assembly, part.group, part.name));
  }
  return paths;
}

// Count, names, tree, placement to 1 µm and volume to a millionth.
void ExpectSame(const StepAssembly& read, const StepAssembly& other) {
  EXPECT_EQ(read.name, other.name);
  EXPECT_EQ(read.parts.size(), other.parts.size());
  EXPECT_EQ(read.groups.size(), other.groups.size());
  EXPECT_EQ(read.products.size(), other.products.size());
  EXPECT_EQ(Paths(read), Paths(other));
  for (const StepPart& part : other.parts) {
    const std::string path = PathOf(other, part.group, part.name);
    const StepPart& again = PartOf(read, path);
    const Eigen::Isometry3d here = PlacementOf(read, again.group) * again.placement;
    const Eigen::Isometry3d there = PlacementOf(other, part.group) * part.placement;
    EXPECT_LT((here.translation() - there.translation()).norm(), 1e-6) << path;
    EXPECT_LT((here.linear() - there.linear()).norm(), 1e-9) << path;
    EXPECT_NEAR(again.volume, part.volume, 1e-6 * part.volume) << path;
    EXPECT_LT((again.minimum - part.minimum).norm(), 1e-6) << path;
    EXPECT_LT((again.maximum - part.maximum).norm(), 1e-6) << path;
    EXPECT_EQ(again.is_box, part.is_box) << path;
  }
}

TEST(StepExchange, KeepsTheTreeInAnyUnit) {
  const StepAssembly stand = Stand();
  for (const StepUnit unit : kUnits) {
    const StepAssembly read = ReadBack(Written(stand, unit));
    EXPECT_EQ(read.name, "stand");
    EXPECT_EQ(Paths(read), Paths(stand));
    EXPECT_EQ(read.products.size(), 3u) << "a product is written once";
    for (const StepPart& part : stand.parts) {
      const StepPart& again = PartOf(read, PathOf(stand, part.group, part.name));
      const Eigen::Isometry3d here = PlacementOf(read, again.group) * again.placement;
      const Eigen::Isometry3d there = PlacementOf(stand, part.group) * part.placement;
      EXPECT_LT((here.translation() - there.translation()).norm(), 1e-7) << part.name;
      EXPECT_LT((here.linear() - there.linear()).norm(), 1e-9) << part.name;
      const double volume = stand.products[static_cast<std::size_t>(part.product)].solid->Volume();
      EXPECT_NEAR(again.volume, volume, 1e-6 * volume) << part.name;
    }
    for (const StepUnit second : kUnits) ExpectSame(ReadBack(Written(read, second)), read);
  }
}

// The kernel takes a name for empty in which nothing is ASCII.
TEST(StepExchange, KeepsNamesInAnyScript) {
  StepAssembly shelf;
  shelf.name = "棚";
  shelf.groups = {{"棚", -1}, {"左", 0}};
  shelf.products = {{"板", Box("板", 0.4, 0.2, 0.018), std::nullopt},
                    {"post", Box("post", 0.04, 0.04, 0.3), std::nullopt}};
  const std::vector<std::string> names = {"板", "柱", "ä", "Brett ä", "棚板 2"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    AddPart(shelf, names[i], static_cast<int>(i % 2), static_cast<int>(i / 3),
            At(0, 0, 0.5 * static_cast<double>(i)));
  }
  const std::string bytes = Written(shelf);
  const StepAssembly read = ReadBack(bytes);
  EXPECT_EQ(read.name, "棚");
  EXPECT_EQ(Paths(read), Paths(shelf));
  EXPECT_EQ(read.products.front().name, "板");
  ExpectSame(ReadBack(Written(read)), read);
  // As other programs write it, whose ids are numbers.
  const std::string numbered = absl::StrReplaceAll(
      bytes,
      {{"OCCURRENCE('柱','柱'", "OCCURRENCE('7','柱'"}, {"PRODUCT('板','板'", "PRODUCT('8','板'"}});
  ASSERT_NE(numbered, bytes);
  EXPECT_EQ(Paths(ReadBack(numbered)), Paths(shelf));
  // Blanks are no name.
  const StepAssembly blank = ReadBack(absl::StrReplaceAll(bytes, {{"'Brett ä'", "'  '"}}));
  EXPECT_TRUE(Paths(blank).contains("左/post") || Paths(blank).contains("左/part")) << "nameless";
}

TEST(StepExchange, MeasuresBoxesInTheAssemblysFrame) {
  const StepAssembly read = ReadBack(Written(Stand()));
  const StepPart& rear = PartOf(read, "left/rear post");
  EXPECT_TRUE(rear.is_box);
  EXPECT_LT((rear.minimum - Eigen::Vector3d(0.1, 0.6, 0)).norm(), 1e-9);
  EXPECT_LT((rear.maximum - Eigen::Vector3d(0.138, 0.689, 0.7)).norm(), 1e-9);
  const StepPart& lying = PartOf(read, "lying post");
  EXPECT_TRUE(lying.is_box) << "a quarter turn";
  EXPECT_LT((lying.maximum - lying.minimum - Eigen::Vector3d(0.7, 0.089, 0.038)).norm(), 1e-9);
  const StepPart& turned = PartOf(read, "right/turned post");
  EXPECT_FALSE(turned.is_box);
  const double c = std::cos(0.3), s = std::sin(0.3);
  EXPECT_NEAR((turned.maximum - turned.minimum).x(), 0.038 * c + 0.089 * s, 1e-9);
  EXPECT_NEAR((turned.maximum - turned.minimum).y(), 0.038 * s + 0.089 * c, 1e-9);
  const StepPart& stop = PartOf(read, "stop");
  EXPECT_FALSE(stop.is_box);
  EXPECT_LT((stop.minimum - Eigen::Vector3d(0.495, 0.495, 0)).norm(), 1e-7);
  EXPECT_LT((stop.maximum - Eigen::Vector3d(0.505, 0.505, 0.04)).norm(), 1e-7);
  // A cylinder of radius r and height h, tilted, has the width h |sin| + 2 r |cos| along each axis.
  const StepPart& pin = PartOf(read, "right/bracket/pin");
  const Eigen::Vector3d along =
      (PlacementOf(read, pin.group) * pin.placement).linear().col(2).cwiseAbs();
  for (int axis = 0; axis < 3; ++axis) {
    const double width = 0.04 * along[axis] + 0.01 * std::sqrt(1 - along[axis] * along[axis]);
    EXPECT_NEAR((pin.maximum - pin.minimum)[axis], width, 1e-6);
  }
}

TEST(StepExchange, KeepsColorsUnitAndSchema) {
  const StepAssembly read = ReadBack(Written(Stand(), StepUnit::kInch));
  EXPECT_EQ(read.length_unit, "INCH");
  EXPECT_THAT(read.schema, HasSubstr("AP242"));
  const StepPart& post = PartOf(read, "left/front post");
  const auto& color = read.products[static_cast<std::size_t>(post.product)].color;
  ASSERT_TRUE(color.has_value());
  EXPECT_LT((*color - Eigen::Vector3d(0.5, 0.25, 0.125)).norm(), 1e-3);
  ASSERT_TRUE(PartOf(read, "stop").color.has_value());
  EXPECT_LT((*PartOf(read, "stop").color - Eigen::Vector3d(1, 0, 0)).norm(), 1e-3);
  const StepPart& angle = PartOf(read, "right/bracket/angle");
  EXPECT_FALSE(read.products[static_cast<std::size_t>(angle.product)].color.has_value());
}

// The kernel's reader that knows nothing of names and trees finds the same solids.
TEST(StepExchange, AnotherReaderFindsTheSameVolumes) {
  const StepAssembly read = ReadBack(Written(Stand()));
  std::multiset<long> ours, theirs;  // mm³
  for (const StepPart& part : read.parts) ours.insert(std::lround(part.volume * 1e9));
  STEPControl_Reader reader;
  std::istringstream bytes(Written(Stand(), StepUnit::kInch));
  ASSERT_EQ(reader.ReadStream("stand", bytes), IFSelect_RetDone);
  reader.TransferRoots();
  const TopoDS_Shape shape = reader.OneShape();
  for (TopExp_Explorer solid(shape, TopAbs_SOLID); solid.More(); solid.Next()) {
    GProp_GProps properties;
    BRepGProp::VolumeProperties(solid.Current(), properties);
    theirs.insert(std::lround(properties.Mass()));
  }
  EXPECT_EQ(ours, theirs);
}

TEST(StepExchange, MakesNamesDistinctAndSaysSo) {
  StepAssembly stand = Stand();
  stand.parts[0].name = stand.parts[1].name = "post";
  stand.parts[2].name = "NAUO7";
  stand.parts[3].name = "post 1";
  stand.groups[1].name = stand.groups[2].name = "frame";
  const StepAssembly read = ReadBack(Written(stand));
  EXPECT_THAT(Paths(read), ::testing::UnorderedElementsAre(
                               "frame 1/post 2", "frame 1/post 3", "frame 2/post 4", "post 1",
                               "frame 2/bracket/angle", "frame 2/bracket/pin", "stop"));
  EXPECT_EQ(PartOf(read, "frame 2/post 4").drawn_name, "post") << "its product's name";
  EXPECT_THAT(read.notes,
              ElementsAre("'frame' occurs 2 times; they are called 'frame 1' to 'frame 2'",
                          "'post' occurs 3 times; they are called 'post 2' to 'post 4'"));
  ExpectSame(ReadBack(Written(read)), read);
}

TEST(StepExchange, NamesAreDistinctShortAndInOneLine) {
  const std::string umlauts = absl::StrReplaceAll(std::string(40, 'u'), {{"u", "ü"}});
  const std::vector<std::string> names =
      DistinctNames({"", "a\nb", "a b", umlauts, umlauts + "!", " x ", "x"}, "part");
  EXPECT_THAT(names,
              ElementsAre("part", "a b 1", "a b 2", ::testing::_, ::testing::_, "x 1", "x 2"));
  for (const std::string& name : names) EXPECT_LE(name.size(), 63u);
  EXPECT_TRUE(names[3].ends_with("ü 1")) << names[3];
  StepAssembly stand = Stand();
  stand.parts[6].name = "Füße 'rechts' \\ 3";
  stand.name = "Ständer";
  const StepAssembly read = ReadBack(Written(stand));
  EXPECT_EQ(read.parts[6].name, "Füße 'rechts' \\ 3");
  EXPECT_EQ(read.name, "Ständer");
}

// A flat assembly of one board and of a product that the kernel's shape is.
StepAssembly BoardAnd(const std::string& name, const TopoDS_Shape& shape) {
  auto kernel = std::make_shared<Solid::Kernel>();
  kernel->name = name;
  kernel->shape = shape;
  StepAssembly flat;
  flat.name = "flat";
  flat.groups = {{"flat", -1}};
  flat.products = {{"board", Box("board", 0.1, 0.2, 0.3), std::nullopt},
                   {name, Solid(std::move(kernel)), std::nullopt}};
  AddPart(flat, "board", 0, 0, At(0, 0, 0));
  AddPart(flat, name, 0, 1, At(1, 0, 0));
  return flat;
}

TEST(StepExchange, AProductOfSeveralSolidsIsSeveralParts) {
  TopoDS_Compound pair;
  BRep_Builder builder;
  builder.MakeCompound(pair);
  builder.Add(pair, Box("a", 0.1, 0.1, 0.1).kernel().shape);
  builder.Add(pair, Box("b", 0.1, 0.1, 0.2).kernel().shape.Moved(ToLocation(At(0, 0, 0.5))));
  const StepAssembly read = ReadBack(Written(BoardAnd("pair", pair)));
  EXPECT_THAT(Paths(read), ::testing::UnorderedElementsAre("board", "pair 1", "pair 2"));
  EXPECT_LT((PartOf(read, "pair 1").minimum - Eigen::Vector3d(1, 0, 0)).norm(), 1e-9);
  EXPECT_LT((PartOf(read, "pair 2").maximum - Eigen::Vector3d(1.1, 0.1, 0.7)).norm(), 1e-9);
  EXPECT_THAT(read.notes, ::testing::Contains("product 'pair' has 2 solids; each is a part"));
  ExpectSame(ReadBack(Written(read)), read);
}

TEST(StepExchange, WhatIsNoSolidIsNoPart) {
  const StepAssembly read = ReadBack(
      Written(BoardAnd("skin", BRepBuilderAPI_MakeFace(gp_Pln(), 0, 0.1, 0, 0.1).Shape())));
  EXPECT_THAT(Paths(read), ElementsAre("board"));
  ASSERT_EQ(read.leaves.size(), 1u);
  EXPECT_EQ(read.leaves[0].name, "skin");
  EXPECT_TRUE(read.leaves[0].is_surface);
  StepAssembly alone = BoardAnd("skin", BRepBuilderAPI_MakeFace(gp_Pln(), 0, 1, 0, 1).Shape());
  alone.parts.erase(alone.parts.begin());
  const absl::Status refused = ReadStep(Written(alone)).status();
  EXPECT_THAT(std::string(refused.message()), HasSubstr("holds no solid"));
}

TEST(StepExchange, WritesOnlyWhatHasAShape) {
  StepAssembly stand = Stand();
  stand.products[1].solid.reset();
  EXPECT_EQ(DetailOf(WriteStep(stand).status()).field, "parts[4].product");
}

TEST(Cylinder, IsRoundOrElliptic) {
  CylinderShape shape;
  shape.name = "pin";
  shape.center = {0.1, 0.2, 0.3};
  shape.u = Eigen::Vector3d::UnitY();
  shape.v = Eigen::Vector3d::UnitZ();
  shape.radius_u = 0.01;
  shape.height = 0.2;
  for (const double radius : {0.01, 0.005, 0.02}) {
    shape.radius_v = radius;
    const auto solid = MakeCylinder(shape);
    ASSERT_TRUE(solid.ok()) << solid.status();
    const double volume = std::numbers::pi * shape.radius_u * radius * shape.height;
    EXPECT_NEAR(solid->Volume(), volume, 1e-9 * volume);
    EXPECT_LT((solid->CentreOfMass() - Eigen::Vector3d(0.2, 0.2, 0.3)).norm(), 1e-9);
    EXPECT_THAT(solid->face_names(), ElementsAre("side", "base", "cap"));
    StepAssembly one;
    one.name = "one";
    one.groups = {{"one", -1}};
    one.products = {{"pin", *solid, std::nullopt}};
    AddPart(one, "pin", 0, 0, At(0, 0, 0));
    const StepAssembly read = ReadBack(Written(one));
    ASSERT_EQ(read.parts.size(), 1u);
    EXPECT_NEAR(read.parts[0].volume, volume, 1e-6 * volume);
    EXPECT_LT((read.parts[0].minimum - Eigen::Vector3d(0.1, 0.19, 0.3 - radius)).norm(), 1e-7);
    EXPECT_LT((read.parts[0].maximum - Eigen::Vector3d(0.3, 0.21, 0.3 + radius)).norm(), 1e-7);
  }
  shape.radius_v = 0;
  EXPECT_EQ(DetailOf(MakeCylinder(shape).status()).field, "radius_v");
  shape.radius_v = 0.01;
  shape.height = NAN;
  EXPECT_EQ(DetailOf(MakeCylinder(shape).status()).field, "height");
  shape.u = shape.v;
  EXPECT_EQ(DetailOf(MakeCylinder(shape).status()).field, "u");
}

// ---- Files that are refused ---------------------------------------------------------------------

// A file of products without shapes, and of which consists of which, from 1.
std::string Products(int count, const std::vector<std::pair<int, int>>& usages) {
  std::string text =
      "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n"
      "FILE_NAME('','',(''),(''),'','','');\n"
      "FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n"
      "#1=APPLICATION_CONTEXT('');\n#2=PRODUCT_CONTEXT('',#1,'mechanical');\n"
      "#3=PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design');\n";
  int id = 10;
  for (int i = 1; i <= count; ++i, id += 3) {
    absl::StrAppend(&text, "#", id, "=PRODUCT('p", i, "','p", i, "','',(#2));\n#", id + 1,
                    "=PRODUCT_DEFINITION_FORMATION('','',#", id, ");\n#", id + 2,
                    "=PRODUCT_DEFINITION('','',#", id + 1, ",#3);\n");
  }
  for (const auto& [whole, part] : usages) {
    absl::StrAppend(&text, "#", id++, "=NEXT_ASSEMBLY_USAGE_OCCURRENCE('','','',#",
                    12 + 3 * (whole - 1), ",#", 12 + 3 * (part - 1), ",$);\n");
  }
  return text + "ENDSEC;\nEND-ISO-10303-21;\n";
}

std::string Refusal(std::string_view bytes, absl::StatusCode code) {
  const absl::Status status = ReadStep(bytes).status();
  EXPECT_EQ(status.code(), code) << status;
  EXPECT_EQ(DetailOf(status).field, "step");
  return std::string(status.message());
}

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
constexpr auto kTooLarge = absl::StatusCode::kResourceExhausted;

TEST(StepReader, SaysWhatTheFileIsNot) {
  const std::string whole = Written(Stand());
  EXPECT_THAT(Refusal("", kInvalid), HasSubstr("is empty"));
  EXPECT_THAT(Refusal(" \n", kInvalid), HasSubstr("is empty"));
  EXPECT_THAT(Refusal("solid cube\nendsolid", kInvalid), HasSubstr("is not a STEP file"));
  EXPECT_THAT(Refusal(whole.substr(0, whole.size() / 2), kInvalid), HasSubstr("is cut off"));
  EXPECT_THAT(Refusal(whole.substr(0, whole.size() - 20), kInvalid), HasSubstr("is cut off"));
  EXPECT_THAT(Refusal(Products(3, {{1, 2}, {1, 3}}), kInvalid), HasSubstr("holds no"));
}

TEST(StepReader, SaysInPlainWordsWhatItDoesNotUnderstand) {
  const auto faults = [](const std::string& bytes) {
    std::vector<std::string> seen;
    const auto read = ReadStep(bytes, [&](const std::vector<std::string>& all) { seen = all; });
    return absl::StrJoin(seen, "\n");
  };
  const std::string whole = Written(Stand());
  EXPECT_EQ(faults(whole), "");
  // Another standard's types, as of a building model.
  EXPECT_EQ(faults(absl::StrReplaceAll(whole, {{"PLANE(", "IFCPLANE("}})),
            "it has entities of types that are not known here, such as IFCPLANE; AP203, AP214 and "
            "AP242 are read");
  const std::size_t at = whole.find("CARTESIAN_POINT('',(") + 20;
  std::string letters = whole;
  letters.replace(at, 1, "x");
  EXPECT_THAT(faults(letters),
              AllOf(HasSubstr("(coordinates) is not such a value"), Not(HasSubstr("Real"))));
}

TEST(StepReader, RefusesProductsThatContainThemselves) {
  EXPECT_THAT(Refusal(Products(1, {{1, 1}}), kInvalid), HasSubstr("'p1' contains 'p1'"));
  EXPECT_THAT(Refusal(Products(4, {{1, 2}, {2, 3}, {3, 4}, {4, 2}}), kInvalid),
              HasSubstr("'p2' contains 'p3' contains 'p4' contains 'p2'"));
  std::vector<std::pair<int, int>> chain;
  for (int i = 1; i < 20'000; ++i) chain.emplace_back(i, i + 1);
  chain.emplace_back(20'000, 1);
  EXPECT_THAT(Refusal(Products(20'000, chain), kInvalid), HasSubstr("goes in a circle"));
}

TEST(StepReader, OpensNoOtherFiles) {
  const std::string reference =
      "#900=DOCUMENT_TYPE('geometry');\n"
      "#901=DOCUMENT_FILE('other.stp','','',#900,'',$);\n"
      "#902=IDENTIFICATION_ROLE('external document id and location',$);\n"
      "#903=EXTERNAL_SOURCE(IDENTIFIER('/etc/passwd'));\n"
      "#904=APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT('other.stp',#902,#903,(#901));\n"
      "#905=PRODUCT('elsewhere','elsewhere','',(#2));\n"
      "#906=PRODUCT_DEFINITION_FORMATION('','',#905);\n"
      "#907=PRODUCT_DEFINITION_WITH_ASSOCIATED_DOCUMENTS('','',#906,#3,(#901));\n";
  const std::string file =
      absl::StrReplaceAll(Products(2, {{1, 2}}), {{"#10=", reference + "#10="}});
  EXPECT_THAT(Refusal(file, kInvalid), HasSubstr("parts in other files"));
}

TEST(StepReader, RefusesMorePartsThanAnAssemblyMayHave) {
  // Ten of ten of ten …: a short file of ten thousand million parts.
  std::vector<std::pair<int, int>> usages;
  for (int level = 1; level <= 10; ++level) usages.insert(usages.end(), 10, {level, level + 1});
  EXPECT_THAT(Refusal(Products(11, usages), kTooLarge), HasSubstr("2000 parts"));
  EXPECT_THAT(Refusal(std::string(kMaxStepBytes + 1, ' '), kTooLarge), HasSubstr("64 MiB"));
}

// ---- In a process of its own --------------------------------------------------------------------

TEST(StepIsolation, TellsTheSameAsInProcess) {
  const std::string bytes = Written(Stand());
  const auto read = ReadStepInChild(bytes);
  ASSERT_TRUE(read.ok()) << read.status();
  const StepAssembly here = ReadBack(bytes);
  ExpectSame(*read, here);
  EXPECT_EQ(read->length_unit, here.length_unit);
  EXPECT_EQ(read->schema, here.schema);
  EXPECT_EQ(read->notes, here.notes);
  EXPECT_EQ(read->parts[6].color, here.parts[6].color);
  EXPECT_FALSE(read->products[0].solid.has_value());
  for (const std::string& bad :
       {std::string(), bytes.substr(0, 3000), Products(1, {{1, 1}}), std::string("x")}) {
    const absl::Status refused = ReadStepInChild(bad).status();
    EXPECT_EQ(refused, ReadStep(bad).status());
  }
}

TEST(StepIsolation, TellsHowManySolidsAreRead) {
  std::vector<std::pair<std::size_t, std::size_t>> told;
  StepChildOptions options;
  options.progress = [&](std::size_t done, std::size_t total) { told.emplace_back(done, total); };
  const auto read = ReadStepInChild(Written(Stand()), options);
  ASSERT_TRUE(read.ok()) << read.status();
  ASSERT_EQ(told.size(), read->parts.size());
  for (std::size_t i = 0; i < told.size(); ++i) {
    EXPECT_EQ(told[i], std::pair(i + 1, read->parts.size()));
  }
}

TEST(StepIsolation, IsGivenUpWhenNobodyWaits) {
  StepChildOptions options;
  options.is_given_up = [] { return true; };
  EXPECT_TRUE(absl::IsCancelled(ReadStepInChild(Written(Stand()), options).status()));
}

TEST(StepIsolation, OutlivesDamagedFiles) {
  const std::string whole = Written(Stand());
  const std::size_t data = whole.find("DATA;");
  std::mt19937 random(5);
  int refused = 0;
  for (int i = 0; i < 40; ++i) {
    std::string damaged = whole;
    for (int k = 0; k <= i % 4; ++k) {
      const std::size_t at = data + 10 + random() % (whole.size() - data - 60);
      if (i % 2 == 0) {
        damaged[at] = "(),;#'$*0E."[random() % 11];
      } else {
        const std::size_t line = damaged.find('\n', at) + 1;
        damaged.erase(line, damaged.find('\n', line) + 1 - line);
      }
    }
    const auto read = ReadStepInChild(damaged);
    if (read.ok()) continue;
    ++refused;
    EXPECT_EQ(read.status().code(), kInvalid) << read.status();
    EXPECT_EQ(DetailOf(read.status()).field, "step");
  }
  EXPECT_GT(refused, 0);
}

TEST(StepIsolation, SaysThatTheChildCannotBeStarted) {
  StepChildOptions options;
  options.program = "/nonexistent/program";
  EXPECT_EQ(ReadStepInChild("x", options).status().code(), absl::StatusCode::kInternal);
}

}  // namespace
}  // namespace mortise::cad

int main(int argc, char** argv) {
  if (argc == 2 && std::string_view(argv[1]) == mortise::cad::kStepChildArgument) {
    return mortise::cad::RunStepChild();
  }
  ::testing::InitGoogleMock(&argc, argv);
  return RUN_ALL_TESTS();
}
