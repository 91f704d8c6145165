#include "common/assembly/model/pattern.h"

#include <algorithm>
#include <boost/dynamic_bitset.hpp>
#include <cmath>
#include <map>
#include <tuple>

#include "common/assembly/model/pattern_contact.h"

namespace mortise::parametric {
namespace {

constexpr int kFewest = 3;  // parts along a direction: two are at equal spacing whatever it is

// Parts of one kind that are still to be had, found by the place of their centres.
class Places {
 public:
  Places(const Assembly& assembly, const std::vector<int>& parts, double tolerance)
      : cell_(8 * tolerance), tolerance_(tolerance) {
    for (const int part : parts) {
      const Eigen::Vector3d center = assembly.parts[static_cast<std::size_t>(part)].box.center();
      cells_[CellOf(center)].push_back({part, center});
    }
  }

  // The part whose centre lies at `point`, or -1.
  int At(const Eigen::Vector3d& point) const {
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d nudged =
          point + tolerance_ * Eigen::Vector3d(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1,
                                               corner & 4 ? 1 : -1);
      const auto found = cells_.find(CellOf(nudged));
      if (found == cells_.end()) continue;
      for (const auto& [part, center] : found->second) {
        if ((center - point).norm() <= tolerance_) return part;
      }
    }
    return -1;
  }

 private:
  using Cell = std::array<long, 3>;
  Cell CellOf(const Eigen::Vector3d& point) const {
    return {std::lround(point[0] / cell_), std::lround(point[1] / cell_),
            std::lround(point[2] / cell_)};
  }

  const double cell_;
  const double tolerance_;
  std::map<Cell, std::vector<std::pair<int, Eigen::Vector3d>>> cells_;
};

// One of each pair of opposite directions: the first component that counts is positive.
bool IsForward(const Eigen::Vector3d& spacing, double tolerance) {
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(spacing[axis]) > tolerance) return spacing[axis] > 0;
  }
  return false;
}

// Whether two parts have the same prominent planes at the same places within them.
bool HaveSamePlanes(const AssemblyPart& a, const AssemblyPart& b, double tolerance) {
  return std::equal(a.prominent_planes.begin(), a.prominent_planes.end(),
                    b.prominent_planes.begin(), b.prominent_planes.end(),
                    [&](const ProminentPlane& of_a, const ProminentPlane& of_b) {
                      const int axis = static_cast<int>(of_a.axis);
                      return of_a.axis == of_b.axis &&
                             std::abs((of_a.position - a.box.minimum[axis]) -
                                      (of_b.position - b.box.minimum[axis])) <= tolerance;
                    });
}

bool AreIdentical(const AssemblyPart& a, const AssemblyPart& b, double tolerance) {
  const auto same_limits = [&](const SizeLimits& of_a, const SizeLimits& of_b) {
    return std::abs(of_a.minimum - of_b.minimum) <= tolerance &&
           std::abs(of_a.maximum - of_b.maximum) <= tolerance;
  };
  return a.item == b.item && a.item_axes == b.item_axes && a.group == b.group &&
         a.connecting == b.connecting && a.shape == b.shape && a.color == b.color &&
         (a.box.size() - b.box.size()).cwiseAbs().maxCoeff() <= tolerance &&
         std::equal(a.limits.begin(), a.limits.end(), b.limits.begin(), same_limits) &&
         HaveSamePlanes(a, b, tolerance);
}

struct Candidate {
  std::array<PatternDirection, 2> directions;
  std::vector<int> parts;
};

// More parts first, then the closer spacing, then the earlier parts.
bool IsBetter(const Candidate& a, const Candidate& b, double tolerance) {
  if (a.parts.size() != b.parts.size()) return a.parts.size() > b.parts.size();
  for (std::size_t i = 0; i < 2; ++i) {
    const double difference = a.directions[i].spacing.norm() - b.directions[i].spacing.norm();
    if (std::abs(difference) > tolerance) return difference < 0;
  }
  return a.parts < b.parts;
}

// Of each part, what patterns that it is in might lose: PatternExclusions::pattern_losses.
using LostBy = std::map<int, boost::dynamic_bitset<>>;

LostBy ByPart(const PatternLosses& pattern_losses, std::size_t parts) {
  LostBy lost_by;
  for (const auto& [part, lost] : pattern_losses) {
    boost::dynamic_bitset<>& by_part = lost_by[part];
    by_part.resize(parts);
    by_part.set(static_cast<std::size_t>(lost));
  }
  return lost_by;
}

class PatternSearch {
 public:
  PatternSearch(const Assembly& assembly, std::vector<int> parts, const LostBy& lost_by,
                double tolerance)
      : assembly_(assembly),
        parts_(std::move(parts)),
        lost_by_(lost_by),
        tolerance_(tolerance),
        places_(assembly, parts_, tolerance) {}

