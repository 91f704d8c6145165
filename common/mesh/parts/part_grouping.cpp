#include "common/mesh/parts/part_grouping.h"

#include <algorithm>
#include <array>
#include <boost/pending/disjoint_sets.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/mass_properties.h"
#include "common/mesh/point_merger.h"
#include "common/mesh/repair/proximity.h"

namespace mortise::mesh {
namespace {

constexpr std::size_t kMaxCompared = 200;  // pieces whose triangles are looked at
constexpr double kSamePlace = 1e-5;        // of the scene's diagonal
constexpr double kFlat = 1e-4;             // of the scene's diagonal: pieces no thicker are flat
constexpr double kSameArea = 1e-3;
constexpr double kReachGrowth = 4;  // from one search for what is nearest to the next

// Two pieces that are no further apart than was looked for.
struct Near {
  std::size_t first = 0, second = 0;
  double distance = 0;
};

// "1 piece", "3 pieces".
std::string Pieces(std::size_t count) {
  return absl::StrCat(count, count == 1 ? " piece" : " pieces");
}

double GapBetween(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b) {
  return std::sqrt(a.squaredExteriorDistance(b));
}

double DiagonalOf(const Eigen::AlignedBox3d& box) { return box.diagonal().norm(); }

// Finds boxes by where they lie, by a hash of both corners' cells of a grid.
class BoxesByPlace {
 public:
  // Boxes are near whose coordinates differ by `reach` at most.
  explicit BoxesByPlace(double reach) : reach_(reach) {}

  void Add(std::size_t number, const Eigen::AlignedBox3d& box) {
    numbers_[CellOf(CornersOf(box))].push_back(number);
  }

  // The boxes that may be near, those that are among them, in the order in which they were added.
  std::vector<std::size_t> Near(const Eigen::AlignedBox3d& box) const {
    const Corners corners = CornersOf(box);
    const Cell low = CellOf(corners.array() - reach_), high = CellOf(corners.array() + reach_);
    std::vector<std::size_t> near;
    for (Cell cell = low;;) {
      if (const auto found = numbers_.find(cell); found != numbers_.end()) {
        near.insert(near.end(), found->second.begin(), found->second.end());
      }
      // The next cell: each coordinate from its low to its high end, as digits are counted.
      std::size_t digit = 0;
      while (digit < cell.size() && cell[digit] == high[digit]) {
        cell[digit] = low[digit];
        ++digit;
      }
      if (digit == cell.size()) break;
      ++cell[digit];
    }
    std::sort(near.begin(), near.end());
    return near;
  }

 private:
  using Corners = Eigen::Matrix<double, 6, 1>;
  using Cell = std::array<std::int64_t, 6>;

  static Corners CornersOf(const Eigen::AlignedBox3d& box) {
    Corners corners;
    corners << box.min(), box.max();
    return corners;
  }

  // Cells are some reaches wide, so that most boxes need only one to be looked into.
  Cell CellOf(const Corners& corners) const {
    constexpr double kWidth = 4;
    Cell cell = {};
    if (reach_ <= 0) return cell;
    for (std::size_t i = 0; i < cell.size(); ++i) {
      cell[i] = static_cast<std::int64_t>(
          std::floor(corners[static_cast<Eigen::Index>(i)] / (kWidth * reach_)));
    }
    return cell;
  }

  struct CellHash {
    std::size_t operator()(const Cell& cell) const {
      std::uint64_t hash = 0;
      for (const std::int64_t coordinate : cell) {
        hash = (hash ^ static_cast<std::uint64_t>(coordinate)) * 0x9E3779B97F4A7C15ull;
        hash ^= hash >> 29;
      }
      return static_cast<std::size_t>(hash);
    }
  };

  const double reach_;
  std::unordered_map<Cell, std::vector<std::size_t>, CellHash> numbers_;
};

class Grouping {
 public:
  Grouping(const std::vector<SurfacePiece>& pieces, const PartGroupingOptions& options)
      : pieces_(pieces), options_(options), parts_(pieces.size()), hanging_(pieces.size()) {
    Eigen::AlignedBox3d all;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      boxes_.push_back(BoxOf(pieces[i].surface));
      component_of_.push_back(pieces[i].component);
      all.extend(boxes_.back());
      parts_.make_set(i);
      hanging_.make_set(i);
    }
    drawn_ = boxes_;
    diagonal_ = DiagonalOf(all);
  }

