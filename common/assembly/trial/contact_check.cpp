#include "common/assembly/trial/contact_check.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/model/linear_design.h"
#include "common/base/errors.h"

namespace mortise::parametric {
namespace {

constexpr double kFurthest =
    0.01;  // m; gaps between solids in each other's boxes are not measured beyond
constexpr double kSame = 1e-3;  // of the tolerance: two parts stand as they are drawn
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Whether one scaling takes two boxes from where they are drawn to where they are, but for
// `tolerance`, m.
bool AreScaled(const OrientedBox& a, const OrientedBox& b, const OrientedBox& drawn_a,
               const OrientedBox& drawn_b, double tolerance) {
  const auto lengths = [](const OrientedBox& one, const OrientedBox& other) {
    Eigen::Matrix<double, 9, 1> all;
    all << one.half_size, other.half_size, one.center - other.center;
    return all;
  };
  const Eigen::Matrix<double, 9, 1> drawn = lengths(drawn_a, drawn_b);
  const Eigen::Matrix<double, 9, 1> now = lengths(a, b);
  Eigen::Index largest = 0;
  drawn.head<6>().maxCoeff(&largest);
  const double factor = now[largest] / drawn[largest];
  return (now - factor * drawn).cwiseAbs().maxCoeff() <= tolerance;
}

// As AreScaled, of boxes at right angles, by a factor of its own along each axis.
bool AreStretched(const OrientedBox& a, const OrientedBox& b, const OrientedBox& drawn_a,
                  const OrientedBox& drawn_b, double tolerance) {
  const auto sizes = [](const OrientedBox& box) -> Eigen::Array3d {
    return box.axes.cwiseAbs() * box.half_size;
  };
  const Eigen::Array3d factors = sizes(a) / sizes(drawn_a);
  const Eigen::Array3d apart = (a.center - b.center).array();
  const Eigen::Array3d drawn_apart = (drawn_a.center - drawn_b.center).array();
  return (sizes(b) - factors * sizes(drawn_b)).abs().maxCoeff() <= tolerance &&
         (apart - factors * drawn_apart).abs().maxCoeff() <= tolerance;
}

}  // namespace

std::string Describe(const ContactFault& fault) {
  const std::string pose = fault.pose.empty() ? "" : absl::StrCat(" in '", fault.pose, "'");
  switch (fault.kind) {
    case ContactFault::Kind::kLostContact:
      return absl::StrCat("'", fault.first, "' has lost '", fault.second, "' by ", fault.amount,
                          " m", pose);
    case ContactFault::Kind::kPenetration:
      return absl::StrCat("'", fault.first, "' reaches ", fault.amount, " m into '", fault.second,
                          "'", pose);
    case ContactFault::Kind::kChangedSize:
      return absl::StrCat("a size of '", fault.first, "' is ", fault.amount,
                          " m beyond what its item allows");
  }
  return "";
}

ContactCheck::ContactCheck(Assembly assembly, std::vector<Element> elements, double tolerance,
                           const std::function<bool(int, int)>& is_asked)
    : assembly_(std::move(assembly)),
      elements_(std::move(elements)),
      tolerance_(tolerance),
      is_asked_(is_asked),
      poses_(PosesOf(assembly_)),
      drawn_(DrawnParameters(assembly_, elements_)) {
  const std::vector<PlacedPart> placed = PlaceParts(assembly_, elements_, drawn_);
  const Parts drawn = PartsIn(poses_.front(), drawn_, placed);
  for (std::size_t a = 0; a < elements_.size(); ++a) {
    for (std::size_t b = a + 1; b < elements_.size(); ++b) {
      if (IsAsked(a, b)) AddRegions(a, b, drawn);
    }
  }
  for (std::size_t pose = 0; pose < poses_.size(); ++pose) AddMeetings(pose, placed);
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    std::array<Neighbours, 2> met;
    const std::array<double, 2> gaps = NeighbourGaps(e, drawn_);
    for (std::size_t i = 0; i < 2; ++i) {
      met[i] = {.touched = gaps[i] <= tolerance_, .intersected = gaps[i] < -tolerance_};
    }
    neighbours_.push_back(met);
  }
}

