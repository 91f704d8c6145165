// Figures 4-12 and 4-14: pictures of what is found for labelled shapes.
#include <algorithm>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "services/retrieval/families/design_surface.h"
#include "tests/bench/services/retrieval/evaluation/figures.h"
#include "tests/bench/services/retrieval/evaluation/query_shapes.h"
#include "tests/bench/services/retrieval/evaluation/shape_sheet.h"

namespace mortise::retrieval {
namespace {

// The first match of a query, and its distance.
struct Found {
  int family = 0;
  double distance = 0;
  mesh::SurfaceMesh surface;
};

// The design of the nearest primitive; of mean shapes the mean shape.
absl::StatusOr<Found> Find(const Study& study, const PrimitiveIndex& index, std::size_t descriptor,
                           const LabelledShape& shape, const Eigen::VectorXd& vector) {
  MORTISE_ASSIGN_OR_RETURN(
      const auto matches,
      study.Search(index, descriptor, vector, 1, FamiliesFor(study, shape, Strictness::kShape)));
  if (matches.empty()) return absl::NotFoundError("no family may be found");
  Found found{.family = matches[0].family, .distance = matches[0].distance, .surface = {}};
  const EvaluationFamily& family = study.families()[static_cast<std::size_t>(found.family)];
  const Eigen::VectorXd q = index.PrimitiveOf(matches[0]).parameters;
  if (q.size() == 0) {
    MORTISE_ASSIGN_OR_RETURN(found.surface, MeanShape(family));
    return found;
  }
  MORTISE_ASSIGN_OR_RETURN(const parametric::EvaluatedDesign design,
                           family.design_template->Evaluate(q));
  found.surface = DesignSurface(design);
  return found;
}

// One labelled shape of each category, the middle one of those that may be asked for; those of the
// thesis, or what there is.
std::vector<std::size_t> ShownQueries(const Study& study, int more) {
  std::vector<std::size_t> shown;
  std::vector<std::string> categories = ThesisCategories();
  for (const LabelledShape& shape : study.shapes()) {
    if (std::ranges::find(categories, shape.category) == categories.end()) {
      categories.push_back(shape.category);
    }
  }
  for (const std::string& category : categories) {
    if (static_cast<int>(shown.size()) >= static_cast<int>(ThesisCategories().size()) + more) break;
    std::vector<std::size_t> of_category;
    for (std::size_t i = 0; i < study.shapes().size(); ++i) {
      if (study.shapes()[i].category == category) of_category.push_back(i);
    }
    if (!of_category.empty()) shown.push_back(of_category[of_category.size() / 2]);
  }
  return shown;
}

ResultTable FoundTable(const std::string& title) {
  return {.title = title,
          .columns = {"query", "category", "by", "found", "its category", "distance"},
          .rows = {}};
}

void AddRow(const Study& study, const LabelledShape& query, const std::string& by,
            const Found& found, ResultTable& table) {
  const EvaluationFamily& family = study.families()[static_cast<std::size_t>(found.family)];
  table.rows.push_back(
      {query.name, query.category, by, family.name, family.category, TableNumber(found.distance)});
}

}  // namespace

absl::Status WriteFoundByDelta(Study& study, ResultFolder& results) {
  const std::vector<double> deltas{study.effort().deltas.front(), study.effort().deltas.back()};
  ShapeSheet sheet(1 + static_cast<int>(study.descriptors().size() * deltas.size()));
  ResultTable table = FoundTable("The nearest design for one shape of each category");
  for (const std::size_t i : ShownQueries(study, 0)) {
    const LabelledShape& shape = study.shapes()[i];
    MORTISE_RETURN_IF_ERROR(sheet.Add(shape.surface, ShapeSheet::Kind::kQuery, shape.category));
    for (std::size_t d = 0; d < study.descriptors().size(); ++d) {
      MORTISE_ASSIGN_OR_RETURN(const auto* vectors, study.Described(d));
      for (const double scales : deltas) {
        const std::string by =
            absl::StrFormat("%s, %g", study.descriptors()[d]->properties().name, scales);
        MORTISE_ASSIGN_OR_RETURN(const PrimitiveIndex* index, study.Manifolds(d, scales));
        MORTISE_ASSIGN_OR_RETURN(const Found found, Find(study, *index, d, shape, (*vectors)[i]));
        MORTISE_RETURN_IF_ERROR(sheet.Add(found.surface, ShapeSheet::Kind::kDesign, by));
        AddRow(study, shape, by, found, table);
      }
    }
  }
  MORTISE_RETURN_IF_ERROR(results.Begin(
      "4-12", "Figure 4-12: what is found for shapes of the web",
      absl::StrFormat("The query, and for each descriptor the design of the nearest primitive at "
                      "δ = %g and %g natural scales. A family made of the query itself is left "
                      "out.",
                      deltas[0], deltas[1])));
  MORTISE_ASSIGN_OR_RETURN(const render::Image picture, sheet.Draw());
  MORTISE_RETURN_IF_ERROR(results.Add("figure-4-12", picture));
  return results.Add("figure-4-12", table);
}

absl::Status WriteFoundByMeanShapes(Study& study, ResultFolder& results) {
  const std::size_t d = study.descriptors().size() - 1;  // the light field
  ShapeSheet sheet(4);
  ResultTable table = FoundTable("By mean shapes and by manifolds, light field");
  MORTISE_ASSIGN_OR_RETURN(const auto* vectors, study.Described(d));
  MORTISE_ASSIGN_OR_RETURN(const PrimitiveIndex* means, study.MeanShapes(d));
  MORTISE_ASSIGN_OR_RETURN(const PrimitiveIndex* manifolds,
                           study.Manifolds(d, study.effort().deltas.back()));
  for (const std::size_t i : ShownQueries(study, 2)) {
    const LabelledShape& shape = study.shapes()[i];
    MORTISE_ASSIGN_OR_RETURN(const Found mean, Find(study, *means, d, shape, (*vectors)[i]));
    MORTISE_ASSIGN_OR_RETURN(const Found design, Find(study, *manifolds, d, shape, (*vectors)[i]));
    const EvaluationFamily& family = study.families()[static_cast<std::size_t>(design.family)];
    MORTISE_ASSIGN_OR_RETURN(const mesh::SurfaceMesh its_mean, MeanShape(family));
    const auto told = [](const Found& found) {
      return absl::StrCat("at ", TableNumber(found.distance, 2));
    };
    MORTISE_RETURN_IF_ERROR(sheet.Add(shape.surface, ShapeSheet::Kind::kQuery, shape.category));
    MORTISE_RETURN_IF_ERROR(sheet.Add(mean.surface, ShapeSheet::Kind::kMeanShape, told(mean)));
    MORTISE_RETURN_IF_ERROR(sheet.Add(design.surface, ShapeSheet::Kind::kDesign, told(design)));
    MORTISE_RETURN_IF_ERROR(sheet.Add(its_mean, ShapeSheet::Kind::kMeanShape, family.name));
    AddRow(study, shape, "mean shapes", mean, table);
    AddRow(study, shape, "manifolds", design, table);
  }
  MORTISE_RETURN_IF_ERROR(results.Begin(
      "4-14", "Figure 4-14: mean shapes and manifolds",
      "The query (green), the nearest mean shape (grey), the nearest design of all manifolds "
      "(blue), and the mean shape of its family (grey); light field."));
  MORTISE_ASSIGN_OR_RETURN(const render::Image picture, sheet.Draw());
  MORTISE_RETURN_IF_ERROR(results.Add("figure-4-14", picture));
  return results.Add("figure-4-14", table);
}

}  // namespace mortise::retrieval
