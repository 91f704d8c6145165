// mesh_families: makes families of meshes and prints what came of each.
//
//   mesh_families FOLDER         the families of the evaluation (mesh_family.h)
//   mesh_families FOLDER --all   every labelled mesh
//   mesh_families FILE …         these meshes
#include <Eigen/Core>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <random>
#include <string_view>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/mesh/scenes/scene_reader.h"
#include "tests/bench/services/retrieval/families/mesh_family.h"

namespace mortise::bench {
namespace {

constexpr int kDesigns = 20;  // that are tried of each family

double Milliseconds(std::chrono::steady_clock::time_point since) {
  const std::chrono::duration<double, std::milli> passed = std::chrono::steady_clock::now() - since;
  return passed.count();
}

struct Trial {
  int made = 0;
  double milliseconds = 0;  // a design
  std::string fault;        // the first
};

// Evaluates designs at random parameters, the same ones in every run.
Trial TryDesigns(const templates::Template& function) {
  Trial trial;
  std::mt19937 random(1);
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < kDesigns; ++i) {
    Eigen::VectorXd q(static_cast<Eigen::Index>(function.parameters().size()));
    for (Eigen::Index k = 0; k < q.size(); ++k) {
      const auto& parameter = function.parameters()[static_cast<std::size_t>(k)];
      q(k) =
          parameter.minimum + (parameter.maximum - parameter.minimum) * (random() / 4294967296.0);
    }
    const auto design = function.Evaluate(q);
    if (design.ok()) {
      ++trial.made;
    } else if (trial.fault.empty()) {
      trial.fault = std::string(design.status().message());
    }
  }
  trial.milliseconds = Milliseconds(begin) / kDesigns;
  return trial;
}

// Returns whether there is a family.
bool Print(const LabelledMesh& mesh) {
  const auto begin = std::chrono::steady_clock::now();
  const absl::StatusOr<MeshFamily> family = FamilyOfMesh(mesh);
  const std::string file = absl::StrCat(mesh.category, "/", mesh.path.filename().string());
  if (!family.ok()) {
    std::printf("%-50s -- %s\n", file.c_str(), family.status().ToString().c_str());
    return false;
  }
  const double made = Milliseconds(begin);
  const Trial trial = TryDesigns(*family->design_template);
  std::printf("%-50s %5zu %8zu %10zu %4d %9zu %8.0f %8.2f %4d/%d %s\n", file.c_str(), family->parts,
              family->elements, family->relationships, family->degrees_of_freedom,
              family->design_template->parameters().size(), made, trial.milliseconds, trial.made,
              kDesigns, trial.fault.c_str());
  std::fflush(stdout);
  return true;
}

int Run(const std::vector<std::string>& arguments) {
  std::vector<LabelledMesh> meshes;
  if (!arguments.empty() && std::filesystem::is_directory(arguments[0])) {
    const absl::StatusOr<std::vector<LabelledMesh>> all = ReadLabels(arguments[0]);
    if (!all.ok()) {
      std::fprintf(stderr, "%s\n", all.status().ToString().c_str());
      return 1;
    }
    meshes = arguments.size() > 1 && arguments[1] == "--all" ? *all : ChooseFamilies(*all);
  } else {
    for (const std::string& argument : arguments) meshes.push_back({argument, "mesh", ""});
  }
  std::printf("%-50s %5s %8s %10s %4s %9s %8s %8s %7s\n", "mesh", "parts", "elements", "relations",
              "free", "parameters", "ms made", "ms F(q)", "designs");
  std::size_t count = 0;
  for (const LabelledMesh& mesh : meshes) count += Print(mesh) ? 1 : 0;
  std::printf("%zu of %zu meshes are families\n", count, meshes.size());
  return 0;
}

}  // namespace
}  // namespace mortise::bench

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments == std::vector<std::string>{mortise::mesh::kSceneChildArgument}) {
    return mortise::mesh::RunSceneChild();
  }
  return mortise::bench::Run(arguments);
}
