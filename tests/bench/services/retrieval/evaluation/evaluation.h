// The evaluation of thesis §4.7 as one call.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "tests/bench/services/retrieval/evaluation/study.h"

namespace mortise::retrieval {

// "4.1", "4-7" … "4-14", "4.2", "labelled", in the order in which they are made.
std::vector<std::string> FigureNames();

// Writes figures into settings.out, all if none are named: tables as CSV, charts as SVG, pictures
// as PNG, each figure's page as Markdown, and evaluation.md with all that are there. What an
// earlier run made of the same is kept, so that a run which was stopped goes on. `say` is told what
// is under way. INVALID_ARGUMENT, "figure", for a name that is not known.
absl::Status Evaluate(const StudySettings& settings, const std::vector<std::string>& figures,
                      const std::function<void(std::string_view)>& say);

}  // namespace mortise::retrieval
