#include "services/fabplanner/cutting/sloped_packing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "services/fabplanner/cutting/board_chain.h"

namespace mortise::fabplanner {
namespace {

using Boards = std::vector<std::vector<int>>;  // the parts on each board

constexpr int64_t kNone = std::numeric_limits<int64_t>::max() / 4;
constexpr int kMostGivenUp = 50;              // boards that are tried to be given up
constexpr std::size_t kMostPutSingly = 2000;  // parts: each is tried on every board

// The parts as chains see them.
class Problem {
 public:
  Problem(const std::vector<SlopedPart>& parts, std::vector<BinType> types,
          const Eigen::Vector2d& section, double kerf, int64_t search_steps)
      : classes_(section, kerf),
        types_(std::move(types)),
        finder_(classes_, KindsOf(parts), 10 * search_steps) {
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const CutEnds& ends = parts[i].ends;
      reaches_.push_back({classes_.ReachOfEnd(ends.front), classes_.ReachOfEnd(ends.rear)});
      lengths_.push_back(parts[i].length);
      middles_.push_back(parts[i].length - reaches_[i][0] - reaches_[i][1]);
    }
    for (const BinType& type : types_) largest_ = std::max(largest_, type.capacity);
    FindLeastSizes();
  }

  std::size_t size() const { return lengths_.size(); }
  const std::vector<BinType>& types() const { return types_; }
  int64_t largest() const { return largest_; }
  int64_t LengthOf(int part) const { return lengths_[static_cast<std::size_t>(part)]; }

  // What each part takes of a board at least, and by how much more a board then has for them.
  const std::vector<int64_t>& least_sizes() const { return least_sizes_; }
  int64_t least_capacity_gain() const { return least_capacity_gain_; }
  int64_t square_kerf() const { return classes_.square_kerf(); }

  // What the parts take of a board when they are chained: the first and the last may reach over a
  // little farther than their classes.
  int64_t TakenBy(const std::vector<int>& parts) {
    int64_t taken = finder_.ChainOf(CountsOf(parts)).extra + 2 * classes_.error();
    for (const int part : parts) taken += middles_[static_cast<std::size_t>(part)];
    return taken;
  }

  // Returns the cheapest type that the parts fit; -1 if none does.
  int TypeFor(const std::vector<int>& parts) {
    const int64_t taken = TakenBy(parts);
    int cheapest = -1;
    for (int t = 0; t < static_cast<int>(types_.size()); ++t) {
      const BinType& type = types_[static_cast<std::size_t>(t)];
      if (type.capacity < taken) continue;
      if (cheapest < 0 || type.cost < types_[static_cast<std::size_t>(cheapest)].cost) cheapest = t;
    }
    return cheapest;
  }

  SlopedBoard LayOut(std::vector<int> parts);

 private:
  std::vector<LaidWays> KindsOf(const std::vector<SlopedPart>& parts) {
    std::map<LaidWays, int> known;
    for (const SlopedPart& part : parts) {
      LaidWays ways;
      for (int way = 0; way < 4; ++way) {
        const CutEnds laid = Laid(part.ends, way);
        ways[static_cast<std::size_t>(way)] = {classes_.Of(laid.front), classes_.Of(laid.rear)};
      }
      const auto [entry, is_new] = known.emplace(ways, static_cast<int>(kinds_.size()));
      if (is_new) kinds_.push_back(ways);
      kind_of_.push_back(entry->second);
    }
    return kinds_;
  }

  std::vector<std::pair<int, int>> CountsOf(const std::vector<int>& parts) const {
    std::map<int, int> counts;
    for (const int part : parts) ++counts[kind_of_[static_cast<std::size_t>(part)]];
    return {counts.begin(), counts.end()};
  }

  void FindLeastSizes();
  std::vector<int64_t> LeastGaps() const;

  // How far the front of a part that lies in one of the four ways reaches over its middle.
  int64_t FrontReach(int part, int way) const {
    return reaches_[static_cast<std::size_t>(part)][way < 2 ? 0 : 1];
  }

