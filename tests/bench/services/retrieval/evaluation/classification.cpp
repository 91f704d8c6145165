// Figure 4-13, Tables 4.1 and 4.2, and labelled shapes among each other.
#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/render/chart.h"
#include "services/retrieval/cover/parallel_evaluator.h"
#include "tests/bench/services/retrieval/evaluation/figures.h"
#include "tests/bench/services/retrieval/evaluation/query_shapes.h"
#include "tests/bench/services/retrieval/evaluation/ranking.h"

namespace mortise::retrieval {
namespace {

using Eigen::VectorXd;

constexpr std::array<int, 6> kThesisModels{17, 11, 15, 9, 10, 15};  // Table 4.1

// The categories that families have, those of the thesis first.
std::vector<std::string> CategoriesOf(const Study& study) {
  std::vector<std::string> categories;
  for (const std::string& category : ThesisCategories()) {
    if (std::ranges::any_of(study.families(),
                            [&](const auto& each) { return each.category == category; })) {
      categories.push_back(category);
    }
  }
  return categories;
}

}  // namespace

absl::Status WriteCollection(Study& study, ResultFolder& results) {
  std::vector<std::string> categories = ThesisCategories();
  categories.push_back("other");
  ResultTable table{
      .title = "Table 4.1: families",
      .columns = {"category", "thesis", "of the meshes", "of what ships", "parameters"},
      .rows = {}};
  for (std::size_t c = 0; c < categories.size(); ++c) {
    int meshes = 0, shipped = 0;
    std::size_t least = 1000, most = 0;
    for (const EvaluationFamily& family : study.families()) {
      if (family.category != categories[c]) continue;
      (family.mesh.empty() ? shipped : meshes) += 1;
      least = std::min(least, family.design_template->parameters().size());
      most = std::max(most, family.design_template->parameters().size());
    }
    table.rows.push_back({categories[c],
                          c < kThesisModels.size() ? absl::StrCat(kThesisModels[c]) : "–",
                          absl::StrCat(meshes), absl::StrCat(shipped),
                          most > 0 ? absl::StrCat(least, " to ", most) : "–"});
  }
  MORTISE_RETURN_IF_ERROR(results.Begin("4.1", "Table 4.1: the families",
                                        "In the thesis 74 were converted from meshes and 2 are of "
                                        "OpenSCAD, with 2 to 9 parameters."));
  return results.Add("table-4.1", table);
}

namespace {

constexpr int kRecalls = 21;  // 0, 0.05 … 1

// Interpolated precisions at the recalls, averaged over queries.
struct Curve {
  std::vector<double> precisions = std::vector<double>(kRecalls, 0.0);
  int queries = 0;