  absl::StatusOr<PartGrouping> Group() {
    LeaveOutDoubled();
    JoinSmallestByBoxes();
    MORTISE_ASSIGN_OR_RETURN(contacts_, FindNear(options_.contact * diagonal_));
    JoinDecals();
    MORTISE_RETURN_IF_ERROR(JoinFloating());
    JoinSmallest();
    return Numbered();
  }

 private:
  // ---- Doubled pieces ---------------------------------------------------------------------------

  void LeaveOutDoubled() {
    is_out_.assign(pieces_.size(), false);
    const double same = kSamePlace * diagonal_;
    BoxesByPlace kept(same);
    std::size_t count = 0;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      for (const std::size_t other : kept.Near(drawn_[i])) {
        if (!HaveSameBox(other, i, same)) continue;
        if (!AreAlike(pieces_[other].surface, pieces_[i].surface, {0, 0, 0}, same)) continue;
        is_out_[i] = true;
        ++count;
        break;
      }
      if (!is_out_[i]) kept.Add(i, drawn_[i]);
    }
    if (count == 0) return;
    notes_.push_back(absl::StrCat(Pieces(count), " drawn twice at one place ",
                                  count == 1 ? "is" : "are", " taken once."));
  }

  bool HaveSameBox(std::size_t a, std::size_t b, double same) const {
    return (drawn_[a].min() - drawn_[b].min()).cwiseAbs().maxCoeff() <= same &&
           (drawn_[a].max() - drawn_[b].max()).cwiseAbs().maxCoeff() <= same;
  }

  // ---- Contact ----------------------------------------------------------------------------------