  EndClasses classes_;
  std::vector<BinType> types_;
  std::vector<LaidWays> kinds_;
  std::vector<int> kind_of_;
  ChainFinder finder_;
  std::vector<std::array<int64_t, 2>> reaches_;  // of each part's own front and rear
  std::vector<int64_t> lengths_, middles_, least_sizes_;
  int64_t least_capacity_gain_ = 0;
  int64_t largest_ = 0;
};

// The least gap between each class of ends and any end of another part that can face it. An end
// that lies behind others faces fronts; turned about, the same two ends face each other from the
// other side, so that fronts that face rears are enough.
std::vector<int64_t> Problem::LeastGaps() const {
  std::map<int, std::set<int>>
      fronts;  // by class, the parts that can have such a front: two at most
  int classes = 0;
  for (std::size_t i = 0; i < kind_of_.size(); ++i) {
    for (const LaidEnds& ends : kinds_[static_cast<std::size_t>(kind_of_[i])]) {
      std::set<int>& having = fronts[ends.front];
      if (having.size() < 2) having.insert(static_cast<int>(i));
      classes = std::max({classes, ends.front + 1, ends.rear + 1});
    }
  }
  std::map<int, std::set<int>> rears;
  for (std::size_t i = 0; i < kind_of_.size(); ++i) {
    for (const LaidEnds& ends : kinds_[static_cast<std::size_t>(kind_of_[i])]) {
      std::set<int>& having = rears[ends.rear];
      if (having.size() < 2) having.insert(static_cast<int>(i));
    }
  }
  std::vector<int64_t> least(static_cast<std::size_t>(classes), kNone);
  for (const auto& [rear, of_rear] : rears) {
    for (const auto& [front, of_front] : fronts) {
      // A part does not face itself.
      if (of_rear.size() == 1 && of_rear == of_front) continue;
      least[static_cast<std::size_t>(rear)] =
          std::min(least[static_cast<std::size_t>(rear)], classes_.Gap(rear, front));
    }
  }
  return least;
}

void Problem::FindLeastSizes() {
  constexpr std::size_t kMostClasses = 1000;  // comparing all takes its square
  std::vector<int64_t> gaps;
  std::set<int> classes;
  for (const LaidWays& ways : kinds_) {
    for (const LaidEnds& ends : ways) classes.insert({ends.front, ends.rear});
  }
  if (classes.size() <= kMostClasses) gaps = LeastGaps();
  const auto half_gap = [&](int rear) -> int64_t {
    const int64_t square = classes_.square_kerf();  // no gap is smaller
    if (gaps.empty()) return square / 2;
    const int64_t gap = gaps[static_cast<std::size_t>(rear)];
    return gap == kNone ? 0 : std::max(square, gap - 3 * classes_.error()) / 2;
  };
  int64_t gain = std::numeric_limits<int64_t>::min();
  for (std::size_t i = 0; i < kind_of_.size(); ++i) {
    const LaidWays& ways = kinds_[static_cast<std::size_t>(kind_of_[i])];
    // The rear as it is, and the front where the part is turned about the width.
    const int64_t rear = half_gap(ways[0].rear), front = half_gap(ways[2].rear);
    least_sizes_.push_back(middles_[i] + rear + front);
    gain =
        std::max({gain, rear - classes_.Reach(ways[0].rear), front - classes_.Reach(ways[2].rear)});
  }
  least_capacity_gain_ = 2 * (gain + classes_.error());
}

SlopedBoard Problem::LayOut(std::vector<int> parts) {
  SlopedBoard board;
  board.type = TypeFor(parts);
  std::stable_sort(parts.begin(), parts.end(),
                   [&](int a, int b) { return LengthOf(a) > LengthOf(b); });
  const Chain& chain = finder_.ChainOf(CountsOf(parts));
  std::map<int, std::vector<int>> of_kind;  // shortest first, to be taken from the back
  for (auto part = parts.rbegin(); part != parts.rend(); ++part) {
    of_kind[kind_of_[static_cast<std::size_t>(*part)]].push_back(*part);
  }
  int64_t middle = 0;  // of the end before
  int before = -1;
  for (const ChainLink& link : chain.links) {
    const int part = of_kind[link.kind].back();
    of_kind[link.kind].pop_back();
    const LaidEnds& ends =
        kinds_[static_cast<std::size_t>(link.kind)][static_cast<std::size_t>(link.way)];
    const int64_t reach = FrontReach(part, link.way);
    middle += before < 0 ? reach : classes_.Gap(before, ends.front);
    board.placements.push_back({part, link.way, middle - reach});
    board.taken = std::max(board.taken, middle - reach + LengthOf(part));
    middle += middles_[static_cast<std::size_t>(part)];
    before = ends.rear;
  }
  return board;
}

std::vector<int> LongestFirst(const Problem& problem, std::vector<int> parts) {
  std::stable_sort(parts.begin(), parts.end(),
                   [&](int a, int b) { return problem.LengthOf(a) > problem.LengthOf(b); });
  return parts;
}

// Puts parts one after another onto the board of `capacity` that they fill most, or a new one;
// nothing where more than `most` boards are needed or a part fits none.
std::optional<Boards> PutBestFit(Problem& problem, Boards boards, const std::vector<int>& parts,
                                 int64_t capacity, std::size_t most) {
  std::vector<int64_t> filled;  // at least
  for (const std::vector<int>& board : boards) {
    int64_t sum = 0;
    for (const int part : board) sum += problem.least_sizes()[static_cast<std::size_t>(part)];
    filled.push_back(sum);
  }
  for (const int part : LongestFirst(problem, parts)) {
    const int64_t size = problem.least_sizes()[static_cast<std::size_t>(part)];
    int64_t fullest = -1;
    std::size_t best = boards.size();
    for (std::size_t b = 0; b < boards.size(); ++b) {
      if (filled[b] + size > capacity + problem.least_capacity_gain()) continue;
      std::vector<int> together = boards[b];
      together.push_back(part);
      const int64_t taken = problem.TakenBy(together);
      if (taken > capacity || taken <= fullest) continue;
      fullest = taken;
      best = b;
    }
    if (best == boards.size()) {
      if (boards.size() == most || problem.TakenBy({part}) > capacity) return std::nullopt;
      boards.emplace_back();
      filled.push_back(0);
    }
    boards[best].push_back(part);
    filled[best] += size;
  }
  return boards;
}

// Takes parts off boards that are too full, shortest first, and puts them elsewhere.
std::optional<Boards> Repair(Problem& problem, const std::vector<PackedBin>& bins) {
  Boards boards;
  std::vector<int> left;
  for (const PackedBin& bin : bins) {
    std::vector<int> parts = LongestFirst(problem, bin.items);
    while (parts.size() > 1 && problem.TakenBy(parts) > problem.largest()) {
      left.push_back(parts.back());
      parts.pop_back();
    }
    boards.push_back(std::move(parts));
  }
  return PutBestFit(problem, std::move(boards), left, problem.largest(), problem.size());
}

// Gives up boards whose parts find place on the others, emptiest first.
void GiveUpBoards(Problem& problem, Boards* boards) {
  for (int tries = 0; tries < kMostGivenUp && boards->size() > 1; ++tries) {
    std::vector<std::pair<int64_t, std::size_t>> order;
    for (std::size_t b = 0; b < boards->size(); ++b) {
      order.emplace_back(problem.TakenBy((*boards)[b]), b);
    }
    std::sort(order.begin(), order.end());
    bool found = false;
    for (std::size_t i = 0; i < std::min<std::size_t>(order.size(), 3) && !found; ++i) {
      Boards others = *boards;
      const std::vector<int> parts = others[order[i].second];
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(order[i].second));
      const std::size_t most = others.size();
      auto without = PutBestFit(problem, std::move(others), parts, problem.largest(), most);
      if (!without) continue;
      *boards = *std::move(without);
      found = true;
    }
    if (!found) return;
  }
}

