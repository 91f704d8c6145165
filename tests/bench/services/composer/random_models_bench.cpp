// Whether what random scripts compose can be made: each model that has several principal parts is
// made a template as saving makes one, divided into tetrahedra as for an analysis, planned, and
// written as STEP and read back. A line for each model, and one for each thing that is wrong; at
// the end how many there were, and how long each took.
// random_models_bench [--seed FIRST] [--count MODELS] [--steps STEPS] [--parts MOST] [--trace]
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/cad/step/step_reader.h"
#include "common/design/parameter_values.h"
#include "common/files/template_codec.h"
#include "common/mesh/tetrahedra/mesher.h"
#include "common/templates/template_codec.h"
#include "services/catalog/exchange/assembly_export.h"
#include "services/fabplanner/planning/planning.h"
#include "services/fabplanner/service/design_codec.h"
#include "services/simulator/worker/template_model.h"
#include "tests/unit/services/composer/scripts/composed_drawing.h"

namespace mortise::composer {
namespace {

// In proportion. Where parts are round meshes have flat sides, which keep the volume but for a
// little.
constexpr double kSameVolume = 1e-3;
constexpr double kSameVolumeOfStep = 1e-6;

struct Request {
  std::uint64_t seed = 1;
  int count = 100;
  RandomScriptOptions options;
  bool trace = false;  // print the steps of every script
};

bool Parse(const std::vector<std::string>& words, Request* request) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "--trace") {
      request->trace = true;
      continue;
    }
    std::uint64_t value = 0;
    if (i + 1 >= words.size() || !absl::SimpleAtoi(words[i + 1], &value)) return false;
    if (words[i] == "--seed") {
      request->seed = value;
    } else if (words[i] == "--count") {
      request->count = static_cast<int>(value);
    } else if (words[i] == "--steps") {
      request->options.steps = static_cast<int>(value);
    } else if (words[i] == "--parts") {
      request->options.most_parts = value;
    } else {
      return false;
    }
    ++i;
  }
  return true;
}

// What is done with each model, with what came of it.
class Workshop {
 public:
  // Whether a model can be saved at all: the catalog takes no parts that nothing holds.
  bool CanBeSaved(const ComposedBody& body) {
    const absl::StatusOr<parametric::Assembly> drawn = DrawnAt(body.design);
    if (!drawn.ok()) return true;  // as is told when it is made
    const absl::Status made = parametric::ParametricAssembly::Create(*drawn).status();
    unheld_ += DetailOf(made).reason == "FEASIBLE_SET_UNBOUNDED" ? 1 : 0;
    return DetailOf(made).reason != "FEASIBLE_SET_UNBOUNDED";
  }

  // Whether nothing is wrong with a model.
  bool Make(const ComposedBody& body, const std::string& id) {
    faults_.clear();
    numbers_.clear();
    Do("template", [&] { return MakeTemplate(body, id); });
    if (!function_) return false;
    Do("mesh", [&] { return MakeMesh(); });
    Do("plan", [&] { return Plan(); });
    Do("step", [&] { return WriteAndReadStep(id); });
    function_ = nullptr;
    return faults_.empty();
  }

  const std::vector<std::string>& faults() const { return faults_; }
  const std::string& numbers() const { return numbers_; }
  int unheld() const { return unheld_; }        // models that cannot be saved
  int untrimmed() const { return untrimmed_; }  // models that default trims leave too little for
  const std::map<std::string, int>& done() const { return done_; }
  const std::map<std::string, double>& seconds() const { return seconds_; }

 private:
  template <typename Work>
  void Do(const std::string& name, const Work& work) {
    const auto began = std::chrono::steady_clock::now();
    const absl::Status status = work();
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - began;
    seconds_[name] += spent.count();
    if (!status.ok()) {
      faults_.push_back(absl::StrFormat("%s: %s", name, status.ToString()));
    } else {
      ++done_[name];
    }
  }

  // As the catalog takes what is saved.
  absl::Status MakeTemplate(const ComposedBody& body, const std::string& id) {
    MORTISE_ASSIGN_OR_RETURN(bundle_, ComposedTemplate(body, id));
    MORTISE_RETURN_IF_ERROR(templates::FillAndCheck(bundle_, templates::Trial::kDefaults));
    MORTISE_ASSIGN_OR_RETURN(function_, templates::Compile(bundle_));
    q_ = parametric::Defaults(function_->parameters());
    absl::StatusOr<parametric::EvaluatedDesign> design = function_->Evaluate(q_);
    if (!design.ok()) {
      function_ = nullptr;
      return design.status();
    }
    design_ = *std::move(design);
    numbers_ += absl::StrFormat("%3d parts", design_.parts.size());
    return absl::OkStatus();
  }

  absl::Status MakeMesh() {
    MORTISE_ASSIGN_OR_RETURN(const simulator::DesignModel model,
                             simulator::MakeDesignModel(*function_, q_, design_));
    MORTISE_ASSIGN_OR_RETURN(const mesh::TetrahedralMesh made, mesh::MeshAssembly(model.surface));
    double volume = 0, wanted = 0;
    for (Eigen::Index e = 0; e < made.tetrahedra.cols(); ++e) {
      const Eigen::Vector3d corner = made.nodes.col(made.tetrahedra(0, e));
      Eigen::Matrix3d edges;
      for (int i = 0; i < 3; ++i) {
        edges.col(i) = made.nodes.col(made.tetrahedra(i + 1, e)) - corner;
      }
      volume += edges.determinant() / 6;
    }
    for (const parametric::EvaluatedPart& part : design_.parts) {
      wanted += part.connecting ? 0 : part.volume;
    }
    numbers_ += absl::StrFormat(", %6d tetrahedra", made.tetrahedra.cols());
    return CheckVolume(volume, wanted, kSameVolume);
  }