  // The pieces that stand for parts and come within `reach` of each other, nearest first.
  absl::StatusOr<std::vector<Near>> FindNear(double reach) const {
    std::vector<std::size_t> which;
    std::vector<SurfaceMesh> surfaces;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (is_out_[i] || is_small_[i]) continue;
      which.push_back(i);
      surfaces.push_back(pieces_[i].surface);
    }
    MORTISE_ASSIGN_OR_RETURN(const std::vector<Proximity> found, FindProximities(surfaces, reach));
    std::vector<Near> near;
    for (const Proximity& each : found) {
      near.push_back({which[static_cast<std::size_t>(each.first)],
                      which[static_cast<std::size_t>(each.second)], each.distance});
    }
    std::stable_sort(near.begin(), near.end(),
                     [](const Near& a, const Near& b) { return a.distance < b.distance; });
    return near;
  }

  // ---- Joining ----------------------------------------------------------------------------------

  std::size_t PartOf(std::size_t piece) { return parts_.find_set(piece); }

  void Join(std::size_t a, std::size_t b) {
    const std::size_t first = PartOf(a), second = PartOf(b);
    if (first == second) return;
    const Eigen::AlignedBox3d together = boxes_[first].merged(boxes_[second]);
    // A part goes on being called after its larger piece.
    const bool first_is_larger = DiagonalOf(boxes_[first]) >= DiagonalOf(boxes_[second]);
    const int component = component_of_[first_is_larger ? first : second];
    parts_.union_set(first, second);
    boxes_[PartOf(a)] = together;
    component_of_[PartOf(a)] = component;
  }

  // The smallest pieces of very many become part of the larger ones nearest to them by their boxes.
  void JoinSmallestByBoxes() {
    is_small_.assign(pieces_.size(), false);
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (!is_out_[i]) order.push_back(i);
    }
    if (order.size() <= kMaxCompared) return;
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return DiagonalOf(drawn_[a]) > DiagonalOf(drawn_[b]);
    });
    for (std::size_t i = kMaxCompared; i < order.size(); ++i) {
      std::size_t nearest = order[0];
      std::pair<double, double> least(std::numeric_limits<double>::infinity(), 0);
      for (std::size_t j = 0; j < kMaxCompared; ++j) {
        const std::size_t other = order[j];
        const double gap = GapBetween(drawn_[order[i]], drawn_[other]);
        if (gap > least.first) continue;
        const std::pair cost(gap, DiagonalOf(drawn_[other]));
        if (!(cost < least)) continue;
        nearest = other;
        least = cost;
      }
      is_small_[order[i]] = true;
      Join(nearest, order[i]);
    }
    joined_ += order.size() - kMaxCompared;
  }

  bool IsFlat(std::size_t piece) const {
    return drawn_[piece].sizes().minCoeff() <= kFlat * diagonal_;
  }

  void JoinDecals() {
    const double same = kFlat * diagonal_;
    std::size_t count = 0;
    for (const Near& contact : contacts_) {
      for (const auto& [decal, base] :
           {std::pair(contact.first, contact.second), std::pair(contact.second, contact.first)}) {
        Eigen::AlignedBox3d around = drawn_[base];
        around.min().array() -= same;
        around.max().array() += same;
        if (!IsFlat(decal) || IsFlat(base) || PartOf(decal) == PartOf(base) ||
            !around.contains(drawn_[decal])) {
          continue;
        }
        Join(base, decal);
        ++count;
        break;
      }
    }
    if (count == 0) return;
    notes_.push_back(
        absl::StrCat(Pieces(count), count == 1 ? " is flat and lies" : " are flat and lie",
                     " on another, of which ", count == 1 ? "it is" : "they are", " part."));
  }

  // Joins what is nearest to each other until all hangs together.
  absl::Status JoinFloating() {
    std::size_t apart = 0;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (!is_out_[i] && PartOf(i) == i) ++apart;
    }
    for (std::size_t i = 0; i < pieces_.size(); ++i) hanging_.union_set(i, PartOf(i));
    const auto hang = [&](const Near& near) {
      if (hanging_.find_set(near.first) == hanging_.find_set(near.second)) return false;
      hanging_.union_set(near.first, near.second);
      --apart;
      return true;
    };
    for (const Near& contact : contacts_) hang(contact);
    std::size_t count = 0;
    for (double reach = options_.contact * diagonal_; apart > 1 && reach < diagonal_;) {
      reach = std::min(std::max(kReachGrowth * reach, kSamePlace * diagonal_), diagonal_);
      MORTISE_ASSIGN_OR_RETURN(const std::vector<Near> near, FindNear(reach));
      for (const Near& each : near) {
        if (!hang(each)) continue;
        Join(each.first, each.second);
        ++count;
      }
    }
    if (count == 0) return absl::OkStatus();
    notes_.push_back(absl::StrCat(Pieces(count), count == 1 ? " touches" : " touch",
                                  " nothing and ", count == 1 ? "is" : "are",
                                  " part of what is nearest."));
    return absl::OkStatus();
  }

  // ---- Too many parts ---------------------------------------------------------------------------

  // The parts, smallest first.
  std::vector<std::size_t> SmallestFirst() {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (!is_out_[i] && PartOf(i) == i) order.push_back(i);
    }
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return DiagonalOf(boxes_[a]) < DiagonalOf(boxes_[b]);
    });
    return order;
  }

  // The part that another one is to be joined with.
  std::size_t BestFor(std::size_t part) {
    std::size_t best = part;
    std::array<double, 3> least = {};
    const auto look_at = [&](std::size_t other) {
      if (other == part) return;
      const bool is_strange =
          options_.keeps_components && component_of_[other] != component_of_[part];
      const double before = DiagonalOf(boxes_[other]);
      const double growth = DiagonalOf(boxes_[other].merged(boxes_[part])) - before;
      const std::array<double, 3> cost = {is_strange ? 1.0 : 0.0, growth, before};
      if (best != part && !(cost < least)) return;
      best = other;
      least = cost;
    };
    for (const Near& contact : contacts_) {
      const std::size_t a = PartOf(contact.first), b = PartOf(contact.second);
      if (a == part) look_at(b);
      if (b == part) look_at(a);
    }
    return best;
  }

  void JoinSmallest() {
    std::vector<std::size_t> order = SmallestFirst();
    double last = 0;  // the diagonal of what was joined last
    const double same = kSamePlace * diagonal_;
    while (order.size() > 1) {
      const bool are_too_many = order.size() > options_.most_parts;
      std::size_t next = 0;  // what nothing touches has been joined before
      while (next < order.size() && BestFor(order[next]) == order[next]) ++next;
      if (next == order.size()) break;
      const double size = DiagonalOf(boxes_[order[next]]);
      if (!are_too_many && !(joined_ > 0 && size <= last + same)) break;
      last = std::max(last, size);
      Join(BestFor(order[next]), order[next]);
      ++joined_;
      order = SmallestFirst();
    }
    if (joined_ == 0) return;
    notes_.push_back(absl::StrCat("There are more than ", options_.most_parts,
                                  " parts: the smallest ", joined_, joined_ == 1 ? " is" : " are",
                                  " part of what they touch."));
  }

  // ---- The result -------------------------------------------------------------------------------

  PartGrouping Numbered() {
    PartGrouping grouping{
        .part_of = std::vector<int>(pieces_.size(), -1), .has_gap = {}, .notes = {}};
    std::vector<int> numbers(pieces_.size(), -1);
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (is_out_[i]) continue;
      int& number = numbers[PartOf(i)];
      if (number < 0) number = grouping.count++;
      grouping.part_of[i] = number;
    }
    grouping.has_gap.assign(static_cast<std::size_t>(grouping.count), false);
    for (const Near& contact : contacts_) {
      if (contact.distance == 0 || PartOf(contact.first) == PartOf(contact.second)) continue;
      for (const std::size_t piece : {contact.first, contact.second}) {
        grouping.has_gap[static_cast<std::size_t>(grouping.part_of[piece])] = true;
      }
    }
    grouping.notes = std::move(notes_);
    return grouping;
  }

  const std::vector<SurfacePiece>& pieces_;
  const PartGroupingOptions options_;
  double diagonal_ = 0;
  std::vector<Eigen::AlignedBox3d> drawn_;  // of pieces
  std::vector<Eigen::AlignedBox3d> boxes_;  // of parts, at the piece that stands for them
  std::vector<int> component_of_;           // likewise
  std::vector<bool> is_out_;                // doubled
  std::vector<bool> is_small_;              // joined by its box, and not looked at any more
  std::vector<Near> contacts_;
  boost::disjoint_sets_with_storage<> parts_;    // pieces of one part
  boost::disjoint_sets_with_storage<> hanging_;  // pieces that hang together
  std::size_t joined_ = 0;                       // as there are too many
  std::vector<std::string> notes_;
};

}  // namespace

absl::StatusOr<PartGrouping> GroupPieces(const std::vector<SurfacePiece>& pieces,
                                         const PartGroupingOptions& options) {
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (pieces[i].surface.triangles.cols() == 0) {
      return InvalidField(absl::StrCat("pieces[", i, "]"), "has no triangles");
    }
  }
  return Grouping(pieces, options).Group();
}

bool AreAlike(const SurfaceMesh& a, const SurfaceMesh& b, const Eigen::Vector3d& translation,
              double tolerance) {
  // A box and a tray have the same corners.
  if (std::abs(SurfaceArea(a) - SurfaceArea(b)) > kSameArea * SurfaceArea(a)) return false;
  PointMerger places(tolerance);
  for (const auto& vertex : a.vertices.colwise()) places.IndexOf(vertex);
  const Eigen::Index count = places.Points().cols();
  std::vector<bool> is_met(static_cast<std::size_t>(count), false);
  for (const auto& vertex : b.vertices.colwise()) {
    const int found = places.IndexOf(vertex + translation);
    if (found >= count) return false;
    is_met[static_cast<std::size_t>(found)] = true;
  }
  return std::all_of(is_met.begin(), is_met.end(), [](bool met) { return met; });
}

}  // namespace mortise::mesh