  void Add(const std::vector<double>& of_query) {
    for (std::size_t i = 0; i < of_query.size(); ++i) {
      precisions[i] += (of_query[i] - precisions[i]) / (queries + 1);
    }
    ++queries;
  }
};

// By category, and "all" of the queries.
using Curves = std::map<std::string, Curve>;

absl::StatusOr<Curves> MeasureCurves(const Study& study, const PrimitiveIndex& index,
                                     std::size_t descriptor, const std::vector<VectorXd>& vectors,
                                     Strictness strictness) {
  Curves curves;
  const std::vector<std::string> categories = CategoriesOf(study);
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const LabelledShape& shape = study.shapes()[i];
    if (std::ranges::find(categories, shape.category) == categories.end()) continue;
    MORTISE_ASSIGN_OR_RETURN(
        const auto ranked,
        study.Search(index, descriptor, vectors[i], static_cast<int>(study.families().size()),
                     FamiliesFor(study, shape, strictness)));
    std::vector<char> relevant;
    for (const IndexMatch& match : ranked) {
      relevant.push_back(study.families()[static_cast<std::size_t>(match.family)].category ==
                         shape.category);
    }
    if (std::ranges::count(relevant, 1) == 0) continue;
    const std::vector<double> precisions = InterpolatedPrecisions(relevant, kRecalls);
    curves["all"].Add(precisions);
    curves[shape.category].Add(precisions);
  }
  return curves;
}

double AveragePrecision(const Curve& curve) {
  return std::accumulate(curve.precisions.begin(), curve.precisions.end(), 0.0) / kRecalls;
}

// One way of searching: a descriptor, by mean shapes or manifolds.
struct Way {
  std::string name;
  std::size_t descriptor = 0;
  Curves curves, strict;
};

absl::StatusOr<std::vector<Way>> MeasureWays(Study& study) {
  std::vector<Way> ways;
  for (std::size_t d = 0; d < study.descriptors().size(); ++d) {
    const std::string& by = study.descriptors()[d]->properties().name;
    MORTISE_ASSIGN_OR_RETURN(const auto* vectors, study.Described(d));
    MORTISE_ASSIGN_OR_RETURN(const PrimitiveIndex* means, study.MeanShapes(d));
    MORTISE_ASSIGN_OR_RETURN(const PrimitiveIndex* manifolds,
                             study.Manifolds(d, study.effort().deltas.back()));
    for (const auto& [index, of] :
         {std::pair(means, "mean shapes"), std::pair(manifolds, "manifolds")}) {
      study.Say(absl::StrCat("precision of ", of, " by ", by));
      Way way{absl::StrCat(by, ", ", of), d, {}, {}};
      MORTISE_ASSIGN_OR_RETURN(way.curves,
                               MeasureCurves(study, *index, d, *vectors, Strictness::kShape));
      MORTISE_ASSIGN_OR_RETURN(way.strict,
                               MeasureCurves(study, *index, d, *vectors, Strictness::kAuthor));
      ways.push_back(std::move(way));
    }
  }
  return ways;
}

std::vector<render::ChartPanel> PrecisionPanels(const std::vector<Way>& ways) {
  std::vector<render::ChartPanel> panels;
  for (const auto& [group, ignored] : ways.front().curves) {
    render::ChartPanel panel{.title = group,
                             .x_name = "recall",
                             .y_name = "precision",
                             .x_shown = {0, 1},
                             .y_shown = {0, 1}};
    for (std::size_t w = 0; w < ways.size(); ++w) {
      const bool mean = w % 2 == 0;
      render::ChartSeries series{
          .name = ways[w].name,
          .color = Mix(render::PartColor(static_cast<int>(ways[w].descriptor)), {1, 1, 1},
                       mean ? 0.55 : 0),
          .line_width = mean ? 1.5 : 2.5,
          .dot_radius = 0};
      series.y = ways[w].curves.at(group).precisions;
      for (int i = 0; i < kRecalls; ++i) series.x.push_back(i / (kRecalls - 1.0));
      panel.series.push_back(std::move(series));
    }
    panels.push_back(std::move(panel));
  }
  return panels;
}

}  // namespace

absl::Status WritePrecision(Study& study, ResultFolder& results) {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<Way> ways, MeasureWays(study));
  MORTISE_RETURN_IF_ERROR(results.Begin(
      "4-13", "Figure 4-13: precision and recall",
      "Labelled shapes of the families' categories look for families; right is the category. "
      "Interpolated precision, averaged over queries. A family made of the query is left out; "
      "“other authors” leaves out all that are made of shapes of its author. In the thesis the "
      "manifolds are better than mean shapes with the light field, and equal or slightly worse "
      "with the other two."));
  ResultTable table{.title = "Mean of the precision over recalls (%)",
                    .columns = {"queries of", "queries"},
                    .rows = {}};
  for (const Way& way : ways) table.columns.push_back(way.name);
  for (const bool strict : {false, true}) {
    const auto curves = [&](const Way& way) { return strict ? way.strict : way.curves; };
    for (const auto& [group, curve] : curves(ways.front())) {
      std::vector<std::string> row{strict ? absl::StrCat(group, ", other authors") : group,
                                   absl::StrCat(curve.queries)};
      for (const Way& way : ways) {
        row.push_back(TablePercent(AveragePrecision(curves(way).at(group))));
      }
      table.rows.push_back(std::move(row));
    }
  }
  MORTISE_RETURN_IF_ERROR(results.Add(
      "figure-4-13",
      DrawChart(PrecisionPanels(ways), {.columns = 4, .panel_width = 260, .panel_height = 230})));
  return results.Add("figure-4-13", table);
}

