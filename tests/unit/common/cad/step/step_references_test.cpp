// References in STEP files to entities that are not there.
#include "common/cad/step/step_references.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>

#include "absl/strings/str_cat.h"
#include "common/base/files.h"

namespace mortise::cad {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::vector<MissingEntity> Missing(const std::string& data) {
  return MissingEntities(absl::StrCat("ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('#7'),'2;1');\n",
                                      "ENDSEC;\nDATA;\n", data, "ENDSEC;\nEND-ISO-10303-21;\n"),
                         10);
}

TEST(StepReferences, NamesWhatIsMissingAndWhoUsesIt) {
  EXPECT_THAT(Missing("#1=A(#2,(#3));\n#2=B();\n#3=C('',#1);\n"), IsEmpty());
  EXPECT_THAT(Missing("#1=A(#2,(#9));\n#2=B(#9,#8);\n"),
              ElementsAre(MissingEntity{8, 2}, MissingEntity{9, 1}));
  // Entities of several types, and in any order.
  EXPECT_THAT(Missing("#5=(A(#3)B(#4));\n#3=C();\n"), ElementsAre(MissingEntity{4, 5}));
}

TEST(StepReferences, ReadsPastTextsCommentsAndBlanks) {
  EXPECT_THAT(Missing("#1=A('#9 it''s; #8=',\"#7\");/* #6; #5=A(); */\n"), IsEmpty());
  EXPECT_THAT(Missing("/* first */ #1 /* is */ \n = A ( #2 ) ;\n#2\t=\tB();\n"), IsEmpty());
  EXPECT_THAT(Missing("#1=A('unfinished #9"), IsEmpty());
  EXPECT_THAT(Missing("#1=A(#2) /* unfinished #9"), ElementsAre(MissingEntity{2, 1}));
  EXPECT_THAT(Missing("#1=A(1./2.,#,#x,#2);\n"), ElementsAre(MissingEntity{2, 1}));
}

TEST(StepReferences, TakesDataSectionsTogether) {
  EXPECT_THAT(Missing("#1=A(#2);\nENDSEC;\nDATA;\n#2=B(#1);\n"), IsEmpty());
  // What another edition of the standard says of a file: a reference that it resolves, an anchor.
  EXPECT_THAT(MissingEntities("REFERENCE;\n#3=<x.stp#y>;\nENDSEC;\nANCHOR;\n<a>=#4;\nENDSEC;\n"
                              "DATA;\n#1=A(#3);\nENDSEC;\n",
                              10),
              ElementsAre(MissingEntity{4, 0}));
}

TEST(StepReferences, NamesNoMoreThanAskedFor) {
  std::string data;
  for (int i = 1; i < 100; ++i) absl::StrAppend(&data, "#", i, "=A(#", 1000 - i, ");\n");
  EXPECT_THAT(MissingEntities(data, 3),
              ElementsAre(MissingEntity{901, 99}, MissingEntity{902, 98}, MissingEntity{903, 97}));
}

TEST(StepReferences, NumbersMayBeOfAnySize) {
  EXPECT_THAT(Missing("#18446744073709551614=A(#18446744073709551613);\n"),
              ElementsAre(MissingEntity{18446744073709551613U, 18446744073709551614U}));
  EXPECT_THAT(Missing("#99999999999999999999999=A(#99999999999999999999998);\n"), IsEmpty())
      << "both are larger than numbers can be told apart";
}

// Each line of a file that others refer to is missed when it is taken out.
TEST(StepReferences, MissesEachEntityOfARealFile) {
  const char* source = std::getenv("MORTISE_SOURCE_DIR");
  const std::filesystem::path folder = source == nullptr ? "." : source;
  const auto whole = ReadFile(folder / "collection/drawings/wall_shelf.step");
  ASSERT_TRUE(whole.ok()) << whole.status();
  EXPECT_THAT(MissingEntities(*whole, 10), IsEmpty());
  int taken = 0;
  for (std::size_t at = whole->find("CARTESIAN_POINT"); at != std::string::npos;
       at = whole->find("CARTESIAN_POINT", at + 1)) {
    if (++taken % 20 != 0) continue;
    const std::size_t begin = whole->rfind('#', at);
    std::string damaged = *whole;
    damaged.erase(begin, damaged.find(';', begin) + 1 - begin);
    EXPECT_THAT(MissingEntities(damaged, 10), SizeIs(1)) << whole->substr(begin, 40);
  }
  EXPECT_GT(taken, 100);
}

TEST(StepReferences, ReadsAnyBytes) {
  std::mt19937 random(7);
  constexpr std::string_view kLetters = "##123=;'\"/*() \nA";
  for (int i = 0; i < 2000; ++i) {
    std::string bytes(random() % 60, '\0');
    for (char& byte : bytes) byte = kLetters[random() % kLetters.size()];
    EXPECT_LE(MissingEntities(bytes, 4).size(), 4u) << bytes;
  }
}

}  // namespace
}  // namespace mortise::cad
