// What StructureShapes has of the last complete round.
#include <algorithm>

#include "common/base/errors.h"
#include "services/interpolator/building/structure_shapes.h"

namespace mortise::interpolator {
namespace {

void IncludeLargest(Spread& largest, const Spread& other) {
  largest.largest = std::max(largest.largest, other.largest);
  largest.of_99 = std::max(largest.of_99, other.of_99);
  largest.mean = std::max(largest.mean, other.mean);
}

void AddShare(Spread& mean, const Spread& other, double share) {
  mean.largest += share * other.largest;
  mean.of_99 += share * other.of_99;
  mean.mean += share * other.mean;
}

template <typename Combine>
void CombineAll(ShapedStructure::Errors& errors, const KnownDifference& difference,
                const Combine& combine) {
  combine(errors.shape, difference.shape);
  for (std::size_t f = 0; f < errors.fields.size(); ++f) {
    combine(errors.fields[f], difference.fields[f]);
  }
}

}  // namespace

int StructureShapes::mesh_count() const {
  std::set<int> meshes;
  for (const auto& [element, settled] : settled_) meshes.insert(settled->mesh);
  return static_cast<int>(meshes.size());
}

absl::StatusOr<ShapedStructure> StructureShapes::Result() const {
  MORTISE_ASSIGN_OR_RETURN(const maps::MapContent content, sampling_.Content());
  MORTISE_ASSIGN_OR_RETURN(const maps::RefinementTree tree,
                           maps::RefinementTree::Replay(content.dimension, content.basis,
                                                        content.options, content.splits));
  ShapedStructure result;
  // A round that is not complete may be the first to have any.
  if (!complete_ranges_.empty()) result.fields = fields_;
  result.ranges = complete_ranges_;
  const ShapedStructure::Errors none{.fields = std::vector<Spread>(result.fields.size())};
  result.largest = result.mean = none;
  std::map<int, int> places;  // of its meshes among those of the result
  std::set<DifferenceKey> probes;
  for (const int element : tree.Elements()) {
    result.element_errors.push_back(none);
    const bool is_cut_off = content.cut_off[result.element_mesh.size()] != 0;
    const auto found = complete_.find(element);
    if (is_cut_off || found == complete_.end()) {
      result.element_mesh.push_back(-1);
      continue;
    }
    const Settled& settled = *found->second;
    const auto place = places.try_emplace(settled.mesh, static_cast<int>(places.size())).first;
    if (place->second == static_cast<int>(result.meshes.size())) {
      result.meshes.push_back(DescriptionOf(settled.mesh));
    }
    result.element_mesh.push_back(place->second);
    for (const DifferenceKey& key : settled.differences) {
      CombineAll(result.element_errors.back(), work_.FindDifference(key), IncludeLargest);
    }
    probes.insert(settled.differences.begin(), settled.differences.end());
    AddShapes(tree.ElementSamples(element), settled.mesh, place->second, result);
  }
  AddErrors(probes, result);
  result.unmapped = CountUnmapped(tree, result.element_mesh);
  return result;
}

ShapedStructure::Mesh StructureShapes::DescriptionOf(int mesh) const {
  const MadeMesh& made = work_.FindMesh(KeyOf(mesh));
  return {made.known.digest, made.known.bytes, made.nodes,
          made.triangles,    made.tetrahedra,  made.regions};
}

void StructureShapes::AddShapes(const std::vector<int>& samples, int mesh, int place,
                                ShapedStructure& result) const {
  for (const int sample : samples) {
    const KnownShape& shape = *work_.FindShape({KeyOf(mesh), sampling_.PointOfSample(sample)});
    result.shapes[{place, sample}] = {shape.digest, shape.bytes, shape.inverted, shape.size,
                                      shape.rounding};
  }
}

// Each probe once, also where it lies on several elements.
void StructureShapes::AddErrors(const std::set<DifferenceKey>& probes,
                                ShapedStructure& result) const {
  const double share = 1.0 / static_cast<double>(std::max<std::size_t>(1, probes.size()));
  for (const DifferenceKey& key : probes) {
    const KnownDifference& difference = work_.FindDifference(key);
    CombineAll(result.largest, difference, IncludeLargest);
    CombineAll(result.mean, difference,
               [share](Spread& mean, const Spread& other) { AddShare(mean, other, share); });
  }
}

// The designs around elements that have no shapes although none of their designs has failed, but
// for those on an element that has.
std::int64_t StructureShapes::CountUnmapped(const maps::RefinementTree& tree,
                                            const std::vector<int>& element_mesh) const {
  std::set<int> covered, shapeless;
  std::size_t order = 0;
  for (const int element : tree.Elements()) {
    std::vector<int> points = sampling_.ProbesOf(element);
    for (const int sample : tree.ElementSamples(element)) {
      points.push_back(sampling_.PointOfSample(sample));
    }
    const bool is_shapeless = element_mesh[order++] < 0;
    const bool has_failed =
        std::ranges::any_of(points, [this](int number) { return sampling_.HasFailed(number); });
    if (is_shapeless && has_failed) continue;
    (is_shapeless ? shapeless : covered).insert(points.begin(), points.end());
  }
  std::int64_t count = 0;
  for (const int number : shapeless) count += covered.contains(number) ? 0 : 1;
  return count;
}

}  // namespace mortise::interpolator
