// Figures 4-10 and 4-11: designs at random parameters as queries.
#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/render/chart.h"
#include "services/retrieval/cover/parallel_evaluator.h"
#include "services/retrieval/families/match_sheet.h"
#include "tests/bench/services/retrieval/evaluation/figures.h"
#include "tests/bench/services/retrieval/evaluation/shape_sheet.h"

namespace mortise::retrieval {
namespace {

using Eigen::VectorXd;

constexpr double kThesisMeanShapes = 0.29;  // of queries, by D2
constexpr int kFailuresShown = 5;

// A design whose family is known.
struct Query {
  int family = 0;
  RandomDesign design;
};

std::vector<Query> Queries(const Study& study, int of_each, std::uint64_t seed) {
  const std::vector<EvaluationFamily>& families = study.families();
  std::vector<std::vector<RandomDesign>> designs(families.size());
  ParallelFor(static_cast<int>(families.size()), study.settings().threads, [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    study.Say(absl::StrCat("random designs of ", families[at].name));
    designs[at] = RandomDesigns(families[at], of_each, seed + at);
  });
  std::vector<Query> queries;
  for (std::size_t i = 0; i < designs.size(); ++i) {
    for (RandomDesign& design : designs[i]) {
      queries.push_back({static_cast<int>(i), std::move(design)});
    }
  }
  return queries;
}

absl::StatusOr<std::vector<VectorXd>> Describe(const Study& study, const Descriptor& by,
                                               const std::vector<Query>& queries) {
  study.Say(absl::StrCat("describing random designs by ", by.properties().name));
  std::vector<absl::StatusOr<VectorXd>> made(queries.size(), VectorXd());
  ParallelFor(static_cast<int>(queries.size()), study.settings().threads, [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    made[at] = by.Describe(queries[at].design.surface);
  });
  std::vector<VectorXd> vectors;
  for (absl::StatusOr<VectorXd>& vector : made) {
    MORTISE_RETURN_IF_ERROR(vector.status());
    vectors.push_back(*std::move(vector));
  }
  return vectors;
}

// Shares of right answers, by what the queries are counted under.
class Shares {
 public:
  void Count(const EvaluationFamily& family, bool right) {
    for (const std::string& group :
         {std::string("all"),
          family.mesh.empty() ? std::string("of what ships") : std::string("of the meshes"),
          absl::StrCat("category ", family.category)}) {
      auto& [rights, all] = counts_[group];
      rights += right ? 1 : 0;
      ++all;
    }
  }

  const std::map<std::string, std::pair<int, int>>& counts() const { return counts_; }

  std::string Percent(const std::string& group) const {
    const auto& [rights, all] = counts_.at(group);
    return TablePercent(static_cast<double>(rights) / std::max(1, all));
  }

 private:
  std::map<std::string, std::pair<int, int>> counts_;  // right, all
};

// What one way of searching came to.
struct Answers {
  std::string title;
  Shares shares;
  std::vector<int> first;  // the family found for each query
};

absl::StatusOr<Answers> Ask(const Study& study, std::string title, const PrimitiveIndex& index,
                            std::size_t descriptor, const std::vector<Query>& queries,
                            const std::vector<VectorXd>& vectors) {
  Answers answers{std::move(title), {}, {}};
  for (std::size_t i = 0; i < queries.size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<IndexMatch> found,
                             study.Search(index, descriptor, vectors[i], 1));
    const EvaluationFamily& own = study.families()[static_cast<std::size_t>(queries[i].family)];
    const EvaluationFamily& first = study.families()[static_cast<std::size_t>(found[0].family)];
    answers.shares.Count(own, own.kin == first.kin);
    answers.first.push_back(found[0].family);
  }
  return answers;
}

// Rows of mean shape, query, and the mean shape that was found instead.
absl::StatusOr<render::Image> DrawFailures(const Study& study, const std::vector<Query>& queries,
                                           const Answers& answers) {
  ShapeSheet sheet(3);
  std::set<int> shown;
  for (std::size_t i = 0; i < queries.size() && shown.size() < kFailuresShown; ++i) {
    const int family = queries[i].family;
    const EvaluationFamily& own = study.families()[static_cast<std::size_t>(family)];
    const EvaluationFamily& found = study.families()[static_cast<std::size_t>(answers.first[i])];
    if (own.kin == found.kin || own.category == "other" || !shown.insert(family).second) continue;
    MORTISE_ASSIGN_OR_RETURN(const mesh::SurfaceMesh mean, MeanShape(own));
    MORTISE_ASSIGN_OR_RETURN(const mesh::SurfaceMesh wrong, MeanShape(found));
    MORTISE_RETURN_IF_ERROR(sheet.Add(mean, ShapeSheet::Kind::kMeanShape, own.name));
    MORTISE_RETURN_IF_ERROR(
        sheet.Add(queries[i].design.surface, ShapeSheet::Kind::kQuery, "query"));
    MORTISE_RETURN_IF_ERROR(sheet.Add(wrong, ShapeSheet::Kind::kMeanShape, found.name));
  }
  return sheet.Draw();
}

}  // namespace

