#include "common/parametric/pattern.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

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

class PatternSearch {
 public:
  PatternSearch(const Assembly& assembly, std::vector<int> parts, double tolerance)
      : assembly_(assembly),
        parts_(std::move(parts)),
        tolerance_(tolerance),
        places_(assembly, parts_, tolerance) {}

  // The best pattern among the parts; without parts if there is none.
  Candidate Best() {
    FindRows();
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      Keep(rows_[i]);
      for (std::size_t j = 0; j < rows_.size(); ++j) {
        if (i != j && rows_[i].parts[0] == rows_[j].parts[0]) KeepGrid(rows_[i], rows_[j]);
      }
    }
    return best_;
  }

 private:
  Eigen::Vector3d Center(int part) const {
    return assembly_.parts[static_cast<std::size_t>(part)].box.center();
  }

  void Keep(const Candidate& candidate) {
    if (best_.parts.empty() || IsBetter(candidate, best_, tolerance_)) best_ = candidate;
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
        row.directions[0].spacing =
            (Center(row.parts.back()) - Center(first)) / static_cast<double>(row.parts.size() - 1);
        rows_.push_back(std::move(row));
      }
    }
  }

  // The largest full grid over (parts of) two rows that begin at the same part.
  void KeepGrid(const Candidate& along, const Candidate& across) {
    const Eigen::Vector3d& p = along.directions[0].spacing;
    const Eigen::Vector3d& r = across.directions[0].spacing;
    if (std::abs(p.dot(r)) > tolerance_ * std::max(p.norm(), r.norm())) return;  // rectangular only
    int count = along.directions[0].count;
    Candidate grid;
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
  const double tolerance_;
  const Places places_;
  std::vector<Candidate> rows_;
  Candidate best_;
};

