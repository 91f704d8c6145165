#include "common/assembly/model/pattern_contact.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

namespace mortise::parametric {
namespace {

const BoundingBox& BoxOf(const Assembly& assembly, int part) {
  return assembly.parts[static_cast<std::size_t>(part)].box;
}

bool Touch(const BoundingBox& a, const BoundingBox& b, double tolerance) {
  return ((a.maximum - b.minimum).array() >= -tolerance).all() &&
         ((b.maximum - a.minimum).array() >= -tolerance).all();
}

// Whether they have more than `tolerance` in common along every axis.
bool Overlap(const BoundingBox& a, const BoundingBox& b, double tolerance) {
  return Touch(a, b, -tolerance);
}

BoundingBox BoxAround(const Assembly& assembly, const std::vector<int>& parts) {
  BoundingBox around = BoxOf(assembly, parts.front());
  for (const int part : parts) {
    around.minimum = around.minimum.cwiseMin(BoxOf(assembly, part).minimum);
    around.maximum = around.maximum.cwiseMax(BoxOf(assembly, part).maximum);
  }
  return around;
}

// Beyond the first or the last part, which stay at the ends of the pattern's box.
bool IsBeyondTheEnds(const BoundingBox& box, const BoundingBox& around,
                     const PatternDirection& direction, double tolerance) {
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(direction.spacing[axis]) <= tolerance) continue;
    if (box.maximum[axis] <= around.minimum[axis] + tolerance ||
        box.minimum[axis] >= around.maximum[axis] - tolerance) {
      return true;
    }
  }
  return false;
}

// Whether a part is too long to stand in a gap between parts of the pattern: at the spacing nearest
// to the drawn one, which two parts exceed by a third at most, or, of parts that nearly touch each
// other, where one more just does not fit in.
bool ReachesAcrossGaps(const AssemblyPart& part, const Eigen::Vector3d& size,
                       const PatternDirection& direction, double tolerance) {
  for (int axis = 0; axis < 3; ++axis) {
    const double spacing = std::abs(direction.spacing[axis]);
    if (spacing <= tolerance || spacing <= size[axis] + tolerance) continue;
    const double widest = std::max(4.0 / 3 * spacing, 2 * size[axis]) - size[axis];
    if (part.limits[static_cast<std::size_t>(axis)].minimum <= widest) return false;
  }
  return true;
}

// Which parts along each direction a box touches.
std::array<std::set<int>, 2> TouchedBy(const BoundingBox& box, const Assembly& assembly,
                                       const std::vector<int>& parts, int count, double tolerance) {
  std::array<std::set<int>, 2> touched;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!Touch(box, BoxOf(assembly, parts[i]), tolerance)) continue;
    touched[0].insert(static_cast<int>(i) % count);
    touched[1].insert(static_cast<int>(i) / count);
  }
  return touched;
}

}  // namespace

std::vector<PartialContact> FindPartialContacts(const Assembly& assembly,
                                                const std::array<PatternDirection, 2>& directions,
                                                const std::vector<int>& parts, double tolerance) {
  std::vector<int> all(assembly.parts.size());
  std::iota(all.begin(), all.end(), 0);
  return FindPartialContactsWith(all, assembly, directions, parts, tolerance);
}

std::vector<PartialContact> FindPartialContactsWith(
    const std::vector<int>& others, const Assembly& assembly,
    const std::array<PatternDirection, 2>& directions, const std::vector<int>& parts,
    double tolerance) {
  std::vector<PartialContact> contacts;
  if (others.empty()) return contacts;
  const BoundingBox around = BoxAround(assembly, parts);
  const Eigen::Vector3d size = BoxOf(assembly, parts.front()).size();
  for (const int other : others) {
    const AssemblyPart& part = assembly.parts[static_cast<std::size_t>(other)];
    if (!Touch(part.box, around, tolerance)) continue;
    if (std::find(parts.begin(), parts.end(), other) != parts.end()) continue;
    const auto touched = TouchedBy(part.box, assembly, parts, directions[0].count, tolerance);
    const bool stands_between = touched[0].empty() && Overlap(part.box, around, tolerance);
    if (touched[0].empty() && !stands_between) continue;
    for (int d = 0; d < 2; ++d) {
      const PatternDirection& direction = directions[static_cast<std::size_t>(d)];
      if (stands_between) {
        if (direction.count > 1) contacts.push_back({other, d, true});
        continue;
      }
      const bool touches_all =
          static_cast<int>(touched[static_cast<std::size_t>(d)].size()) == direction.count;
      if (!touches_all && !IsBeyondTheEnds(part.box, around, direction, tolerance) &&
          !ReachesAcrossGaps(part, size, direction, tolerance)) {
        contacts.push_back({other, d, false});
      }
    }
  }
  return contacts;
}

}  // namespace mortise::parametric
