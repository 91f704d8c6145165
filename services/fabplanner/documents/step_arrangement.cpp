#include "services/fabplanner/documents/step_arrangement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <queue>
#include <set>
#include <unordered_map>

namespace mortise::fabplanner {
namespace {

constexpr double kApart = 0.16;        // of the step's diagonal: how far what comes in is drawn
constexpr double kScrewsApart = 0.09;  // how far screws are
constexpr double kNear = 1e-3;         // m, within which a connector lies at a part

using PartsByName = std::unordered_map<std::string, const Part*>;

PartsByName PartsOf(const Design& design) {
  PartsByName parts;
  for (const Part& part : design.parts) parts[part.name] = &part;
  return parts;
}

// A connection, and the two parts of those that it joins.
using JoinedParts = std::array<std::string, 3>;

// How two parts of a step are joined, seen from one of them.
struct Joint {
  std::string neighbour;
  Eigen::Vector3d away;  // unit: from the neighbour towards the part
};

std::map<std::string, std::vector<Joint>> JointsOf(const AssemblyStep& step, const Design& design) {
  std::map<std::string, std::vector<Joint>> joints;
  std::map<JoinedParts, const Peg*> first_peg;
  for (const Peg& peg : design.pegs) {
    first_peg.emplace(JoinedParts{peg.connection, peg.part, peg.other_part}, &peg);
  }
  for (const StepConnection& connection : step.connections) {
    const Peg& peg = *first_peg.at({connection.name, connection.part, connection.other_part});
    joints[peg.part].push_back({peg.other_part, -peg.direction});
    joints[peg.other_part].push_back({peg.part, peg.direction});
  }
  return joints;
}

// Which parts were built into one piece before the step: each part's piece is named by one of its
// parts. Parts that come in are pieces of their own.
std::map<std::string, std::string> PiecesBefore(const std::vector<AssemblyStep>& steps,
                                                int number) {
  std::map<std::string, std::string> piece;
  for (const AssemblyStep& step : steps) {
    if (step.number > number) break;
    for (const std::string& part : step.added_parts) piece[part] = part;
    if (step.number == number) break;
    for (const StepConnection& connection : step.connections) {
      const std::string kept = piece.at(connection.part);
      const std::string merged = piece.at(connection.other_part);
      for (auto& [part, name] : piece) {
        if (name == merged) name = kept;
      }
    }
  }
  return piece;
}

// Offsets of all parts in a step. Pieces move as a whole: the largest stays, the others follow by
// breadth-first search over the step's joints, each pulled away from the one it joins.
class Explosion {
 public:
  Explosion(const std::vector<AssemblyStep>& steps, int number, const Design& design,
            double distance)
      : piece_(PiecesBefore(steps, number)), distance_(distance) {
    const AssemblyStep& step = steps[number - 1];
    for (const auto& [part, joints] : JointsOf(step, design)) {
      for (const Joint& joint : joints) {
        joints_[piece_.at(part)].push_back({piece_.at(joint.neighbour), joint.away});
      }
    }
    std::map<std::string, int64_t> volumes;  // mm³: equal pieces must not differ by rounding
    std::vector<std::string> order;  // of first appearance, so that ties do not depend on names
    for (const Part& part : design.parts) {
      const auto piece = piece_.find(part.name);
      if (piece == piece_.end()) continue;
      if (volumes.emplace(piece->second, 0).second) order.push_back(piece->second);
      volumes[piece->second] += std::llround(part.size.prod() * 1e9);
    }
    // What stood before goes first, however small: people build onto it.
    const std::set<std::string> added(step.added_parts.begin(), step.added_parts.end());
    std::stable_sort(order.begin(), order.end(), [&](const auto& a, const auto& b) {
      return std::pair(added.contains(a), -volumes[a]) < std::pair(added.contains(b), -volumes[b]);
    });
    for (const std::string& root : order) {
      if (offsets_.emplace(root, Eigen::Vector3d::Zero()).second) Spread(root);
    }
  }

  Eigen::Vector3d Of(const std::string& part) const {
    const auto piece = piece_.find(part);
    return piece == piece_.end() ? Eigen::Vector3d::Zero().eval() : offsets_.at(piece->second);
  }

 private:
  void Spread(const std::string& root) {
    std::queue<std::string> reached({root});
    while (!reached.empty()) {
      const std::string from = reached.front();
      reached.pop();
      for (const Joint& joint : joints_[from]) {
        const Eigen::Vector3d offset = offsets_[from] - distance_ * joint.away;
        if (offsets_.emplace(joint.neighbour, offset).second) reached.push(joint.neighbour);
      }
    }
  }

