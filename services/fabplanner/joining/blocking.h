// Finds which of several things stand in each other's way when one is moved off in a straight line
// along an axis, and what can be taken off at all (directional blocking graphs, Wilson and Latombe
// 1994).
#pragma once

#include <Eigen/Core>
#include <array>
#include <stop_token>
#include <utility>
#include <vector>

#include "services/fabplanner/joining/fixings.h"
#include "services/fabplanner/joining/part_solid.h"
#include "services/fabplanner/plan/design.h"

namespace mortise::fabplanner {

// The directions in which things are taken off, in the order in which people prefer them: up, to
// the front, to the back, to the left, to the right, down.
inline constexpr int kDirections = 6;
Eigen::Vector3d DirectionOf(int direction);
int Opposite(int direction);
// Returns "from above" for what comes back from there.
const char* ComingFrom(int direction);

class Blocking {
 public:
  // `units` are parts that move together, by index, each part in at most one. Parts that are pushed
  // over pegs or rods move only along them. Parts that reach into each other otherwise do not block
  // each other: nothing is known of their joint. Once a stop is requested, what is not compared yet
  // does not block.
  Blocking(const Design& design, const Items& items, const std::vector<PartSolid>& solids,
           const Joints& joints, const std::vector<std::vector<int>>& units,
           const std::stop_token& stop = {});

  // Whether `other` stands in the way of `unit` leaving in a direction.
  bool Blocks(int direction, int unit, int other) const { return blocks_[direction][unit][other]; }
  // Returns what must move with `unit` in a direction, of `units`: itself, what blocks it, what
  // blocks that.
  std::vector<int> MovesWith(int direction, int unit, const std::vector<int>& units) const;

  // Returns the parts of two units that reach into each other in an unknown way.
  const std::vector<std::pair<int, int>>& unknown() const { return unknown_; }

 private:
  void AddPair(const Design& design, const Items& items, const std::vector<PartSolid>& solids,
               int a, int b, int unit_a, int unit_b);
  void Tie(int unit_a, int unit_b, int axis);

  std::array<std::vector<std::vector<bool>>, kDirections> blocks_;
  std::vector<std::pair<int, int>> unknown_;
};

}  // namespace mortise::fabplanner
