#include "services/fabplanner/joining/fastener_holes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "services/fabplanner/joining/joinery.h"
#include "services/fabplanner/joining/part_solid.h"

namespace mortise::fabplanner {
namespace {

constexpr double kLeftAtFarSide = 5e-4;  // m, of a blind hole at least

// ISO 273:1979, medium series: thread and hole, mm.
constexpr std::array<std::pair<double, double>, 15> kIso273 = {{{2, 2.4},
                                                                {2.5, 2.9},
                                                                {3, 3.4},
                                                                {4, 4.5},
                                                                {5, 5.5},
                                                                {6, 6.6},
                                                                {8, 9},
                                                                {10, 11},
                                                                {12, 13.5},
                                                                {14, 15.5},
                                                                {16, 17.5},
                                                                {18, 20},
                                                                {20, 22},
                                                                {22, 24},
                                                                {24, 26}}};

double ToHalfMillimetre(double metres) { return std::round(metres * 2000) / 2000; }

double MeasureOr(const Item& item, const char* name, double otherwise) {
  const auto found = item.measures.find(name);
  return found == item.measures.end() ? otherwise : found->second;
}

// Long and round things reach into parts along a line.
bool IsRoundPin(const Item& item) {
  switch (item.kind) {
    case ItemKind::kDowel:
    case ItemKind::kScrew:
    case ItemKind::kBolt:
      return true;
    case ItemKind::kHardware:
      return item.pin;
    default:
      return false;
  }
}

const Item* ItemOf(const Part& part, const Items& items) {
  const auto found = items.find(part.item);
  return found == items.end() ? nullptr : &found->second;
}

bool MayBeDrilled(const Part& part, const Items& items) {
  if (part.connecting) return false;
  const Item* item = ItemOf(part, items);
  return item == nullptr || item->kind == ItemKind::kBoard || item->kind == ItemKind::kSheet ||
         item->kind == ItemKind::kDowel;
}

// What of a part a connector's line passes, measured along the line from head to tip.
struct Passage {
  const Part* part;
  double enter;
  double leave;
};

// A connector as a stretch of its line: s = 0 at the head, `length` at the tip.
struct Line {
  const Part* connector;
  const Item* item;
  Eigen::Vector3d head;
  Eigen::Vector3d direction;
  double length;
  bool head_inside = false;  // in the first part that it passes
  bool tip_inside = false;   // in the last
  std::vector<Passage> passages;
};

// Of the end that reaches into parts, m: of pins, of the hole too.
double PinDiameter(const Line& line) {
  return MeasureOr(*line.item, "tenon_diameter", line.connector->size.y());
}

// The lesser width of a box across an axis, m.
double SectionAcross(const Eigen::AlignedBox3d& box, int axis) {
  return std::min(box.sizes()[(axis + 1) % 3], box.sizes()[(axis + 2) % 3]);
}

bool Contains(const Passage& passage, double s) {
  return passage.enter + kFit < s && s < passage.leave - kFit;
}

void Reverse(Line* line) {
  line->head += line->length * line->direction;
  line->direction = -line->direction;
  for (Passage& passage : line->passages) {
    passage = {passage.part, line->length - passage.leave, line->length - passage.enter};
  }
  std::reverse(line->passages.begin(), line->passages.end());
  std::swap(line->head_inside, line->tip_inside);
}

class HoleMaker {
 public:
  HoleMaker(const Design& design, const Items& items) : design_(design), items_(items) {
    solids_.reserve(design.parts.size());
    for (const Part& part : design.parts) solids_.emplace_back(part);
  }

  void AddHoles(std::vector<Hole>* holes) const {
    for (std::size_t i = 0; i < design_.parts.size(); ++i) {
      const Part& part = design_.parts[i];
      const Item* item = ItemOf(part, items_);
      if (item == nullptr || !IsRoundPin(*item)) continue;
      // Of principal parts, only rods reach into others.
      if (!part.connecting && item->kind != ItemKind::kDowel && item->kind != ItemKind::kBolt) {
        continue;
      }
      const Line line = LineOf(i, *item);
      if (item->kind == ItemKind::kScrew) {
        AddScrewHoles(line, holes);
      } else if (item->kind == ItemKind::kBolt) {
        AddBoltHoles(line, holes);
      } else {
        AddPinHoles(line, holes);
      }
    }
  }