namespace {

// What stands for a family in Table 4.2: some points of its manifold, each as its quarter turns.
struct Points {
  std::string category;
  Eigen::MatrixXd vectors;  // N × points
};

constexpr std::size_t kPointsAFamily = 40;

Points PointsOf(const EvaluationFamily& family, const std::vector<Primitive>& primitives) {
  const std::size_t count = std::min(kPointsAFamily, primitives.size());
  Points points{family.category, {}};
  points.vectors.resize(primitives.front().center.size(), static_cast<Eigen::Index>(count));
  for (std::size_t i = 0; i < count; ++i) {
    points.vectors.col(static_cast<Eigen::Index>(i)) =
        primitives[i * primitives.size() / count].center;
  }
  return points;
}

// Least and largest distances between the points of two families, over the quarter turns.
std::pair<double, double> Distances(const Descriptor& by, const Points& a, const Points& b) {
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const auto& point : a.vectors.colwise()) {
    Eigen::ArrayXd nearest = Eigen::ArrayXd::Constant(b.vectors.cols(), 1e300);
    const Eigen::MatrixXd turns = by.QuarterTurns(point);
    for (const auto& turn : turns.colwise()) {
      nearest = nearest.min((b.vectors.colwise() - turn).colwise().norm().transpose().array());
    }
    least = std::min(least, nearest.minCoeff());
    most = std::max(most, nearest.maxCoeff());
  }
  return {least, most};
}

struct Spread {
  double between = 0;  // the average, over pairs of categories, of the least distance
  double size = 0;     // the average, over categories, of the largest distance
};

Spread SpreadOf(const Study& study, const Descriptor& by, const std::vector<Points>& points) {
  const std::vector<std::string> categories = CategoriesOf(study);
  std::map<std::pair<std::string, std::string>, double> least;
  std::map<std::string, double> size;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t k = 0; k <= i; ++k) {
      const auto& [first, second] = std::minmax(points[i].category, points[k].category);
      if (std::ranges::find(categories, first) == categories.end() ||
          std::ranges::find(categories, second) == categories.end()) {
        continue;
      }
      const auto [nearest, furthest] = Distances(by, points[i], points[k]);
      if (first == second) {
        size[first] = std::max(size[first], furthest);
      } else {
        auto [place, is_new] = least.try_emplace({first, second}, nearest);
        place->second = std::min(place->second, nearest);
      }
    }
  }
  Spread spread;
  for (const auto& [pair, distance] : least) spread.between += distance / double(least.size());
  for (const auto& [category, largest] : size) spread.size += largest / double(size.size());
  return spread;
}

struct ThesisSpread {
  Spread mean, manifold;
};

const std::map<std::string, ThesisSpread>& ThesisSpreads() {
  static const auto* const spreads =
      new std::map<std::string, ThesisSpread>{{"d2", {{0.16, 0.98}, {0.02, 1.83}}},
                                              {"voxel", {{0.40, 1.17}, {0.16, 1.54}}},
                                              {"light-field", {{1.75, 3.61}, {1.12, 5.37}}}};
  return *spreads;
}

std::vector<std::string> SpreadRow(const std::string& descriptor, const std::string& whose,
                                   const Spread& mean, const Spread& manifold) {
  return {descriptor,
          whose,
          TableNumber(mean.between),
          TableNumber(manifold.between),
          TablePercent(1 - manifold.between / mean.between),
          TableNumber(mean.size),
          TableNumber(manifold.size),
          mean.size > 0 ? TablePercent(manifold.size / mean.size - 1) : "–"};
}

}  // namespace

absl::Status WriteCategoryDistances(Study& study, ResultFolder& results) {
  ResultTable table{
      .title = "Table 4.2: distances between categories, and their sizes",
      .columns = {"descriptor", "whose", "between, mean shapes", "between, manifolds",
                  "less by (%)", "size, mean shapes", "size, manifolds", "more by (%)"},
      .rows = {}};
  for (std::size_t d = 0; d < study.descriptors().size(); ++d) {
    const Descriptor& by = *study.descriptors()[d];
    const std::string& name = by.properties().name;
    study.Say(absl::StrCat("distances of categories by ", name));
    MORTISE_ASSIGN_OR_RETURN(const auto* covers, study.Covers(d, study.effort().deltas.back()));
    std::vector<Points> means, manifolds;
    for (const FamilyCover& cover : *covers) {
      const EvaluationFamily& family = study.families()[static_cast<std::size_t>(cover.family)];
      if (cover.primitives.empty() || family.category == "other") continue;
      manifolds.push_back(PointsOf(family, cover.primitives));
      MORTISE_ASSIGN_OR_RETURN(const mesh::SurfaceMesh surface, MeanShape(family));
      MORTISE_ASSIGN_OR_RETURN(VectorXd vector, by.Describe(surface));
      means.push_back({family.category, std::move(vector)});
    }
    const ThesisSpread& thesis = ThesisSpreads().at(name);
    table.rows.push_back(
        SpreadRow(name, "ours", SpreadOf(study, by, means), SpreadOf(study, by, manifolds)));
    table.rows.push_back(SpreadRow(name, "thesis", thesis.mean, thesis.manifold));
  }
  MORTISE_RETURN_IF_ERROR(results.Begin(
      "4.2", "Table 4.2: categories in descriptor space",
      "Between: the average over pairs of categories of the least distance. Size: the average over "
      "categories of the largest. Of manifolds, between up to 40 points of each family's cover. "
      "Our "
      "descriptors have other scales than the thesis's: only the changes compare."));
  return results.Add("table-4.2", table);
}

