// Figures 4-8 and 4-9: how good covers are, and what they cost.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/render/chart.h"
#include "services/retrieval/cover/cover_error.h"
#include "services/retrieval/cover/manifold_cover.h"
#include "services/retrieval/families/family_manifold.h"
#include "tests/bench/services/retrieval/evaluation/figures.h"
#include "tests/bench/services/retrieval/evaluation/remembering_manifold.h"

namespace mortise::retrieval {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

// The thesis's kinds of shape: a chair with 2 parameters, a table with 3, a cart with 5, a chair
// with 7.
struct Kind {
  std::string category;
  std::string assembly;
  int parameters;
};

const std::vector<Kind> kKinds{{"chair", "garden-bench", 2},
                               {"table", "dining-table", 3},
                               {"cart", "toy-wagon", 5},
                               {"chair", "step-stool", 7}};

std::string Titled(const Kind& kind) {
  return absl::StrCat(kind.category, ", ", kind.parameters, " parameters");
}

// Of a mesh, as in the thesis; without meshes of an assembly that ships.
absl::StatusOr<std::unique_ptr<Manifold>> ManifoldOf(
    const Study& study, const Kind& kind, const std::shared_ptr<const Descriptor>& descriptor) {
  const std::filesystem::path& shapes = study.settings().shapes;
  MORTISE_ASSIGN_OR_RETURN(const EvaluationFamily family,
                           shapes.empty() ? ShippedAssemblyOf(kind.assembly, kind.parameters)
                                          : MeshFamilyOf(shapes, kind.category, kind.parameters));
  study.Say(absl::StrCat(Titled(kind), ": ", family.name));
  MORTISE_ASSIGN_OR_RETURN(std::unique_ptr<Manifold> manifold,
                           MakeFamilyManifold(family.design_template, descriptor));
  return std::make_unique<RememberingManifold>(std::move(manifold));
}

struct Accuracy {
  double delta = 0;
  int primitives = 0, tangents = 0;
  bool covered = false;
  double coverage = 0, fitting = 0;  // 99th percentiles
};

absl::StatusOr<Accuracy> MeasureAccuracy(const Study& study, const Manifold& manifold, double delta,
                                         int samples) {
  const StudySettings& settings = study.settings();
  MORTISE_ASSIGN_OR_RETURN(
      const Cover cover, CoverManifold(manifold, {.delta = delta,
                                                  .seed = settings.seed,
                                                  .rejections = study.effort().rejections,
                                                  .most_evaluations = study.effort().most_measured,
                                                  .threads = settings.threads}));
  const ErrorSampling sampling{
      .count = samples, .seed = settings.seed + 77, .threads = settings.threads};
  ErrorSampling dense = sampling;
  dense.count = 5 * samples;
  MORTISE_ASSIGN_OR_RETURN(const auto coverage, CoverageErrors(manifold, cover.primitives, dense));
  MORTISE_ASSIGN_OR_RETURN(const auto fitting, FittingErrors(manifold, cover.primitives, sampling));
  Accuracy accuracy{.delta = delta,
                    .primitives = static_cast<int>(cover.primitives.size()),
                    .covered = cover.end == CoverEnd::kCovered,
                    .coverage = Quantile(coverage, 0.99),
                    .fitting = Quantile(fitting, 0.99)};
  accuracy.tangents = static_cast<int>(
      std::ranges::count_if(cover.primitives, [](const Primitive& p) { return Cost(p) > 1; }));
  return accuracy;
}

void AddRow(const Kind& kind, const Descriptor& by, const Accuracy& each, ResultTable& table) {
  table.rows.push_back({Titled(kind), by.properties().name, TableNumber(each.delta),
                        absl::StrCat(each.primitives), absl::StrCat(each.tangents),
                        each.covered ? "yes" : "no", TableNumber(each.coverage / each.delta),
                        TableNumber(each.fitting / each.delta)});
}

render::ChartPanel PanelOf(const Descriptor& by, const std::vector<Accuracy>& measured) {
  render::ChartSeries bound{.name = "δ", .color = {0.6, 0.6, 0.6}, .dot_radius = 0};
  render::ChartSeries coverage{.name = "coverage error", .color = render::PartColor(0)};
  render::ChartSeries fitting{.name = "fitting error", .color = render::PartColor(1)};
  for (const Accuracy& each : measured) {
    for (render::ChartSeries* series : {&bound, &coverage, &fitting}) {
      series->x.push_back(each.delta);
    }
    bound.y.push_back(each.delta);
    coverage.y.push_back(each.coverage);
    fitting.y.push_back(each.fitting);
  }
  return {.title = by.properties().name,
          .x_name = "δ",
          .y_name = "99th percentile of the error",
          .series = {bound, coverage, fitting},
          .y_shown = {0}};
}

}  // namespace

