// The evaluation of §4.7 on a handful of families: all its files come out, with numbers that can
// be; and the measures that it counts by.
#include "tests/bench/services/retrieval/evaluation/evaluation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "common/base/files.h"
#include "common/files/csv_table.h"
#include "tests/bench/services/retrieval/evaluation/labelled_shapes.h"
#include "tests/bench/services/retrieval/evaluation/ranking.h"
#include "tests/bench/services/retrieval/evaluation/result_folder.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

namespace mortise::retrieval {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// The cells below the titles of a table, each by its title.
using Rows = std::vector<std::map<std::string, std::string>>;

Rows ReadTable(const std::filesystem::path& path) {
  const absl::StatusOr<std::string> text = ReadFile(path);
  EXPECT_TRUE(testing::IsOk(text));
  const parametric::CsvTable table = parametric::ParseCsv(text.value_or(""));
  EXPECT_TRUE(table.findings.empty()) << path;
  Rows rows;
  for (std::size_t r = 1; r < table.rows.size(); ++r) {
    rows.emplace_back();
    for (std::size_t c = 0; c < table.rows[r].size(); ++c) {
      rows.back()[table.rows[0][c].text] = table.rows[r][c].text;
    }
  }
  EXPECT_FALSE(rows.empty()) << path;
  return rows;
}

double NumberOf(const std::map<std::string, std::string>& row, const std::string& column) {
  const absl::StatusOr<double> number = parametric::ParseCsvNumber(row.at(column));
  EXPECT_TRUE(number.ok()) << column << ": " << row.at(column);
  return number.value_or(-1);
}

void ExpectShares(const std::map<std::string, std::string>& row,
                  const std::vector<std::string>& columns) {
  for (const std::string& column : columns) {
    EXPECT_GE(NumberOf(row, column), 0) << column;
    EXPECT_LE(NumberOf(row, column), 100) << column;
  }
}

// What one evaluation of everything wrote.
class EvaluationTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new testing::TemporaryFolder();
    said_ = new std::vector<std::string>();
    ASSERT_TRUE(testing::IsOk(Run({})));
  }
  static void TearDownTestSuite() {
    delete folder_;
    delete said_;
  }

  static absl::Status Run(const std::vector<std::string>& figures) {
    said_->clear();
    StudySettings settings;
    settings.out = folder_->path();
    settings.quick = true;
    return Evaluate(settings, figures, [](std::string_view what) { said_->emplace_back(what); });
  }

  static std::filesystem::path File(const std::string& name) { return folder_->path() / name; }

  static testing::TemporaryFolder* folder_;
  static std::vector<std::string>* said_;
};

testing::TemporaryFolder* EvaluationTest::folder_ = nullptr;
std::vector<std::string>* EvaluationTest::said_ = nullptr;

TEST_F(EvaluationTest, WritesTablesChartsAndPicturesAndAPageWithAllOfThem) {
  const std::string page = *ReadFile(File("evaluation.md"));
  for (const std::string& figure : FigureNames()) {
    EXPECT_THAT(page, HasSubstr(*ReadFile(File(figure + ".md")))) << figure;
  }
  for (const char* chart : {"figure-4-7", "figure-4-8", "figure-4-9", "figure-4-11-d2",
                            "figure-4-11-light-field", "figure-4-13"}) {
    const absl::StatusOr<std::string> svg = ReadFile(File(std::string(chart) + ".svg"));
    ASSERT_TRUE(testing::IsOk(svg));
    EXPECT_THAT(*svg, HasSubstr("</svg>"));
    EXPECT_EQ(svg->find("nan"), std::string::npos) << chart;
    EXPECT_THAT(page, HasSubstr(std::string(chart) + ".svg"));
  }
  for (const char* picture : {"figure-4-10.png", "figure-4-12.png", "figure-4-14.png"}) {
    const absl::StatusOr<std::string> png = ReadFile(File(picture));
    ASSERT_TRUE(testing::IsOk(png));
    EXPECT_EQ(png->substr(1, 3), "PNG");
    EXPECT_THAT(page, HasSubstr(picture));
  }
}

TEST_F(EvaluationTest, RejectionLeavesNoGapsOnTheParaboloidAndAdaptiveSamplingDoes) {
  std::map<std::string, std::map<std::string, std::string>> schemes;
  for (const auto& row : ReadTable(File("figure-4-7.csv"))) schemes[row.at("scheme")] = row;
  for (const std::string kind : {"points", "tangents"}) {
    const auto& rejection = schemes.at(kind + ", by rejection");
    const auto& adaptive =
        schemes.at(kind + (kind == "points" ? ", adaptive by area" : ", adaptive by curvature"));
    EXPECT_EQ(rejection.at("primitives"), adaptive.at("primitives"));
    EXPECT_LE(NumberOf(rejection, "99th percentile of the distance / δ"), 1);
    EXPECT_LT(NumberOf(rejection, "not covered (%)"), 0.5);
    EXPECT_GT(NumberOf(adaptive, "not covered (%)"), 5);
  }
}

TEST_F(EvaluationTest, ErrorsLieBelowDelta) {
  for (const auto& row : ReadTable(File("figure-4-8.csv"))) {
    EXPECT_LE(NumberOf(row, "fitting / δ"), 1) << row.at("family") << row.at("descriptor");
    EXPECT_GT(NumberOf(row, "primitives"), 0);
  }
}