void ContactCheck::AddMeetings(std::size_t pose, const std::vector<PlacedPart>& drawn) {
  std::vector<bool>& moved = moved_.emplace_back();
  std::vector<OrientedBox>& boxes = boxes_.emplace_back();
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    moved.push_back(MovesIn(poses_[pose], assembly_, elements_[e]));
    boxes.push_back(BoxIn(poses_[pose], assembly_, elements_, static_cast<int>(e), drawn_));
  }
  const Parts parts = PartsIn(poses_[pose], drawn_, drawn);
  // Boxes at right angles that are further apart than this do not touch; of others that is not said
  // by what is around them.
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(2 * tolerance_);
  std::vector<Eigen::AlignedBox3d> around;
  for (const std::vector<Part>& of_element : parts) {
    Eigen::AlignedBox3d box = BoxAround(of_element);
    const bool at_right_angles =
        std::all_of(of_element.begin(), of_element.end(),
                    [](const Part& part) { return IsAtRightAngles(part.box.axes); });
    const Eigen::Vector3d more =
        at_right_angles ? reach : Eigen::Vector3d(Eigen::Vector3d::Constant(kInfinity));
    around.emplace_back(box.min() - more, box.max() + more);
  }
  std::vector<Meeting> meetings(elements_.size() * elements_.size());
  Pairs& touching = touching_.emplace_back();
  for (const auto& [a, b] : PairsThatMeet(pose, around)) {
    Meeting& meeting = meetings[PairIndex(a, b)];
    meeting = MeetingOf(parts[a], parts[b]);
    if (meeting.any) touching.emplace_back(a, b);
  }
  meetings_.push_back(std::move(meetings));
}

absl::Status ContactCheck::CheckParameters(const Eigen::VectorXd& q) const {
  const std::size_t expected = 6 * elements_.size() + 3 * assembly_.joints.size();
  if (q.size() != static_cast<Eigen::Index>(expected) || !q.allFinite()) {
    return InvalidField("q", absl::StrCat("must be ", expected, " finite numbers"));
  }
  if (q.size() > 0 && q.cwiseAbs().maxCoeff() > kMaxFromOrigin) {
    return InvalidField("q", absl::StrCat("must be within ", kMaxFromOrigin, " m"));
  }
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const Eigen::Vector3d size = q.segment<3>(SizeVariable(static_cast<int>(e), Axis::kX));
    if (size.minCoeff() <= 0) {
      return InvalidField("q", absl::StrCat("'", elements_[e].name, "' must have positive sizes"));
    }
  }
  return CheckPartCount(assembly_, elements_, q);
}

absl::StatusOr<std::vector<ContactFault>> ContactCheck::FaultsAt(const Eigen::VectorXd& q,
                                                                 double penetration) const {
  MORTISE_RETURN_IF_ERROR(CheckParameters(q));
  std::vector<ContactFault> faults;
  const std::vector<PlacedPart> placed = PlaceParts(assembly_, elements_, q);
  for (std::size_t p = 0; p < poses_.size(); ++p) {
    const Parts parts = PartsIn(poses_[p], q, placed);
    if (p == 0) {
      CheckSizes(parts, faults);
      CheckNeighbours(parts, q, penetration, faults);
    }
    std::vector<Eigen::AlignedBox3d> around;
    for (const std::vector<Part>& of_element : parts) around.push_back(BoxAround(of_element));
    const Pairs met = PairsThatMeet(p, around);
    Pairs pairs;
    std::set_union(met.begin(), met.end(), touching_[p].begin(), touching_[p].end(),
                   std::back_inserter(pairs));
    for (const auto& [a, b] : pairs) {
      if (StandAsDrawn(p, a, b, parts)) continue;
      const Meeting& meeting = meetings_[p][PairIndex(a, b)];
      ContactFault fault;
      fault.pose = poses_[p].name;
      fault.first_element = static_cast<int>(a);
      fault.second_element = static_cast<int>(b);
      CheckPair(meeting, parts[a], parts[b], fault, penetration, faults);
    }
  }
  return faults;
}

void ContactCheck::AddRegions(std::size_t a, std::size_t b, const Parts& drawn) {
  const Element& one = elements_[a];
  const Element& other = elements_[b];
  if (one.shape == nullptr && other.shape == nullptr) return;
  const auto apart = [](const BoundingBox& box_a, const BoundingBox& box_b) {
    return (box_a.minimum.cwiseMax(box_b.minimum) - box_a.maximum.cwiseMin(box_b.maximum))
        .maxCoeff();
  };
  if (apart(one.box, other.box) > tolerance_) return;
  Regions regions{drawn[a].size(), drawn[b].size(), {}};
  for (std::size_t i = 0; i < drawn[a].size(); ++i) {
    for (std::size_t j = 0; j < drawn[b].size(); ++j) {
      const BoundingBox box_a = BoxAround(drawn[a][i]), box_b = BoxAround(drawn[b][j]);
      if (apart(box_a, box_b) > tolerance_) continue;
      regions.of.try_emplace({i, j}, box_a, one.shape.get(), box_b, other.shape.get(), tolerance_);
    }
  }
  if (!regions.of.empty()) regions_.emplace(std::pair(a, b), std::move(regions));
}