absl::Status WriteAccuracy(Study& study, ResultFolder& results) {
  ResultTable table{.title = "99th percentiles of errors, in δ (wanted: at most 1)",
                    .columns = {"family", "descriptor", "δ", "primitives", "tangents", "covered",
                                "coverage / δ", "fitting / δ"},
                    .rows = {}};
  std::vector<render::ChartPanel> panels;
  for (const std::shared_ptr<const Descriptor>& by : study.descriptors()) {
    for (const Kind& kind : kKinds) {
      const bool first = &kind == &kKinds.front();
      MORTISE_ASSIGN_OR_RETURN(const std::unique_ptr<Manifold> manifold,
                               ManifoldOf(study, kind, by));
      std::vector<Accuracy> measured;
      for (const double scales :
           first ? study.effort().accuracy_deltas : study.effort().other_accuracy_deltas) {
        study.Say(absl::StrFormat("errors of %s by %s at %g", Titled(kind), by->properties().name,
                                  scales));
        const int samples = study.effort().accuracy_samples / (first ? 1 : 3);
        MORTISE_ASSIGN_OR_RETURN(
            const Accuracy each,
            MeasureAccuracy(study, *manifold, Study::DeltaOf(*by, scales), samples));
        measured.push_back(each);
        AddRow(kind, *by, each, table);
      }
      if (first) panels.push_back(PanelOf(*by, measured));
    }
  }
  MORTISE_RETURN_IF_ERROR(results.Begin(
      "4-8", "Figure 4-8: fitting and coverage error",
      "A chair with two parameters, as in the thesis, whose errors lie below δ for all three "
      "descriptors; the table has the thesis's larger families besides. Coverage: fresh samples of "
      "the manifold to the nearest primitive. Fitting: random places on tangents to the nearest "
      "point of the manifold, found by Gauss-Newton steps."));
  MORTISE_RETURN_IF_ERROR(results.Add("figure-4-8", DrawChart(panels)));
  return results.Add("figure-4-8", table);
}

namespace {

const std::vector<std::pair<CoverKind, std::string>> kCoverKinds{
    {CoverKind::kMixed, "hybrid"},
    {CoverKind::kPoints, "points"},
    {CoverKind::kTangents, "tangents"}};

// The cost of each kind of cover for one δ; not a number where it did not get done.
absl::StatusOr<std::vector<double>> CostsAt(const Study& study, const Manifold& manifold,
                                            double delta) {
  std::vector<double> costs;
  for (const auto& [kind, name] : kCoverKinds) {
    MORTISE_ASSIGN_OR_RETURN(
        const Cover cover,
        CoverManifold(manifold, {.delta = delta,
                                 .seed = study.settings().seed,
                                 .rejections = study.effort().rejections,
                                 .kind = kind,
                                 .most_primitives = 8'000,
                                 .most_evaluations = study.effort().most_measured,
                                 .threads = study.settings().threads}));
    costs.push_back(cover.end == CoverEnd::kCovered ? static_cast<double>(cover.cost) : kNothing);
  }
  return costs;
}

// A panel of costs above, and one of costs over the hybrid's below.
std::pair<render::ChartPanel, render::ChartPanel> CostPanels(
    const Kind& kind, const std::vector<double>& deltas,
    const std::vector<std::vector<double>>& costs) {
  render::ChartPanel cost{.title = Titled(kind),
                          .x_name = "δ",
                          .y_name = "cost",
                          .x_logarithmic = true,
                          .y_logarithmic = true};
  render::ChartPanel relative{.title = Titled(kind),
                              .x_name = "δ",
                              .y_name = "cost over the hybrid's",
                              .x_logarithmic = true,
                              .y_shown = {0}};
  for (std::size_t k = 0; k < kCoverKinds.size(); ++k) {
    render::ChartSeries series{.name = kCoverKinds[k].second,
                               .x = deltas,
                               .color = render::PartColor(static_cast<int>(k))};
    render::ChartSeries over = series;
    for (const std::vector<double>& each : costs) {
      series.y.push_back(each[k]);
      over.y.push_back(each[k] / each[0]);
    }
    cost.series.push_back(std::move(series));
    relative.series.push_back(std::move(over));
  }
  return {std::move(cost), std::move(relative)};
}

std::string CostText(double cost) {
  return std::isfinite(cost) ? absl::StrFormat("%.0f", cost) : "over the limit";
}

}  // namespace

absl::Status WriteCosts(Study& study, ResultFolder& results) {
  const std::shared_ptr<const Descriptor>& by = study.descriptors().front();
  ResultTable table{.title = "Cost by D2: 1 for a point, 1 and the axes for a tangent",
                    .columns = {"family", "δ", "hybrid", "points", "tangents",
                                "hybrid over the cheaper", "dearer over hybrid"},
                    .rows = {}};
  std::vector<render::ChartPanel> above, below;
  for (const Kind& kind : kKinds) {
    if (kind.parameters == 2) continue;
    MORTISE_ASSIGN_OR_RETURN(const std::unique_ptr<Manifold> manifold, ManifoldOf(study, kind, by));
    std::vector<double> deltas;
    std::vector<std::vector<double>> costs;
    for (auto scales = study.effort().cost_deltas.rbegin();
         scales != study.effort().cost_deltas.rend(); ++scales) {
      study.Say(absl::StrFormat("costs of %s at %g", Titled(kind), *scales));
      deltas.push_back(Study::DeltaOf(*by, *scales));
      MORTISE_ASSIGN_OR_RETURN(std::vector<double> each, CostsAt(study, *manifold, deltas.back()));
      if (std::isnan(each[0])) {
        deltas.pop_back();
        break;
      }
      const double cheaper = std::fmin(each[1], each[2]), dearer = std::fmax(each[1], each[2]);
      table.rows.push_back({Titled(kind), TableNumber(deltas.back()), CostText(each[0]),
                            CostText(each[1]), CostText(each[2]), TableNumber(each[0] / cheaper),
                            TableNumber(dearer / each[0])});
      costs.push_back(std::move(each));
    }
    auto [cost, relative] = CostPanels(kind, deltas, costs);
    above.push_back(std::move(cost));
    below.push_back(std::move(relative));
  }
  above.insert(above.end(), below.begin(), below.end());
  MORTISE_RETURN_IF_ERROR(results.Begin(
      "4-9", "Figure 4-9: what covers cost",
      "Points alone, tangents alone, and the hybrid, by D2. The thesis: the hybrid is constantly "
      "below both, and the others cost up to 5 times as much."));
  MORTISE_RETURN_IF_ERROR(results.Add("figure-4-9", DrawChart(above)));
  return results.Add("figure-4-9", table);
}

}  // namespace mortise::retrieval