// Parts of one item, role, shape and group, split by size.
std::vector<std::vector<int>> IdenticalParts(const Assembly& assembly, double tolerance) {
  std::vector<std::vector<int>> kinds;
  for (std::size_t i = 0; i < assembly.parts.size(); ++i) {
    const AssemblyPart& part = assembly.parts[i];
    const auto is_alike = [&](const std::vector<int>& kind) {
      const AssemblyPart& other = assembly.parts[static_cast<std::size_t>(kind.front())];
      return other.item == part.item && other.group == part.group &&
             other.connecting == part.connecting && other.shape == part.shape &&
             (other.box.size() - part.box.size()).cwiseAbs().maxCoeff() <= tolerance;
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

Pattern PatternOf(const Assembly& assembly, const Candidate& candidate) {
  const AssemblyPart& first = assembly.parts[static_cast<std::size_t>(candidate.parts.front())];
  Pattern pattern;
  pattern.directions = candidate.directions;
  pattern.part_size = first.box.size();
  pattern.connecting = first.connecting;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    pattern.resizable[axis] = first.limits[axis].minimum < first.limits[axis].maximum;
  }
  return pattern;
}

// ---- Layout ------------------------------------------------------------------------------------

// The axes that a direction leads along.
bool LeadsAlong(const PatternDirection& direction, int axis) {
  return direction.count > 1 && std::abs(direction.spacing[axis]) > 1e-9 * direction.spacing.norm();
}

struct Laid {
  Eigen::Vector3d spacing = Eigen::Vector3d::Zero();
  Eigen::Vector3d part_size;  // changed along the direction only
};

// `count` parts along one direction of the pattern, between the ends of a box of this size.
Laid Lay(const Pattern& pattern, const PatternDirection& direction, int count,
         const Eigen::Vector3d& box_size) {
  Laid laid;
  laid.part_size = pattern.part_size;
  for (int axis = 0; axis < 3; ++axis) {
    if (!LeadsAlong(direction, axis)) continue;
    const double original = std::abs(direction.spacing[axis]);
    const double part = pattern.part_size[axis];
    const double sign = direction.spacing[axis] < 0 ? -1 : 1;
    if (pattern.resizable[static_cast<std::size_t>(axis)]) {
      // (count - 1) · spacing + part · spacing / original fills the box.
      const double spacing = box_size[axis] / (count - 1 + part / original);
      laid.spacing[axis] = sign * spacing;
      laid.part_size[axis] = part * spacing / original;
    } else {
      laid.spacing[axis] = sign * (box_size[axis] - part) / (count - 1);
    }
  }
  return laid;
}

// Whether neighbours, of the pattern or of the principal one that it follows, do not stay clear of
// each other where they were clear in the original.
bool Intersects(const Pattern& pattern, const PatternDirection& direction, const Laid& laid) {
  if (direction.principal_size > 0) {
    const double clear_from = direction.principal_size - 1e-9 * (1 + direction.principal_size);
    return direction.spacing.norm() >= clear_from && laid.spacing.norm() < clear_from;
  }
  bool clear = false;
  bool was_clear = false;
  for (int axis = 0; axis < 3; ++axis) {
    const double slack = 1e-9 * (1 + pattern.part_size.norm());
    clear |= std::abs(laid.spacing[axis]) >= laid.part_size[axis] - slack;
    was_clear |= std::abs(direction.spacing[axis]) >= pattern.part_size[axis] - slack;
  }
  return was_clear && !clear;
}

int CountFor(const Pattern& pattern, const PatternDirection& direction,
             const Eigen::Vector3d& box_size) {
  constexpr int kMost = 100000;
  const double original = direction.spacing.norm();
  const auto spacing = [&](int count) {
    return Lay(pattern, direction, count, box_size).spacing.norm();
  };
  // The spacing falls as the count grows: the first that is not above the original.
  int low = 2;
  int high = 2;
  while (spacing(high) > original * (1 + 1e-9) && high < kMost) high *= 2;
  while (low < high) {
    const int middle = low + (high - low) / 2;
    if (spacing(middle) > original * (1 + 1e-9)) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  int count = low;
  if ((!pattern.connecting || direction.principal_size > 0) && count > 2 &&
      spacing(count - 1) - original <= original - spacing(count)) {
    --count;
  }
  while (count > 2 && Intersects(pattern, direction, Lay(pattern, direction, count, box_size))) {
    --count;
  }
  return count;
}

}  // namespace

std::vector<FoundPattern> FindPatterns(const Assembly& assembly, double tolerance) {
  std::vector<FoundPattern> found;
  for (std::vector<int> kind : IdenticalParts(assembly, tolerance)) {
    while (static_cast<int>(kind.size()) >= kFewest) {
      const Candidate best = PatternSearch(assembly, kind, tolerance).Best();
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

Eigen::Vector3d PatternLayout::CenterOf(int index) const {
  return first_center + (index % directions[0].count) * directions[0].spacing +
         (index / directions[0].count) * directions[1].spacing;
}

std::optional<std::pair<int, int>> CommonDirection(const Pattern& a, const Pattern& b, int axis,
                                                   double tolerance) {
  const auto index = static_cast<std::size_t>(axis);
  if (a.resizable[index] || b.resizable[index]) return std::nullopt;
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      const PatternDirection& of_a = a.directions[static_cast<std::size_t>(i)];
      const PatternDirection& of_b = b.directions[static_cast<std::size_t>(j)];
      const bool alike = of_a.count > 1 && of_a.count == of_b.count &&
                         (of_a.spacing - of_b.spacing).norm() <= tolerance;
      const bool along_axis = std::abs(of_a.spacing[axis]) >= of_a.spacing.norm() - tolerance;
      if (alike && along_axis) return std::pair(i, j);
    }
  }
  return std::nullopt;
}

PatternLayout LayOut(const Pattern& pattern, const BoundingBox& box) {
  PatternLayout layout;
  layout.part_size = pattern.part_size;
  for (int axis = 0; axis < 3; ++axis) {
    const bool led =
        LeadsAlong(pattern.directions[0], axis) || LeadsAlong(pattern.directions[1], axis);
    if (!led) layout.part_size[axis] = box.size()[axis];
  }
  Eigen::Vector3d reach = Eigen::Vector3d::Zero();  // from the first part to the last
  for (std::size_t i = 0; i < 2; ++i) {
    const PatternDirection& direction = pattern.directions[i];
    if (direction.count < 2) continue;
    const int count = CountFor(pattern, direction, box.size());
    const Laid laid = Lay(pattern, direction, count, box.size());
    layout.directions[i] = {count, laid.spacing};
    reach += (count - 1) * laid.spacing;
    for (int axis = 0; axis < 3; ++axis) {
      if (LeadsAlong(direction, axis)) layout.part_size[axis] = laid.part_size[axis];
    }
  }
  layout.first_center = box.center() - reach / 2;
  return layout;
}

}  // namespace mortise::parametric