  // The best pattern among the parts; without parts if there is none.
  Candidate Best() {
    FindRows();
    // Rows that begin at one part follow each other.
    for (std::size_t begin = 0, end = 0; begin < rows_.size(); begin = end) {
      while (end < rows_.size() && rows_[end].parts[0] == rows_[begin].parts[0]) ++end;
      for (std::size_t i = begin; i < end; ++i) {
        KeepRow(rows_[i]);
        for (std::size_t j = begin; j < end; ++j) {
          if (i != j) KeepGrid(rows_[i], rows_[j]);
        }
      }
    }
    return best_;
  }

 private:
  Eigen::Vector3d Center(int part) const {
    return assembly_.parts[static_cast<std::size_t>(part)].box.center();
  }

  void Keep(const Candidate& candidate) {
    if (MayReplaceBest(candidate) && IsSound(candidate)) best_ = candidate;
  }

  // A row, or as much of it as is sound.
  void KeepRow(Candidate row) {
    while (static_cast<int>(row.parts.size()) >= kFewest && MayReplaceBest(row)) {
      if (IsSound(row)) best_ = row;
      row.parts.pop_back();
      row.directions[0].count -= 1;
    }
  }

  bool MayReplaceBest(const Candidate& candidate) const {
    return best_.parts.empty() || IsBetter(candidate, best_, tolerance_);
  }

  bool IsSound(const Candidate& candidate) const {
    return !HasStranger(candidate) && !MightLose(candidate);
  }

  const BoundingBox& Box(int part) const {
    return assembly_.parts[static_cast<std::size_t>(part)].box;
  }

  // Whether two boxes have more than `depth` in common along every axis.
  static bool Overlap(const BoundingBox& a, const BoundingBox& b, double depth) {
    return ((a.maximum - b.minimum).array() > depth).all() &&
           ((b.maximum - a.minimum).array() > depth).all();
  }

  // Whether a principal part stands between principal ones and does not touch all of them.
  // Fasteners go where their connections want them; rows of them may cross.
  bool HasStranger(const Candidate& candidate) const {
    if (assembly_.parts[static_cast<std::size_t>(candidate.parts.front())].connecting) return false;
    BoundingBox around = Box(candidate.parts.front());
    for (const int part : candidate.parts) {
      around.minimum = around.minimum.cwiseMin(Box(part).minimum);
      around.maximum = around.maximum.cwiseMax(Box(part).maximum);
    }
    for (std::size_t i = 0; i < assembly_.parts.size(); ++i) {
      const BoundingBox& other = assembly_.parts[i].box;
      if (assembly_.parts[i].connecting || !Overlap(other, around, tolerance_)) continue;
      const auto& own = candidate.parts;
      if (std::find(own.begin(), own.end(), static_cast<int>(i)) != own.end()) continue;
      if (!std::all_of(own.begin(), own.end(),
                       [&](int part) { return Overlap(other, Box(part), -tolerance_); })) {
        return true;
      }
    }
    return false;
  }

  // Whether something that has been lost by such patterns touches the parts in part.
  bool MightLose(const Candidate& candidate) const {
    boost::dynamic_bitset<> lost(assembly_.parts.size());  // by patterns of any of the parts
    for (const int part : candidate.parts) {
      const auto by_part = lost_by_.find(part);
      if (by_part != lost_by_.end()) lost |= by_part->second;
    }
    std::vector<int> others;
    for (auto other = lost.find_first(); other != lost.npos; other = lost.find_next(other)) {
      others.push_back(static_cast<int>(other));
    }
    return !FindPartialContactsWith(others, assembly_, candidate.directions, candidate.parts,
                                    tolerance_)
                .empty();
  }

  // From `first`, as long as parts follow each other at `spacing`.
  std::vector<int> Walk(int first, const Eigen::Vector3d& spacing, int most) const {
    std::vector<int> row = {first};
    // From the first part, so that errors do not add up.
    while (static_cast<int>(row.size()) < most) {
      const int next = places_.At(Center(first) + static_cast<double>(row.size()) * spacing);
      if (next < 0) break;
      row.push_back(next);
    }
    return row;
  }

  // Every row of three or more, from each of its parts on: a grid may begin in the middle of one.
  void FindRows() {
    for (const int first : parts_) {
      for (const int second : parts_) {
        if (first == second) continue;
        const Eigen::Vector3d spacing = Center(second) - Center(first);
        if (!IsForward(spacing, tolerance_)) continue;
        Candidate row;
        row.parts = Walk(first, spacing, static_cast<int>(parts_.size()));
        if (static_cast<int>(row.parts.size()) < kFewest) continue;
        // The mean spacing, better than that of the first two.
        row.directions[0].count = static_cast<int>(row.parts.size());
        // What the drawing is out by is no direction.
        Eigen::Vector3d reach = Center(row.parts.back()) - Center(first);
        reach = (reach.array().abs() > tolerance_).select(reach, 0);
        row.directions[0].spacing = reach / static_cast<double>(row.parts.size() - 1);
        rows_.push_back(std::move(row));
      }
    }
  }

