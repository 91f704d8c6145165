// STEP as people send it: mirrored and scaled occurrences, files without units, contradictory
// solids, names in any encoding, bodies that are no solids, numbers that are none.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "common/base/errors.h"
#include "common/cad/step/step_reader.h"
#include "common/cad/step/step_writer.h"
#include "common/mesh/mass_properties.h"
#include "tests/unit/common/cad/step/step_files.h"
#include "tests/unit/common/cad/step/step_samples.h"

namespace mortise::cad {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

std::string Refusal(const std::string& bytes) {
  const absl::Status status = ReadStep(bytes).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
  EXPECT_EQ(DetailOf(status).field, "step");
  return std::string(status.message());
}

const StepPart& PartOf(const StepAssembly& assembly, const std::string& name) {
  static const StepPart none;
  for (const StepPart& part : assembly.parts) {
    if (part.name == name) return part;
  }
  ADD_FAILURE() << "no part " << name << " of " << assembly.parts.size();
  return none;
}

std::vector<std::string> NamesOf(const StepAssembly& assembly) {
  std::vector<std::string> names;
  for (const StepPart& part : assembly.parts) {
    names.push_back(PathOf(assembly, part.group, part.name));
  }
  return names;
}

// Where a part's surface stands, m.
mesh::SurfaceMesh SurfaceOf(const StepAssembly& assembly, const StepPart& part) {
  EXPECT_GE(part.shape, 0) << part.name << absl::StrJoin(part.faults, "; ");
  if (part.shape < 0) return {};
  const mesh::DrawnShape& shape = assembly.shapes[static_cast<std::size_t>(part.shape)];
  mesh::SurfaceMesh surface = mesh::SurfaceIn(shape, shape.size);
  surface.vertices.colwise() += (part.minimum + part.maximum) / 2;
  return surface;
}

// Whether one surface is the other, moved, corner by corner and with its outside outside.
void ExpectMoved(const mesh::SurfaceMesh& surface, const Eigen::Affine3d& motion,
                 const mesh::SurfaceMesh& moved) {
  ASSERT_EQ(moved.vertices.cols(), surface.vertices.cols());
  for (const auto& vertex : surface.vertices.colwise()) {
    const Eigen::Vector3d there = motion * Eigen::Vector3d(vertex);
    EXPECT_LT((moved.vertices.colwise() - there).colwise().norm().minCoeff(), 1e-7)
        << there.transpose();
  }
  const double scale = std::abs(motion.linear().determinant());
  EXPECT_NEAR(mesh::ComputeMassProperties(moved).volume,
              scale * mesh::ComputeMassProperties(surface).volume, 1e-12);
}

Eigen::Affine3d Similarity(const Eigen::Matrix3d& linear,
                           const Eigen::Vector3d& origin = {0, 0, 0}) {
  Eigen::Affine3d motion = Eigen::Affine3d::Identity();
  motion.linear() = linear;
  motion.translation() = origin;
  return motion;
}

Eigen::Matrix3d Diagonal(double x, double y, double z) {
  return Eigen::Vector3d(x, y, z).asDiagonal();
}

// ---- Mirrors and scales -------------------------------------------------------------------------

TEST(StepField, MirrorsAMappedItem) {
  const StepAssembly pair = Reading(FieldFile("mirror-mapped.step"));
  EXPECT_THAT(NamesOf(pair), UnorderedElementsAre("first", "second"));
  ExpectMoved(SurfaceOf(pair, PartOf(pair, "first")), Similarity(Diagonal(1, 1, -1)),
              SurfaceOf(pair, PartOf(pair, "second")));
  EXPECT_NE(PartOf(pair, "first").product, PartOf(pair, "second").product);
  EXPECT_NE(PartOf(pair, "first").shape, PartOf(pair, "second").shape);
  EXPECT_THAT(pair.notes, Contains(AllOf(HasSubstr("'second'"), HasSubstr("mirror image"))));
}

TEST(StepField, MirrorsAnOccurrence) {
  const StepAssembly pair = Reading(FieldFile("mirror-assembly.step"));
  EXPECT_THAT(NamesOf(pair), UnorderedElementsAre("right", "left"));
  ExpectMoved(SurfaceOf(pair, PartOf(pair, "right")), Similarity(Diagonal(-1, 1, 1)),
              SurfaceOf(pair, PartOf(pair, "left")));
  ASSERT_EQ(pair.products.size(), 2u);
  EXPECT_EQ(pair.products[0].name, "arm");
  EXPECT_EQ(pair.products[1].name, "arm");
  EXPECT_THAT(pair.notes,
              ElementsAre("'left' is a mirror image of 'arm', which cannot be made from "
                          "it by turning"));
}

// The operator of the field's assembly with other axes.
std::string WithAxes(const Eigen::Matrix3d& axes, const std::string& scale = "1.",
                     const std::string& origin = "0.,0.,0.") {
  const auto direction = [&](int i) {
    return absl::StrCat("DIRECTION('',(", axes(0, i), ",", axes(1, i), ",", axes(2, i), "))");
  };
  std::string bytes = FieldFile("mirror-assembly.step");
  bytes = Changed(bytes, "#227 = DIRECTION('',(-1.,0.,0.))", absl::StrCat("#227 = ", direction(0)));
  bytes = Changed(bytes, "#228 = DIRECTION('',(0.,1.,0.))", absl::StrCat("#228 = ", direction(1)));
  bytes = Changed(bytes, "#230 = DIRECTION('',(0.,0.,1.))", absl::StrCat("#230 = ", direction(2)));
  bytes = Changed(bytes, "#229 = CARTESIAN_POINT('',(0.,0.,0.))",
                  absl::StrCat("#229 = CARTESIAN_POINT('',(", origin, "))"));
  return Changed(bytes, "#229,1.,#230", absl::StrCat("#229,", scale, ",#230"));
}

TEST(StepField, PlacesByAnyOperator) {
  std::vector<Eigen::Matrix3d> all = {Diagonal(1, 1, 1),    Diagonal(-1, 1, 1),
                                      Diagonal(1, -1, 1),   Diagonal(1, 1, -1),
                                      Diagonal(-1, -1, -1), Diagonal(-1, -1, 1)};
  Eigen::Matrix3d swap;
  swap << 0, 1, 0, 1, 0, 0, 0, 0, 1;
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (const Eigen::Matrix3d& one :
       {swap, turn, Eigen::Matrix3d(turn * Diagonal(1, -1, 1)), Eigen::Matrix3d(turn * swap)}) {
    all.push_back(one);
  }
  for (const Eigen::Matrix3d& axes : all) {
    for (const double scale : {1.0, 0.5}) {
      SCOPED_TRACE(::testing::Message() << axes << "\nscale " << scale);
      const StepAssembly pair = Reading(WithAxes(axes, scale == 1 ? "1." : "0.5", "10.,-20.,30."));
      const StepPart& right = PartOf(pair, "right");
      const StepPart& left = PartOf(pair, "left");
      const Eigen::Affine3d motion = Similarity(scale * axes, Eigen::Vector3d(0.01, -0.02, 0.03));
      // The right one's shape is not turned; the left one's may have been.
      ExpectMoved(SurfaceOf(pair, right), motion, SurfaceOf(pair, left));
      EXPECT_NEAR(left.volume, scale * scale * scale * right.volume, 1e-9 * right.volume);
      EXPECT_EQ(left.product == right.product, axes.determinant() > 0 && scale == 1);
      EXPECT_EQ(pair.notes.empty(), axes.determinant() > 0 && scale == 1);
      if (scale != 1) {
        EXPECT_THAT(pair.notes, Contains(HasSubstr("0.5 times its size")));
      }
    }
  }
}

TEST(StepField, IsOneProductAtOneScaleHoweverItIsTurned) {
  std::string items, placed = "(#218";
  for (int i = 0; i < 12; ++i) {
    const Eigen::Matrix3d axes =
        Eigen::AngleAxisd(0.4 * i, Eigen::Vector3d(1, 2, 3).normalized()).matrix();
    const int number = 1000 + 10 * i;
    for (int axis = 0; axis < 3; ++axis) {
      absl::StrAppend(&items, "#", number + axis,
                      absl::StrFormat(" = DIRECTION('',(%.17g,%.17g,%.17g));\n", axes(0, axis),
                                      axes(1, axis), axes(2, axis)));
    }
    absl::StrAppend(&items, "#", number + 3, " = CARTESIAN_TRANSFORMATION_OPERATOR_3D('','','',#",
                    number, ",#", number + 1, ",#215,0.7,#", number + 2, ");\n#", number + 4,
                    " = MAPPED_ITEM('item ", i, "',#198,#", number + 3, ");\n");
    absl::StrAppend(&placed, ",#", number + 4);
  }
  const StepAssembly all =
      Reading(Changed(Changed(FieldFile("mirror-mapped.step"), "(#218,#209,#204)", placed + ")"),
                      "ENDSEC;\nEND-ISO", items + "ENDSEC;\nEND-ISO"));
  EXPECT_EQ(all.parts.size(), 12u);
  EXPECT_EQ(all.products.size(), 1u);
}

TEST(StepField, TakesOperatorsInTheFilesUnit) {
  const std::string millimetres = WithAxes(Diagonal(1, -1, 1), "1.", "10.,-20.,30.");
  const StepAssembly pair = Reading(Changed(millimetres, "SI_UNIT(.MILLI.,", "SI_UNIT(.CENTI.,"));
  ExpectMoved(SurfaceOf(pair, PartOf(pair, "right")),
              Similarity(Diagonal(1, -1, 1), Eigen::Vector3d(0.1, -0.2, 0.3)),
              SurfaceOf(pair, PartOf(pair, "left")));
}

TEST(StepField, OperatorsLeaveOutAxes) {
  // As the standard derives them: z is what is left out, whatever the others are.
  const std::string bytes = FieldFile("mirror-assembly.step");
  const StepAssembly mirrored =
      Reading(Changed(bytes, "#227,#228,#229,1.,#230", "#227,#228,#229,$,$"));
  ExpectMoved(SurfaceOf(mirrored, PartOf(mirrored, "right")), Similarity(Diagonal(-1, 1, 1)),
              SurfaceOf(mirrored, PartOf(mirrored, "left")));
  const StepAssembly same = Reading(Changed(bytes, "#227,#228,#229,1.,#230", "$,$,#229,$,$"));
  ExpectMoved(SurfaceOf(same, PartOf(same, "right")), Similarity(Diagonal(1, 1, 1)),
              SurfaceOf(same, PartOf(same, "left")));
}

TEST(StepField, RefusesOperatorsThatAreNone) {
  EXPECT_THAT(Refusal(WithAxes(Diagonal(-1, 1, 1), "-2.")),
              AllOf(HasSubstr("#231"), HasSubstr("scale of -2")));
  EXPECT_THAT(Refusal(WithAxes(Diagonal(-1, 1, 1), "0.")), HasSubstr("#231"));
  Eigen::Matrix3d flat = Diagonal(1, 1, 1);
  flat.col(1) = flat.col(0);
  EXPECT_THAT(Refusal(WithAxes(flat)), AllOf(HasSubstr("#231"), HasSubstr("span no frame")));
}

// Replaces the placement of an occurrence in what WriteStep writes by an operator.
std::string WithOperator(std::string bytes, const std::string& occurrence,
                         const std::string& axes) {
  bytes = absl::StrReplaceAll(bytes, {{"\n  ", ""}});  // a statement a line
  const auto number_before = [&](std::size_t at) {
    const std::size_t begin = bytes.rfind('#', at);
    return bytes.substr(begin, bytes.find_first_of(" =", begin) - begin);
  };
  const auto user_of = [&](const std::string& what) {
    const std::size_t at = bytes.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    const std::size_t begin = bytes.rfind(";\n#", at) + 2;
    return std::pair(number_before(bytes.find('=', begin)), begin);
  };
  const std::string usage = user_of(absl::StrCat(",'", occurrence, "','',#5,")).first;
  const std::string shape = user_of(absl::StrCat(",", usage, ");")).first;
  const std::size_t placed = user_of(absl::StrCat(",", shape, ");")).second;
  const std::size_t open = bytes.find('(', placed);
  const std::string relation = bytes.substr(open + 1, bytes.find(',', open) - open - 1);
  const std::size_t related = bytes.find(absl::StrCat("\n", relation, " ="));
  const std::size_t transformed = bytes.find("WITH_TRANSFORMATION(", related) + 20;
  bytes.replace(transformed, bytes.find(')', transformed) - transformed, "#90000");
  const std::size_t end = bytes.rfind("ENDSEC;");
  return bytes.insert(end,
                      absl::StrCat("#90000=CARTESIAN_TRANSFORMATION_OPERATOR_3D('','','',#90001,"
                                   "#90002,#90004,1.,#90003);\n#90004=CARTESIAN_POINT('',"
                                   "(100.,0.,0.));\n",
                                   axes));
}

constexpr char kMirrorX[] =
    "#90001=DIRECTION('',(-1.,0.,0.));\n#90002=DIRECTION('',(0.,1.,0.));\n"
    "#90003=DIRECTION('',(0.,0.,1.));\n";

TEST(StepField, MirrorsWholeSubAssemblies) {
  const StepAssembly stand = Stand();
  const auto bytes = WriteStep(stand);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  const StepAssembly straight = Reading(*bytes);
  const StepAssembly mirrored = Reading(WithOperator(*bytes, "right", kMirrorX));
  EXPECT_THAT(NamesOf(mirrored), ::testing::UnorderedElementsAreArray(NamesOf(straight)));
  // From where the group stood to where it is mirrored to.
  const Eigen::Affine3d motion = Similarity(Diagonal(-1, 1, 1), Eigen::Vector3d(0.1, 0, 0)) *
                                 PlacementOf(straight, 2).inverse();
  for (const char* name : {"turned post", "angle", "pin"}) {
    const StepPart& before = PartOf(straight, name);
    const StepPart& after = PartOf(mirrored, name);
    EXPECT_NEAR(after.volume, before.volume, 1e-9 * before.volume);
    const Eigen::Vector3d centre =
        mesh::ComputeMassProperties(SurfaceOf(straight, before)).centroid;
    Eigen::Vector3d there = (after.minimum + after.maximum) / 2;
    if (!after.is_box) there = mesh::ComputeMassProperties(SurfaceOf(mirrored, after)).centroid;
    EXPECT_LT((there - motion * centre).norm(), 1e-6) << name;
  }
  ExpectMoved(SurfaceOf(straight, PartOf(straight, "angle")), motion,
              SurfaceOf(mirrored, PartOf(mirrored, "angle")));
  // A post, a pin and an angle are their own mirror images: the products are the same.
  EXPECT_EQ(mirrored.products.size(), straight.products.size());
  EXPECT_THAT(mirrored.notes, IsEmpty());
}

TEST(StepField, WhatIsWrittenOfMirroredPartsIsReadAgain) {
  const StepAssembly pair = Reading(FieldFile("mirror-assembly.step"));
  const auto bytes = WriteStep(pair);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  const StepAssembly again = Reading(*bytes);
  for (const char* name : {"right", "left"}) {
    ExpectMoved(SurfaceOf(pair, PartOf(pair, name)), Similarity(Diagonal(1, 1, 1)),
                SurfaceOf(again, PartOf(again, name)));
  }
}

// ---- Units --------------------------------------------------------------------------------------

TEST(StepField, TakesMillimetresWhereNoUnitIs) {
  const StepAssembly board = Reading(FieldFile("no-unit.step"));
  ASSERT_EQ(board.parts.size(), 1u);
  const Eigen::Vector3d size = board.parts[0].maximum - board.parts[0].minimum;
  EXPECT_LT((size - Eigen::Vector3d(0.1, 0.05, 0.02)).norm(), 1e-9) << size.transpose();
  EXPECT_THAT(board.notes, Contains(AllOf(HasSubstr("unit of length"), HasSubstr("millimetres"))));
}

TEST(StepField, TakesMillimetresWhereOnlyAnglesHaveUnits) {
  const std::string bytes =
      Changed(FieldFile("latin1-names.step"), "CONTEXT((#5,#6,#7))", "CONTEXT((#6,#7))");
  const StepAssembly row = Reading(bytes);
  ASSERT_EQ(row.parts.size(), 2u);
  EXPECT_NEAR((row.parts[0].maximum - row.parts[0].minimum).x(), 0.01, 1e-9);
  EXPECT_THAT(row.notes, Contains(HasSubstr("millimetres")));
}

TEST(StepField, TellsOfUnitsThatAreNotWhatTheirNameSays) {
  const std::string millimetres = "#5 = ( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) );";
  const std::string inches = Changed(
      FieldFile("latin1-names.step"), millimetres,
      absl::StrCat("#5 = ( CONVERSION_BASED_UNIT('INCH',#901) LENGTH_UNIT() NAMED_UNIT(#902) );\n"
                   "#901 = LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#903);\n"
                   "#902 = DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);\n#903",
                   millimetres.substr(2)));
  const StepAssembly row = Reading(inches);
  EXPECT_NEAR((row.parts[0].maximum - row.parts[0].minimum).x(), 0.254, 1e-9);
  EXPECT_THAT(row.notes, ElementsAre(HasSubstr("Latin-1")));
  EXPECT_THAT(Reading(Changed(inches, "(25.4)", "(2.54)")).notes,
              Contains(AllOf(HasSubstr("INCH is 2.54 mm"), HasSubstr("not 25.4 mm"))));
}

// The kernel makes one of what is closer together than the file is accurate.
TEST(StepField, TakesNoFileForLessAccurateThanItCanBe) {
  const StepAssembly row = Reading(
      Changed(FieldFile("latin1-names.step"), "LENGTH_MEASURE(1.E-07)", "LENGTH_MEASURE(1.E+03)"));
  ASSERT_EQ(row.parts.size(), 2u);
  EXPECT_NEAR(row.parts[0].volume, 1e-6, 1e-12);
  EXPECT_THAT(row.notes, Contains(HasSubstr("accurate to 1000 mm only")));
}

// ---- Contradictions -----------------------------------------------------------------------------

TEST(StepField, TellsOfAPlaneThatMissesItsEdges) {
  const StepAssembly board = Reading(FieldFile("plane-5mm-off.step"));
  ASSERT_EQ(board.parts.size(), 1u);
  EXPECT_THAT(board.parts[0].faults, ElementsAre(AllOf(HasSubstr("contradict"), HasSubstr("mm"))));
  EXPECT_EQ(board.parts[0].name, "board");
}

TEST(StepField, TellsOfSmallContradictions) {
  const std::string bytes = FieldFile("plane-5mm-off.step");
  const StepAssembly sound = Reading(Changed(bytes, "(35.,0.,0.)", "(30.,0.,0.)"));
  EXPECT_THAT(sound.parts[0].faults, IsEmpty());
  EXPECT_THAT(sound.notes, IsEmpty());
  const StepAssembly near = Reading(Changed(bytes, "(35.,0.,0.)", "(30.004,0.,0.)"));
  EXPECT_THAT(near.parts[0].faults, IsEmpty());
  EXPECT_THAT(near.notes, ElementsAre(AllOf(HasSubstr("'board'"), HasSubstr("0.004 mm"))));
}

TEST(StepField, RefusesPointsOfFourCoordinates) {
  EXPECT_THAT(Refusal(FieldFile("four-coordinates.step")),
              AllOf(HasSubstr("#138"), HasSubstr("4 numbers"), HasSubstr("line 145")));
}

// ---- Names --------------------------------------------------------------------------------------

TEST(StepField, TakesNamesForLatin1) {
  const StepAssembly row = Reading(FieldFile("latin1-names.step"));
  EXPECT_THAT(NamesOf(row), UnorderedElementsAre("Gehäuse", "Straße"));
  EXPECT_EQ(row.products[0].name, "Gehäuse");
  EXPECT_THAT(row.notes, ElementsAre(AllOf(HasSubstr("Latin-1"), HasSubstr("'Gehäuse'"))));
}

TEST(StepField, TakesNamesForGb18030WhereThatFits) {
  const std::string bytes =
      absl::StrReplaceAll(FieldFile("latin1-names.step"), {{"Geh\xE4use", "\xB5\xD7\xB0\xE5"},
                                                           {"Stra\xDF"
                                                            "e",
                                                            "\xD7\xF3\xB2\xE0\xB0\xE5 2"}});
  const StepAssembly row = Reading(bytes);
  EXPECT_THAT(NamesOf(row), UnorderedElementsAre("底板", "左侧板 2"));
  EXPECT_THAT(row.notes, ElementsAre(AllOf(HasSubstr("GB18030"), HasSubstr("底板"))));
}

TEST(StepField, DecodesEscapedNames) {
  const std::string bytes = absl::StrReplaceAll(
      FieldFile("latin1-names.step"), {{"Geh\xE4use", "Geh\\X\\E4use \\X2\\68DA677F\\X0\\"},
                                       {"Stra\xDF"
                                        "e",
                                        "\\PA\\Stra\\S\\_e \\X4\\0001F600\\X0\\ it''s a \\\\ b"}});
  const StepAssembly row = Reading(bytes);
  EXPECT_THAT(NamesOf(row), UnorderedElementsAre("Gehäuse 棚板", "Straße 😀 it's a \\ b"));
  EXPECT_THAT(row.notes, IsEmpty());
}

TEST(StepField, SkipsAMarkOfUtf8AndNamesUtf16) {
  const StepAssembly brick = Reading(FieldFile("bom.step"));
  EXPECT_THAT(NamesOf(brick), UnorderedElementsAre("straight", "aslant"));
  EXPECT_THAT(brick.notes, IsEmpty());
  for (const bool is_marked : {true, false}) {
    for (const bool is_little : {true, false}) {
      std::string wide;
      if (is_marked) wide = is_little ? "\xFF\xFE" : "\xFE\xFF";
      for (const char c : FieldFile("nan.step")) {
        if (!is_little) wide += '\0';
        wide += c;
        if (is_little) wide += '\0';
      }
      EXPECT_THAT(Refusal(wide), HasSubstr("UTF-16"));
    }
  }
}

// ---- What is no solid ---------------------------------------------------------------------------

TEST(StepField, TellsOfAnOpenBodyBesideASolid) {
  const StepAssembly both = Reading(FieldFile("open-in-one.step"));
  EXPECT_THAT(NamesOf(both), ElementsAre("both"));
  EXPECT_THAT(both.notes, ElementsAre("'both': body #295 is open, so no solid, and is left out"));
}

TEST(StepField, TellsOfASurfaceBesideASolid) {
  const StepAssembly hybrid = Reading(FieldFile("hybrid.step"));
  EXPECT_THAT(NamesOf(hybrid), ElementsAre("hybrid"));
  EXPECT_THAT(hybrid.notes, ElementsAre("'hybrid': surface #208 is no solid and is left out"));
  EXPECT_THAT(Refusal(FieldFile("surface-only.step")),
              AllOf(HasSubstr("holds no solid"), HasSubstr("'plate' is a surface")));
}

TEST(StepField, TellsOfATessellatedBody) {
  const std::string bytes = Changed(
      FieldFile("hybrid.step"), "#208 = SHELL_BASED_SURFACE_MODEL('',(#206));",
      "#208 = TESSELLATED_SOLID('facets',(#900),$);\n#900 = "
      "TRIANGULATED_FACE('',#901,3,((0.,0.,1.)),"
      "$,(1,2,3),((1,2,3)));\n#901 = COORDINATES_LIST('',3,((0.,0.,0.),(1.,0.,0.),(0.,1.,0.)));");
  const StepAssembly hybrid = Reading(bytes);
  EXPECT_THAT(NamesOf(hybrid), ElementsAre("hybrid"));
  EXPECT_THAT(hybrid.notes, Contains(AllOf(HasSubstr("tessellated body"), HasSubstr("#208"))));
}

TEST(StepField, TellsOfAnOccurrenceWithoutPlacement) {
  std::string bytes = FieldFile("mirror-assembly.step");
  bytes = Changed(bytes, "#234 = CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#232,#233);", "");
  const StepAssembly pair = Reading(bytes);
  EXPECT_THAT(NamesOf(pair), ElementsAre("right"));
  EXPECT_THAT(pair.notes, Contains("'left' in 'pair' (#226) has no placement and is left out"));
}

TEST(StepField, TellsOfABodyOfNoProduct) {
  const std::string bytes =
      Changed(FieldFile("open-in-one.step"), "(#304,#157,#295)", "(#304,#295)");
  EXPECT_THAT(Refusal(bytes), AllOf(HasSubstr("holds no solid"), HasSubstr("#157")));
}

TEST(StepField, KeepsNamesOfPartsWithDatumCurves) {
  const StepAssembly two = Reading(FieldFile("datum-curve.step"));
  EXPECT_THAT(NamesOf(two), UnorderedElementsAre("left board", "right board"));
  ASSERT_EQ(two.products.size(), 1u);
  EXPECT_EQ(two.products[0].name, "board");
  EXPECT_EQ(two.groups.size(), 1u);
  EXPECT_THAT(two.leaves, IsEmpty());
  EXPECT_THAT(two.notes, IsEmpty());
}

// ---- Numbers that are none ----------------------------------------------------------------------

TEST(StepField, RefusesNumbersThatAreNone) {
  EXPECT_THAT(Refusal(FieldFile("nan.step")),
              AllOf(HasSubstr("#10, line 17"), HasSubstr("NAN is no finite number")));
  for (const char* number : {"nan", "-NaN", "Inf", "+INFINITY", "-inf", "1.#INF", "-1.#IND",
                             "1.#QNAN0", "1E400", "-1.E+999", "1.E13", "1.2.3", "0x10"}) {
    const std::string bytes = Changed(FieldFile("nan.step"), "NAN", number);
    EXPECT_THAT(Refusal(bytes), AllOf(HasSubstr("#10, line 17"), HasSubstr(number)));
  }
  // As far as the kernel goes, zero.
  const StepAssembly board = Reading(Changed(FieldFile("nan.step"), "NAN,0.", "30.,1.E-320"));
  EXPECT_THAT(board.parts[0].faults, IsEmpty());
}

TEST(StepField, RefusesEntitiesThatAreNone) {
  const std::string whole = Changed(FieldFile("nan.step"), "NAN", "30.");
  EXPECT_THAT(Refusal(Changed(whole, "#157 = MANIFOLD_SOLID_BREP('',#156)",
                              "#157 = MANIFOLD_SOLID_BREP('',#157)")),
              AllOf(HasSubstr("#157"), HasSubstr("refers to itself")));
  EXPECT_THAT(Refusal(Changed(whole, "#158 =", "#157 =")),
              HasSubstr("#157: is defined twice, in lines"));
  EXPECT_THAT(Refusal(Changed(whole, "(30.,0.,0.)",
                              std::string(5000, '(') + "30." + std::string(5000, ')'))),
              HasSubstr("lists in lists"));
  EXPECT_THAT(Refusal(whole.substr(0, whole.size() / 2)), HasSubstr("cut off"));
  EXPECT_THAT(Refusal(Changed(whole, "END-ISO-10303-21;", "")), HasSubstr("cut off"));
}

TEST(StepField, TellsOfFacesThatAreThereTwice) {
  std::string faces = "#55";
  for (int i = 0; i < 100; ++i) faces += ",#55";
  const std::string bytes = Changed(Changed(FieldFile("nan.step"), "NAN", "30."), "(#55,#87,",
                                    absl::StrCat("(", faces, ",#87,"));
  const StepAssembly board = Reading(bytes);
  EXPECT_THAT(NamesOf(board), ElementsAre("board"));
  EXPECT_THAT(board.notes, ElementsAre("'board': body #157 has lost 100 of its 106 faces"));
}

}  // namespace
}  // namespace mortise::cad