absl::Status WriteRandomDesigns(Study& study, ResultFolder& results) {
  const std::vector<Query> queries =
      Queries(study, study.effort().random_designs, study.settings().seed + 1000);
  std::vector<Answers> all;
  for (std::size_t d = 0; d < study.descriptors().size(); ++d) {
    const Descriptor& by = *study.descriptors()[d];
    MORTISE_ASSIGN_OR_RETURN(const std::vector<VectorXd> vectors, Describe(study, by, queries));
    MORTISE_ASSIGN_OR_RETURN(const PrimitiveIndex* means, study.MeanShapes(d));
    MORTISE_ASSIGN_OR_RETURN(
        Answers by_means, Ask(study, absl::StrCat("mean shapes, ", by.properties().name), *means, d,
                              queries, vectors));
    all.push_back(std::move(by_means));
    MORTISE_ASSIGN_OR_RETURN(const PrimitiveIndex* manifolds,
                             study.Manifolds(d, study.effort().deltas.back()));
    MORTISE_ASSIGN_OR_RETURN(Answers by_manifolds,
                             Ask(study, absl::StrCat("manifolds, ", by.properties().name),
                                 *manifolds, d, queries, vectors));
    all.push_back(std::move(by_manifolds));
  }
  ResultTable table{
      .title = absl::StrFormat(
          "Right family first (%%), δ = %g natural scales; the thesis, mean shapes by "
          "D2: %s",
          study.effort().deltas.back(), TablePercent(kThesisMeanShapes)),
      .columns = {"designs", "queries"},
      .rows = {}};
  for (const Answers& each : all) table.columns.push_back(each.title);
  for (const auto& [group, counts] : all.front().shares.counts()) {
    std::vector<std::string> row{group, absl::StrCat(counts.second)};
    for (const Answers& each : all) row.push_back(each.shares.Percent(group));
    table.rows.push_back(std::move(row));
  }
  MORTISE_RETURN_IF_ERROR(results.Begin(
      "4-10", "Figure 4-10: designs at random parameters",
      absl::StrFormat(
          "%d designs of each of %d families at random parameters are looked for. A "
          "template is right as well if it is made of the same assembly. The picture: "
          "a family's mean shape, a query made of it, and the mean shape that D2 finds.",
          study.effort().random_designs, study.families().size())));
  MORTISE_RETURN_IF_ERROR(results.Add("figure-4-10", table));
  MORTISE_ASSIGN_OR_RETURN(const render::Image failures, DrawFailures(study, queries, all.front()));
  return results.Add("figure-4-10", failures);
}

namespace {

// As many points of each family as all covers together would pay for, at random parameters.
absl::StatusOr<PrimitiveIndex> NaiveIndex(const Study& study, std::size_t descriptor,
                                          const std::vector<FamilyCover>& covers) {
  long cost = 0;
  for (const FamilyCover& cover : covers) {
    for (const Primitive& primitive : cover.primitives) cost += Cost(primitive);
  }
  const auto& families = study.families();
  const int each = std::max(1, static_cast<int>(cost / static_cast<long>(families.size())));
  std::vector<FamilyCover> naive(families.size());
  ParallelFor(static_cast<int>(families.size()), study.settings().threads, [&](int i) {
    FamilyCover& cover = naive[static_cast<std::size_t>(i)];
    cover.family = i;
    const auto seed = study.settings().seed + 2000 + static_cast<std::uint64_t>(i);
    for (const RandomDesign& design :
         RandomDesigns(families[static_cast<std::size_t>(i)], each, seed)) {
      absl::StatusOr<VectorXd> vector = study.descriptors()[descriptor]->Describe(design.surface);
      if (!vector.ok()) continue;
      const Eigen::Index size = vector->size();
      cover.primitives.push_back({.parameters = design.q,
                                  .center = *std::move(vector),
                                  .axes = Eigen::MatrixXd(size, 0),
                                  .radii = VectorXd(0)});
    }
  });
  std::erase_if(naive, [](const FamilyCover& cover) { return cover.primitives.empty(); });
  return PrimitiveIndex::Build(std::move(naive));
}

// The largest, over queries of a category, of how much nearer the nearest primitive of all is than
// the nearest of the right kin.
absl::StatusOr<std::map<std::string, double>> WorstErrors(const Study& study,
                                                          std::size_t descriptor,
                                                          const PrimitiveIndex& index,
                                                          const std::vector<Query>& queries,
                                                          const std::vector<VectorXd>& vectors) {
  std::map<std::string, double> worst;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const auto& families = study.families();
    const EvaluationFamily& own = families[static_cast<std::size_t>(queries[i].family)];
    MORTISE_ASSIGN_OR_RETURN(const auto nearest, study.Search(index, descriptor, vectors[i], 1));
    MORTISE_ASSIGN_OR_RETURN(const auto right,
                             study.Search(index, descriptor, vectors[i], 1, [&](int family) {
                               return families[static_cast<std::size_t>(family)].kin == own.kin;
                             }));
    if (right.empty()) continue;
    const double error = right[0].distance - nearest[0].distance;
    for (const std::string& group : {std::string("all"), own.category}) {
      worst[group] = std::max(worst[group], error);
    }
  }
  return worst;
}

