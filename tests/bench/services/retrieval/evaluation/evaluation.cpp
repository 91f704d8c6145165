#include "tests/bench/services/retrieval/evaluation/evaluation.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "tests/bench/services/retrieval/evaluation/figures.h"

namespace mortise::retrieval {
namespace {

struct Figure {
  std::string name;
  absl::Status (*write)(Study&, ResultFolder&);
};

// What needs no covers first.
const std::vector<Figure>& Figures() {
  static const auto* const figures = new std::vector<Figure>{{"4.1", WriteCollection},
                                                             {"4-7", WriteSamplingSchemes},
                                                             {"labelled", WriteLabelledShapes},
                                                             {"4-8", WriteAccuracy},
                                                             {"4-9", WriteCosts},
                                                             {"4-10", WriteRandomDesigns},
                                                             {"4-11", WriteNaiveSampling},
                                                             {"4-12", WriteFoundByDelta},
                                                             {"4-13", WritePrecision},
                                                             {"4.2", WriteCategoryDistances},
                                                             {"4-14", WriteFoundByMeanShapes}};
  return *figures;
}

}  // namespace

std::vector<std::string> FigureNames() {
  std::vector<std::string> names;
  for (const Figure& figure : Figures()) names.push_back(figure.name);
  return names;
}

absl::Status Evaluate(const StudySettings& settings, const std::vector<std::string>& figures,
                      const std::function<void(std::string_view)>& say) {
  const std::vector<std::string> names = FigureNames();
  for (const std::string& figure : figures) {
    if (std::ranges::find(names, figure) != names.end()) continue;
    return InvalidField("figure", absl::StrCat("there is no figure '", figure, "', only ",
                                               absl::StrJoin(names, ", ")));
  }
  MORTISE_ASSIGN_OR_RETURN(const std::unique_ptr<Study> study, Study::Create(settings, say));
  ResultFolder results(settings.out);
  for (const Figure& figure : Figures()) {
    if (!figures.empty() && std::ranges::find(figures, figure.name) == figures.end()) continue;
    if (results.IsDone(figure.name, study->digest())) {
      say(absl::StrCat("figure ", figure.name, " is there already"));
      continue;
    }
    const auto begin = std::chrono::steady_clock::now();
    MORTISE_RETURN_IF_ERROR(figure.write(*study, results));
    MORTISE_RETURN_IF_ERROR(results.End(study->digest()));
    MORTISE_RETURN_IF_ERROR(results.WritePage(names));
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    say(absl::StrFormat("figure %s is done: %.0f s", figure.name, seconds.count()));
  }
  return results.WritePage(names);
}

}  // namespace mortise::retrieval