bool ContactCheck::StandAsDrawn(const Regions& regions, const Meeting& meeting,
                                const std::vector<Part>& a, const std::vector<Part>& b) const {
  const auto stand = [&](const Part& one, const Part& other, const MeetingRegion& region) {
    return region.StandsAsDrawn({BoxAround(one), one.placed->stretch},
                                {BoxAround(other), other.placed->stretch}, kSame * tolerance_);
  };
  const bool are_as_many = a.size() == regions.count_a && b.size() == regions.count_b;
  // More or fewer parts of a pattern, all of which touch the one other: alike, each may stand to it
  // as any of them was drawn.
  const bool are_alike = meeting.all_of_first && meeting.all_of_second &&
                         std::min(a.size(), b.size()) == 1 &&
                         std::min(regions.count_a, regions.count_b) == 1 &&
                         regions.of.size() == std::max(regions.count_a, regions.count_b);
  if (!are_as_many && !are_alike) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) {
      const auto own = regions.of.find({i, j});
      const bool is_as_drawn =
          !are_as_many              ? std::any_of(regions.of.begin(), regions.of.end(),
                                                  [&](const auto& any) { return stand(a[i], b[j], any.second); })
          : own != regions.of.end() ? stand(a[i], b[j], own->second)
                                    : Separation(a[i].box, b[j].box) > tolerance_;
      if (!is_as_drawn) return false;
    }
  }
  return true;
}

bool ContactCheck::StandAsDrawn(std::size_t pose, std::size_t a, std::size_t b,
                                const Parts& parts) const {
  const auto regions = regions_.find({a, b});
  if (poses_[pose].joint < 0 && regions != regions_.end() &&
      StandAsDrawn(regions->second, meetings_[pose][PairIndex(a, b)], parts[a], parts[b])) {
    return true;
  }
  if (elements_[a].pattern || elements_[b].pattern) return false;
  const Part& part_a = parts[a].front();
  const Part& part_b = parts[b].front();
  for (const Part* part : {&part_a, &part_b}) {
    if (!part->placed->stretch.IsInProportion()) return false;
  }
  const OrientedBox& box_a = part_a.box;
  const OrientedBox& box_b = part_b.box;
  const OrientedBox& drawn_a = boxes_[pose][a];
  const OrientedBox& drawn_b = boxes_[pose][b];
  const bool at_right_angles = IsAtRightAngles(box_a.axes) && IsAtRightAngles(box_b.axes);
  return (at_right_angles ? AreStretched : AreScaled)(box_a, box_b, drawn_a, drawn_b,
                                                      kSame * tolerance_);
}

// Of a part that no pose has turned.
BoundingBox ContactCheck::BoxAround(const Part& part) {
  return {part.box.center - part.box.half_size, part.box.center + part.box.half_size};
}

Eigen::AlignedBox3d ContactCheck::BoxAround(const std::vector<Part>& parts) {
  Eigen::AlignedBox3d around;
  for (const Part& part : parts) {
    const Eigen::Vector3d reach = part.box.axes.cwiseAbs() * part.box.half_size;
    around.extend(part.box.center - reach);
    around.extend(part.box.center + reach);
  }
  return around;
}

ContactCheck::Pairs ContactCheck::PairsThatMeet(
    std::size_t pose, const std::vector<Eigen::AlignedBox3d>& boxes) const {
  // In order of where they begin along x; each meets only those that begin before it ends.
  std::vector<std::size_t> order(boxes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return boxes[a].min().x() < boxes[b].min().x(); });
  const bool is_drawn = poses_[pose].joint < 0;
  Pairs pairs;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::size_t a = order[i];
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const std::size_t b = order[j];
      if (boxes[b].min().x() > boxes[a].max().x()) break;
      if (!is_drawn && moved_[pose][a] == moved_[pose][b]) continue;
      if (!boxes[a].intersects(boxes[b])) continue;
      const std::pair<std::size_t, std::size_t> pair = std::minmax(a, b);
      if (!is_drawn || IsAsked(pair.first, pair.second)) pairs.push_back(pair);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