TEST_F(EvaluationTest, TheHybridCostsNoMoreThanEither) {
  for (const auto& row : ReadTable(File("figure-4-9.csv"))) {
    EXPECT_LE(NumberOf(row, "hybrid over the cheaper"), 1.05) << row.at("family");
    EXPECT_GE(NumberOf(row, "dearer over hybrid"), 1 / 1.05) << row.at("family");
  }
}

TEST_F(EvaluationTest, CountsRightAnswersOfRandomDesigns) {
  const Rows rows = ReadTable(File("figure-4-10.csv"));
  EXPECT_EQ(rows.front().at("designs"), "all");
  EXPECT_EQ(NumberOf(rows.front(), "queries"), 4 * 3);
  for (const auto& row : rows) {
    for (const std::string by : {"d2", "voxel", "light-field"}) {
      ExpectShares(row, {"mean shapes, " + by, "manifolds, " + by});
    }
  }
  EXPECT_GE(NumberOf(rows.front(), "manifolds, light-field"),
            NumberOf(rows.front(), "mean shapes, light-field"));
}

TEST_F(EvaluationTest, MeasuresCategoriesAndLabelledShapes) {
  for (const auto& row : ReadTable(File("figure-4-13.csv"))) {
    ExpectShares(row, {"d2, mean shapes", "d2, manifolds", "light-field, manifolds"});
  }
  for (const auto& row : ReadTable(File("labelled.csv"))) {
    ExpectShares(row, {"nearest neighbour", "first tier"});
  }
  // What a manifold covers is larger than a point of it, and nearer to others.
  for (const auto& row : ReadTable(File("table-4.2.csv"))) {
    EXPECT_LE(NumberOf(row, "between, manifolds"), 1.05 * NumberOf(row, "between, mean shapes"));
    EXPECT_GE(NumberOf(row, "size, manifolds"), NumberOf(row, "size, mean shapes"));
  }
  for (const auto& row : ReadTable(File("figure-4-11.csv"))) {
    EXPECT_GE(NumberOf(row, "covers"), 0);
    EXPECT_GE(NumberOf(row, "random points"), 0);
  }
}

TEST_F(EvaluationTest, GoesOnWhereItWasAndGivesTheSameAgain) {
  const std::string before = *ReadFile(File("figure-4-10.csv"));
  ASSERT_TRUE(testing::IsOk(Run({})));
  for (const std::string& figure : FigureNames()) {
    EXPECT_THAT(*said_, Contains("figure " + figure + " is there already"));
  }
  // Without a figure's page it is made anew, of covers that are kept.
  std::filesystem::remove(File("4-10.md"));
  ASSERT_TRUE(testing::IsOk(Run({"4-10"})));
  EXPECT_EQ(*ReadFile(File("figure-4-10.csv")), before);
}

TEST_F(EvaluationTest, RefusesFiguresThatThereAreNot) {
  const absl::Status status = Run({"4-99"});
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()), HasSubstr("4-14"));
}

TEST(RankingTest, InterpolatesPrecision) {
  // Relevant at the first, third and fourth place: 1, 2/3, 3/4.
  EXPECT_THAT(InterpolatedPrecisions({1, 0, 1, 1, 0}, 4), ElementsAre(1, 1, 0.75, 0.75));
  EXPECT_THAT(InterpolatedPrecisions({0, 1}, 3), ElementsAre(0.5, 0.5, 0.5));
}

TEST(RankingTest, CountsTheFirstTier) {
  EXPECT_EQ(FirstTier({1, 0, 1, 1, 0, 0}), 2.0 / 3);
  EXPECT_EQ(FirstTier({1, 1, 0}), 1);
  EXPECT_EQ(FirstTier({0, 0}), 0);
}

TEST(LabelledShapesTest, ReadsAFolder) {
  const testing::TemporaryFolder folder;
  ASSERT_TRUE(
      WriteFile(folder.path() / "labels.csv", "file,category,source\nchair/one.obj,chair,quat17\n")
          .ok());
  const auto missing = ReadLabelledShapes(folder.path());
  EXPECT_FALSE(missing.ok());
  ASSERT_TRUE(
      WriteFile(folder.path() / "chair/one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").ok());
  const auto shapes = ReadLabelledShapes(folder.path());
  ASSERT_TRUE(testing::IsOk(shapes));
  ASSERT_EQ(shapes->size(), 1U);
  EXPECT_EQ(shapes->front().category, "chair");
  EXPECT_EQ(shapes->front().author, "quat");
  EXPECT_EQ(shapes->front().surface.triangles.cols(), 1);
}

TEST(ResultTableTest, IsWrittenAsCsvAndMarkdown) {
  const ResultTable table{.title = "Sizes", .columns = {"a, b", "c"}, .rows = {{"1", "say \"x\""}}};
  EXPECT_EQ(AsCsv(table), "\"a, b\",c\n1,\"say \"\"x\"\"\"\n");
  EXPECT_EQ(AsMarkdown(table), "**Sizes**\n\n| a, b | c |\n| --- | --- |\n| 1 | say \"x\" |\n\n");
}

}  // namespace
}  // namespace mortise::retrieval