int64_t CostOf(Problem& problem, const Boards& boards) {
  int64_t cost = 0;
  for (const std::vector<int>& board : boards) {
    const int type = problem.TypeFor(board);
    if (type < 0) return kNone;
    cost += problem.types()[static_cast<std::size_t>(type)].cost;
  }
  return cost;
}

// The packing in which every part takes least, whose cost bounds all others.
Packing PackLeast(const Problem& problem, int64_t search_steps) {
  std::vector<BinType> types = problem.types();
  std::vector<int64_t> sizes = problem.least_sizes();
  for (int64_t& size : sizes) size = std::max<int64_t>(size, 1);
  int64_t largest = 0;
  for (BinType& type : types) {
    type.capacity = std::max<int64_t>(type.capacity + problem.least_capacity_gain(), 1);
    largest = std::max(largest, type.capacity);
  }
  // Rounding must not keep a part off the board that it fits by itself.
  for (int64_t& size : sizes) size = std::min(size, largest);
  return PackBins(sizes, types, search_steps);
}

// The packing in which every part takes its rectangle.
Packing PackRectangles(const Problem& problem, int64_t search_steps) {
  const int64_t kerf = problem.square_kerf();
  std::vector<BinType> types = problem.types();
  for (BinType& type : types) type.capacity += kerf;
  std::vector<int64_t> sizes;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    sizes.push_back(problem.LengthOf(static_cast<int>(i)) + kerf);
  }
  return PackBins(sizes, types, search_steps);
}

}  // namespace

SlopedPacking PackSlopedParts(const std::vector<SlopedPart>& parts,
                              const std::vector<BinType>& types, const Eigen::Vector2d& section,
                              double kerf, int64_t search_steps) {
  SlopedPacking packing;
  packing.optimal = parts.empty();
  if (parts.empty()) return packing;
  Problem problem(parts, types, section, kerf, search_steps);
  const Packing least = PackLeast(problem, search_steps);
  packing.lower_bound = least.lower_bound;

  Boards best;
  packing.cost = kNone;
  const auto consider = [&](std::optional<Boards> boards) {
    if (!boards) return;
    const int64_t cost = CostOf(problem, *boards);
    if (cost >= packing.cost) return;
    packing.cost = cost;
    best = *std::move(boards);
  };
  consider(Repair(problem, least.bins));
  if (packing.cost > packing.lower_bound) {
    consider(Repair(problem, PackRectangles(problem, search_steps).bins));
  }
  if (packing.cost > packing.lower_bound && parts.size() <= kMostPutSingly) {
    std::vector<int> all(parts.size());
    std::iota(all.begin(), all.end(), 0);
    for (const BinType& type : types) {
      consider(PutBestFit(problem, {}, all, type.capacity, parts.size()));
    }
  }
  if (packing.cost > packing.lower_bound) {
    Boards fewer = best;
    GiveUpBoards(problem, &fewer);
    consider(std::move(fewer));
  }
  packing.optimal = packing.cost == packing.lower_bound;
  for (const std::vector<int>& board : best) packing.boards.push_back(problem.LayOut(board));
  return packing;
}

}  // namespace mortise::fabplanner
