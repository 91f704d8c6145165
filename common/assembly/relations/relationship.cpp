#include "common/assembly/relations/relationship.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <set>

#include "absl/strings/str_cat.h"
#include "common/assembly/model/oriented_box.h"
#include "common/assembly/model/rest_pose.h"
#include "common/assembly/relations/attachments.h"
#include "common/assembly/relations/fit_relationships.h"
#include "common/assembly/relations/pose_contacts.h"

namespace mortise::parametric {
namespace {

class RelationshipSearch {
 public:
  RelationshipSearch(const Assembly& assembly, const std::vector<Element>& elements,
                     double tolerance)
      : assembly_(assembly),
        elements_(elements),
        tolerance_(tolerance),
        drawn_(DrawnParameters(assembly, elements)) {}

  std::vector<Relationship> Find(const Contacts& contacts, const KnownConflicts& known_conflicts) {
    FindSizes();
    FindSymmetries();
    for (const Pose& pose : PosesOf(assembly_)) {
      NoteMoved(pose);
      const std::vector<PosedPosition> positions = PositionsIn(pose, assembly_, elements_);
      if (pose.joint < 0) {
        Append(TieJoints(assembly_, elements_, positions, tolerance_));
        Append(TiePatterns(assembly_, elements_, contacts, tolerance_));
        Append(TieFasteners(assembly_, elements_, contacts, tolerance_));
      }
      for (const Axis axis : kAxes) {
        FindLevel(pose, positions, axis);
        FindOrder(pose, positions, axis);
      }
      const std::set<std::pair<int, int>> neighbours = NeighboursIn(pose, contacts, positions);
      KeepOrderOfPlanes(pose, neighbours, positions);
      Append(FindFits(pose, assembly_, elements_, neighbours, tolerance_));
      Keep(pose, known_conflicts.kept_apart, Meeting::kApart);
      Keep(pose, known_conflicts.kept_touching, Meeting::kTouching);
      Append(StretchTogether(pose, assembly_, elements_, known_conflicts.fitted));
    }
    return std::move(found_);
  }

 private:
  using PositionPointer = const PosedPosition*;

  const Element& At(int element) const { return elements_[static_cast<std::size_t>(element)]; }
  int GroupOf(int element) const { return At(element).group; }
  int CommonGroup(int a, int b) const {
    return LowestCommonGroup(assembly_, GroupOf(a), GroupOf(b));
  }
  // What the pose that is looked at moves.
  void NoteMoved(const Pose& pose) {
    moved_.assign(elements_.size(), false);
    for (std::size_t e = 0; e < elements_.size(); ++e) {
      moved_[e] = MovesIn(pose, assembly_, elements_[e]);
    }
  }
  bool IsMoved(int element) const { return moved_[static_cast<std::size_t>(element)]; }
  // Among themselves, what moves together and what stays are related in the drawn pose already.
  bool IsOfInterest(const Pose& pose, int a, int b) const {
    return pose.joint < 0 || IsMoved(a) != IsMoved(b);
  }
  // Whether a plane or centre of two elements that a pose moves together says something of its own:
  // turned obliquely, what is level in the pose is not as drawn.
  bool IsTurned(const Pose& pose, int a, int b) const {
    if (pose.joint < 0 || !IsMoved(a) || !IsMoved(b)) return false;
    return !IsAtRightAngles(MotionIn(pose, assembly_, elements_.size(), drawn_).linear());
  }

  // Of what relates two positions in a pose.
  void Relate(const Pose& pose, RelationshipKind kind, bool equality, const PosedPosition& a,
              const PosedPosition& b, std::string description) {
    LinearForm form = a.position - b.position;
    const int group = GroupIn(pose, assembly_, elements_, At(a.element), At(b.element), form);
    Add(kind, equality, std::move(form), group, std::move(description));
  }