ContactCheck::Parts ContactCheck::PartsIn(const Pose& pose, const Eigen::VectorXd& q,
                                          const std::vector<PlacedPart>& placed) const {
  const Eigen::Isometry3d motion = MotionIn(pose, assembly_, elements_.size(), q);
  Parts parts(elements_.size());
  for (const PlacedPart& part : placed) {
    const auto element = static_cast<std::size_t>(part.element);
    OrientedBox box;
    box.center = part.box.center();
    box.half_size = part.box.size() / 2;
    if (MovesIn(pose, assembly_, elements_[element])) {
      box.center = motion * box.center;
      // What counts as its box does not turn where it is round.
      box.axes = elements_[element].shape == nullptr ? AxesIn(pose, assembly_, elements_[element])
                                                     : Eigen::Matrix3d(motion.linear());
    }
    parts[element].push_back({&part, box, elements_[element].shape.get(), std::nullopt});
  }
  return parts;
}

const mesh::ProbedSurface& ContactCheck::Probed(const Part& part) {
  if (!part.probed) {
    const Eigen::Vector3d half = part.box.half_size;
    mesh::SurfaceMesh surface = part.shape == nullptr
                                    ? SurfaceOf(BoundingBox{-half, half})
                                    : mesh::SurfaceIn(*part.shape, part.placed->stretch);
    surface.vertices = (part.box.axes * surface.vertices).colwise() + part.box.center;
    part.probed.emplace(surface);
  }
  return *part.probed;
}

double ContactCheck::SeparationOf(const Part& a, const Part& b, const Question& question) const {
  const double boxes = Separation(a.box, b.box);
  if (boxes > tolerance_ || (a.shape == nullptr && b.shape == nullptr)) return boxes;
  double missed = 0;  // by the triangles of curved faces
  for (const Part* part : {&a, &b}) {
    if (part->shape != nullptr) missed += mesh::DeflectionIn(*part->shape, part->placed->stretch);
  }
  // What only touches the other's box reaches nowhere into it.
  const bool may_be_deep = question.shallowest < kInfinity && boxes < -tolerance_;
  const double limit = missed + question.furthest;
  const double apart = may_be_deep ? mesh::ProbedSurface::Separation(Probed(a), Probed(b), limit,
                                                                     missed + question.shallowest)
                                   : mesh::ProbedSurface::Distance(Probed(a), Probed(b), limit);
  if (apart > 0) return std::min(std::max(apart - missed, 0.0), kFurthest);
  return std::min(apart + missed, 0.0);
}

double ContactCheck::GapOf(const Part& part, const std::vector<Part>& others) const {
  double gap = kInfinity;
  for (const Part& other : others) {
    gap = std::min(gap, SeparationOf(part, other, {kFurthest, kInfinity}));
  }
  return gap;
}

ContactCheck::Meeting ContactCheck::MeetingOf(const std::vector<Part>& a,
                                              const std::vector<Part>& b) const {
  std::vector<bool> second_touches(b.size(), false);
  Meeting meeting;
  meeting.all_of_first = true;
  for (const Part& part : a) {
    bool touches = false;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const double separation = SeparationOf(part, b[j], {tolerance_, tolerance_});
      if (separation > tolerance_) continue;
      meeting.is_clear &= separation >= -tolerance_;
      touches = true;
      second_touches[j] = true;
    }
    meeting.any |= touches;
    meeting.all_of_first &= touches;
  }
  meeting.all_of_second = std::all_of(second_touches.begin(), second_touches.end(),
                                      [](bool touches) { return touches; });
  return meeting;
}

