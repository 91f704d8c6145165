// Ground as messages: what is read, what is wrong with it and where, digests.
#include "common/files/height_field_codec.h"

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <google/protobuf/util/message_differencer.h>
#include <gtest/gtest.h>

#include <limits>

#include "common/files/template_codec.h"
#include "common/files/template_reader.h"
#include "common/terrain/height_field.h"
#include "tests/unit/common/files/table.h"

namespace mortise::parametric {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr char kSlope[] =
    "name: 'ground' datum: 300 grid { x: -1 y: -1 x_spacing: 2 y_spacing: 3 columns: 3 "
    "heights: 300 heights: 301 heights: 302 heights: 300.5 heights: 301.5 heights: 302.5 }";
constexpr char kTriangle[] =
    "name: 'scan' triangles { vertices: [0, 0, 1, 9, 0, 1, 0, 9, 2] triangles: [0, 1, 2] }";

v1::HeightField Parsed(const std::string& text) {
  v1::HeightField message;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &message)) << text;
  return message;
}

// The fields at fault of ground, and why.
std::vector<std::string> FaultsOf(const std::vector<v1::HeightField>& messages) {
  std::vector<FieldViolation> findings;
  ReadGrounds({messages.begin(), messages.end()}, findings);
  std::vector<std::string> told;
  for (const FieldViolation& each : findings) told.push_back(each.field + ": " + each.message);
  return told;
}

TEST(HeightFieldCodec, TakesTheDatumOff) {
  std::vector<FieldViolation> findings;
  const std::vector<v1::HeightField> messages = {Parsed(kSlope), Parsed(kTriangle)};
  const auto grounds = ReadGrounds({messages.begin(), messages.end()}, findings);
  ASSERT_THAT(findings, IsEmpty());
  ASSERT_EQ(grounds.size(), 2u);
  EXPECT_EQ(grounds[0].name, "ground");
  EXPECT_NEAR(grounds[0].heights->HeightAt(1, -1)->value, 1, 1e-12);
  EXPECT_NEAR(grounds[0].heights->HeightAt(-1, 2)->value, 0.5, 1e-12);
  EXPECT_NEAR(grounds[1].heights->HeightAt(0, 4.5)->value, 1.5, 1e-12);
}

TEST(HeightFieldCodec, GivesBackWhatItRead) {
  for (const char* const text : {kSlope, kTriangle}) {
    v1::HeightField message = Parsed(text);
    for (double& height : *message.mutable_grid()->mutable_heights()) height -= message.datum();
    if (message.grid().heights().empty()) message = Parsed(text);
    message.clear_datum();
    std::vector<FieldViolation> findings;
    const std::vector<v1::HeightField> messages = {message};
    const auto grounds = ReadGrounds({messages.begin(), messages.end()}, findings);
    EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals(ToProto(grounds.at(0)), message))
        << ToProto(grounds.at(0)).DebugString();
  }
}

TEST(HeightFieldCodec, TellsWhereSomethingIsWrong) {
  v1::HeightField infinite = Parsed(kSlope);
  infinite.mutable_grid()->set_heights(4, std::numeric_limits<double>::infinity());
  v1::HeightField ragged = Parsed(kSlope);
  ragged.mutable_grid()->add_heights(1);
  v1::HeightField odd = Parsed(kTriangle);
  odd.mutable_triangles()->add_vertices(1);
  odd.mutable_triangles()->add_triangles(1);
  EXPECT_THAT(
      FaultsOf({Parsed(kSlope), infinite, ragged, Parsed("name: 'none'"), odd}),
      ElementsAre("height_fields[1].grid.heights[4]: must be a finite number",
                  "height_fields[2].grid.heights: are 7, which are no whole rows of 3",
                  "height_fields[3].heights: must be given, as a grid or as triangles",
                  "height_fields[4].triangles.vertices: are 10 numbers, where each has three",
                  "height_fields[4].triangles.triangles: are 4 numbers, where each has three"));
  EXPECT_THAT(FaultsOf({Parsed("name: 'a' grid { columns: 1 }"), Parsed("datum: nan grid {}")}),
              ElementsAre("height_fields[0].grid.columns: must be 2 to 10000",
                          "height_fields[1].datum: must be a finite number"));
}

