// What a STEP file has and is no solid: told by name, never hushed by what else is in the file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "tests/unit/common/cad/step/step_files.h"

namespace mortise::cad {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

// A solid and a surface in one product, and a surface that is all of another, of the given id and
// name.
std::string WithSurface(const std::string& id, const std::string& name) {
  return Changed(FieldFile("hybrid.step"), "ENDSEC;\nEND-ISO",
                 absl::StrCat("#906 = OPEN_SHELL('',(#205));\n"
                              "#908 = SHELL_BASED_SURFACE_MODEL('',(#906));\n"
                              "#910 = PRODUCT('",
                              id, "','", name,
                              "','',(#3));\n"
                              "#911 = PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(#910));\n"
                              "#912 = PRODUCT_DEFINITION_FORMATION('','',#910);\n"
                              "#913 = PRODUCT_DEFINITION('design','',#912,#4);\n"
                              "#914 = PRODUCT_DEFINITION_SHAPE('','',#913);\n"
                              "#921 = MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#217,#908),#219);\n"
                              "#922 = SHAPE_DEFINITION_REPRESENTATION(#914,#921);\n"
                              "ENDSEC;\nEND-ISO"));
}

TEST(StepLosses, AreToldWhateverAnotherProductIsCalled) {
  for (const char* name : {"skin", "hybrid", ""}) {
    const StepAssembly both = Reading(WithSurface(name, name));
    ASSERT_THAT(both.parts, SizeIs(1)) << name;
    // Of the other product nothing is a solid, and it is a leaf.
    ASSERT_THAT(both.leaves, SizeIs(1)) << name;
    EXPECT_THAT(both.notes, Contains("'hybrid': surface #208 is no solid and is left out")) << name;
    EXPECT_THAT(both.notes, Not(Contains(HasSubstr("#908")))) << name;
  }
}

TEST(StepLosses, OfNoProductAreToldBesideNamelessOnes) {
  const std::string bytes = Changed(WithSurface("", ""), "(#217,#157,#208)", "(#217,#157)");
  EXPECT_THAT(Reading(bytes).notes, Contains("surface #208 is no solid and is left out"));
}

TEST(StepLosses, AreCountedWhereTheyAreTooManyToName) {
  for (const int bodies : {20, 21, 31}) {
    std::string items = "(#304,#157,#295", open;
    for (int i = 1; i < bodies; ++i) {
      absl::StrAppend(&items, ",#", 5000 + i);
      absl::StrAppend(&open, "#", 5000 + i, " = MANIFOLD_SOLID_BREP('',#294);\n");
    }
    std::string bytes = Changed(FieldFile("open-in-one.step"), "(#304,#157,#295", items);
    bytes = Changed(bytes, "ENDSEC;\nEND-ISO", absl::StrCat(open, "ENDSEC;\nEND-ISO"));
    const std::vector<std::string> notes = Reading(bytes).notes;
    ASSERT_THAT(notes, SizeIs(bodies == 20 ? 20 : 21));
    EXPECT_THAT(notes[19], HasSubstr("is open, so no solid"));
    if (bodies == 21) {
      EXPECT_EQ(notes[20], "and 1 more is left out or incomplete");
    } else if (bodies == 31) {
      EXPECT_EQ(notes[20], "and 11 more are left out or incomplete");
    }
  }
}

// With an item beside the solid, in a representation of facets of the same product.
std::string WithFacets(const std::string& item) {
  std::string bytes = Changed(FieldFile("hybrid.step"), "(#217,#157,#208)", "(#217,#157)");
  bytes = Changed(bytes, "#208 = SHELL_BASED_SURFACE_MODEL('',(#206));\n", "");
  return Changed(bytes, "ENDSEC;\nEND-ISO",
                 absl::StrCat("#600 = COORDINATES_LIST('',4,((0.,0.,0.),(10.,0.,0.),(10.,10.,0.),"
                              "(0.,10.,0.)));\n#601 = ",
                              item,
                              ";\n"
                              "#602 = TESSELLATED_SHAPE_REPRESENTATION('',(#601),#219);\n"
                              "#603 = SHAPE_DEFINITION_REPRESENTATION(#213,#602);\n"
                              "#604 = TRIANGULATED_FACE('',#600,3,((0.,0.,1.)),$,(),((1,2,3)));\n"
                              "ENDSEC;\nEND-ISO"));
}

TEST(StepLosses, AreToldOfFacetsOfAnyKind) {
  for (const char* item :
       {"TRIANGULATED_SURFACE_SET('lid',#600,4,((0.,0.,1.)),(),((1,2,3),(1,3,4)))",
        "COMPLEX_TRIANGULATED_SURFACE_SET('lid',#600,4,((0.,0.,1.)),(),(),((1,2,3,4)))",
        "TESSELLATED_SOLID('lid',(#604),$)", "TESSELLATED_GEOMETRIC_SET('lid',(#604))",
        "TESSELLATED_CURVE_SET('lid',#600,((1,2,3)))", "TESSELLATED_POINT_SET('lid',#600,(1,2))"}) {
    const StepAssembly read = Reading(WithFacets(item));
    EXPECT_THAT(read.parts, SizeIs(1)) << item;
    EXPECT_THAT(read.notes, Contains(AllOf(HasSubstr("tessellated body"), HasSubstr("#601 is not "
                                                                                    "read"))))
        << item;
  }
}

TEST(StepLosses, AreNotToldOfNotesDrawnOfFacets) {
  const std::string bytes = WithFacets("TESSELLATED_ANNOTATION_OCCURRENCE('note',(),#604)");
  EXPECT_THAT(Reading(bytes).notes, Not(Contains(HasSubstr("tessellated body"))));
}

TEST(StepLosses, FaultsAreCountedWhereTheyAreTooManyToName) {
  std::string wrong;
  for (int i = 0; i < 23; ++i) absl::StrAppend(&wrong, "#", 700 + i, " = DIRECTION('',$);\n");
  const StepAssembly read = Reading(Changed(FieldFile("hybrid.step"), "ENDSEC;\nEND-ISO",
                                            absl::StrCat(wrong, "ENDSEC;\nEND-ISO")));
  EXPECT_THAT(read.notes, Contains(HasSubstr("passed over: #719: ")));
  EXPECT_THAT(read.notes, Contains("a fault that was passed over: and 3 more entities are wrong"));
}

}  // namespace
}  // namespace mortise::cad
