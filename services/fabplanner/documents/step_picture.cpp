#include "services/fabplanner/documents/step_picture.h"

#include <algorithm>
#include <map>
#include <utility>

#include "common/base/errors.h"
#include "services/fabplanner/documents/part_mesh.h"
#include "services/fabplanner/documents/step_view.h"

namespace mortise::fabplanner {
namespace {

constexpr double kApart = 0.16;        // of the step's diagonal: how far what comes in is drawn
constexpr double kScrewsApart = 0.09;  // how far screws are
constexpr double kNear = 1e-3;         // m, within which a connector lies at a part
constexpr std::size_t kMaxArrows = 24;

class StepScene {
 public:
  StepScene(const Design& design, const Items& items, const std::vector<Hole>& holes,
            const AssemblyStep& step)
      : items_(items), step_(step) {
    for (const Part& part : design.parts) parts_[part.name] = &part;
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

  absl::StatusOr<std::string> Draw() {
    for (const std::string& name : step_.standing) {
      AddPart(name, Eigen::Vector3d::Zero(), kPresentColor);
    }
    for (const AssemblyStep::Move& move : step_.moves) {
      for (const std::string& name : move.parts) AddPart(name, OffsetOf(move), ColorOf(move));
    }
    MORTISE_ASSIGN_OR_RETURN(const Eigen::Vector3d view, ChooseView(scene_));
    for (const std::string& name : step_.connectors) AddConnector(name);
    for (const AssemblyStep::Move& move : step_.moves) {
      if (scene_.lines.size() < kMaxArrows) AddArrow(move);
    }
    return RenderStep(std::move(scene_), view);
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
  const render::Color& ColorOf(const AssemblyStep::Move& move) const {
    const bool is_new =
        std::any_of(move.parts.begin(), move.parts.end(), [&](const std::string& part) {
          return std::count(step_.added_parts.begin(), step_.added_parts.end(), part) > 0;
        });
    return is_new || !move.way_in.isZero() ? kAddedColor : kPresentColor;
  }

  void AddPart(const std::string& name, const Eigen::Vector3d& offset, const render::Color& color) {
    const auto part = parts_.find(name);
    if (part == parts_.end()) return;
    render::Shape shape = PartShape(*part->second, offset);
    if (shape.triangles.cols() == 0) return;
    shape.color = color;
    scene_.shapes.push_back(std::move(shape));
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
      for (const Hole* hole : holes) offset += OffsetOfPart(hole->part) / holes.size();
    } else {
      offset = OffsetBeside(*part->second);
    }
    AddPart(name, offset, kPegColor);
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
    render::Line arrow;
    arrow.points.resize(3, 2);
    arrow.points.col(0) = leading + OffsetOf(move);
    arrow.points.col(1) = leading;
    arrow.color = kArrowColor;
    arrow.width = 2.5;
    arrow.arrow = true;
    arrow.on_top = true;
    scene_.lines.push_back(std::move(arrow));
  }

  const Items& items_;
  const AssemblyStep& step_;
  std::map<std::string, const Part*> parts_;
  std::map<std::string, std::vector<const Hole*>> holes_;
  std::map<std::string, Eigen::Vector3d> offsets_;
  double diagonal_ = 0;
  render::Scene scene_;
};

}  // namespace

absl::StatusOr<std::string> OrderedStepPicture(const Design& design, const Items& items,
                                               const std::vector<Hole>& holes,
                                               const AssemblyStep& step) {
  return StepScene(design, items, holes, step).Draw();
}

}  // namespace mortise::fabplanner