TEST(HeightFieldCodec, LimitsAllGroundTogether) {
  v1::HeightField large = Parsed("grid { x_spacing: 1 y_spacing: 1 columns: 300 }");
  large.mutable_grid()->mutable_heights()->Resize(60'000, 0);
  EXPECT_THAT(FaultsOf({large}), IsEmpty());
  EXPECT_THAT(FaultsOf({large, large}),
              ElementsAre("height_fields: have 120000 heights and vertices; at most 100000 are "
                          "accepted in all"));
}

TEST(HeightFieldCodec, DigestsSayTheHeightsAlone) {
  const std::string digest = HeightsDigest(Parsed(kSlope));
  v1::HeightField renamed = Parsed(kSlope);
  renamed.set_name("bank");
  renamed.set_title("Bank");
  renamed.set_digest(digest);
  EXPECT_EQ(HeightsDigest(renamed), digest);
  v1::HeightField lower = Parsed(kSlope);
  lower.set_datum(299);
  EXPECT_NE(HeightsDigest(lower), digest);
  v1::HeightField other = Parsed(kSlope);
  other.mutable_grid()->set_heights(0, 300.001);
  EXPECT_NE(HeightsDigest(other), digest);
}

// ---- In templates -------------------------------------------------------------------------------

class TableOnGround : public ::testing::Test {
 protected:
  TableOnGround() : message_(ToProto(bundle_.definition)) {
    *message_.add_height_fields() = Parsed(kSlope);
  }

  std::vector<std::string> Faults() const {
    std::vector<std::string> told;
    for (const FieldViolation& each :
         ValidateTemplateMessage(message_, bundle_.items, bundle_.materials)) {
      told.push_back(each.field + ": " + each.message);
    }
    return told;
  }

  const TemplateBundle bundle_ = TableBundle();
  v1::Template message_;
};

TEST_F(TableOnGround, IsAsGoodAsTheTable) { EXPECT_THAT(Faults(), IsEmpty()); }

TEST_F(TableOnGround, HasItsHeightsInItsDigest) {
  const std::string digest = TemplateDigest(message_);
  message_.mutable_height_fields(0)->set_digest("abc");
  message_.set_placed_template("templates/other");
  EXPECT_EQ(TemplateDigest(message_), digest) << "what the service sets is no content";
  message_.mutable_height_fields(0)->mutable_grid()->set_heights(5, 303);
  EXPECT_NE(TemplateDigest(message_), digest);
}

TEST_F(TableOnGround, NamesGroundOnceAndByNoWordOrParameter) {
  *message_.add_height_fields() = Parsed(kSlope);
  message_.add_height_fields()->set_name("length");
  message_.add_height_fields()->set_name("terrain");
  for (int i = 2; i < 4; ++i)
    *message_.mutable_height_fields(i)->mutable_grid() = Parsed(kSlope).grid();
  EXPECT_THAT(Faults(),
              ElementsAre("height_fields[1].name: 'ground' is used twice",
                          "height_fields[2].name: 'length' is a parameter",
                          "height_fields[3].name: 'terrain' is a word of the expression language"));
  while (message_.height_fields_size() < 11) *message_.add_height_fields() = Parsed(kSlope);
  EXPECT_THAT(Faults(), ElementsAre("height_fields: has 11 entries; 0 to 10 are accepted"));
}

TEST_F(TableOnGround, TellsOfUnknownGroundAndNothingThatFollowsFromUnreadGround) {
  v1::Extent& height = *message_.mutable_parts(0)->mutable_box()->mutable_z();
  height.set_from("terrain('grund', 0, 0)");
  EXPECT_THAT(Faults(), ElementsAre(HasSubstr("there is no ground 'grund'; there is 'ground'")));
  height.set_from("terrain('ground', 0, 0)");
  message_.mutable_height_fields(0)->mutable_grid()->clear_heights();
  EXPECT_THAT(Faults(), ElementsAre(HasSubstr("height_fields[0].grid.heights: are 3 x 0")));
}

TEST_F(TableOnGround, IsRefusedWhereTheGroundEnds) {
  message_.mutable_boundary_conditions(0)->set_present("terrain('ground', length * 2, 0) > 0");
  EXPECT_THAT(Faults(), ::testing::Contains(
                            ::testing::AllOf(HasSubstr("boundary_conditions[0].present: "),
                                             HasSubstr("ground 'ground' is known for x -1 to 3 m"),
                                             HasSubstr("(at length = "))));
}

}  // namespace
}  // namespace mortise::parametric
