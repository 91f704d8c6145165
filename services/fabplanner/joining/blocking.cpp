#include "services/fabplanner/joining/blocking.h"

#include <algorithm>
#include <optional>

namespace mortise::fabplanner {
namespace {

struct Direction {
  int axis;
  int sign;
  const char* coming_from;
};

constexpr std::array<Direction, kDirections> kAll = {{{2, 1, "from above"},
                                                      {1, -1, "from the front"},
                                                      {1, 1, "from the back"},
                                                      {0, -1, "from the left"},
                                                      {0, 1, "from the right"},
                                                      {2, -1, "from below"}}};

// The axis along which a rod runs; nothing for what is no rod.
std::optional<int> RodAxis(const Part& part, const Items& items) {
  const auto item = items.find(part.item);
  if (item == items.end() || !item->second.round || part.size.x() < part.size.y()) {
    return std::nullopt;
  }
  return part.length_axis;
}

}  // namespace

Eigen::Vector3d DirectionOf(int direction) {
  return kAll[direction].sign * Eigen::Vector3d::Unit(kAll[direction].axis);
}

int Opposite(int direction) {
  for (int i = 0; i < kDirections; ++i) {
    if (kAll[i].axis == kAll[direction].axis && i != direction) return i;
  }
  return direction;
}

const char* ComingFrom(int direction) { return kAll[direction].coming_from; }

Blocking::Blocking(const Design& design, const Items& items, const std::vector<PartSolid>& solids,
                   const Joints& joints, const std::vector<std::vector<int>>& units,
                   const std::stop_token& stop) {
  for (auto& blocks : blocks_) blocks.assign(units.size(), std::vector<bool>(units.size(), false));
  std::vector<int> unit_of(design.parts.size(), -1);
  for (std::size_t unit = 0; unit < units.size(); ++unit) {
    for (int part : units[unit]) unit_of[part] = static_cast<int>(unit);
  }
  for (std::size_t a = 0; a < solids.size() && !stop.stop_requested(); ++a) {
    if (unit_of[a] < 0 || design.parts[a].connecting) continue;
    for (std::size_t b = a + 1; b < solids.size(); ++b) {
      if (unit_of[b] < 0 || unit_of[a] == unit_of[b] || design.parts[b].connecting) continue;
      AddPair(design, items, solids, static_cast<int>(a), static_cast<int>(b), unit_of[a],
              unit_of[b]);
    }
  }
  for (const PegTie& peg : joints.pegs) {
    const int a = unit_of[peg.part], b = unit_of[peg.other_part];
    if (a >= 0 && b >= 0 && a != b) Tie(a, b, peg.axis);
  }
}

void Blocking::AddPair(const Design& design, const Items& items,
                       const std::vector<PartSolid>& solids, int a, int b, int unit_a, int unit_b) {
  if (solids[a].Overlaps(solids[b])) {
    std::optional<int> rod = RodAxis(design.parts[a], items);
    const std::optional<int> other = RodAxis(design.parts[b], items);
    if (!rod || (other && design.parts[b].size.y() < design.parts[a].size.y())) rod = other;
    if (rod) {
      Tie(unit_a, unit_b, *rod);
    } else {
      unknown_.emplace_back(a, b);
    }
    return;
  }
  for (int direction = 0; direction < kDirections; ++direction) {
    const auto [axis, sign, name] = kAll[direction];
    auto& blocks = blocks_[direction];
    if (!blocks[unit_a][unit_b] && solids[a].IsBlockedBy(solids[b], axis, sign)) {
      blocks[unit_a][unit_b] = true;
    }
    if (!blocks[unit_b][unit_a] && solids[b].IsBlockedBy(solids[a], axis, sign)) {
      blocks[unit_b][unit_a] = true;
    }
  }
}

void Blocking::Tie(int unit_a, int unit_b, int axis) {
  for (int direction = 0; direction < kDirections; ++direction) {
    if (kAll[direction].axis == axis) continue;
    blocks_[direction][unit_a][unit_b] = blocks_[direction][unit_b][unit_a] = true;
  }
}

std::vector<int> Blocking::MovesWith(int direction, int unit, const std::vector<int>& units) const {
  std::vector<int> moving = {unit};
  for (std::size_t next = 0; next < moving.size(); ++next) {
    for (int other : units) {
      if (Blocks(direction, moving[next], other) &&
          std::find(moving.begin(), moving.end(), other) == moving.end()) {
        moving.push_back(other);
      }
    }
  }
  std::sort(moving.begin(), moving.end());
  return moving;
}

}  // namespace mortise::fabplanner
