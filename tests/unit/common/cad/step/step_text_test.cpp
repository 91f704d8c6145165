// The text of STEP files before the kernel sees it: tokens, statements, encodings.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/cad/step/step_encoding.h"
#include "common/cad/step/step_statements.h"
#include "common/cad/step/step_tokens.h"

namespace mortise::cad {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::vector<std::string> Tokens(std::string_view text) {
  std::vector<std::string> found;
  StepTokens tokens(text);
  for (StepToken token = tokens.Next(); token.kind != StepToken::Kind::kEnd;
       token = tokens.Next()) {
    found.emplace_back(token.text);
  }
  return found;
}

std::vector<std::string> Faults(const std::string& statements) {
  return StatementFaults(absl::StrCat("ISO-10303-21;\nDATA;\n", statements, "ENDSEC;\n"), 10);
}

std::string Decoded(const std::string& text) {
  const auto decoded = DecodeStep(absl::StrCat("#1=A('", text, "');"));
  EXPECT_TRUE(decoded.ok()) << decoded.status();
  if (!decoded.ok()) return "";
  return decoded->text.substr(6, decoded->text.size() - 9);
}

TEST(StepTokens, AreWhatTheStandardHas) {
  EXPECT_THAT(Tokens("#12 = A_B('it''s; #3',-1.5E-3,.T.,$,*,\"0F\",(.5,+2));"),
              ElementsAre("#12", "=", "A_B", "(", "'it''s; #3'", ",", "-1.5E-3", ",", ".T.", ",",
                          "$", ",", "*", ",", "\"0F\"", ",", "(", ".5", ",", "+2", ")", ")", ";"));
  EXPECT_THAT(Tokens("/* #1 */ END-ISO-10303-21; 'open"),
              ElementsAre("END-ISO-10303-21", ";", "'open"));
  EXPECT_THAT(Tokens("1.#INF -nan ''''"), ElementsAre("1.#INF", "-nan", "''''"));
}

TEST(StepStatements, TellWhatIsNoNumber) {
  EXPECT_THAT(Faults("#1=CARTESIAN_POINT('nan',(1.,-2.5E-3,.5));\n#2=A(.NAN.,'1E400');\n"),
              IsEmpty());
  EXPECT_THAT(
      Faults("#1=A((1.,\nnan));\n#2=B(1E400,1.2.3,1.#QNAN);\n"),
      ElementsAre("#1, line 4: nan is no finite number", "#2, line 5: 1E400 is no finite number",
                  "#2, line 5: 1.2.3 is no number", "#2, line 5: 1.#QNAN is no finite number"));
  // What has no end is written so, but no point is there.
  EXPECT_THAT(Faults("#1=TRIMMED_CURVE('',#2,(PARAMETER_VALUE(-2.E+100)),(),.T.,.$.);\n"),
              IsEmpty());
  EXPECT_THAT(Faults("#1=CARTESIAN_POINT('',(0.,2.E+100,0.));\n"), SizeIs(1));
}

TEST(StepStatements, TellWhatIsNoStatement) {
  EXPECT_THAT(Faults("#1=A(#1);\n"), ElementsAre("#1, line 3: refers to itself"));
  EXPECT_THAT(Faults("#1=A(1);\n#2=B();\n#1=A(2);\n"),
              ElementsAre("#1: is defined twice, in lines 3 and 5"));
  EXPECT_THAT(Faults("#1=A(1);\n#1=A(1);\n"), IsEmpty()) << "the same again";
  EXPECT_THAT(Faults("#1=CARTESIAN_POINT('',(1,5,2.,3.));\n"), ElementsAre(HasSubstr("4 numbers")));
  EXPECT_THAT(Faults("#1=(A()CARTESIAN_POINT((1.,2.)));\n"), IsEmpty());
}

TEST(StepEncoding, DecodesWhatIsEscaped) {
  EXPECT_EQ(Decoded("Geh\\X\\E4use \\X2\\68DA677F\\X0\\ \\X4\\0001F600\\X0\\"), "Gehäuse 棚板 😀");
  EXPECT_EQ(Decoded("\\X2\\D83DDE00\\X0\\"), "😀") << "as two halves";
  EXPECT_EQ(Decoded("\\S\\d \\PB\\\\S\\1"), "ä ą");
  EXPECT_EQ(Decoded("\\X\\27 \\X\\5C \\X\\0A."), "'' \\\\  .") << "quotes stay doubled";
  EXPECT_EQ(Decoded("a \\\\X\\\\E4 b"), "a \\\\X\\\\E4 b") << "backslashes of the name";
  for (const char* broken : {"\\X\\G0", "\\X2\\68D", "\\X2\\68DA", "\\S\\", "C:\\Parts", "\\"}) {
    EXPECT_EQ(Decoded(broken), broken);
  }
}

TEST(StepEncoding, TellsEncodingsApart) {
  EXPECT_EQ(Decoded("Gr\xF6\xDF"
                    "e \x93M\x94"),
            "Größe “M”");
  EXPECT_EQ(Decoded("\xB5\xD7\xB0\xE5"), "底板");
  EXPECT_EQ(Decoded("底板 Größe"), "底板 Größe");
  EXPECT_EQ(Decoded("5 \xB5m \xB1"
                    "0.1"),
            "5 µm ±0.1");
}

TEST(StepText, ReadsAnyBytes) {
  std::mt19937 random(7);
  constexpr std::string_view kLetters = "##123=;'\"/*() \nA\\X2.+-eE\xE4\xB0\xFF,";
  for (int i = 0; i < 3000; ++i) {
    std::string bytes(random() % 60, '\0');
    for (char& byte : bytes) byte = kLetters[random() % kLetters.size()];
    EXPECT_LE(StatementFaults(bytes, 4).size(), 4u) << bytes;
    const auto decoded = DecodeStep(bytes);
    if (!decoded.ok()) continue;
    EXPECT_LE(decoded->text.size(), 4 * bytes.size() + 4);
  }
}

}  // namespace
}  // namespace mortise::cad