void ContactCheck::CheckPair(const Meeting& meeting, const std::vector<Part>& a,
                             const std::vector<Part>& b, ContactFault fault, double penetration,
                             std::vector<ContactFault>& faults) const {
  // Told once, of the parts of a pattern rather than of what they all touch.
  const bool each_of_second = meeting.all_of_second && b.size() > 1;
  const bool each_of_first = meeting.all_of_first && (a.size() > 1 || !each_of_second);
  const auto lose = [&](ContactFault lost, const Part& part, const Part& other, double by) {
    lost.kind = ContactFault::Kind::kLostContact;
    lost.first = part.placed->name;
    lost.second = other.placed->name;
    lost.amount = by;
    faults.push_back(std::move(lost));
  };
  ContactFault turned = fault;
  std::swap(turned.first_element, turned.second_element);
  // What is within the other as drawn may be, however deep. How wide a gap is, is measured only
  // where one is told of.
  const Question question{tolerance_, meeting.is_clear ? penetration : kInfinity};
  std::vector<bool> second_touches(b.size(), false);
  bool any_touches = false;
  for (const Part& part : a) {
    bool touches = false;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const double separation = SeparationOf(part, b[j], question);
      if (separation <= tolerance_) {
        touches = true;
        second_touches[j] = true;
      }
      if (meeting.is_clear && -separation > penetration) {
        fault.kind = ContactFault::Kind::kPenetration;
        fault.first = part.placed->name;
        fault.second = b[j].placed->name;
        fault.amount = -separation;
        faults.push_back(fault);
      }
    }
    any_touches |= touches;
    if (each_of_first && !touches) lose(fault, part, b.front(), GapOf(part, b));
  }
  for (std::size_t j = 0; j < b.size(); ++j) {
    if (each_of_second && !second_touches[j]) lose(turned, b[j], a.front(), GapOf(b[j], a));
  }
  const bool told = each_of_first || each_of_second;
  if (!meeting.any || told || any_touches) return;
  double gap = kInfinity;
  for (const Part& part : a) gap = std::min(gap, GapOf(part, b));
  lose(fault, a.front(), b.front(), gap);
}

void ContactCheck::CheckSizes(const Parts& parts, std::vector<ContactFault>& faults) const {
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const auto first = static_cast<std::size_t>(elements_[e].parts.front());
    const AssemblyPart& drawn = assembly_.parts[first];
    for (const Part& part : parts[e]) {
      double differs = 0;
      for (int axis = 0; axis < 3; ++axis) {
        // As drawn, which may differ from the item by the tolerance of the drawing.
        const SizeLimits& limits = drawn.limits[static_cast<std::size_t>(axis)];
        const double drawn_size = drawn.box.size()[axis];
        const bool is_fixed = limits.minimum == limits.maximum;
        const double least = is_fixed ? drawn_size : std::min(limits.minimum, drawn_size);
        const double most = is_fixed ? drawn_size : std::max(limits.maximum, drawn_size);
        const double size = 2 * part.box.half_size[axis];
        differs = std::max({differs, least - size, size - most});
      }
      if (differs <= tolerance_) continue;
      ContactFault fault;
      fault.kind = ContactFault::Kind::kChangedSize;
      fault.first = part.placed->name;
      fault.first_element = static_cast<int>(e);
      fault.amount = differs;
      faults.push_back(fault);
    }
  }
}

std::array<double, 2> ContactCheck::NeighbourGaps(std::size_t element,
                                                  const Eigen::VectorXd& q) const {
  std::array<double, 2> gaps = {kInfinity, kInfinity};
  const Element& subject = elements_[element];
  if (!subject.pattern) return gaps;
  const PatternLayout layout = LayOut(*subject.pattern, BoxOf(q, static_cast<int>(element)));
  for (std::size_t i = 0; i < 2; ++i) {
    if (layout.directions[i].count < 2) continue;
    const Eigen::Vector3d apart = layout.directions[i].spacing.cwiseAbs() - layout.part_size;
    gaps[i] = apart.maxCoeff();
  }
  return gaps;
}

void ContactCheck::CheckNeighbours(const Parts& parts, const Eigen::VectorXd& q, double penetration,
                                   std::vector<ContactFault>& faults) const {
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const std::array<double, 2> gaps = NeighbourGaps(e, q);
    for (std::size_t i = 0; i < 2; ++i) {
      if (gaps[i] == kInfinity) continue;
      const Neighbours& met = neighbours_[e][i];
      ContactFault fault;
      fault.first = parts[e].front().placed->name;
      fault.second = parts[e].back().placed->name;
      fault.first_element = fault.second_element = static_cast<int>(e);
      if (met.touched && gaps[i] > tolerance_) {
        fault.kind = ContactFault::Kind::kLostContact;
        fault.amount = gaps[i];
        faults.push_back(fault);
      } else if (!met.intersected && -gaps[i] > penetration) {
        fault.kind = ContactFault::Kind::kPenetration;
        fault.amount = -gaps[i];
        faults.push_back(fault);
      }
    }
  }
}

}  // namespace mortise::parametric