struct Comparison {
  double delta = 0;
  std::map<std::string, double> ours, naive;
};

// A panel for each category, the whole database first.
std::vector<render::ChartPanel> PanelsOf(const std::vector<Comparison>& compared) {
  std::vector<render::ChartPanel> panels;
  for (const auto& [group, ignored] : compared.front().ours) {
    render::ChartSeries delta{.name = "δ", .color = {0.6, 0.6, 0.6}, .dot_radius = 0};
    render::ChartSeries ours{.name = "covers", .color = render::PartColor(0)};
    render::ChartSeries naive{.name = "random points at equal cost", .color = render::PartColor(1)};
    for (const Comparison& each : compared) {
      for (render::ChartSeries* series : {&delta, &ours, &naive}) series->x.push_back(each.delta);
      delta.y.push_back(each.delta);
      ours.y.push_back(each.ours.at(group));
      naive.y.push_back(each.naive.at(group));
    }
    panels.push_back({.title = group,
                      .x_name = "δ",
                      .y_name = "worst error",
                      .series = {delta, ours, naive},
                      .y_shown = {0}});
  }
  return panels;
}

}  // namespace

absl::Status WriteNaiveSampling(Study& study, ResultFolder& results) {
  const std::vector<Query> queries =
      Queries(study, study.effort().random_designs, study.settings().seed + 3000);
  MORTISE_RETURN_IF_ERROR(results.Begin(
      "4-11", "Figure 4-11: against random points of the parameters",
      "The worst case, over designs at random parameters, of the distance from the right family "
      "less that from the nearest primitive of all. The naive way stores random points, as many "
      "for each family, that cost as much as our covers together. The thesis finds its own method "
      "close to δ and better in every category."));
  ResultTable table{.title = "Worst errors",
                    .columns = {"descriptor", "δ", "queries of", "covers", "random points"},
                    .rows = {}};
  for (const std::size_t d : {std::size_t{0}, study.descriptors().size() - 1}) {
    const Descriptor& by = *study.descriptors()[d];
    MORTISE_ASSIGN_OR_RETURN(const std::vector<VectorXd> vectors, Describe(study, by, queries));
    std::vector<Comparison> compared;
    for (const double scales : study.effort().deltas) {
      study.Say(absl::StrFormat("random points for %s at %g", by.properties().name, scales));
      Comparison each{.delta = Study::DeltaOf(by, scales), .ours = {}, .naive = {}};
      MORTISE_ASSIGN_OR_RETURN(const auto* covers, study.Covers(d, scales));
      MORTISE_ASSIGN_OR_RETURN(const PrimitiveIndex* index, study.Manifolds(d, scales));
      MORTISE_ASSIGN_OR_RETURN(each.ours, WorstErrors(study, d, *index, queries, vectors));
      MORTISE_ASSIGN_OR_RETURN(const PrimitiveIndex naive, NaiveIndex(study, d, *covers));
      MORTISE_ASSIGN_OR_RETURN(each.naive, WorstErrors(study, d, naive, queries, vectors));
      for (const auto& [group, error] : each.ours) {
        table.rows.push_back({by.properties().name, TableNumber(each.delta), group,
                              TableNumber(error), TableNumber(each.naive[group])});
      }
      compared.push_back(std::move(each));
    }
    MORTISE_RETURN_IF_ERROR(results.Add(
        absl::StrCat("figure-4-11-", by.properties().name),
        DrawChart(PanelsOf(compared), {.columns = 4, .panel_width = 260, .panel_height = 220})));
  }
  return results.Add("figure-4-11", table);
}

}  // namespace mortise::retrieval
