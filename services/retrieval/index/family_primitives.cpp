#include "services/retrieval/index/family_primitives.h"

#include <algorithm>
#include <set>
#include <tuple>

#include "common/base/errors.h"
#include "services/retrieval/index/primitive_distance.h"

namespace mortise::retrieval {
namespace {

absl::Status Check(const PrimitiveIndex& index, const IndexQuery& query) {
  if (query.count < 1) return InvalidField("count", "must be at least 1");
  if (query.descriptors.empty()) return InvalidField("descriptors", "there must be one");
  for (const Eigen::VectorXd& each : query.descriptors) {
    if (each.size() != index.dimension() || !each.allFinite()) {
      return InvalidField("descriptors", "must have as many finite numbers as the index's");
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::vector<IndexMatch>> NearestOfFamily(const PrimitiveIndex& index,
                                                        const IndexQuery& query, int family) {
  MORTISE_RETURN_IF_ERROR(Check(index, query));
  const IndexArrays& arrays = index.arrays();
  const auto found = std::lower_bound(arrays.families.begin(), arrays.families.end(), family);
  if (found == arrays.families.end() || *found != family) return std::vector<IndexMatch>();
  const auto place = static_cast<std::int32_t>(found - arrays.families.begin());
  std::vector<IndexMatch> all;
  Eigen::VectorXd offset(index.dimension());
  for (std::size_t i = 0; i < arrays.primitives.size(); ++i) {
    const PrimitiveEntry& entry = arrays.primitives[i];
    if (entry.family != place) continue;
    IndexMatch best;
    for (std::size_t turn = 0; turn < query.descriptors.size(); ++turn) {
      const double distance =
          DistanceFrom(arrays, entry, query.descriptors[turn].data(), offset.data());
      if (turn > 0 && distance >= best.distance) continue;
      best = {family, entry.number, static_cast<int>(turn), distance, static_cast<int>(i)};
    }
    all.push_back(best);
  }
  std::sort(all.begin(), all.end(), [](const IndexMatch& a, const IndexMatch& b) {
    return std::tie(a.distance, a.primitive) < std::tie(b.distance, b.primitive);
  });
  std::vector<IndexMatch> nearest;
  std::set<std::int32_t> structures;
  const auto count = static_cast<std::size_t>(query.count);
  for (const IndexMatch& each : all) {
    const PrimitiveEntry& entry = arrays.primitives[static_cast<std::size_t>(each.entry)];
    const bool is_new = structures.insert(entry.structure).second;
    if (nearest.size() < count || (is_new && nearest.size() < 2 * count)) nearest.push_back(each);
  }
  return nearest;
}

}  // namespace mortise::retrieval
