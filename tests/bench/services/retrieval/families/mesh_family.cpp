#include "tests/bench/services/retrieval/families/mesh_family.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <random>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "common/assembly/codec/assembly_codec.h"
#include "common/assembly/codec/parametrization_codec.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/mesh/scenes/scene_reader.h"
#include "common/templates/assembly_template.h"
#include "services/catalog/exchange/assembly_import.h"
#include "services/catalog/exchange/mesh_drawing.h"
#include "services/catalog/records/shape_records.h"

namespace mortise::bench {
namespace {

constexpr int kTrials = 40;            // designs at random parameters
constexpr double kFeasible = 0.9;      // of them that can be made
constexpr std::size_t kMaxSizes = 60;  // that are looked at

struct WantedCategory {
  const char* name;
  std::size_t count;
  const char* filler;  // where there are too few
};
constexpr WantedCategory kWanted[] = {{"lamp", 17, ""},    {"boat", 11, ""},
                                      {"chair", 15, ""},   {"plane", 9, "spaceship"},
                                      {"cart", 10, "car"}, {"table", 15, ""}};

absl::StatusOr<cad::StepAssembly> DrawingOf(const LabelledMesh& mesh,
                                            const MeshFamilyOptions& options) {
  MORTISE_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(mesh.path));
  MORTISE_ASSIGN_OR_RETURN(mesh::Scene scene,
                           mesh::ReadScene(bytes, mesh.path.filename().string()));
  return catalog::DrawingOfScene(std::move(scene), mesh.path.stem().string(),
                                 {.most_parts = options.most_parts});
}

// Of one category, those of several parts first, and then one of each source after the other.
std::vector<LabelledMesh> InTurn(const std::vector<LabelledMesh>& all, const std::string& category,
                                 const MeshFamilyOptions& options) {
  std::map<std::pair<bool, std::string>, std::size_t> seen;
  std::vector<std::pair<std::pair<bool, std::size_t>, LabelledMesh>> turns;
  for (const LabelledMesh& mesh : all) {
    if (mesh.category != category) continue;
    const absl::StatusOr<cad::StepAssembly> drawing = DrawingOf(mesh, options);
    if (!drawing.ok()) continue;
    const bool is_one_part = drawing->parts.size() == 1;
    turns.push_back({{is_one_part, seen[{is_one_part, mesh.source}]++}, mesh});
  }
  std::stable_sort(turns.begin(), turns.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<LabelledMesh> meshes;
  for (auto& [turn, mesh] : turns) meshes.push_back(std::move(mesh));
  return meshes;
}

std::string IdOf(const LabelledMesh& mesh) {
  std::string id = absl::StrCat(mesh.category, "-", mesh.path.stem().string());
  for (char& letter : id) {
    const auto byte = static_cast<unsigned char>(letter);
    letter = std::isalnum(byte) != 0 ? static_cast<char>(std::tolower(byte)) : '-';
  }
  return id.substr(0, 63);
}

// Whether enough designs at random parameters can be made.
bool AreFeasible(const parametric::ParametricAssembly& assembly,
                 const std::vector<templates::AssemblyHandle>& handles) {
  std::mt19937 random(7);
  int made = 0;
  for (int i = 0; i < kTrials; ++i) {
    std::vector<parametric::MeasureDemand> demands;
    for (const templates::AssemblyHandle& handle : handles) {
      const double share = random() / 4294967296.0;
      demands.push_back(
          {handle.measure, handle.minimum + share * (handle.maximum - handle.minimum)});
    }
    made += assembly.Meet(demands).ok() ? 1 : 0;
  }
  return made >= kFeasible * kTrials;
}

// The handles of a family, as MeshFamily::function says.
absl::StatusOr<std::vector<templates::AssemblyHandle>> ChooseHandles(
    const parametric::ParametricAssembly& assembly, std::size_t most) {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<templates::AssemblyHandle> sizes,
                           templates::IndependentSizes(assembly, kMaxSizes));
  std::vector<templates::AssemblyHandle> chosen;
  for (const templates::AssemblyHandle& size : sizes) {
    if (chosen.size() == most) break;
    MORTISE_ASSIGN_OR_RETURN(const parametric::MeasureRange range, assembly.RangeOf(size.measure));
    for (const double share : {1.0, 0.5, 0.25}) {
      templates::AssemblyHandle handle = size;
      handle.minimum = range.drawn + share * (range.minimum - range.drawn);
      handle.maximum = range.drawn + share * (range.maximum - range.drawn);
      chosen.push_back(std::move(handle));
      if (AreFeasible(assembly, chosen)) break;
      chosen.pop_back();
    }
  }
  return chosen;
}

// The assembly of a drawing, with its shapes.
absl::StatusOr<v1::AssemblyBundle> BundleOf(const cad::StepAssembly& drawing,
                                            const std::string& id) {
  v1::AssemblyAnnotations annotations;
  annotations.set_name("assemblies/" + id);
  annotations.set_tolerance(catalog::ToleranceOfMesh(drawing));
  const catalog::DrawnAssembly drawn = catalog::MakeAssembly(drawing, annotations, {});
  MORTISE_RETURN_IF_ERROR(catalog::AtRequest(drawn, annotations, absl::OkStatus()));
  v1::AssemblyBundle bundle;
  *bundle.mutable_assembly() = drawn.assembly;
  for (const mesh::DrawnShape& shape : drawing.shapes) {
    *bundle.add_shapes() = catalog::NamedShape(shape);
  }
  return bundle;
}

}  // namespace