  // The largest full grid over (parts of) two rows that begin at the same part.
  void KeepGrid(const Candidate& along, const Candidate& across) {
    const Eigen::Vector3d& p = along.directions[0].spacing;
    const Eigen::Vector3d& r = across.directions[0].spacing;
    // Each fills the box along axes of its own.
    if (((p.array().abs() > tolerance_) && (r.array().abs() > tolerance_)).any()) return;
    int count = along.directions[0].count;
    for (std::size_t row = 0; row < across.parts.size(); ++row) {
      const std::vector<int> parts = Walk(across.parts[row], p, count);
      count = std::min(count, static_cast<int>(parts.size()));
      if (count < kFewest) break;
      KeepRows(along, across, count, static_cast<int>(row) + 1);
    }
  }

  void KeepRows(const Candidate& along, const Candidate& across, int count, int rows) {
    if (rows < kFewest) return;
    if (static_cast<std::size_t>(count) * static_cast<std::size_t>(rows) < best_.parts.size()) {
      return;
    }
    Candidate grid;
    grid.directions[0] = {count, along.directions[0].spacing};
    grid.directions[1] = {rows, across.directions[0].spacing};
    for (int row = 0; row < rows; ++row) {
      const std::vector<int> parts =
          Walk(across.parts[static_cast<std::size_t>(row)], along.directions[0].spacing, count);
      grid.parts.insert(grid.parts.end(), parts.begin(), parts.end());
    }
    Keep(grid);
  }

  const Assembly& assembly_;
  const std::vector<int> parts_;
  const LostBy& lost_by_;
  const double tolerance_;
  const Places places_;
  std::vector<Candidate> rows_;
  Candidate best_;
};

std::vector<std::vector<int>> IdenticalParts(const Assembly& assembly, double tolerance) {
  std::vector<std::vector<int>> kinds;
  for (std::size_t i = 0; i < assembly.parts.size(); ++i) {
    const AssemblyPart& part = assembly.parts[i];
    const auto is_alike = [&](const std::vector<int>& kind) {
      return AreIdentical(assembly.parts[static_cast<std::size_t>(kind.front())], part, tolerance);
    };
    const auto kind = std::find_if(kinds.begin(), kinds.end(), is_alike);
    if (kind == kinds.end()) {
      kinds.push_back({static_cast<int>(i)});
    } else {
      kind->push_back(static_cast<int>(i));
    }
  }
  return kinds;
}

// Along a slope the sizes would change by axes of their own, with one number of parts for both: no
// number keeps all of them within what the item allows.
void KeepSizesOfSlope(const PatternDirection& direction, Pattern& pattern) {
  if (direction.count < 2 || (direction.spacing.array() != 0).count() < 2) return;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction.spacing[axis] != 0) pattern.resizable[static_cast<std::size_t>(axis)] = false;
  }
}

Pattern PatternOf(const Assembly& assembly, const Candidate& candidate) {
  const AssemblyPart& first = assembly.parts[static_cast<std::size_t>(candidate.parts.front())];
  Pattern pattern;
  pattern.directions = candidate.directions;
  pattern.part_size = first.box.size();
  pattern.connecting = first.connecting;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    pattern.resizable[axis] = first.limits[axis].minimum < first.limits[axis].maximum;
    if (pattern.resizable[axis]) pattern.part_limits[axis] = first.limits[axis];
  }
  for (const PatternDirection& direction : pattern.directions) KeepSizesOfSlope(direction, pattern);
  return pattern;
}

}  // namespace

std::vector<FoundPattern> FindPatterns(const Assembly& assembly, double tolerance,
                                       const PatternExclusions& exclusions) {
  std::vector<FoundPattern> found;
  const LostBy lost_by = ByPart(exclusions.pattern_losses, assembly.parts.size());
  for (std::vector<int> kind : IdenticalParts(assembly, tolerance)) {
    std::erase_if(kind, [&](int part) { return exclusions.lone.count(part) != 0; });
    while (static_cast<int>(kind.size()) >= kFewest) {
      const Candidate best = PatternSearch(assembly, kind, lost_by, tolerance).Best();
      if (best.parts.empty()) break;
      found.push_back({PatternOf(assembly, best), best.parts});
      std::erase_if(kind, [&](int part) {
        return std::find(best.parts.begin(), best.parts.end(), part) != best.parts.end();
      });
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const FoundPattern& a, const FoundPattern& b) {
    return a.parts.size() > b.parts.size();
  });
  return found;
}

}  // namespace mortise::parametric
