// Puts parts with sloped ends one behind the other on a board so that they take as little of it as
// can be. Private to this folder.
//
// Two ends that run alike are made by one cut, whose kerf is measured along the board. Of two that
// do not, the squarer is cut first, and the other of what that leaves: the wedge between them is
// waste, and the first cut's kerf keeps them apart. Or a square cut goes between them, where that
// takes less. With the ends' slopes s and t, on a board of width W and thickness T, the middles of
// the two ends are apart by
//
//     min(|s − t|_W + min(k_s, k_t), |s|_W + |t|_W + k), |s|_W = (|s.across| W + |s.through| T) /
//     2,
//
// where k_s is the kerf along the board. Each part lies in one of four ways: as it is, or turned by
// half a turn about one of the board's axes. The shortest chain is found by dynamic programming
// over how many parts of each kind are placed and the end they leave; where that is too much, by
// putting part after part where it takes least. Lengths are in nanometres.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "services/fabplanner/plan/end_cuts.h"

namespace mortise::fabplanner {

// The slopes that occur on boards of one section. Those that one cut makes are one class.
class EndClasses {
 public:
  // `section` is the boards' width and thickness, m, both > 0; `kerf` in m, >= 0.
  EndClasses(const Eigen::Vector2d& section, double kerf);

  // Returns the class of a slope, which is added if it is new.
  int Of(const EndSlope& slope);

  // Returns the least distance between the middles of two ends that face each other.
  int64_t Gap(int rear, int front) const;
  // Returns how far an end of the class reaches over its middle.
  int64_t Reach(int end) const { return ends_[static_cast<std::size_t>(end)].reach; }
  // Returns how far this very end does, which differs from its class's by error() at most.
  int64_t ReachOfEnd(const EndSlope& slope) const;
  // Returns by how much, at most, reach and kerf of an end that Of was asked for differ from those
  // of its class: 0 where ends that run alike do so exactly. A gap differs by three times that.
  int64_t error() const { return error_; }
  // Returns the kerf of a square cut, the least of all gaps.
  int64_t square_kerf() const { return square_kerf_; }

 private:
  struct End {
    Eigen::Vector2d rise;  // m, across the width and through the thickness
    int64_t reach = 0;
    int64_t kerf = 0;
  };

  Eigen::Vector2d section_;
  double kerf_;
  int64_t square_kerf_;
  int64_t error_ = 0;
  std::vector<End> ends_;
  std::map<std::pair<int64_t, int64_t>, std::vector<int>> by_cell_;
};

// The ends of a part as it lies in one way: classes.
struct LaidEnds {
  int front = 0;
  int rear = 0;

  auto operator<=>(const LaidEnds&) const = default;
};

// The four ways in which a part can lie, by the classes of its ends: parts with the same are of one
// kind. In the order of Laid.
using LaidWays = std::array<LaidEnds, 4>;

// Returns the ends of a part that lies in one of the four ways, 0 to 3.
CutEnds Laid(const CutEnds& ends, int way);

// A part in a chain.
struct ChainLink {
  int kind = 0;
  int way = 0;
};

// Kinds of parts behind each other.
struct Chain {
  std::vector<ChainLink> links;
  // What the chain takes of a board besides the lengths of its parts along the middle line: gaps,
  // and the reach of its first and last end.
  int64_t extra = 0;
};

// Finds chains of kinds.
class ChainFinder {
 public:
  // `work` bounds how many steps of the exact search are made over all calls.
  ChainFinder(const EndClasses& classes, std::vector<LaidWays> kinds, int64_t work)
      : classes_(classes), kinds_(std::move(kinds)), work_(work) {}

  // Returns a chain of so many parts of each kind (kind and count > 0, by kind). The same counts
  // give the same chain.
  const Chain& ChainOf(const std::vector<std::pair<int, int>>& counts);

 private:
  Chain Shortest(const std::vector<std::pair<int, int>>& counts) const;
  Chain Inserted(const std::vector<std::pair<int, int>>& counts) const;

  const LaidEnds& EndsOf(const ChainLink& link) const {
    return kinds_[static_cast<std::size_t>(link.kind)][static_cast<std::size_t>(link.way)];
  }
  int64_t ExtraOf(const std::vector<ChainLink>& links) const;

  const EndClasses& classes_;
  std::vector<LaidWays> kinds_;
  int64_t work_;
  std::map<std::vector<std::pair<int, int>>, Chain> known_;
};

}  // namespace mortise::fabplanner
