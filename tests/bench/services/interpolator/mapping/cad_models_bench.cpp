// How well, and how quickly, shapes of CAD templates that ship are brought into the mesh of the
// design in the middle of their parameters: the corners of the box of parameters shrunk about the
// middle to halves, and the box itself, or as many of its corners as are asked for, spread over it.
//
//   cad_models_bench [--size SHARE] [--spacing SHARE] [--corners N] [--linear] [--unmatched]
//   [NAME…]
//
// Meshes are those that the simulator's workers make; SHARE is of the element size of their own
// choice (a smaller one: finer), or of the design's diagonal for control points; with --unmatched
// the control points are told that only one of two designs has. A line a design: elements; control
// points that both have, paths given and added, patches; elements turned over at first, and left;
// distance of the two surfaces in millionths of the design's diagonal, largest and at 99 of 100
// places, and the largest in edges of the mesh; seconds of the mesh and the solution of the loads,
// of control variables, layout, disks, interior; and the ratio of the map to mesh and solution.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/design/parameter_values.h"
#include "common/templates/features/codec/cad_template_codec.h"
#include "common/templates/features/edge_samples.h"
#include "common/templates/template_codec.h"
#include "services/interpolator/mapping/control_points.h"
#include "services/interpolator/mapping/mesh_mapper.h"
#include "services/interpolator/mapping/nearest_place.h"
#include "services/simulator/worker/template_model.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::interpolator {
namespace {

struct Request {
  double size = 1, spacing = 0.25;
  int corners = 4;
  bool is_linear = false;
  bool tells_unmatched = false;
  std::vector<std::string> names;
};

class Stopwatch {
 public:
  // Returns the seconds since the last lap.
  double Lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - start_).count();
    start_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// A template that ships, as a function to evaluate and as a list of features.
struct Model {
  std::string name;
  std::shared_ptr<const templates::Template> function;
  std::shared_ptr<const cad::FeatureModel> features;
};

struct Sample {
  ModelMesh model;
  double evaluation_seconds = 0;  // mesh and solution
  double variables_seconds = 0;
};

double DiagonalOf(const Eigen::Matrix3Xd& nodes) {
  return (nodes.rowwise().maxCoeff() - nodes.rowwise().minCoeff()).norm();
}

absl::StatusOr<Model> Load(const std::string& name) {
  Model model{name, nullptr, nullptr};
  const v1::TemplateBundle bundle = templates::ShippedTemplate(name);
  if (!bundle.template_().has_cad()) return absl::NotFoundError("no CAD template");
  MORTISE_ASSIGN_OR_RETURN(model.function, templates::Compile(bundle));
  MORTISE_ASSIGN_OR_RETURN(cad::CadTemplate definition, cad::FromProto(bundle.template_().cad()));
  MORTISE_ASSIGN_OR_RETURN(cad::FeatureModel features,
                           cad::FeatureModel::Create(std::move(definition)));
  model.features = std::make_shared<const cad::FeatureModel>(std::move(features));
  return model;
}

absl::StatusOr<Sample> Evaluate(const Model& model, const Eigen::VectorXd& q,
                                const Request& request, double size) {
  Sample sample;
  MORTISE_ASSIGN_OR_RETURN(const auto design, model.function->Evaluate(q));
  MORTISE_ASSIGN_OR_RETURN(const simulator::DesignModel made,
                           simulator::MakeDesignModel(*model.function, q, design, {true, size}));
  simulator::DesignAnalysisOptions options;
  options.mesh.element_size = size > 0 ? size : mesh::DefaultElementSize(made.surface);
  options.mesh.quadratic = !request.is_linear;
  options.with_mesh = true;
  options.besides.loads = simulator::IsLoaded(made);
  MORTISE_ASSIGN_OR_RETURN(const simulator::DesignAnalysis analysis,
                           simulator::AnalyzeDesign(made, {"volume"}, false, options));
  sample.model.mesh = *analysis.mesh;
  sample.evaluation_seconds = analysis.seconds;
  Stopwatch watch;
  MORTISE_ASSIGN_OR_RETURN(const cad::RegeneratedModel solid, model.features->Regenerate(q));
  watch.Lap();
  MORTISE_ASSIGN_OR_RETURN(
      sample.model.variables,
      cad::FindControlVariables(solid, request.spacing * DiagonalOf(analysis.mesh->nodes)));
  sample.variables_seconds = watch.Lap();
  return sample;
}

// The distances of vertices and middles of triangles of each of two surfaces from the other.
std::vector<double> Distances(const mesh::SurfaceMesh& a, const mesh::SurfaceMesh& b) {
  std::vector<double> distances;
  for (const auto& [from, to] : {std::pair{&a, &b}, std::pair{&b, &a}}) {
    const NearestPlaces nearest = NearestPlaces::Create(*to).value();
    for (const auto& corners : from->triangles.colwise()) {
      const Eigen::Matrix3d at = from->vertices(Eigen::all, corners);
      distances.push_back(nearest.Distance(at.rowwise().mean()).value());
      distances.push_back(nearest.Distance(at.col(0)).value());
      distances.push_back(nearest.Distance((at.col(0) + at.col(1)) / 2).value());
    }
  }
  std::sort(distances.begin(), distances.end());
  return distances;
}

double MeanEdge(const mesh::SurfaceMesh& surface) {
  double sum = 0;
  for (const auto& corners : surface.triangles.colwise()) {
    sum += (surface.vertices.col(corners[1]) - surface.vertices.col(corners[0])).norm();
  }
  return sum / static_cast<double>(surface.triangles.cols());
}

void Print(const std::string& label, const Sample& sample, const MeshMapper& mapper) {
  std::printf("%-24s %6d ", label.c_str(), static_cast<int>(sample.model.mesh.tetrahedra.cols()));
  std::fflush(stdout);
  Stopwatch watch;
  const OuterSurface source = OuterSurfaceOf(sample.model.mesh);
  const auto marked = PlaceControlVariables(source.marked.surface, sample.model.variables);
  const double placing = sample.variables_seconds + watch.Lap();
  if (!marked.ok())
    return void(std::printf("%s\n", std::string(marked.status().message()).c_str()));
  const auto target =
      PlaceControlVariables(mapper.outer().marked.surface, mapper.target().variables);
  watch.Lap();
  const auto layout = BuildPatchLayout(*marked, *target);
  const double laying = watch.Lap();
  if (!layout.ok()) {
    std::printf("%s (%.1f s, evaluation %.1f s)\n", std::string(layout.status().message()).c_str(),
                laying, sample.evaluation_seconds);
    return;
  }
  const auto surface = MapSurface(*marked, *target);
  const double flattening = watch.Lap() - laying;
  const auto map = mapper.Map(sample.model);
  const double all = watch.Lap();
  if (!map.ok()) return void(std::printf("%s\n", std::string(map.status().message()).c_str()));
  mesh::SurfaceMesh mapped = mapper.outer().marked.surface;
  mapped.vertices = map->surface.positions;
  const std::vector<double> off = Distances(source.marked.surface, mapped);
  const double diagonal = DiagonalOf(sample.model.mesh.nodes);
  std::printf(
      "%4d %4d %4d %4d  %4d %3zu  %6.0f %6.0f %5.2f  %6.2f  %5.2f %5.2f %5.2f %5.2f  %5.2f\n",
      map->surface.points, map->surface.given_paths, map->surface.added_paths, map->surface.patches,
      map->volume.inverted_at_first, map->volume.inverted.size(), 1e6 * off.back() / diagonal,
      1e6 * off[off.size() * 99 / 100] / diagonal, off.back() / MeanEdge(source.marked.surface),
      sample.evaluation_seconds, placing, laying, flattening, all - laying - flattening,
      (all + sample.variables_seconds) / sample.evaluation_seconds);
}

void TellUnmatched(const mesh::ControlVariables& ours, const mesh::ControlVariables& theirs) {
  for (const auto& [from, to] : {std::pair{&ours, &theirs}, std::pair{&theirs, &ours}}) {
    std::set<std::string> names;
    for (const auto& point : to->points) names.insert(point.name);
    for (const auto& point : from->points) {
      if (names.count(point.name) > 0) continue;
      std::printf("  only in the %s: %s\n", from == &ours ? "design" : "middle",
                  point.name.c_str());
    }
  }
}

// Returns the middle of the parameters, and which of them vary.
Eigen::VectorXd MiddleOf(const std::vector<parametric::Parameter>& parameters,
                         std::vector<int>& varied) {
  const auto count = static_cast<int>(parameters.size());
  Eigen::VectorXd middle = parametric::Defaults(parameters);
  for (int i = 0; i < count; ++i) {
    const auto& parameter = parameters[static_cast<std::size_t>(i)];
    // What is counted has nothing between.
    if (parameter.step > 0 || parameter.minimum >= parameter.maximum) continue;
    middle[i] = (parameter.minimum + parameter.maximum) / 2;
    varied.push_back(i);
  }
  return middle;
}

void Run(const std::string& name, const Request& request) {
  const auto model = Load(name);
  if (!model.ok()) return void(std::printf("%s: %s\n", name.c_str(), "no CAD template"));
  const auto& parameters = model->function->parameters();
  std::vector<int> varied;
  const Eigen::VectorXd middle = MiddleOf(parameters, varied);
  absl::StatusOr<Sample> canonical = Evaluate(*model, middle, request, 0);
  if (!canonical.ok()) {
    std::printf("%s: %s\n", name.c_str(), std::string(canonical.status().message()).c_str());
    return;
  }
  const double size =
      request.size == 1
          ? 0
          : request.size * MeanEdge(OuterSurfaceOf(canonical->model.mesh).marked.surface);
  if (size > 0) canonical = Evaluate(*model, middle, request, size);
  Stopwatch watch;
  const auto mapper = MeshMapper::Create(canonical->model);
  if (!mapper.ok()) {
    std::printf("%s: %s\n", name.c_str(), std::string(mapper.status().message()).c_str());
    return;
  }
  std::printf("%s: made ready in %.2f s\n", name.c_str(), watch.Lap());
  Print(absl::StrCat(name, " itself"), *canonical, **mapper);
  const int corners = 1 << std::min<std::size_t>(varied.size(), 20);
  for (const double share : {0.5, 1.0}) {
    for (int c = 0; c < std::min(corners, request.corners); ++c) {
      // Spread, the first and last among them.
      const int corner =
          request.corners >= corners || request.corners < 2
              ? c
              : static_cast<int>(static_cast<long>(c) * (corners - 1) / (request.corners - 1));
      Eigen::VectorXd q = middle;
      std::string label = absl::StrCat(name, share < 1 ? " half " : " full ");
      for (std::size_t i = 0; i < varied.size(); ++i) {
        const auto& parameter = parameters[static_cast<std::size_t>(varied[i])];
        const bool is_high = corner >> i & 1;
        q[varied[i]] = std::clamp(
            q[varied[i]] + share * (is_high ? 0.5 : -0.5) * (parameter.maximum - parameter.minimum),
            parameter.minimum, parameter.maximum);
        label += is_high ? '+' : '-';
      }
      const auto sample = Evaluate(*model, q, request, size);
      if (sample.ok()) Print(label, *sample, **mapper);
      if (sample.ok() && request.tells_unmatched) {
        TellUnmatched(sample->model.variables, canonical->model.variables);
      }
      if (!sample.ok()) {
        std::printf("%-24s no design: %s\n", label.c_str(),
                    std::string(sample.status().message()).c_str());
      }
    }
  }
}

int Main(const std::vector<std::string>& words) {
  Request request;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto number = [&](double& value) {
      return i + 1 < words.size() && absl::SimpleAtod(words[++i], &value);
    };
    double corners = 0;
    if (words[i] == "--size") {
      if (!number(request.size)) return 2;
    } else if (words[i] == "--spacing") {
      if (!number(request.spacing)) return 2;
    } else if (words[i] == "--corners") {
      if (!number(corners)) return 2;
      request.corners = static_cast<int>(corners);
    } else if (words[i] == "--linear") {
      request.is_linear = true;
    } else if (words[i] == "--unmatched") {
      request.tells_unmatched = true;
    } else {
      request.names.push_back(words[i]);
    }
  }
  if (request.names.empty()) {
    request.names = {"wrench",       "chair", "bike-rocker-arm", "camera-mount",
                     "swing-castle", "plane", "drum-brake",      "arbor-press"};
  }
  for (const std::string& name : request.names) Run("templates/" + name, request);
  return 0;
}

}  // namespace
}  // namespace mortise::interpolator

int main(int argc, char** argv) { return mortise::interpolator::Main({argv + 1, argv + argc}); }
