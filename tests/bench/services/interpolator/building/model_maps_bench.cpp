// Maps of shapes and stresses of the models of the thesis (Tables 6.1 and 6.2), built in process by
// two threads: what they take, and how far they are off at ten random designs.
//
//   model_maps_bench [MODEL [POINTS [ELEMENT_SIZE in mm]]]
//
// Without arguments the wrench. Per model: K, levels, samples, evaluations, tetrahedra of the
// canonical meshes, their number, shapes stored and their bytes; seconds of evaluation and of all
// else, summed over threads; errors over size and range, largest and 99 %, beside the thesis's.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/base/digest.h"
#include "common/base/elapsed_time.h"
#include "common/base/errors.h"
#include "common/base/random.h"
#include "common/design/parameter_values.h"
#include "common/fields/fields_file.h"
#include "common/maps/packed_weights.h"
#include "common/templates/template_codec.h"
#include "services/interpolator/building/map_building.h"
#include "services/interpolator/shapes/blend.h"
#include "services/interpolator/shapes/shape_file.h"
#include "services/simulator/analysis/design_fields.h"
#include "services/simulator/worker/template_model.h"
#include "tests/unit/common/templates/shipped_collection.h"
#include "tests/unit/services/interpolator/shapes/brought_design.h"

namespace mortise::interpolator {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kThreads = 2;

struct Model {
  std::string name;
  int evaluations = 0;
  double element_size = 0;  // m
  const char* published;    // K, levels, samples; geometry max, 99 %; FEM max, 99 %
};

const Model kModels[] = {{"wrench", 80, 0.006, "3, 5, 49; .0028 .0004; .2138 .0393"},
                         {"chair", 1600, 0.03, "6, 7, 777; .0243 .0022; .3756 .1130"},
                         {"bike-rocker-arm", 240, 0.004, "4, 6, 103; .0112 .0003; .1403 .0281"},
                         {"camera-mount", 560, 0.004, "5, 6, 259; .0009 .0002; .4107 .1861"},
                         {"swing-castle", 140, 0.08, "3, 5, 58; .0013 .0002; .4750 .2042"},
                         {"plane", 330, 0.01, "4, 5, 148; .0162 .0055; -"},
                         {"drum-brake", 160, 0.008, "3, 6, 72; .0016 .0006; .3095 .0490"}};

class Shelf {
 public:
  std::string Put(const std::string& bytes) {
    const std::lock_guard lock(mutex_);
    std::string digest = Sha256Hex(bytes);
    files_[digest] = bytes;
    return digest;
  }
  absl::StatusOr<std::string> Get(const std::string& digest) const {
    const std::lock_guard lock(mutex_);
    const auto found = files_.find(digest);
    if (found == files_.end()) return absl::NotFoundError(digest);
    return found->second;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::string> files_;
};

class ModelEvaluator {
 public:
  explicit ModelEvaluator(const Model& model) : model_(model) {
    auto function = templates::Compile(templates::ShippedTemplate("templates/" + model.name));
    if (!function.ok()) std::abort();
    function_ = *std::move(function);
  }

  MapPlan Plan() const {
    MapPlan plan;
    plan.base = parametric::Defaults(function_->parameters());
    for (const parametric::Parameter& parameter : function_->parameters()) {
      const auto index = static_cast<Eigen::Index>(plan.names.size());
      plan.names.push_back(parameter.name);
      plan.parameters.push_back({.name = parameter.name,
                                 .unit = parameter.unit,
                                 .index = index,
                                 .minimum = parameter.minimum,
                                 .maximum = parameter.maximum});
    }
    plan.evaluations = model_.evaluations;
    plan.structures.resize(0, 1);
    return plan;
  }

  absl::StatusOr<fields::DesignFields> Evaluate(const Eigen::VectorXd& q) {
    const auto start = Clock::now();
    simulator::FieldsDemand demand{.tetrahedra = true, .fields = {"von_mises"}};
    simulator::DesignAnalysisOptions options;
    options.mesh.element_size = model_.element_size;
    simulator::DemandFields(demand, options);
    MORTISE_ASSIGN_OR_RETURN(const auto design, function_->Evaluate(q));
    MORTISE_ASSIGN_OR_RETURN(
        const auto model,
        simulator::MakeDesignModel(*function_, q, design, {.element_size = model_.element_size}));
    MORTISE_ASSIGN_OR_RETURN(const auto analysis,
                             simulator::AnalyzeDesign(model, {"max_von_mises"}, false, options));
    auto fields = simulator::CollectFields(model, analysis, demand);
    microseconds_ += static_cast<std::int64_t>(1e6 * SecondsSince(start));
    return fields;
  }

