#include "tests/bench/services/retrieval/evaluation/evaluation_families.h"

#include <algorithm>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/random.h"
#include "common/design/parameter_values.h"
#include "common/templates/template_codec.h"
#include "services/retrieval/families/design_surface.h"
#include "tests/bench/services/retrieval/evaluation/labelled_shapes.h"
#include "tests/bench/services/retrieval/families/mesh_family.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::retrieval {
namespace {

constexpr int kDrawsADesign = 50;

// What ships in the categories of the thesis; all else is "other".
std::string CategoryOf(const std::string& name) {
  static const auto* const categories = new std::map<std::string, std::string>{
      {"bar-chair", "chair"},
      {"boat", "boat"},
      {"chair", "chair"},
      {"crossed-side-table", "table"},
      {"dining-table", "table"},
      {"fin-lamp", "lamp"},
      {"garden-bench", "chair"},
      {"garden-cart", "cart"},
      {"go-kart", "cart"},
      {"hand-truck", "cart"},
      {"ladder-back-chair", "chair"},
      {"lamp", "lamp"},
      {"pendant-lamp", "lamp"},
      {"picnic-table", "table"},
      {"plane", "plane"},
      {"punt", "boat"},
      {"rocking-chair", "chair"},
      {"serving-trolley", "cart"},
      {"shade-lamp", "lamp"},
      {"slat-lantern", "lamp"},
      {"slatted-armchair", "chair"},
      {"slatted-coffee-table", "table"},
      {"step-stool", "chair"},
      {"table", "table"},
      {"tool-cart", "cart"},
      {"toy-biplane", "plane"},
      {"toy-catamaran", "boat"},
      {"toy-glider", "plane"},
      {"toy-seaplane", "plane"},
      {"toy-tug", "boat"},
      {"toy-wagon", "cart"},
      {"trestle-desk", "table"},
      {"wheelbarrow", "cart"},
      {"workbench", "table"},
  };
  const auto found = categories->find(name);
  return found == categories->end() ? "other" : found->second;
}

std::string WithoutFolder(const std::string& name) { return name.substr(name.find('/') + 1); }

// What the catalog would freeze: the template, and the assembly that it is made of.
absl::StatusOr<v1::TemplateBundle> BundleOfTemplate(const v1::Template& message) {
  v1::TemplateBundle bundle = templates::ShippedTemplate(message.name());
  if (message.has_assembly()) {
    *bundle.mutable_assembly() =
        templates::ShippedAssembly(message.assembly().assembly()).assembly();
  }
  return bundle;
}

absl::StatusOr<EvaluationFamily> MakeFamily(v1::TemplateBundle bundle) {
  const v1::Template& message = bundle.template_();
  EvaluationFamily family{
      .name = WithoutFolder(message.name()),
      .category = CategoryOf(WithoutFolder(message.name())),
      .kin = WithoutFolder(message.has_assembly() ? message.assembly().assembly() : message.name()),
      .author = "",
      .mesh = "",
      .uses_kernel = message.has_cad(),
      .design_template = nullptr};
  MORTISE_RETURN_IF_ERROR(templates::FillAndCheck(bundle, templates::Trial::kDefaults));
  MORTISE_ASSIGN_OR_RETURN(family.design_template, templates::Compile(bundle));
  return family;
}

// All bundles by the name of the family. A template of designs/ goes before the assembly's own of
// the same name.
absl::StatusOr<std::map<std::string, v1::TemplateBundle>> Bundles() {
  std::map<std::string, v1::TemplateBundle> bundles;
  for (const v1::Template& message : templates::ShippedCollection().templates) {
    MORTISE_ASSIGN_OR_RETURN(bundles[WithoutFolder(message.name())], BundleOfTemplate(message));
  }
  for (const v1::Assembly& message : templates::ShippedCollection().assemblies) {
    bundles.try_emplace(WithoutFolder(message.name()), templates::ShippedAssembly(message.name()));
  }
  return bundles;
}

}  // namespace

const std::vector<std::string>& ThesisCategories() {
  static const auto* const categories =
      new std::vector<std::string>{"lamp", "boat", "chair", "plane", "cart", "table"};
  return *categories;
}

absl::StatusOr<std::vector<EvaluationFamily>> ShippedFamilies(
    const std::vector<std::string>& names) {
  MORTISE_ASSIGN_OR_RETURN(auto bundles, Bundles());
  std::vector<EvaluationFamily> families;
  for (const std::string& name : names) {
    if (!bundles.contains(name)) return ResourceNotFound(name);
  }
  for (auto& [name, bundle] : bundles) {
    if (!names.empty() && std::ranges::find(names, name) == names.end()) continue;
    absl::StatusOr<EvaluationFamily> family = MakeFamily(std::move(bundle));
    if (!family.ok() && names.empty()) continue;
    MORTISE_RETURN_IF_ERROR(family.status());
    families.push_back(*std::move(family));
  }
  return families;
}

