// Searches that fit the designs of their matches, by mortise-retrieval as a real process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "tests/integration/services/retrieval/retrieval_house.h"
#include "tests/support/png_image.h"

namespace mortise::retrieval {
namespace {

constexpr double kCoarse = 0.5;  // δ of an index that is made in seconds

class ShapeFitTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    house_ = std::make_unique<testing::RetrievalHouse>();
    house_->Build("shared", kCoarse);
  }
  static void TearDownTestSuite() { house_.reset(); }

  // The table at hidden parameters as an OBJ file, in metres.
  static v1::SearchShapesRequest HiddenTable() {
    v1::ExportDesignRequest request;
    request.set_name("templates/table");
    *request.add_parameters() = testing::Value("length", 1.37);
    *request.add_parameters() = testing::Value("width", 0.81);
    *request.add_parameters() = testing::Value("height", 0.66);
    request.set_format(v1::ExportDesignRequest::OBJ);
    grpc::ClientContext context;
    testing::Prepare(context);
    const auto bytes = testing::ReadChunks(*house_->catalog().ExportDesign(&context, request));
    EXPECT_TRUE(bytes.ok()) << bytes.status();
    v1::SearchShapesRequest search;
    search.mutable_mesh()->set_file(bytes.value_or(""));
    search.mutable_mesh()->set_file_name("table.obj");
    search.set_fit(true);
    return search;
  }

  static double ValueOf(const v1::ShapeFit& fit, const std::string& name) {
    for (const v1::ParameterValue& each : fit.parameters()) {
      if (each.name() == name) return each.value();
    }
    ADD_FAILURE() << "there is no " << name;
    return 0;
  }

  static std::unique_ptr<testing::RetrievalHouse> house_;
};

std::unique_ptr<testing::RetrievalHouse> ShapeFitTest::house_;

TEST_F(ShapeFitTest, FindsTheParametersOfAMesh) {
  v1::SearchShapesRequest request = HiddenTable();
  request.mutable_mesh()->set_length_unit("m");
  request.set_with_sheet(true);
  const auto found = house_->Search(request);
  ASSERT_TRUE(found.ok()) << found.status();
  ASSERT_EQ(found->matches_size(), 2);
  EXPECT_LE(found->matches(0).distance(), found->matches(1).distance());
  const v1::ShapeMatch& table =
      found->matches(0).template_() == "templates/table" ? found->matches(0) : found->matches(1);
  ASSERT_EQ(table.fit().fault(), "");
  EXPECT_NEAR(ValueOf(table.fit(), "length"), 1.37, 0.012);
  EXPECT_NEAR(ValueOf(table.fit(), "width"), 0.81, 0.005);
  EXPECT_NEAR(ValueOf(table.fit(), "height"), 0.66, 0.006);
  EXPECT_LT(table.fit().remaining(), 1e-3);
  EXPECT_LE(table.fit().remaining(), table.fit().remaining_95() + 1e-3);
  EXPECT_EQ(table.fit().scale(), 1);
  EXPECT_FALSE(table.fit().scale_is_free());
  for (const v1::ShapeMatch& other : found->matches()) {
    if (other.template_() == "templates/table") continue;
    EXPECT_TRUE(!other.fit().fault().empty() ||
                other.fit().remaining() > 10 * table.fit().remaining());
  }
  const auto sheet = testing::DecodePng(found->sheet());
  ASSERT_TRUE(sheet.ok()) << sheet.status();
  EXPECT_GT(sheet->height, 400) << "a row for each match";
}

TEST_F(ShapeFitTest, AsksForTheUnitWhereNothingIsSoSmall) {
  const auto asks = [](const v1::SearchShapesResponse& found) {
    return std::any_of(found.notes().begin(), found.notes().end(), [](const std::string& note) {
      return note.find("is its unit right?") != std::string::npos;
    });
  };
  v1::SearchShapesRequest request = HiddenTable();
  request.add_templates("templates/table");
  for (const auto& [unit, wrong] : {std::pair("mm", true), {"m", false}}) {
    request.mutable_mesh()->set_length_unit(unit);
    const auto found = house_->Search(request);
    ASSERT_TRUE(found.ok()) << found.status();
    EXPECT_EQ(asks(*found), wrong) << unit;
  }
}

TEST_F(ShapeFitTest, TellsThatTheScaleIsFreeWithoutAUnit) {
  v1::SearchShapesRequest request = HiddenTable();
  request.add_templates("templates/table");
  const auto found = house_->Search(request);
  ASSERT_TRUE(found.ok()) << found.status();
  ASSERT_EQ(found->matches_size(), 1);
  const v1::ShapeFit& fit = found->matches(0).fit();
  ASSERT_EQ(fit.fault(), "");
  EXPECT_TRUE(fit.scale_is_free());
  EXPECT_GT(fit.scale(), 0);
  // The proportions are those of the table, whatever its size.
  EXPECT_NEAR(ValueOf(fit, "length") / ValueOf(fit, "height"), 1.37 / 0.66, 0.05);
}

TEST_F(ShapeFitTest, FitsADesignThatIsGiven) {
  v1::SearchShapesRequest request;
  request.mutable_design()->set_template_("templates/table");
  *request.mutable_design()->add_parameters() = testing::Value("length", 1.9);
  request.add_templates("templates/table");
  request.set_fit(true);
  const auto found = house_->Search(request);
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_NEAR(ValueOf(found->matches(0).fit(), "length"), 1.9, 0.012);
  EXPECT_FALSE(found->matches(0).fit().scale_is_free());
}

TEST_F(ShapeFitTest, HasNoFitThatNobodyAskedFor) {
  v1::SearchShapesRequest request = HiddenTable();
  request.set_fit(false);
  const auto found = house_->Search(request);
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_FALSE(found->matches(0).has_fit());
}

TEST_F(ShapeFitTest, FitsNoMoreThanCanBeWaitedFor) {
  v1::SearchShapesRequest request = HiddenTable();
  request.set_limit(21);
  EXPECT_EQ(DetailOf(house_->Search(request).status()).field, "limit");
}

// One triangle is a surface, if not much of one.
TEST_F(ShapeFitTest, KeepsTheMatchesOfWhatHardlyFits) {
  v1::SearchShapesRequest request;
  request.mutable_mesh()->set_file("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  request.mutable_mesh()->set_file_name("triangle.obj");
  request.mutable_mesh()->set_length_unit("m");
  request.set_fit(true);
  const auto found = house_->Search(request);
  ASSERT_TRUE(found.ok()) << found.status();
  ASSERT_EQ(found->matches_size(), 2);
  for (const v1::ShapeMatch& match : found->matches()) {
    EXPECT_TRUE(!match.fit().fault().empty() || std::isfinite(match.fit().remaining()));
  }
}

}  // namespace
}  // namespace mortise::retrieval
