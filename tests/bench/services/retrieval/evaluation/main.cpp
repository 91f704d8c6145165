// `retrieval_evaluation`: the evaluation of thesis §4.7 (docs/retrieval-evaluation.md). It needs no
// house, but runs where collection/ is.
#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "common/mesh/scenes/scene_reader.h"
#include "tests/bench/services/retrieval/evaluation/evaluation.h"

int main(int argc, char** argv) {
  using namespace mortise::retrieval;
  if (argc == 2 && std::string_view(argv[1]) == mortise::mesh::kSceneChildArgument) {
    return mortise::mesh::RunSceneChild();
  }
  CLI::App app("Evaluate retrieval as §4.7 of the thesis does", "retrieval_evaluation");
  StudySettings settings;
  std::vector<std::string> figures;
  app.add_option("--shapes", settings.shapes,
                 "Folder of labelled shapes, with labels.csv; random designs stand in without");
  app.add_option("--out", settings.out, "Folder for what is measured")->required();
  app.add_option("--figure", figures,
                 "Only this, again for more: " + absl::StrJoin(FigureNames(), ", "));
  app.add_option("--families", settings.families,
                 "At most so many families of what ships, and of each category of meshes");
  app.add_option("--evaluations", settings.evaluations,
                 "At most so many designs for the cover of a family");
  app.add_flag("--points", settings.points,
               "Covers of points alone, which take a tenth of the time");
  app.add_flag("--kernel", settings.kernel,
               "Also families whose solids the CAD kernel makes: hours instead of an hour");
  app.add_option("--threads", settings.threads, "Same results with any number")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seed", settings.seed, "Same seed, same results")->capture_default_str();
  app.add_flag("--quick", settings.quick, "A handful of families and samples, to see it work");
  CLI11_PARSE(app, argc, argv);
  std::mutex mutex;
  const auto begin = std::chrono::steady_clock::now();
  const absl::Status done = Evaluate(settings, figures, [&](std::string_view what) {
    const std::lock_guard lock(mutex);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    std::cerr << absl::StrFormat("%6.0f s  ", seconds.count()) << what << std::endl;
  });
  if (done.ok()) return 0;
  std::cerr << done << std::endl;
  return 1;
}