  void Add(RelationshipKind kind, bool equality, LinearForm form, int group,
           std::string description) {
    if (form.terms.empty()) return;  // true whatever q is
    // The drawing may miss a relationship by less than the tolerance; what was drawn stays valid.
    if (equality) form.constant -= form.At(drawn_);
    found_.push_back({kind, equality, std::move(form), group, std::move(description)});
  }

  void Append(std::vector<Relationship> others) {
    std::move(others.begin(), others.end(), std::back_inserter(found_));
  }

  // ---- Sizes
  // -------------------------------------------------------------------------------------

  void FindSizes() {
    for (std::size_t e = 0; e < elements_.size(); ++e) {
      for (const Axis axis : kAxes) AddLimits(static_cast<int>(e), axis);
    }
  }

  void AddLimits(int element, Axis axis) {
    const SizeLimits& limits = At(element).limits[static_cast<std::size_t>(axis)];
    const LinearForm size = LinearForm::Variable(SizeVariable(element, axis));
    const std::string label = absl::StrCat("'", At(element).name, "' ", AxisName(axis), " size");
    const auto bound = [&](double scale, double limit, bool equality, const char* what) {
      LinearForm form = scale * size;
      form.constant = -scale * limit;
      Add(RelationshipKind::kSize, equality, std::move(form), GroupOf(element),
          absl::StrCat(label, what, limit, " m"));
    };
    if (limits.minimum == limits.maximum) {
      // As drawn, which may differ from the item by the tolerance of the drawing.
      bound(1, At(element).box.size()[static_cast<int>(axis)], true, " fixed at ");
      return;
    }
    bound(-1, limits.minimum, false, " at least ");
    bound(1, limits.maximum, false, " at most ");
  }

  // ---- Symmetry
  // ----------------------------------------------------------------------------------

  bool AreAlike(const Element& a, const Element& b) const {
    if (a.item != b.item || a.connecting != b.connecting || a.parts.size() != b.parts.size()) {
      return false;
    }
    return (a.box.size() - b.box.size()).cwiseAbs().maxCoeff() <= tolerance_;
  }

  void FindSymmetries() {
    const int count = static_cast<int>(elements_.size());
    for (int a = 0; a < count; ++a) {
      for (int b = a + 1; b < count; ++b) {
        if (AreAlike(At(a), At(b))) FindMirror(a, b);
      }
    }
  }

  // Two elements that differ in place along one axis only, about a third.
  void FindMirror(int a, int b) {
    const Eigen::Vector3d apart = At(b).box.center() - At(a).box.center();
    int differing = -1;
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(apart[axis]) <= tolerance_) continue;
      if (differing >= 0) return;
      differing = axis;
    }
    if (differing < 0) return;
    const Axis axis = static_cast<Axis>(differing);
    const int middle = MiddleElement(a, b, differing);
    if (middle < 0) return;
    const std::string label = absl::StrCat("'", At(a).name, "' and '", At(b).name, "'");
    const int group = LowestCommonGroup(assembly_, CommonGroup(a, b), GroupOf(middle));
    Add(RelationshipKind::kSymmetric, true,
        LinearForm::Variable(CenterVariable(a, axis)) +
            LinearForm::Variable(CenterVariable(b, axis)) -
            LinearForm::Variable(CenterVariable(middle, axis), 2),
        group,
        absl::StrCat(label, " mirrored along ", AxisName(axis), " about '", At(middle).name, "'"));
    for (const Axis size : kAxes) {
      Add(RelationshipKind::kSymmetric, true,
          LinearForm::Variable(SizeVariable(a, size)) - LinearForm::Variable(SizeVariable(b, size)),
          group, absl::StrCat(label, " equal in ", AxisName(size), " size"));
    }
  }