absl::StatusOr<std::vector<LabelledMesh>> ReadLabels(const std::filesystem::path& folder) {
  MORTISE_ASSIGN_OR_RETURN(const std::string text, ReadFile(folder / "labels.csv"));
  std::vector<LabelledMesh> meshes;
  for (const absl::string_view line : absl::StrSplit(text, '\n', absl::SkipEmpty())) {
    const std::vector<std::string> fields = absl::StrSplit(line, ',');
    if (fields.size() < 3) return InvalidField("labels.csv", absl::StrCat("has the line ", line));
    if (fields[0] == "file") continue;
    meshes.push_back({folder / fields[0], fields[1], fields[2]});
  }
  return meshes;
}

std::vector<LabelledMesh> ChooseFamilies(const std::vector<LabelledMesh>& all,
                                         const MeshFamilyOptions& options) {
  std::vector<LabelledMesh> chosen;
  for (const WantedCategory& wanted : kWanted) {
    std::vector<LabelledMesh> of_category = InTurn(all, wanted.name, options);
    if (of_category.size() < wanted.count) {
      const std::vector<LabelledMesh> fillers = InTurn(all, wanted.filler, options);
      of_category.insert(of_category.end(), fillers.begin(), fillers.end());
    }
    if (of_category.size() > wanted.count) of_category.resize(wanted.count);
    for (LabelledMesh& mesh : of_category) {
      mesh.category = wanted.name;
      chosen.push_back(std::move(mesh));
    }
  }
  return chosen;
}

absl::StatusOr<MeshFamily> FamilyOfMesh(const LabelledMesh& mesh,
                                        const MeshFamilyOptions& options) {
  const std::string id = IdOf(mesh);
  MORTISE_ASSIGN_OR_RETURN(const cad::StepAssembly drawing, DrawingOf(mesh, options));
  MORTISE_ASSIGN_OR_RETURN(const v1::AssemblyBundle bundle, BundleOf(drawing, id));
  MORTISE_ASSIGN_OR_RETURN(const auto assembly, parametric::Parametrize(bundle));
  MORTISE_ASSIGN_OR_RETURN(std::vector<templates::AssemblyHandle> handles,
                           ChooseHandles(*assembly, options.most_parameters));
  MeshFamily family{.name = "templates/" + id,
                    .category = mesh.category,
                    .path = mesh.path,
                    .design_template = nullptr,
                    .parts = drawing.parts.size(),
                    .elements = assembly->elements().size(),
                    .relationships = assembly->relationships().size(),
                    .degrees_of_freedom = assembly->feasible_set().degrees_of_freedom(),
                    .notes = drawing.notes};
  templates::TemplateHead head;
  head.name = family.name;
  head.revision = 1;
  head.digest = parametric::BundleDigest(bundle);
  head.title = drawing.name;
  MORTISE_ASSIGN_OR_RETURN(
      family.design_template,
      templates::MakeAssemblyTemplate(
          std::move(head), assembly,
          {.handles = std::move(handles), .boundary_conditions = {}, .reference_temperature = ""}));
  return family;
}

}  // namespace mortise::bench