  void AddMarks(std::vector<Mark>* marks) const {
    for (std::size_t i = 0; i < design_.parts.size(); ++i) {
      const Part& part = design_.parts[i];
      const Item* item = ItemOf(part, items_);
      if (!part.connecting || item == nullptr || item->kind != ItemKind::kHardware) continue;
      if (IsRoundPin(*item) || IsFastened(i)) continue;
      for (std::size_t j = 0; j < design_.parts.size(); ++j) {
        if (!MayBeDrilled(design_.parts[j], items_) || !solids_[i].Touches(solids_[j])) continue;
        Eigen::AlignedBox3d region = solids_[i].box().intersection(solids_[j].box());
        if (region.isEmpty()) {
          region = {region.min().cwiseMin(region.max()), region.min().cwiseMax(region.max())};
        }
        marks->push_back({design_.parts[j].name, part.name, region});
      }
    }
  }

 private:
  // The line of a connector, with its tip at the end that stays in a part.
  Line LineOf(std::size_t index, const Item& item) const {
    const Part& part = design_.parts[index];
    const Eigen::AlignedBox3d& box = solids_[index].box();
    const int axis = part.length_axis;
    Line line{&part, &item, box.center(), Eigen::Vector3d::Unit(axis), box.sizes()[axis], false,
              false, {}};
    line.head[axis] = box.min()[axis];
    for (std::size_t j = 0; j < design_.parts.size(); ++j) {
      if (j == index || !MayBeDrilled(design_.parts[j], items_)) continue;
      if (!solids_[j].box().intersects(box)) continue;
      const double section = SectionAcross(solids_[j].box(), axis);
      for (const Stretch& stretch : solids_[j].Along(axis, box.center())) {
        const double enter = stretch.from - line.head[axis], leave = stretch.to - line.head[axis];
        if (std::min(leave, line.length) - std::max(enter, 0.0) <= kFit) continue;
        // Of rods that join rods the thinner goes into the thicker, which does not drill it.
        const bool crosses = enter > kFit && leave < line.length - kFit;
        if ((crosses ? part.size.y() : PinDiameter(line)) > section - kFit) continue;
        line.passages.push_back({&design_.parts[j], enter, leave});
      }
    }
    std::stable_sort(line.passages.begin(), line.passages.end(),
                     [](const Passage& a, const Passage& b) { return a.enter < b.enter; });
    for (const Passage& passage : line.passages) {
      line.head_inside = line.head_inside || Contains(passage, 0);
      line.tip_inside = line.tip_inside || Contains(passage, line.length);
    }
    if (line.passages.empty()) return line;
    if (HeadIsAtTip(line)) Reverse(&line);
    return line;
  }

  // Whether the connector has to be turned round: its head is at the end that is sunk less. Where
  // both are sunk alike, as of a screw that is flush at both, it is in the thinner of the parts at
  // the ends, which the other is pulled against.
  static bool HeadIsAtTip(const Line& line) {
    const Passage& first = line.passages.front();
    const Passage& last = line.passages.back();
    const double sunk_at_head = -first.enter, sunk_at_tip = last.leave - line.length;
    if (std::abs(sunk_at_head - sunk_at_tip) <= kFit) {
      return last.leave - last.enter < first.leave - first.enter - kFit;
    }
    return line.head_inside && (!line.tip_inside || sunk_at_tip < sunk_at_head);
  }

  // A hole along the line from where it enters the part.
  static void AddHole(const Line& line, const Passage& passage, double depth, double diameter,
                      HoleKind kind, std::vector<Hole>* holes) {
    const double available = passage.leave - passage.enter;
    const bool through = depth >= available - 1e-9;
    holes->push_back({passage.part->name, line.head + passage.enter * line.direction,
                      line.direction, diameter, through ? available : depth, kind, through,
                      line.connector->name});
  }

  // For a head that lies below the surface.
  static void AddCounterbore(const Line& line, std::vector<Hole>* holes) {
    if (!line.head_inside) return;
    const Passage& first = line.passages.front();
    const double thread = line.connector->size.y();
    AddHole(line, first, -first.enter, MeasureOr(*line.item, "head_diameter", 2 * thread),
            HoleKind::kClearance, holes);
  }

  // How deep a blind hole is that ends at the tip, and a little beyond where there is room.
  static double BlindDepth(const Line& line, const Passage& passage, double beyond) {
    const double reach = line.length - passage.enter;
    return std::max(reach,
                    std::min(reach + beyond, passage.leave - passage.enter - kLeftAtFarSide));
  }