  double seconds() const { return 1e-6 * static_cast<double>(microseconds_.load()); }

 private:
  const Model model_;
  std::shared_ptr<const templates::Template> function_;
  std::atomic<std::int64_t> microseconds_ = 0;
};

BuildOptions OptionsOf(ModelEvaluator& evaluator, Shelf& shelf, int evaluations) {
  BuildOptions options;
  options.lanes = kThreads;
  options.sampling.round_points = std::clamp(evaluations / 16, 8, 64);
  options.evaluate = [&](const std::vector<Eigen::VectorXd>& designs)
      -> absl::StatusOr<std::vector<DesignAnswer>> {
    std::vector<DesignAnswer> answers;
    for (const Eigen::VectorXd& design : designs) {
      DesignAnswer& answer = answers.emplace_back();
      const auto fields = evaluator.Evaluate(design);
      answer.status = fields.status();
      if (!fields.ok()) continue;
      answer.file = shelf.Put(fields::WriteFields(*fields).value());
    }
    return answers;
  };
  ShapeOptions shapes;
  shapes.threads = kThreads;
  shapes.fields = {{"von_mises", 0.02}};
  shapes.noise_floor = 1e-3;
  shapes.put = [&shelf](const std::string& bytes) { return shelf.Put(bytes); };
  shapes.get = [&shelf](const std::string& digest) { return shelf.Get(digest); };
  options.shapes = std::move(shapes);
  options.progress = [](const BuildProgress& progress) {
    std::fprintf(
        stderr,
        "\r%ld evaluated (%ld failed), %ld mapped, %ld to map, %ld not, %d meshes, error %.4f ",
        progress.evaluations, progress.failed, progress.shapes, progress.to_map, progress.unmapped,
        progress.meshes, progress.error);
  };
  return options;
}

// How far the design itself is off when it is brought into the mesh: its facets are others.
double FacetingOf(const ConsistentShape& shape, const CanonicalMesh& mesh,
                  const fields::DesignFields& truth) {
  BlendedShape blended;
  blended.positions.assign(shape.nodes.data(), shape.nodes.data() + shape.nodes.size());
  const auto difference = Difference(blended, mesh, truth, nullptr);
  return difference.ok() ? difference->shape.of_99 / difference->size : 0;
}

// Errors at random designs, over size and range.
void Verify(const MapBuilding& building, const ShapedStructure& structure, const MapPlan& plan,
            ModelEvaluator& evaluator, const Shelf& shelf) {
  const maps::RefinementTree& tree = building.structures()[0]->tree();
  const maps::PackedWeights weights(tree);
  std::map<int, int> order;
  for (const int element : tree.Elements()) order.emplace(element, static_cast<int>(order.size()));
  Random random(2026);
  Spread shape, stress;
  double faceting = 0;
  int compared = 0, uncovered = 0;
  while (compared < 10) {
    Eigen::VectorXd point(tree.dimension());
    for (double& coordinate : point) coordinate = random.Uniform();
    const auto truth = evaluator.Evaluate(plan.DesignAt(0, point));
    if (!truth.ok()) continue;
    ++compared;
    std::vector<maps::SampleWeight> acting;
    const int mesh = structure.element_mesh[order.at(weights.At(point.data(), acting))];
    if (mesh < 0) {
      ++uncovered;
      continue;
    }
    const CanonicalMesh canonical =
        ReadMesh(shelf.Get(structure.meshes[mesh].digest).value()).value();
    std::vector<PackedShape> packed;
    for (const maps::SampleWeight& each : acting) {
      const std::string& digest = structure.shapes.at({mesh, each.sample}).digest;
      packed.push_back(ReadShape(shelf.Get(digest).value(), canonical).value());
    }
    std::vector<WeightedShape> weighted;
    for (std::size_t n = 0; n < acting.size(); ++n) {
      weighted.push_back({&packed[n], acting[n].weight});
    }
    BlendedShape blended;
    if (!Blend(weighted, canonical, {.surface_only = false, .fields = {0}}, blended).ok()) abort();
    const auto brought = Brought(*truth, canonical);
    const auto difference =
        Difference(blended, canonical, *truth, brought.ok() ? &brought->shape : nullptr);
    if (!difference.ok()) std::abort();
    if (!brought.ok()) {
      std::printf("  not brought: %s\n", brought.status().ToString().c_str());
    } else {
      const Spread& each = difference->fields[0];
      const double range = structure.ranges[0].length();
      stress.largest = std::max(stress.largest, each.largest / range);
      stress.of_99 = std::max(stress.of_99, each.of_99 / range);
      faceting = std::max(faceting, FacetingOf(brought->shape, canonical, *truth));
    }
    shape.largest = std::max(shape.largest, difference->shape.largest / difference->size);
    shape.of_99 = std::max(shape.of_99, difference->shape.of_99 / difference->size);
  }
  std::printf(
      "  10 designs: geometry %.4f %.4f (of two meshes of one design: %.4f), stress %.4f %.4f, "
      "%d uncovered\n",
      shape.largest, shape.of_99, faceting, stress.largest, stress.of_99, uncovered);
}

int DepthOf(const maps::RefinementTree& tree) {
  int depth = 0;
  for (const int element : tree.Elements()) {
    for (int d = 0; d < tree.dimension(); ++d) depth = std::max(depth, tree.DepthOf(element, d));
  }
  return depth;
}

void Run(const Model& model) {
  ModelEvaluator evaluator(model);
  const MapPlan plan = evaluator.Plan();
  Shelf shelf;
  const BuildOptions options = OptionsOf(evaluator, shelf, plan.evaluations);
  auto building = MapBuilding::Create(plan, options).value();
  const auto start = Clock::now();
  const absl::Status status = building->Run({});
  const double seconds = SecondsSince(start);
  const double evaluation = evaluator.seconds();
  std::fprintf(stderr, "\n");
  if (!status.ok()) {
    std::printf("%s: %s\n", model.name.c_str(), status.ToString().c_str());
    return;
  }
  const auto shapes = building->ShapesOf(0);
  if (!shapes.ok()) std::abort();
  const ShapedStructure& structure = **shapes;
  const BuildProgress progress = building->progress();
  const maps::MapSamplingProgress sampling = building->structures()[0]->Progress();
  std::int64_t bytes = 0, inverted = 0, tetrahedra = 0;
  for (const auto& [key, shape] : structure.shapes)
    bytes += shape.bytes, inverted += shape.inverted;
  for (const auto& mesh : structure.meshes) tetrahedra = std::max(tetrahedra, mesh.tetrahedra);
  std::printf("%s (thesis: %s)\n", model.name.c_str(), model.published);
  std::printf(
      "  K %zu, levels %d, samples %d, evaluations %ld (%ld failed), %d of %d elements cut off\n",
      plan.parameters.size(), DepthOf(building->structures()[0]->tree()) + 1, sampling.samples,
      progress.evaluations, progress.failed, sampling.cut_off, sampling.elements);
  std::printf("  %ld tetrahedra, %zu meshes, %zu shapes, %.1f MB, %ld inverted, %ld unmapped\n",
              tetrahedra, structure.meshes.size(), structure.shapes.size(),
              static_cast<double>(bytes) / 1e6, inverted, structure.unmapped);
  std::printf("  %.0f s; evaluation %.0f s of two threads, mapping and comparing %ld designs\n",
              seconds, evaluation, progress.shapes);
  for (const evaluation::FailureCount& failure : progress.failures) {
    std::printf("  %ld failed: %s\n", failure.count, failure.message.c_str());
  }
  if (structure.fields.empty()) return;
  std::printf("  at probes: geometry %.4f %.4f (mean %.4f), stress %.4f %.4f (mean %.4f)\n",
              structure.largest.shape.largest / structure.shapes.begin()->second.size,
              structure.largest.shape.of_99 / structure.shapes.begin()->second.size,
              structure.mean.shape.of_99 / structure.shapes.begin()->second.size,
              structure.largest.fields[0].largest / structure.ranges[0].length(),
              structure.largest.fields[0].of_99 / structure.ranges[0].length(),
              structure.mean.fields[0].of_99 / structure.ranges[0].length());
  Verify(*building, structure, plan, evaluator, shelf);
}

}  // namespace
}  // namespace mortise::interpolator

int main(int argc, char** argv) {
  using mortise::interpolator::kModels;
  const std::string name = argc > 1 ? argv[1] : "wrench";
  for (mortise::interpolator::Model model : kModels) {
    if (model.name != name && name != "all") continue;
    if (argc > 2) model.evaluations = std::atoi(argv[2]);
    if (argc > 3) model.element_size = 1e-3 * std::atof(argv[3]);
    mortise::interpolator::Run(model);
  }
  return 0;
}
