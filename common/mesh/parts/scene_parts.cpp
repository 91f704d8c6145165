#include "common/mesh/parts/scene_parts.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/joined_surface.h"
#include "common/mesh/parts/surface_pieces.h"

namespace mortise::mesh {
namespace {

constexpr double kSamePlace = 1e-5;  // of the scene's diagonal
constexpr double kFlat = 1e-6;       // of the scene's diagonal

// Whether all vertices lie in one plane.
bool IsFlat(const SurfaceMesh& surface) {
  const Eigen::Matrix3Xd from_middle =
      surface.vertices.colwise() - surface.vertices.rowwise().mean().eval();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(from_middle * from_middle.transpose());
  const Eigen::RowVectorXd heights = axes.eigenvectors().col(0).transpose() * from_middle;
  return heights.maxCoeff() - heights.minCoeff() <= kFlat * BoxOf(surface).diagonal().norm();
}

std::size_t NamedComponents(const Scene& scene) {
  return static_cast<std::size_t>(
      std::count_if(scene.components.begin(), scene.components.end(),
                    [](const SceneComponent& component) { return !component.name.empty(); }));
}

// The pieces of each part together; the larger first, as the part is called after it.
std::vector<std::vector<const SurfacePiece*>> PiecesByPart(const std::vector<SurfacePiece>& pieces,
                                                           const PartGrouping& grouping) {
  std::vector<std::vector<const SurfacePiece*>> by_part(static_cast<std::size_t>(grouping.count));
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (grouping.part_of[i] < 0) continue;
    by_part[static_cast<std::size_t>(grouping.part_of[i])].push_back(&pieces[i]);
  }
  for (std::vector<const SurfacePiece*>& of_part : by_part) {
    std::stable_sort(
        of_part.begin(), of_part.end(), [](const SurfacePiece* a, const SurfacePiece* b) {
          return BoxOf(a->surface).diagonal().norm() > BoxOf(b->surface).diagonal().norm();
        });
  }
  return by_part;
}

SurfaceMesh SurfaceOf(const std::vector<const SurfacePiece*>& pieces) {
  std::vector<SurfaceView> surfaces;
  surfaces.reserve(pieces.size());
  for (const SurfacePiece* piece : pieces) surfaces.push_back(ViewOf(piece->surface));
  return Joined(surfaces);
}

// Names the parts after their components, which are `component_of`.
void NameParts(const Scene& scene, const std::vector<int>& component_of,
               std::vector<ScenePart>& parts) {
  const bool has_groups = NamedComponents(scene) > 1;
  std::map<int, int> counts, numbers;
  for (const int component : component_of) ++counts[component];
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const int component = component_of[i];
    const std::string& name = scene.components[static_cast<std::size_t>(component)].name;
    if (name.empty()) continue;
    const bool is_one_of_several = counts[component] > 1;
    parts[i].name =
        is_one_of_several ? absl::StrCat(name, " ", ++numbers[component]) : std::string(name);
    if (is_one_of_several && has_groups) parts[i].group = name;
  }
}

void FindAlike(double same, std::vector<ScenePart>& parts) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    parts[i].first_alike = static_cast<int>(i);
    const Eigen::AlignedBox3d box = BoxOf(parts[i].surface);
    for (std::size_t first = 0; first < i; ++first) {
      if (parts[first].first_alike != static_cast<int>(first)) continue;
      const Eigen::AlignedBox3d other = BoxOf(parts[first].surface);
      if ((other.sizes() - box.sizes()).cwiseAbs().maxCoeff() > 2 * same) continue;
      if (!AreAlike(parts[first].surface, parts[i].surface, other.center() - box.center(), same)) {
        continue;
      }
      parts[i].first_alike = static_cast<int>(first);
      break;
    }
  }
}

}  // namespace

absl::StatusOr<SceneParts> PartsOf(const Scene& scene, std::size_t most_parts) {
  const std::vector<SurfacePiece> pieces = PiecesOf(scene);
  if (pieces.empty()) return InvalidField("file", "has no triangle that has an area");
  std::vector<const SurfacePiece*> all;
  for (const SurfacePiece& piece : pieces) all.push_back(&piece);
  const SurfaceMesh whole = SurfaceOf(all);
  if (IsFlat(whole)) {
    return InvalidField("file", "is flat: all of its triangles lie in one plane");
  }
  const bool has_names = NamedComponents(scene) > 1;
  MORTISE_ASSIGN_OR_RETURN(
      PartGrouping grouping,
      GroupPieces(pieces, {.most_parts = most_parts, .keeps_components = has_names}));
  SceneParts made{.parts = {}, .notes = std::move(grouping.notes)};
  std::vector<int> component_of;
  for (const std::vector<const SurfacePiece*>& of_part : PiecesByPart(pieces, grouping)) {
    ScenePart part;
    part.surface = SurfaceOf(of_part);
    part.has_gap = grouping.has_gap[made.parts.size()];
    component_of.push_back(of_part.front()->component);
    made.parts.push_back(std::move(part));
  }
  NameParts(scene, component_of, made.parts);
  FindAlike(kSamePlace * BoxOf(whole).diagonal().norm(), made.parts);
  return made;
}

}  // namespace mortise::mesh