  // The element centred between two, from the lowest group that has one; -1 if there is none.
  int MiddleElement(int a, int b, int axis) const {
    const double middle = (At(a).box.center()[axis] + At(b).box.center()[axis]) / 2;
    const int common = CommonGroup(a, b);
    int best = -1;
    int best_depth = -1;
    for (std::size_t e = 0; e < elements_.size(); ++e) {
      if (static_cast<int>(e) == a || static_cast<int>(e) == b) continue;
      if (std::abs(elements_[e].box.center()[axis] - middle) > tolerance_) continue;
      const int depth =
          GroupDepth(assembly_, LowestCommonGroup(assembly_, common, elements_[e].group));
      if (depth <= best_depth) continue;
      best = static_cast<int>(e);
      best_depth = depth;
    }
    return best;
  }

  // ---- Planes and centres in one place
  // -----------------------------------------------------------

  // Splits positions along an axis into those within the tolerance of each other.
  std::vector<std::vector<PositionPointer>> Clusters(const std::vector<PosedPosition>& positions,
                                                     Axis axis, bool centers) const {
    std::vector<PositionPointer> sorted;
    for (const PosedPosition& position : positions) {
      if (position.axis == axis && position.is_center == centers) sorted.push_back(&position);
    }
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](PositionPointer a, PositionPointer b) { return a->drawn < b->drawn; });
    std::vector<std::vector<PositionPointer>> clusters;
    for (const PositionPointer position : sorted) {
      if (clusters.empty() || position->drawn - clusters.back().back()->drawn > tolerance_) {
        clusters.emplace_back();
      }
      clusters.back().push_back(position);
    }
    return clusters;
  }

  void FindLevel(const Pose& pose, const std::vector<PosedPosition>& positions, Axis axis) {
    for (const bool centers : {false, true}) {
      for (std::vector<PositionPointer>& cluster : Clusters(positions, axis, centers)) {
        Chain(pose, std::move(cluster));
      }
    }
  }

  // Ties the members of a cluster together, each pair of branches at the group where they meet:
  // what a subtree holds then ties its own members without the rest of the tree.
  void Chain(const Pose& pose, std::vector<PositionPointer> members) {
    if (members.size() < 2) return;
    // What a pose moves is related among itself only where it meets something that stays.
    if (pose.joint >= 0 && std::all_of(members.begin(), members.end(), [&](PositionPointer member) {
          return IsMoved(member->element);
        })) {
      return;
    }
    // Moved elements first, so that they represent their branch.
    std::stable_sort(members.begin(), members.end(), [&](PositionPointer a, PositionPointer b) {
      return IsMoved(a->element) > IsMoved(b->element);
    });
    std::map<int, std::vector<PositionPointer>> at_group;
    for (const PositionPointer member : members) {
      at_group[GroupOf(member->element)].push_back(member);
    }
    while (!at_group.empty()) {
      const auto deepest =
          std::max_element(at_group.begin(), at_group.end(), [&](const auto& a, const auto& b) {
            return GroupDepth(assembly_, a.first) < GroupDepth(assembly_, b.first);
          });
      const int group = deepest->first;
      const std::vector<PositionPointer> branches = deepest->second;
      at_group.erase(deepest);
      for (std::size_t i = 1; i < branches.size(); ++i) Tie(pose, *branches[0], *branches[i]);
      if (group == 0) return;
      std::vector<PositionPointer>& above =
          at_group[assembly_.groups[static_cast<std::size_t>(group)].parent];
      if (IsMoved(branches[0]->element)) {
        above.insert(above.begin(), branches[0]);
      } else {
        above.push_back(branches[0]);
      }
    }
  }

  void Tie(const Pose& pose, const PosedPosition& a, const PosedPosition& b) {
    if (!IsOfInterest(pose, a.element, b.element) && !IsTurned(pose, a.element, b.element)) return;
    Relate(pose, a.is_center ? RelationshipKind::kConcentric : RelationshipKind::kCoplanar, true, a,
           b, absl::StrCat(a.label, a.is_center ? " level with " : " in one plane with ", b.label));
  }

  // ---- Order
  // -------------------------------------------------------------------------------------

  struct Span {
    PositionPointer minimum = nullptr;
    PositionPointer maximum = nullptr;
  };

  // Of every element; without ends where a pose leaves it no planes along the axis.
  std::vector<Span> AllSpans(const std::vector<PosedPosition>& positions, Axis axis) const {
    std::vector<Span> spans(elements_.size());
    for (const PosedPosition& position : positions) {
      if (position.axis != axis) continue;
      Span& span = spans[static_cast<std::size_t>(position.element)];
      if (position.is_minimum) span.minimum = &position;
      if (position.is_maximum) span.maximum = &position;
    }
    return spans;
  }

  std::vector<Span> SpansOf(const std::vector<PosedPosition>& positions, Axis axis) const {
    std::vector<Span> spans = AllSpans(positions, axis);
    std::erase_if(
        spans, [](const Span& span) { return span.minimum == nullptr || span.maximum == nullptr; });
    return spans;
  }

  bool Precedes(const Span& a, const Span& b) const {
    return a.maximum->drawn < b.minimum->drawn - tolerance_;
  }

  void FindOrder(const Pose& pose, const std::vector<PosedPosition>& positions, Axis axis) {
    const std::vector<Span> spans = SpansOf(positions, axis);
    for (const Span& a : spans) {
      const std::vector<double> ends = FirstEndsBehind(spans, a);
      for (const Span& b : spans) {
        if (!Precedes(a, b) || !IsOfInterest(pose, a.minimum->element, b.minimum->element)) {
          continue;
        }
        // A third element of the same subtree that lies between the two says their order by its own
        // to both.
        const int group = CommonGroup(a.minimum->element, b.minimum->element);
        const bool lies_between =
            ends[static_cast<std::size_t>(group)] < b.minimum->drawn - tolerance_;
        if (!lies_between) Order(pose, *a.maximum, *b.minimum);
      }
    }
  }

  // Of each group, where the first element of its subtree ends that lies wholly behind a span.
  std::vector<double> FirstEndsBehind(const std::vector<Span>& spans, const Span& span) const {
    std::vector<double> ends(assembly_.groups.size(), std::numeric_limits<double>::infinity());
    for (const Span& behind : spans) {
      if (!Precedes(span, behind)) continue;
      for (int group = GroupOf(behind.minimum->element); group >= 0;
           group = assembly_.groups[static_cast<std::size_t>(group)].parent) {
        double& first = ends[static_cast<std::size_t>(group)];
        if (first <= behind.maximum->drawn) break;  // as it is then above, too
        first = behind.maximum->drawn;
      }
    }
    return ends;
  }

  void Order(const Pose& pose, const PosedPosition& before, const PosedPosition& after) {
    Relate(pose, RelationshipKind::kOrder, false, before, after,
           absl::StrCat(before.label, " before ", after.label));
  }

  // Whose planes keep their order: elements that touch, so that they go on touching, and those in
  // each other's boxes that do not, so that they go on not touching. In a pose, what comes so near
  // only there.
  std::set<std::pair<int, int>> NeighboursIn(const Pose& pose, const Contacts& contacts,
                                             const std::vector<PosedPosition>& positions) const {
    std::set<std::pair<int, int>> neighbours;
    if (pose.joint < 0) neighbours.insert(contacts.begin(), contacts.end());
    const double reach = pose.joint < 0 ? -tolerance_ : tolerance_;  // as drawn, touching is told
    std::array<std::vector<Span>, 3> spans;
    for (const Axis axis : kAxes) spans[static_cast<std::size_t>(axis)] = AllSpans(positions, axis);
    for (std::size_t a = 0; a < elements_.size(); ++a) {
      for (std::size_t b = a + 1; b < elements_.size(); ++b) {
        if (!IsOfInterest(pose, static_cast<int>(a), static_cast<int>(b))) continue;
        if (std::all_of(spans.begin(), spans.end(), [&](const std::vector<Span>& along) {
              return Meet(along[a], along[b], reach);
            })) {
          neighbours.emplace(static_cast<int>(a), static_cast<int>(b));
        }
      }
    }
    return neighbours;
  }

  // Whether two spans are apart by no more than `reach`, m; if it is negative, overlap by as much.
  static bool Meet(const Span& a, const Span& b, double reach) {
    return a.minimum != nullptr && b.minimum != nullptr &&
           a.minimum->drawn - b.maximum->drawn <= reach &&
           b.minimum->drawn - a.maximum->drawn <= reach;
  }

  // Of rows of parts that keep their size, as drawn: the inner faces of the first and the last
  // part, which are as far from the ends of the row's box as a part is long. What touches all parts
  // touches these two, and what touches one of them stays with it.
  std::vector<PosedPosition> InnerFacesOfRows(const Pose& pose,
                                              const std::vector<PosedPosition>& positions) const {
    std::vector<PosedPosition> faces;
    if (pose.joint >= 0) return faces;
    for (const PosedPosition& end : positions) {
      const Element& row = At(end.element);
      const int axis = static_cast<int>(end.axis);
      if (!row.pattern || !(end.is_minimum || end.is_maximum)) continue;
      if (!LeadsAlong(*row.pattern, axis)) continue;
      if (row.pattern->resizable[static_cast<std::size_t>(axis)]) continue;
      const double inwards = (end.is_minimum ? 1 : -1) * row.pattern->part_size[axis];
      PosedPosition face = end;
      face.is_minimum = face.is_maximum = false;
      face.position.constant += inwards;
      face.drawn += inwards;
      face.label = absl::StrCat("'", row.name, "' ", AxisName(end.axis),
                                end.is_minimum ? " maximum of the first" : " minimum of the last");
      faces.push_back(std::move(face));
    }
    return faces;
  }

  void KeepOrderOfPlanes(const Pose& pose, const std::set<std::pair<int, int>>& neighbours,
                         const std::vector<PosedPosition>& positions) {
    std::map<std::pair<int, Axis>, std::vector<PositionPointer>> planes;
    for (const PosedPosition& position : positions) {
      if (!position.is_center) planes[{position.element, position.axis}].push_back(&position);
    }
    const std::vector<PosedPosition> inner = InnerFacesOfRows(pose, positions);
    for (const PosedPosition& position : inner) {
      planes[{position.element, position.axis}].push_back(&position);
    }
    for (const auto& [a, b] : neighbours) {
      for (const Axis axis : kAxes) {
        for (const PositionPointer plane_a : planes[{a, axis}]) {
          for (const PositionPointer plane_b : planes[{b, axis}]) {
            if (plane_a->drawn < plane_b->drawn - tolerance_) Order(pose, *plane_a, *plane_b);
            if (plane_b->drawn < plane_a->drawn - tolerance_) Order(pose, *plane_b, *plane_a);
          }
        }
      }
    }
  }

  void Keep(const Pose& pose, const std::set<PosedPair>& pairs, Meeting meeting) {
    for (Relationship& kept : KeepMeeting(pose, assembly_, elements_, pairs, meeting, tolerance_)) {
      found_.push_back(std::move(kept));
    }
  }

  const Assembly& assembly_;
  const std::vector<Element>& elements_;
  const double tolerance_;
  const Eigen::VectorXd drawn_;
  std::vector<bool> moved_;  // of each element, by the pose that is looked at
  std::vector<Relationship> found_;
};

}  // namespace

std::vector<Relationship> FindRelationships(const Assembly& assembly,
                                            const std::vector<Element>& elements,
                                            const Contacts& contacts, double tolerance,
                                            const KnownConflicts& known_conflicts) {
  return RelationshipSearch(assembly, elements, tolerance).Find(contacts, known_conflicts);
}

}  // namespace mortise::parametric
