// Finds translational patterns of identical parts in a design, and lays them out anew when the box
// they fill is resized (thesis §3.5, after Bokeloh et al. 2012).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "common/assembly/model/assembly.h"

namespace mortise::parametric {

// A generator translation and how often it occurs.
struct PatternDirection {
  int count = 1;                                      // number of parts along it; 1: none
  Eigen::Vector3d spacing = Eigen::Vector3d::Zero();  // m, from one part to the next
  // In a connecting pattern that fastens a principal one part by part: how long the principal parts
  // are along the direction, m. The count is then chosen as for them, so that there are as many. 0
  // if it fastens none.
  double principal_size = 0;
};

// Identical parts at equal spacings along one or two perpendicular directions. A direction need not
// follow an axis: the steps of a stair are a pattern.
struct Pattern {
  std::array<PatternDirection, 2> directions;  // the second has count 1 in one-dimensional patterns
  Eigen::Vector3d part_size = Eigen::Vector3d::Zero();  // m
  // The axes along which a part may be resized. Along a direction of the pattern it then scales
  // with the spacing, elsewhere it fills the box. It cannot be resized along a direction that
  // slopes.
  std::array<bool, 3> resizable = {false, false, false};
  // The sizes that a part may take along those axes, m.
  std::array<SizeLimits, 3> part_limits = {kAnySize, kAnySize, kAnySize};
  bool connecting = false;

  static constexpr SizeLimits kAnySize{0, std::numeric_limits<double>::infinity()};
};

// Pairs of a pattern's part and a part that this pattern might lose (pattern_losses.h), by their
// indices in the assembly.
using PatternLosses = std::set<std::pair<int, int>>;

// Says which patterns are not wanted, with parts by their index in the assembly.
struct PatternExclusions {
  // No pattern of the first touches the second in part only (pattern_contact.h): it ends before.
  PatternLosses pattern_losses;
  std::set<int> lone;  // are in no pattern
};

// A pattern, and the parts it was found in.
struct FoundPattern {
  Pattern pattern;
  std::vector<int> parts;  // indices into the assembly, first direction running fastest
};

// Returns all patterns of at least three parts along each direction, largest first, no part in two
// of them (ties: the closer spacing, then the lower part). Parts are identical if these agree: item
// and how it lies in them, role, group, size and the limits of sizes, shape, colour and prominent
// planes. The directions of a grid lead along different axes. Nothing else stands between the parts
// of a pattern without touching one: as their number changes, they would run into it. `tolerance`
// is in metres. O(n² log n) for n identical parts of one group in one dimension; two dimensions add
// the pairs of directions that begin at one part.
std::vector<FoundPattern> FindPatterns(const Assembly& assembly, double tolerance,
                                       const PatternExclusions& exclusions = {});

// Whether there are as many parts along both directions, and as far apart. `tolerance` is in
// metres.
bool RepeatAlike(const PatternDirection& a, const PatternDirection& b, double tolerance);

// Returns the direction of `a`, and that of `b`, along an axis in which the two repeat together: as
// often and as far apart as each other, along that axis only. Returns nothing if there is none.
// `tolerance` is in metres.
std::optional<std::pair<int, int>> CommonDirection(const Pattern& a, const Pattern& b, int axis,
                                                   double tolerance);

// The layout of a pattern that fills a box: count, spacing and size of its parts.
struct PatternLayout {
  std::array<PatternDirection, 2> directions;
  Eigen::Vector3d part_size = Eigen::Vector3d::Zero();     // m
  Eigen::Vector3d first_center = Eigen::Vector3d::Zero();  // m, in the design's coordinates

  std::int64_t part_count() const {
    return static_cast<std::int64_t>(directions[0].count) * directions[1].count;
  }
  // Returns the centre of part `index`, first direction running fastest, m.
  Eigen::Vector3d CenterOf(int index) const;
};

// Fills `box` with the pattern. The first and the last part touch the ends of the box. A principal
// pattern takes the count whose spacing is nearest the original; a connecting pattern the smallest
// count whose spacing is not above the original. Neither lets parts intersect: then the count
// shrinks, to two at least. Parts that scale with the spacing take the nearest count with which
// they stay within their limits, if there is one (see LengthsOf).
PatternLayout LayOut(const Pattern& pattern, const BoundingBox& box);

// Returns how long the box of a pattern may be along an axis that it leads along, m: from half to
// twice the drawn length. If the parts may be resized along the axis, some number of them must fill
// every such length within their limits, without a gap between it and the drawn length. Otherwise
// there must be room for two; parts that touch each other take the drawn length alone, or they
// would come apart.
SizeLimits LengthsOf(const Pattern& pattern, int axis, double drawn, double tolerance);

// Whether one of its directions leads along the axis.
bool LeadsAlong(const Pattern& pattern, int axis);

}  // namespace mortise::parametric