  std::map<std::string, std::string> piece_;
  std::map<std::string, std::vector<Joint>> joints_;  // between pieces
  double distance_;
  std::map<std::string, Eigen::Vector3d> offsets_;  // of pieces
};

std::vector<std::string> PresentBefore(const std::vector<AssemblyStep>& steps, int number) {
  std::vector<std::string> present;
  for (const AssemblyStep& step : steps) {
    if (step.number >= number) break;
    present.insert(present.end(), step.added_parts.begin(), step.added_parts.end());
  }
  return present;
}

void AddParts(const PartsByName& parts, const std::vector<std::string>& names, StepRole role,
              const Explosion& explosion, StepArrangement* arrangement) {
  for (const std::string& name : names) {
    const auto part = parts.find(name);
    if (part == parts.end()) continue;
    arrangement->parts.push_back({part->second, role, explosion.Of(name)});
  }
}

// Pegs of the step in the gap that they bridge, and an arrow for each connection along its middle.
void AddPegsAndArrows(const Design& design, const AssemblyStep& step, const Explosion& explosion,
                      StepArrangement* arrangement) {
  std::map<JoinedParts, std::pair<Eigen::Vector3d, int>> centres;  // sum and count
  std::map<JoinedParts, StepWay> ways;
  std::set<JoinedParts> made;
  for (const StepConnection& connection : step.connections) {
    made.insert({connection.name, connection.part, connection.other_part});
  }
  for (const Peg& peg : design.pegs) {
    const JoinedParts joined = {peg.connection, peg.part, peg.other_part};
    if (!made.contains(joined)) continue;
    auto& [sum, count] =
        centres.emplace(joined, std::pair(Eigen::Vector3d::Zero().eval(), 0)).first->second;
    sum += peg.position;
    ++count;
    const Eigen::Vector3d own = explosion.Of(peg.part), other = explosion.Of(peg.other_part);
    const bool own_moves = own.norm() > other.norm();
    const Eigen::Vector3d &stays = own_moves ? other : own, &moves = own_moves ? own : other;
    arrangement->pegs.push_back({&peg, stays});
    arrangement->goals.push_back({peg.position, stays, moves});
    ways.emplace(joined, StepWay{peg.position, moves, stays});
  }
  for (auto& [joined, way] : ways) {
    if ((way.from - way.to).norm() < 1e-9) continue;
    const auto& [sum, count] = centres.at(joined);
    way.place = sum / count;
    arrangement->arrows.push_back(way);
  }
}

StepArrangement ArrangePegged(const Design& design, const std::vector<AssemblyStep>& steps,
                              int number) {
  const AssemblyStep& step = steps[static_cast<std::size_t>(number - 1)];
  const PartsByName parts = PartsOf(design);
  const std::vector<std::string> present = PresentBefore(steps, number);
  Eigen::AlignedBox3d box;
  for (const std::vector<std::string>* names : {&present, &step.added_parts}) {
    for (const std::string& name : *names) {
      const auto part = parts.find(name);
      if (part != parts.end()) box.extend(BoundsOf(*part->second));
    }
  }
  const Explosion explosion(steps, number, design, kApart * box.diagonal().norm());
  StepArrangement arrangement;
  AddParts(parts, present, StepRole::kStanding, explosion, &arrangement);
  AddParts(parts, step.added_parts, StepRole::kAdded, explosion, &arrangement);
  AddPegsAndArrows(design, step, explosion, &arrangement);
  return arrangement;
}

// Of a step in which parts come in along ways of their own, and screws after them.
class OrderedStep {
 public:
  OrderedStep(const Design& design, const Items& items, const std::vector<Hole>& holes,
              const AssemblyStep& step)
      : items_(items), step_(step), parts_(PartsOf(design)) {
    for (const Hole& hole : holes) holes_[hole.connector].push_back(&hole);
    Eigen::AlignedBox3d box;
    for (const std::string& name : step.standing) Extend(name, &box);
    for (const AssemblyStep::Move& move : step.moves) {
      for (const std::string& name : move.parts) Extend(name, &box);
    }
    diagonal_ = box.diagonal().norm();
    for (const AssemblyStep::Move& move : step.moves) {
      for (const std::string& name : move.parts) offsets_[name] = OffsetOf(move);
    }
  }

  StepArrangement Arrange() {
    for (const std::string& name : step_.standing) {
      AddPart(name, Eigen::Vector3d::Zero(), StepRole::kStanding);
    }
    for (const AssemblyStep::Move& move : step_.moves) {
      for (const std::string& name : move.parts) AddPart(name, OffsetOf(move), RoleOf(move));
    }
    for (const std::string& name : step_.connectors) AddConnector(name);
    for (const AssemblyStep::Move& move : step_.moves) AddArrow(move);
    return std::move(arrangement_);
  }