absl::StatusOr<EvaluationFamily> ShippedAssemblyOf(const std::string& name, int parameters) {
  v1::TemplateBundle bundle = templates::ShippedAssembly(absl::StrCat("assemblies/", name));
  if (bundle.assembly().name().empty()) return ResourceNotFound(name);
  MORTISE_RETURN_IF_ERROR(templates::FillAndCheck(bundle, templates::Trial::kDefaults));
  v1::Template& message = *bundle.mutable_template_();
  if (message.assembly().handles_size() < parameters) {
    return PreconditionFailed("TOO_FEW_SIZES",
                              absl::StrCat(name, " has fewer than ", parameters, " sizes"));
  }
  auto& handles = *message.mutable_assembly()->mutable_handles();
  handles.DeleteSubrange(parameters, handles.size() - parameters);
  message.clear_parameters();
  MORTISE_ASSIGN_OR_RETURN(EvaluationFamily family, MakeFamily(std::move(bundle)));
  family.name = absl::StrCat(name, " with ", parameters, " parameters");
  return family;
}

namespace {

absl::StatusOr<EvaluationFamily> FamilyOf(const bench::LabelledMesh& mesh,
                                          const std::filesystem::path& shapes,
                                          const bench::MeshFamilyOptions& options) {
  MORTISE_ASSIGN_OR_RETURN(bench::MeshFamily made, bench::FamilyOfMesh(mesh, options));
  const std::string file = mesh.path.lexically_relative(shapes).generic_string();
  return EvaluationFamily{.name = mesh.path.stem().string(),
                          .category = made.category,
                          .kin = file,
                          .author = AuthorOf(mesh.source),
                          .mesh = file,
                          .design_template = std::move(made.design_template)};
}

}  // namespace

absl::StatusOr<std::vector<EvaluationFamily>> MeshFamilies(
    const std::filesystem::path& shapes, int most,
    const std::function<void(std::string_view)>& say) {
  MORTISE_ASSIGN_OR_RETURN(const auto meshes, bench::ReadLabels(shapes));
  std::vector<EvaluationFamily> families;
  std::map<std::string, int> counts;
  for (const bench::LabelledMesh& mesh : bench::ChooseFamilies(meshes)) {
    if (counts[mesh.category] >= most) continue;
    absl::StatusOr<EvaluationFamily> family = FamilyOf(mesh, shapes, {});
    if (!family.ok()) {
      say(absl::StrCat(mesh.path.string(), ": ", family.status().message()));
      continue;
    }
    ++counts[mesh.category];
    families.push_back(*std::move(family));
  }
  return families;
}

absl::StatusOr<EvaluationFamily> MeshFamilyOf(const std::filesystem::path& shapes,
                                              const std::string& category, int parameters) {
  MORTISE_ASSIGN_OR_RETURN(const auto meshes, bench::ReadLabels(shapes));
  bench::MeshFamilyOptions options;
  options.most_parameters = static_cast<std::size_t>(parameters);
  for (const bench::LabelledMesh& mesh : meshes) {
    if (mesh.category != category) continue;
    absl::StatusOr<EvaluationFamily> family = FamilyOf(mesh, shapes, options);
    if (family.ok() && family->design_template->parameters().size() == options.most_parameters) {
      return family;
    }
  }
  return absl::NotFoundError(absl::StrCat("no ", category, " has ", parameters, " sizes"));
}

std::vector<RandomDesign> RandomDesigns(const EvaluationFamily& family, int count,
                                        std::uint64_t seed) {
  const std::vector<parametric::Parameter>& parameters = family.design_template->parameters();
  Random random(seed);
  std::vector<RandomDesign> designs;
  for (int draw = 0; draw < kDrawsADesign * count && static_cast<int>(designs.size()) < count;
       ++draw) {
    Eigen::VectorXd q(static_cast<Eigen::Index>(parameters.size()));
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const parametric::Parameter& parameter = parameters[static_cast<std::size_t>(i)];
      q[i] = parameter.minimum + random.Uniform() * (parameter.maximum - parameter.minimum);
    }
    const absl::StatusOr<parametric::EvaluatedDesign> design = family.design_template->Evaluate(q);
    if (design.ok()) designs.push_back({q, DesignSurface(*design)});
  }
  return designs;
}

absl::StatusOr<mesh::SurfaceMesh> MeanShape(const EvaluationFamily& family) {
  MORTISE_ASSIGN_OR_RETURN(
      const parametric::EvaluatedDesign design,
      family.design_template->Evaluate(parametric::Defaults(family.design_template->parameters())));
  return DesignSurface(design);
}

}  // namespace mortise::retrieval
