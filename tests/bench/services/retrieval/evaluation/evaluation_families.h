// The families that the evaluation searches, with what is known of them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"
#include "common/templates/template.h"

namespace mortise::retrieval {

struct EvaluationFamily {
  std::string name;      // "table"
  std::string category;  // one of ThesisCategories, or another
  // Families of one kin are one and the same for who looks for a shape: an assembly, its own
  // template, and templates made of it. Whichever of them is found is right.
  std::string kin;
  std::string author;        // of the mesh that it was made of; empty where we drew it
  std::string mesh;          // the LabelledShape that it was made of; empty where we drew it
  bool uses_kernel = false;  // whether each design's solids are made anew by the CAD kernel
  std::shared_ptr<const templates::Template> design_template;
};

// "lamp", "boat", "chair", "plane", "cart", "table": those of Table 4.1, in its order.
const std::vector<std::string>& ThesisCategories();

// The families of collection/ with these names, all that can be made where none are named.
// NOT_FOUND for a name that there is not; as templates::Compile.
absl::StatusOr<std::vector<EvaluationFamily>> ShippedFamilies(
    const std::vector<std::string>& names = {});

// The shipped assembly of this name as a template of its `parameters` largest independent sizes.
// NOT_FOUND; FAILED_PRECONDITION where it has fewer.
absl::StatusOr<EvaluationFamily> ShippedAssemblyOf(const std::string& name, int parameters);

// The families made of the labelled meshes of a folder (tests/bench/services/retrieval/families),
// at most `most` of each category. Those that cannot be made are told to `say`, and left out.
absl::StatusOr<std::vector<EvaluationFamily>> MeshFamilies(
    const std::filesystem::path& shapes, int most,
    const std::function<void(std::string_view)>& say);

// The first of them in a category that has `parameters` independent sizes, of those alone.
// NOT_FOUND.
absl::StatusOr<EvaluationFamily> MeshFamilyOf(const std::filesystem::path& shapes,
                                              const std::string& category, int parameters);

// A design of a family at parameters drawn evenly from their ranges.
struct RandomDesign {
  Eigen::VectorXd q;
  mesh::SurfaceMesh surface;
};

// `count` of them that can be made; fewer where 50 times as many draws do not find so many.
std::vector<RandomDesign> RandomDesigns(const EvaluationFamily& family, int count,
                                        std::uint64_t seed);

// The surface at the defaults: the mean shape of thesis §4.7.2.
absl::StatusOr<mesh::SurfaceMesh> MeanShape(const EvaluationFamily& family);

}  // namespace mortise::retrieval