  static void AddScrewHoles(const Line& line, std::vector<Hole>* holes) {
    if (line.passages.empty()) return;
    const double thread = line.connector->size.y();
    const double pilot = MeasureOr(*line.item, "pilot_diameter", ToHalfMillimetre(0.7 * thread));
    const double clearance =
        MeasureOr(*line.item, "clearance_diameter", ToHalfMillimetre(thread + 5e-4));
    AddCounterbore(line, holes);
    for (std::size_t i = 0; i < line.passages.size(); ++i) {
      const Passage& passage = line.passages[i];
      if (i + 1 < line.passages.size()) {
        AddHole(line, passage, passage.leave - passage.enter, clearance, HoleKind::kClearance,
                holes);
      } else {
        AddHole(line, passage, BlindDepth(line, passage, 0), pilot, HoleKind::kPilot, holes);
      }
    }
  }

  void AddBoltHoles(const Line& line, std::vector<Hole>* holes) const {
    if (line.passages.empty()) return;
    const double thread = line.connector->size.y();
    const double clearance = MeasureOr(*line.item, "clearance_diameter", ClearanceOf(thread));
    const double pitch = MeasureOr(*line.item, "thread_pitch", 0.15 * thread);
    AddCounterbore(line, holes);
    for (const Passage& passage : line.passages) {
      if (!Contains(passage, line.length)) {
        AddHole(line, passage, passage.leave - passage.enter, clearance, HoleKind::kClearance,
                holes);
      } else if (IsInNut(line)) {
        AddHole(line, passage, BlindDepth(line, passage, kHoleClearance), clearance,
                HoleKind::kClearance, holes);
      } else {
        AddHole(line, passage, BlindDepth(line, passage, kHoleClearance), thread - pitch,
                HoleKind::kTapped, holes);
      }
    }
  }

  static void AddPinHoles(const Line& line, std::vector<Hole>* holes) {
    const double diameter = PinDiameter(line);
    for (const Passage& passage : line.passages) {
      const bool starts = Contains(passage, 0), ends = Contains(passage, line.length);
      if (starts && ends) continue;  // it lies in a pocket that no drill makes
      if (!starts) {
        const double depth =
            ends ? BlindDepth(line, passage, kHoleClearance) : passage.leave - passage.enter;
        AddHole(line, passage, depth, diameter, HoleKind::kPeg, holes);
        continue;
      }
      Line backwards = line;
      backwards.passages = {passage};
      Reverse(&backwards);
      const Passage& seen = backwards.passages.front();
      AddHole(backwards, seen, BlindDepth(backwards, seen, kHoleClearance), diameter,
              HoleKind::kPeg, holes);
    }
  }

  // Whether something with a thread of its own, such as an insert nut, is around the bolt's tip.
  bool IsInNut(const Line& line) const {
    const Eigen::Vector3d tip = line.head + (line.length - kFit) * line.direction;
    for (std::size_t i = 0; i < design_.parts.size(); ++i) {
      const Part& part = design_.parts[i];
      if (&part == line.connector || !part.connecting) continue;
      const Item* item = ItemOf(part, items_);
      if (item == nullptr || item->kind == ItemKind::kScrew || item->kind == ItemKind::kBolt) {
        continue;
      }
      if (solids_[i].box().contains(tip)) return true;
    }
    return false;
  }

  // Whether a screw, bolt or pin that is a part holds it.
  bool IsFastened(std::size_t index) const {
    for (std::size_t i = 0; i < design_.parts.size(); ++i) {
      const Item* item = ItemOf(design_.parts[i], items_);
      if (i == index || !design_.parts[i].connecting || item == nullptr) continue;
      if (IsRoundPin(*item) && solids_[i].Touches(solids_[index])) return true;
    }
    return false;
  }

  const Design& design_;
  const Items& items_;
  std::vector<PartSolid> solids_;
};

}  // namespace

double ClearanceOf(double thread_diameter) {
  for (const auto& [thread, hole] : kIso273) {
    if (std::abs(thread_diameter - thread * 1e-3) < 1e-5) return hole * 1e-3;
  }
  return 1.1 * thread_diameter;
}

void AddFastenerHoles(const Design& design, const Items& items, FabricationPlan* plan) {
  const bool has_connectors = std::any_of(design.parts.begin(), design.parts.end(),
                                          [](const Part& part) { return part.connecting; });
  if (!has_connectors) return;
  const HoleMaker maker(design, items);
  maker.AddHoles(&plan->holes);
  maker.AddMarks(&plan->marks);
}

}  // namespace mortise::fabplanner