  absl::Status Plan() {
    MORTISE_ASSIGN_OR_RETURN(fabplanner::Design design,
                             fabplanner::DesignFrom(parametric::ToProto(design_)));
    fabplanner::AddDrawing(bundle_.assembly(), &design);
    MORTISE_ASSIGN_OR_RETURN(const fabplanner::Items items, fabplanner::ItemsFrom(bundle_));
    absl::StatusOr<fabplanner::FabricationPlan> plan = fabplanner::MakePlan(design, items, 1);
    const std::string reason = DetailOf(plan.status()).reason;
    if (reason == "PART_TOO_LONG" || reason == "PART_TOO_LARGE") {
      // Dragged until it takes all of its board or sheet, of which nothing can be trimmed then.
      ++untrimmed_;
      numbers_ += ", untrimmed";
      plan = fabplanner::MakePlan(design, items, 1, {.board_trim = 0, .sheet_trim = 0});
    }
    MORTISE_RETURN_IF_ERROR(plan.status());
    numbers_ += absl::StrFormat(", %3d steps", plan->steps.size());
    if (plan->parts.size() == design.parts.size()) return absl::OkStatus();
    return absl::InternalError("not all parts are planned");
  }

  absl::Status WriteAndReadStep(const std::string& id) {
    MORTISE_ASSIGN_OR_RETURN(const auto drawn, function_->AssemblyAt(q_));
    MORTISE_ASSIGN_OR_RETURN(
        const std::string bytes,
        catalog::ExportAssemblyStep({*drawn->assembly, drawn->q, design_, ""}, id));
    MORTISE_ASSIGN_OR_RETURN(const cad::StepAssembly read, cad::ReadStep(bytes));
    double volume = 0, wanted = 0;
    for (const cad::StepPart& part : read.parts) volume += part.volume;
    for (const parametric::EvaluatedPart& part : design_.parts) wanted += part.volume;
    numbers_ += absl::StrFormat(", STEP of %4.1f MB", 1e-6 * static_cast<double>(bytes.size()));
    if (read.parts.size() != design_.parts.size()) {
      return absl::InternalError(absl::StrFormat("%d solids are read of %d parts",
                                                 read.parts.size(), design_.parts.size()));
    }
    return CheckVolume(volume, wanted, kSameVolumeOfStep);
  }

  static absl::Status CheckVolume(double volume, double wanted, double share) {
    if (std::abs(volume - wanted) <= share * wanted) return absl::OkStatus();
    return absl::InternalError(
        absl::StrFormat("its volume is %.9g m3 and not %.9g m3, %.2g of it off", volume, wanted,
                        std::abs(volume / wanted - 1)));
  }

  v1::TemplateBundle bundle_;
  std::shared_ptr<const templates::Template> function_;
  Eigen::VectorXd q_;
  parametric::EvaluatedDesign design_;
  std::vector<std::string> faults_;
  std::string numbers_;
  int unheld_ = 0, untrimmed_ = 0;
  std::map<std::string, int> done_;
  std::map<std::string, double> seconds_;
};

int Run(const Request& request) {
  Workshop workshop;
  int made = 0, faulty = 0;
  for (std::uint64_t seed = request.seed; made < request.count; ++seed) {
    RandomScriptOptions options = request.options;
    options.seed = seed;
    const ScriptOutcome outcome = RunRandomScript(options);
    if (!outcome.body || outcome.parts < 2 || !workshop.CanBeSaved(*outcome.body)) continue;
    ++made;
    const bool is_sound = workshop.Make(*outcome.body, absl::StrFormat("random-%d", seed));
    faulty += is_sound ? 0 : 1;
    std::cout << absl::StrFormat("seed %5d: %s\n", seed, workshop.numbers());
    for (const std::string& fault : workshop.faults()) {
      std::cout << "seed " << seed << ", " << fault << "\n";
    }
    std::cout << std::flush;
    if (!request.trace) continue;
    for (const std::string& step : outcome.steps) std::cout << "  " << step << "\n";
  }
  std::cout << absl::StrFormat(
      "%d models from seed %d; with %d something is wrong; %d only fit "
      "stock that is not trimmed\n",
      made, request.seed, faulty, workshop.untrimmed());
  std::cout << absl::StrFormat("%d more have parts that nothing holds, and cannot be saved\n",
                               workshop.unheld());
  for (const auto& [name, seconds] : workshop.seconds()) {
    const auto done = workshop.done().find(name);
    std::cout << absl::StrFormat("  %-8s %4d of them, %.1f s\n", name,
                                 done == workshop.done().end() ? 0 : done->second, seconds);
  }
  return faulty == 0 ? 0 : 1;
}

}  // namespace
}  // namespace mortise::composer

int main(int count, char** arguments) {
  mortise::composer::Request request;
  if (!mortise::composer::Parse({arguments + 1, arguments + count}, &request)) {
    std::cerr << "Usage: random_models_bench [--seed FIRST] [--count MODELS] [--steps STEPS] "
                 "[--parts MOST] [--trace]\n";
    return 2;
  }
  return mortise::composer::Run(request);
}
