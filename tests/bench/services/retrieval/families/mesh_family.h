// Parametric families made of single meshes, as the thesis's collection was (§4.6.1: 74 meshes in
// six categories became parametric assemblies): what retrieval is evaluated with. The meshes are
// other people's, lie beside the repository (../shared/data/shapes) and stay out of it.
//
// A mesh takes the way of `mortise assembly import`: the reader, the parts, the annotated assembly
// (there are no annotations here), the automatic parametrisation, the template. So the program that
// uses this calls mesh::RunSceneChild() in its main() where the first argument is
// mesh::kSceneChildArgument, as it is the reader's child, too.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/templates/template.h"

namespace mortise::bench {

// A line of labels.csv.
struct LabelledMesh {
  std::filesystem::path path;
  std::string category;  // "chair"
  std::string source;    // who made it: "kenney"
};

struct MeshFamilyOptions {
  std::size_t most_parts = 24;      // of the assembly; the smallest are joined beyond
  std::size_t most_parameters = 9;  // thesis §4.6.1: 2 to 9
};

struct MeshFamily {
  std::string name;      // templates/{category}-{file}
  std::string category;  // of the evaluation: "cart" for a car that fills up the carts
  std::filesystem::path path;
  // Its parameters are sizes of principal elements that can be chosen independently of each other,
  // the largest first (templates::IndependentSizes): so the principal extents of the whole come
  // first, as its largest elements have them, then the elements' own sizes. Each has all of the
  // range that the assembly allows it, which is half to twice as drawn or less, or the half, or
  // the quarter of it that lies about the drawn size: the first of these with which nine of ten
  // designs at random parameters can be made, together with the parameters before it. Where none
  // is, the size is no parameter.
  std::shared_ptr<const templates::Template> design_template;
  std::size_t parts = 0;          // as drawn
  std::size_t elements = 0;       // parts and patterns
  std::size_t relationships = 0;  // that were found
  int degrees_of_freedom = 0;
  std::vector<std::string> notes;  // what was guessed and joined
};

// The meshes of a folder that has a labels.csv, in its order. NOT_FOUND; INVALID_ARGUMENT for lines
// of fewer than three fields.
absl::StatusOr<std::vector<LabelledMesh>> ReadLabels(const std::filesystem::path& folder);

// The meshes that become the families, in the thesis's proportions: 17 lamps, 11 boats, 15 chairs,
// 9 planes, 10 carts and 15 tables. Those of several parts come first, as one part can only be
// stretched; then they come from each source in turn, so that no author dominates. Where a category
// has too few, near relatives fill it up: spaceships the planes, cars the carts; the boats are as
// many as there are. The category of the evaluation is in `category`. Meshes that are refused are
// left out. It reads all candidates, which takes seconds.
std::vector<LabelledMesh> ChooseFamilies(const std::vector<LabelledMesh>& all,
                                         const MeshFamilyOptions& options = {});

// The family of one mesh. Fails as its reader, the import and the parametrisation do.
absl::StatusOr<MeshFamily> FamilyOfMesh(const LabelledMesh& mesh,
                                        const MeshFamilyOptions& options = {});

}  // namespace mortise::bench