 private:
  void Extend(const std::string& name, Eigen::AlignedBox3d* box) const {
    const auto part = parts_.find(name);
    if (part != parts_.end()) box->extend(BoundsOf(*part->second));
  }

  Eigen::Vector3d OffsetOf(const AssemblyStep::Move& move) const {
    return -kApart * diagonal_ * move.way_in;
  }

  // What the rest comes onto stands already, unless it is new itself.
  StepRole RoleOf(const AssemblyStep::Move& move) const {
    const bool is_new =
        std::any_of(move.parts.begin(), move.parts.end(), [&](const std::string& part) {
          return std::count(step_.added_parts.begin(), step_.added_parts.end(), part) > 0;
        });
    return is_new || !move.way_in.isZero() ? StepRole::kAdded : StepRole::kStanding;
  }

  void AddPart(const std::string& name, const Eigen::Vector3d& offset, StepRole role) {
    const auto part = parts_.find(name);
    if (part != parts_.end()) arrangement_.parts.push_back({part->second, role, offset});
  }

  // Screws and bolts stand before the part under their head, along their holes; pegs half-way
  // between the parts that they join; the rest half-way between the place and the part that brings
  // it.
  void AddConnector(const std::string& name) {
    const auto part = parts_.find(name);
    if (part == parts_.end()) return;
    const auto item = items_.find(part->second->item);
    const bool screw = item != items_.end() && (item->second.kind == ItemKind::kScrew ||
                                                item->second.kind == ItemKind::kBolt);
    const std::vector<const Hole*>& holes = holes_[name];
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();
    if (screw && !holes.empty()) {
      offset =
          OffsetOfPart(holes.front()->part) - kScrewsApart * diagonal_ * holes.front()->direction;
    } else if (!holes.empty()) {
      for (const Hole* hole : holes) {
        offset += OffsetOfPart(hole->part) / static_cast<double>(holes.size());
      }
    } else {
      offset = OffsetBeside(*part->second);
    }
    AddPart(name, offset, StepRole::kFastener);
    for (const Hole* hole : holes) {
      arrangement_.goals.push_back({hole->position, offset, OffsetOfPart(hole->part)});
      if (screw) break;  // through the part under its head into the others
    }
  }

  Eigen::Vector3d OffsetOfPart(const std::string& name) const {
    const auto offset = offsets_.find(name);
    return offset == offsets_.end() ? Eigen::Vector3d::Zero().eval() : offset->second;
  }

  // The mean of the offsets of all parts that the connector lies at.
  Eigen::Vector3d OffsetBeside(const Part& connector) const {
    const Eigen::AlignedBox3d box = BoundsOf(connector);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int count = 0;
    const auto add = [&](const std::string& name) {
      const auto part = parts_.find(name);
      if (part == parts_.end() || part->second->connecting) return;
      Eigen::AlignedBox3d grown = BoundsOf(*part->second);
      grown.min().array() -= kNear;
      grown.max().array() += kNear;
      if (!grown.intersects(box)) return;
      sum += OffsetOfPart(name);
      ++count;
    };
    for (const std::string& name : step_.standing) add(name);
    for (const AssemblyStep::Move& move : step_.moves) {
      for (const std::string& name : move.parts) add(name);
    }
    if (count == 0) return sum;
    return sum / count;
  }

  // From the leading face of what comes in to where that will be.
  void AddArrow(const AssemblyStep::Move& move) {
    if (move.way_in.isZero()) return;
    Eigen::AlignedBox3d box;
    for (const std::string& name : move.parts) Extend(name, &box);
    if (box.isEmpty()) return;
    const Eigen::Vector3d leading = box.center() + box.sizes().cwiseProduct(move.way_in) / 2;
    arrangement_.arrows.push_back({leading, OffsetOf(move), Eigen::Vector3d::Zero()});
  }

  const Items& items_;
  const AssemblyStep& step_;
  PartsByName parts_;
  std::map<std::string, std::vector<const Hole*>> holes_;
  std::map<std::string, Eigen::Vector3d> offsets_;
  double diagonal_ = 0;
  StepArrangement arrangement_;
};

}  // namespace

Eigen::Vector3d ExplodedOffset(const std::string& part, const Design& design,
                               const std::vector<AssemblyStep>& steps, int number,
                               double distance) {
  return Explosion(steps, number, design, distance).Of(part);
}

StepArrangement ArrangeStep(const Design& design, const Items& items,
                            const std::vector<Hole>& holes, const std::vector<AssemblyStep>& steps,
                            int number) {
  const AssemblyStep& step = steps[static_cast<std::size_t>(number - 1)];
  return step.moves.empty() ? ArrangePegged(design, steps, number)
                            : OrderedStep(design, items, holes, step).Arrange();
}

}  // namespace mortise::fabplanner