namespace {

enum class Among { kAll, kOtherAuthors };

struct Counted {
  double nearest = 0, tier = 0;  // of queries
  int queries = 0;
};

// Distances of all pairs, rows as queries.
Eigen::MatrixXd PairDistances(const Study& study, const Descriptor& by,
                              const std::vector<VectorXd>& vectors) {
  const auto count = static_cast<Eigen::Index>(vectors.size());
  Eigen::MatrixXd all(vectors.front().size(), count), distances(count, count);
  for (Eigen::Index i = 0; i < count; ++i) all.col(i) = vectors[static_cast<std::size_t>(i)];
  ParallelFor(static_cast<int>(count), study.settings().threads, [&](int i) {
    Eigen::RowVectorXd nearest = Eigen::RowVectorXd::Constant(count, 1e300);
    const Eigen::MatrixXd turns = by.QuarterTurns(all.col(i));
    for (const auto& turn : turns.colwise()) {
      nearest = nearest.cwiseMin((all.colwise() - turn).colwise().norm());
    }
    distances.row(i) = nearest;
  });
  return distances;
}

Counted CountAmong(const Study& study, const Eigen::MatrixXd& distances, Among among) {
  Counted counted;
  const std::vector<LabelledShape>& shapes = study.shapes();
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    std::vector<std::pair<double, bool>> others;  // distance, whether of the category
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      if (k == i || (among == Among::kOtherAuthors && shapes[k].author == shapes[i].author)) {
        continue;
      }
      others.emplace_back(distances(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)),
                          shapes[k].category == shapes[i].category);
    }
    std::ranges::stable_sort(others, {}, &std::pair<double, bool>::first);
    std::vector<char> relevant;
    for (const auto& other : others) relevant.push_back(other.second);
    if (std::ranges::count(relevant, 1) == 0) continue;
    counted.nearest += relevant.front();
    counted.tier += FirstTier(relevant);
    ++counted.queries;
  }
  counted.nearest /= std::max(1, counted.queries);
  counted.tier /= std::max(1, counted.queries);
  return counted;
}

}  // namespace

absl::Status WriteLabelledShapes(Study& study, ResultFolder& results) {
  ResultTable table{
      .title = absl::StrCat("Leaving one out of ", study.shapes().size(), " labelled shapes (%)"),
      .columns = {"descriptor", "hits", "queries", "nearest neighbour", "first tier"},
      .rows = {{"plain D2", "all (baseline)", "249", "45", "20"},
               {"plain voxel", "all (baseline)", "249", "71", "35"},
               {"light-field", "all (wanted)", "", "80", "45"}}};
  for (std::size_t d = 0; d < study.descriptors().size(); ++d) {
    const Descriptor& by = *study.descriptors()[d];
    MORTISE_ASSIGN_OR_RETURN(const auto* vectors, study.Described(d));
    const Eigen::MatrixXd distances = PairDistances(study, by, *vectors);
    for (const Among among : {Among::kAll, Among::kOtherAuthors}) {
      const Counted counted = CountAmong(study, distances, among);
      table.rows.push_back({by.properties().name, among == Among::kAll ? "all" : "of other authors",
                            absl::StrCat(counted.queries), TablePercent(counted.nearest),
                            TablePercent(counted.tier)});
    }
  }
  MORTISE_RETURN_IF_ERROR(results.Begin(
      "labelled", "Labelled shapes among each other",
      "Each labelled shape looks for the others. Nearest neighbour: how often the first is of its "
      "category. First tier: of as many as its category has, how many are of it. Packs of one "
      "author look alike, so hits of the same author are left out in the second row; queries "
      "whose category no other author has are not counted then."));
  return results.Add("labelled", table);
}

}  // namespace mortise::retrieval
