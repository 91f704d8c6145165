#include "common/assembly/relations/pose_contacts.h"

#include <algorithm>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/model/oriented_box.h"

namespace mortise::parametric {
namespace {

class MeetingSearch {
 public:
  MeetingSearch(const Pose& pose, const Assembly& assembly, const std::vector<Element>& elements,
                double tolerance)
      : pose_(pose),
        assembly_(assembly),
        elements_(elements),
        tolerance_(tolerance),
        drawn_(DrawnParameters(assembly, elements)) {}

  std::vector<Relationship> Find(const std::set<PosedPair>& pairs, Meeting meeting) {
    for (const auto& [a, b] : ElementsOf(pairs)) {
      const SeparatingAxis separating = FindSeparatingAxis(BoxOf(a), BoxOf(b));
      if (separating.distance < -tolerance_) continue;
      KeepSides(a, b, separating.direction, meeting);
      if (meeting == Meeting::kTouching) {
        const bool is_moved = MovesIn(pose_, assembly_, At(a));
        KeepPointWithin(is_moved ? a : b, is_moved ? b : a);
      }
    }
    return std::move(found_);
  }

 private:
  const Element& At(int element) const { return elements_[static_cast<std::size_t>(element)]; }
  OrientedBox BoxOf(int element) const {
    return BoxIn(pose_, assembly_, elements_, element, drawn_);
  }

  std::set<std::pair<int, int>> ElementsOf(const std::set<PosedPair>& pairs) const {
    std::set<std::pair<int, int>> elements;
    const std::vector<int> element_of = ElementsOfParts(assembly_, elements_);
    for (const PosedPair& pair : pairs) {
      if (pair.pose != pose_.name) continue;
      elements.insert(std::minmax(element_of[static_cast<std::size_t>(pair.first)],
                                  element_of[static_cast<std::size_t>(pair.second)]));
    }
    return elements;
  }

  // The drawing may miss the contact by less than the tolerance; what was drawn stays valid.
  void KeepSides(int a, int b, const Eigen::Vector3d& direction, Meeting meeting) {
    const bool touching = meeting == Meeting::kTouching;
    LinearForm overlap = ReachIn(pose_, assembly_, elements_, a, direction) +
                         ReachIn(pose_, assembly_, elements_, b, -direction);
    if (!touching) overlap.constant -= std::max(0.0, overlap.At(drawn_));
    Add(touching ? RelationshipKind::kCoplanar : RelationshipKind::kOrder, touching,
        std::move(overlap), a, b,
        absl::StrCat("'", At(a).name, touching ? "' on '" : "' clear of '", At(b).name, "' in '",
                     pose_.name, "'"));
  }

  // Where one that the pose moves meets one that it does not, as drawn, stays within the other.
  void KeepPointWithin(int moved, int still) {
    const OrientedBox box = BoxOf(moved);
    const Eigen::Vector3d point = CommonPoint(box, BoxOf(still), tolerance_);
    const Eigen::Vector3d fractions =
        (box.axes.transpose() * (point - box.center)).array() / (2 * box.half_size.array());
    const std::string label =
        absl::StrCat("'", At(moved).name, "' within '", At(still).name, "' along ");
    for (const Axis axis : kAxes) {
      const Eigen::Vector3d along = Eigen::Vector3d::Unit(static_cast<int>(axis));
      for (const int side : {-1, 1}) {
        LinearForm beyond = side * PlaceIn(pose_, assembly_, elements_, moved, fractions, along) +
                            -1 * ReachIn(pose_, assembly_, elements_, still, side * along);
        beyond.constant -= std::max(0.0, beyond.At(drawn_));
        Add(RelationshipKind::kOrder, false, std::move(beyond), moved, still,
            absl::StrCat(label, AxisName(axis), " where they meet in '", pose_.name, "'"));
      }
    }
  }

  void Add(RelationshipKind kind, bool equality, LinearForm form, int a, int b,
           std::string description) {
    if (form.terms.empty()) return;  // true whatever q is
    if (equality) form.constant -= form.At(drawn_);
    const int group = GroupIn(pose_, assembly_, elements_, At(a), At(b), form);
    found_.push_back({kind, equality, std::move(form), group, std::move(description)});
  }

  const Pose& pose_;
  const Assembly& assembly_;
  const std::vector<Element>& elements_;
  const double tolerance_;
  const Eigen::VectorXd drawn_;
  std::vector<Relationship> found_;
};

}  // namespace

std::vector<Relationship> KeepMeeting(const Pose& pose, const Assembly& assembly,
                                      const std::vector<Element>& elements,
                                      const std::set<PosedPair>& pairs, Meeting meeting,
                                      double tolerance) {
  return MeetingSearch(pose, assembly, elements, tolerance).Find(pairs, meeting);
}

}  // namespace mortise::parametric
