#include "services/fabplanner/documents/assembly_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <queue>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/render/scene.h"
#include "services/fabplanner/documents/part_mesh.h"
#include "services/fabplanner/documents/step_picture.h"
#include "services/fabplanner/documents/step_view.h"

namespace mortise::fabplanner {
namespace {

constexpr int kMaxPegsDrawn = 400;

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

const Part* FindPart(const Design& design, const std::string& name) {
  for (const Part& part : design.parts) {
    if (part.name == name) return &part;
  }
  return nullptr;
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

void AddParts(const Design& design, const std::vector<std::string>& names,
              const render::Color& color, const Explosion& explosion, render::Scene* scene) {
  for (const std::string& name : names) {
    const Part* part = FindPart(design, name);
    if (part == nullptr) continue;
    render::Shape shape = PartShape(*part, explosion.Of(name));
    if (shape.triangles.cols() == 0) continue;
    shape.color = color;
    scene->shapes.push_back(std::move(shape));
  }
}

// Pegs of the step in the gap that they bridge, and an arrow for each connection along its middle.
void AddPegsAndArrows(const Design& design, const AssemblyStep& step, const Explosion& explosion,
                      render::Scene* scene) {
  std::map<JoinedParts, std::pair<Eigen::Vector3d, int>> centres;  // sum and count
  std::map<JoinedParts, const Peg*> pegs;
  std::set<JoinedParts> made;
  for (const StepConnection& connection : step.connections) {
    made.insert({connection.name, connection.part, connection.other_part});
  }
  int drawn = 0;
  for (const Peg& peg : design.pegs) {
    const JoinedParts joined = {peg.connection, peg.part, peg.other_part};
    if (!made.contains(joined)) continue;
    auto& [sum, count] =
        centres.emplace(joined, std::pair(Eigen::Vector3d::Zero().eval(), 0)).first->second;
    sum += peg.position;
    ++count;
    pegs.emplace(joined, &peg);
    if (++drawn > kMaxPegsDrawn) continue;
    // The peg stands in the part that moves less.
    const Eigen::Vector3d own = explosion.Of(peg.part), other = explosion.Of(peg.other_part);
    const Eigen::Vector3d face = peg.position + (own.norm() > other.norm() ? other : own);
    render::Shape shape =
        PegShape(face - peg.depth_in_part * peg.direction,
                 face + (peg.length - peg.depth_in_part) * peg.direction, peg.diameter);
    shape.color = kPegColor;
    scene->shapes.push_back(std::move(shape));
  }
  for (const auto& [name, centre] : centres) {
    const Peg& peg = *pegs.at(name);
    const Eigen::Vector3d middle = centre.first / centre.second;
    const Eigen::Vector3d own = explosion.Of(peg.part), other = explosion.Of(peg.other_part);
    if ((own - other).norm() < 1e-9) continue;
    // From the part that moves further to the one that it goes to.
    const bool own_moves = own.norm() > other.norm();
    const Eigen::Vector3d from = middle + (own_moves ? own : other);
    const Eigen::Vector3d to = middle + (own_moves ? other : own);
    render::Line arrow;
    arrow.points.resize(3, 2);
    arrow.points.col(0) = from;
    arrow.points.col(1) = to;
    arrow.color = kArrowColor;
    arrow.width = 2.5;
    arrow.arrow = true;
    arrow.on_top = true;
    scene->lines.push_back(std::move(arrow));
  }
}

}  // namespace

Eigen::Vector3d ExplodedOffset(const std::string& part, const Design& design,
                               const std::vector<AssemblyStep>& steps, int number,
                               double distance) {
  return Explosion(steps, number, design, distance).Of(part);
}

absl::StatusOr<std::string> StepPicture(const Design& design, const Items& items,
                                        const std::vector<Hole>& holes,
                                        const std::vector<AssemblyStep>& steps, int number) {
  if (number < 1 || number > static_cast<int>(steps.size())) {
    return InvalidField("number", absl::StrCat("there are ", steps.size(), " steps"));
  }
  const AssemblyStep& step = steps[number - 1];
  if (!step.moves.empty()) return OrderedStepPicture(design, items, holes, step);
  const std::vector<std::string> present = PresentBefore(steps, number);
  Eigen::AlignedBox3d box;
  for (const std::vector<std::string>* names : {&present, &step.added_parts}) {
    for (const std::string& name : *names) {
      if (const Part* part = FindPart(design, name)) box.extend(BoundsOf(*part));
    }
  }
  const Explosion explosion(steps, number, design, 0.16 * box.diagonal().norm());
  render::Scene scene;
  AddParts(design, present, kPresentColor, explosion, &scene);
  AddParts(design, step.added_parts, kAddedColor, explosion, &scene);
  MORTISE_ASSIGN_OR_RETURN(const Eigen::Vector3d view, ChooseView(scene));
  AddPegsAndArrows(design, step, explosion, &scene);
  return RenderStep(std::move(scene), view);
}

}  // namespace mortise::fabplanner
