#include "common/assembly/connections/connection_relationships.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/model/rest_pose.h"

namespace mortise::parametric {
namespace {

constexpr double kDependent = 1e-8;  // length of what is left of a unit row among others
constexpr double kMinWeight = 1e-2;  // of the further edge, however near the nearer one is

class ConnectionRelationships {
 public:
  ConnectionRelationships(const Contacts& contacts, ElementConnection& connection)
      : contacts_(contacts),
        connection_(connection),
        drawn_(DrawnParameters(connection)),
        touching_(contacts.begin(), contacts.end()) {
    for (int element = connection.principal_count(); element < element_count(); ++element) {
      reference_.push_back(ReferenceOf(element));
    }
  }

  void Relate(const std::vector<Relationship>& joint_ties) {
    required_ = joint_ties;
    TakeFromDesign();
    for (const Pose& pose : PosesOf(connection_.assembly)) TieLevel(pose);
    KeepInside();
    KeepIndependent();
    for (int element = connection_.principal_count(); element < element_count(); ++element) {
      for (const Axis axis : kAxes) AddSoft(element, axis);
    }
    for (std::size_t joint = 0; joint < connection_.joints.size(); ++joint) {
      for (const Axis axis : kAxes) AddSoftJoint(static_cast<int>(joint), axis);
    }
  }

 private:
  int element_count() const { return static_cast<int>(connection_.elements.size()); }
  const Element& At(int element) const {
    return connection_.elements[static_cast<std::size_t>(element)];
  }
  const ConnectionPatch& PatchAt(int patch) const {
    return connection_.patches[static_cast<std::size_t>(patch)];
  }
  bool IsPrincipal(int element) const { return element < connection_.principal_count(); }
  int Reference(int element) const {
    return reference_[static_cast<std::size_t>(element - connection_.principal_count())];
  }
  bool Touch(int a, int b) const { return touching_.contains(std::minmax(a, b)); }
  bool PassesThrough(int element, const ConnectionPatch& patch) const {
    return patch.kind == PatchKind::kContact && Touch(element, patch.first) &&
           Touch(element, patch.second);
  }
  bool InvolvesUnknown(const LinearForm& form) const {
    return std::any_of(form.terms.begin(), form.terms.end(), [&](const LinearTerm& term) {
      return term.variable >= connection_.first_unknown() &&
             term.variable < connection_.end_unknown();
    });
  }

  std::string Describe(int patch) const {
    const ConnectionPatch& described = PatchAt(patch);
    const std::string first = absl::StrCat("'", At(described.first).name, "'");
    const std::string second = absl::StrCat("'", At(described.second).name, "'");
    if (described.kind == PatchKind::kWhole) return first;
    return absl::StrCat("the ", PatchKindName(described.kind),
                        described.kind == PatchKind::kContact ? " of " : " between ", first,
                        " and ", second);
  }

  Relationship Make(RelationshipKind kind, LinearForm form, std::string description) const {
    form.constant -= form.At(drawn_);  // what was drawn stays valid
    return {kind, true, std::move(form), connection_.group, std::move(description)};
  }

  // ---- What an element is placed against

  // A patch that it passes through, else whose principals it touches, else the nearest.
  int ReferenceOf(int element) const {
    const auto rank = [&](int index) {
      const ConnectionPatch& patch = PatchAt(index);
      const int touched =
          (Touch(element, patch.first) ? 1 : 0) + (Touch(element, patch.second) ? 1 : 0);
      const BoundingBox& box = At(element).box;
      const double apart = (patch.region.minimum - box.maximum)
                               .cwiseMax(box.minimum - patch.region.maximum)
                               .cwiseMax(0)
                               .norm();
      // What lies within the tolerance is as near as can be.
      return std::tuple(-touched, apart <= connection_.tolerance ? 0 : apart, -patch.area, index);
    };
    int best = 0;
    for (int patch = 1; patch < static_cast<int>(connection_.patches.size()); ++patch) {
      if (rank(patch) < rank(best)) best = patch;
    }
    return best;
  }

  // ---- Relationships that a design has

  void TakeFromDesign() {
    for (Relationship& found : FindRelationships(connection_.assembly, connection_.elements,
                                                 contacts_, connection_.tolerance)) {
      if (!InvolvesUnknown(found.form)) continue;
      switch (found.kind) {
        case RelationshipKind::kCoplanar:
        case RelationshipKind::kConcentric:
          break;  // tied anew below: a design's chains may lead over any member
        case RelationshipKind::kSymmetric:
          alignments_.push_back(AboutWhatTheyShare(std::move(found)));
          break;
        case RelationshipKind::kOrder:
          inequalities_.push_back(std::move(found));
          break;
        case RelationshipKind::kSize:
        case RelationshipKind::kRepeat:
        case RelationshipKind::kProportion:
          (found.equality ? required_ : inequalities_).push_back(std::move(found));
          break;
      }
    }
  }

  // A symmetry about a principal, put as one about the patch or the shortest principal there.
  Relationship AboutWhatTheyShare(Relationship symmetry) const {
    std::vector<int> mirrored;
    int middle = -1;
    for (const LinearTerm& term : symmetry.form.terms) {
      if (term.variable % 6 >= 3) return symmetry;  // sizes
      if (term.coefficient == -2) {
        middle = term.variable;
      } else {
        mirrored.push_back(term.variable / 6);
      }
    }
    if (middle < 0 || !IsPrincipal(middle / 6) || mirrored.size() != 2) return symmetry;
    const Axis axis = static_cast<Axis>(middle % 6);
    const double position = drawn_[middle];
    const int patch = Reference(mirrored[0]);
    Level about;
    if (patch == Reference(mirrored[1])) about = LevelWithPatch(patch, axis, position, 0);
    for (int principal = 0; about.form.terms.empty() && principal < connection_.principal_count();
         ++principal) {
      const int other = CenterVariable(principal, axis);
      if (std::abs(drawn_[other] - position) > connection_.tolerance) continue;
      if (drawn_[other + 3] < drawn_[middle + 3] - connection_.tolerance) middle = other;
    }
    if (about.form.terms.empty()) {
      about = {LinearForm::Variable(middle), absl::StrCat("'", At(middle / 6).name, "'")};
    }
    const LinearForm pair = LinearForm::Variable(CenterVariable(mirrored[0], axis)) +
                            LinearForm::Variable(CenterVariable(mirrored[1], axis));
    return Make(RelationshipKind::kSymmetric, Combine(1, pair, -2, about.form),
                absl::StrCat("'", At(mirrored[0]).name, "' and '", At(mirrored[1]).name,
                             "' mirrored along ", AxisName(axis), " about ", about.label));
  }

  // ---- Planes and centres in one place

  struct Level {
    LinearForm form;
    std::string label;
  };

  // The centre (side 0) or an edge (-1, 1) of a contact patch, if both of its principals have
  // theirs at `position` as drawn, and so the patch; else nothing.
  Level LevelWithPatch(int index, Axis axis, double position, int side) const {
    const ConnectionPatch& patch = PatchAt(index);
    if (patch.kind != PatchKind::kContact || axis == patch.normal) return {};
    const auto of = [&](const BoundingBox& box) {
      return box.center()[static_cast<int>(axis)] + 0.5 * side * box.size()[static_cast<int>(axis)];
    };
    for (const BoundingBox& box : {At(patch.first).box, At(patch.second).box, patch.region}) {
      if (std::abs(of(box) - position) > connection_.tolerance) return {};
    }
    if (side == 0) {
      return {LinearForm::Variable(connection_.PatchVariable(index, axis)),
              absl::StrCat(AxisName(axis), " centre of ", Describe(index))};
    }
    return {
        PatchEdge(connection_, index, axis, side > 0),
        absl::StrCat(AxisName(axis), side > 0 ? " maximum of " : " minimum of ", Describe(index))};
  }

  void TieLevel(const Pose& pose) {
    const std::vector<PosedPosition> positions =
        PositionsIn(pose, connection_.assembly, connection_.elements);
    for (const PosedPosition& position : positions) {
      if (!IsPrincipal(position.element)) Tie(pose, positions, position);
    }
  }

  bool IsMoved(const Pose& pose, int element) const {
    return pose.joint >= 0 && IsWithin(connection_.assembly, At(element).group, pose.moved_group);
  }

  // Whether faces lie against each other, in the pose the design is drawn in.
  bool IsContact(const Pose& pose, const PosedPosition& a, const PosedPosition& b) const {
    const bool opposite = (a.is_minimum && b.is_maximum) || (a.is_maximum && b.is_minimum);
    return pose.joint < 0 && opposite && Touch(a.element, b.element);
  }

  void Tie(const Pose& pose, const std::vector<PosedPosition>& positions,
           const PosedPosition& position) {
    bool tied = false;
    const PosedPosition* best = nullptr;
    for (const PosedPosition& other : positions) {
      if (other.element == position.element || other.axis != position.axis ||
          other.is_center != position.is_center ||
          std::abs(other.drawn - position.drawn) > connection_.tolerance) {
        continue;
      }
      if (pose.joint >= 0 && IsMoved(pose, other.element) == IsMoved(pose, position.element)) {
        continue;  // related in the drawn pose already
      }
      if (IsContact(pose, position, other)) {
        // Between two connecting elements once.
        if (IsPrincipal(other.element) || other.element < position.element) {
          required_.push_back(TieOf(position, {other.position, other.label}));
        }
        tied = true;
      } else if (best == nullptr || IsBetter(position, other, *best)) {
        best = &other;
      }
    }
    if (tied || best == nullptr) return;
    if (!IsPrincipal(best->element)) {
      if (best->element < position.element) {
        alignments_.push_back(TieOf(position, {best->position, best->label}));
      }
      return;
    }
    Level level;
    const bool is_end = position.is_minimum || position.is_maximum;
    if (pose.joint < 0 && (position.is_center || is_end)) {
      const int side = position.is_center ? 0 : (position.is_maximum ? 1 : -1);
      level = LevelWithPatch(Reference(position.element), position.axis, position.drawn, side);
    }
    if (level.form.terms.empty()) level = {best->position, best->label};
    alignments_.push_back(TieOf(position, level));
  }

  // Of what a position is level with: principals first, then what it touches, then the shorter.
  bool IsBetter(const PosedPosition& position, const PosedPosition& a,
                const PosedPosition& b) const {
    const auto rank = [&](const PosedPosition& other) {
      const double size = At(other.element).box.size()[static_cast<int>(other.axis)];
      return std::tuple(!IsPrincipal(other.element), !Touch(position.element, other.element),
                        IsPrincipal(other.element) ? size : 0, other.element);
    };
    return rank(a) < rank(b);
  }

  Relationship TieOf(const PosedPosition& position, const Level& level) const {
    return Make(
        position.is_center ? RelationshipKind::kConcentric : RelationshipKind::kCoplanar,
        position.position - level.form,
        absl::StrCat(position.label, position.is_center ? " level with " : " in one plane with ",
                     level.label));
  }

  // ---- Inside the patch

  void KeepInside() {
    for (int element = connection_.principal_count(); element < element_count(); ++element) {
      for (int patch = 0; patch < static_cast<int>(connection_.patches.size()); ++patch) {
        if (!PassesThrough(element, PatchAt(patch))) continue;
        for (const Axis axis : kAxes) {
          if (axis != PatchAt(patch).normal) KeepInside(element, patch, axis);
        }
      }
    }
  }

  void KeepInside(int element, int patch, Axis axis) {
    std::vector<Relationship> both;
    for (const bool upper : {false, true}) {
      const LinearForm face = PositionOf(element, {"", axis, upper ? 0.5 : -0.5});
      const double outwards = upper ? 1 : -1;
      LinearForm form = outwards * (face - PatchEdge(connection_, patch, axis, upper));
      const double outside = form.At(drawn_);
      if (outside > connection_.tolerance) return;  // as drawn it is wider than the patch
      if (outside > 0) form.constant -= outside;
      both.push_back({RelationshipKind::kOrder, false, std::move(form), connection_.group,
                      absl::StrCat("'", At(element).name, "' ", AxisName(axis),
                                   upper ? " maximum" : " minimum", " inside ", Describe(patch))});
    }
    for (Relationship& inside : both) inequalities_.push_back(std::move(inside));
  }

  // ---- What is kept

  void KeepIndependent() {
    // Sizes and repetition first: they say least about places.
    std::stable_sort(required_.begin(), required_.end(), [](const auto& a, const auto& b) {
      return (a.kind != RelationshipKind::kSize) < (b.kind != RelationshipKind::kSize);
    });
    std::vector<Relationship> all = required_;
    all.insert(all.end(), alignments_.begin(), alignments_.end());
    Eigen::MatrixXd rows =
        Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(all.size()),
                              connection_.end_unknown() - connection_.first_unknown());
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (const LinearTerm& term : all[i].form.terms) {
        const int column = term.variable - connection_.first_unknown();
        if (column < 0 || column >= rows.cols()) continue;
        rows(static_cast<Eigen::Index>(i), column) = term.coefficient;
      }
    }
    const std::vector<bool> independent = IndependentRows(rows);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (independent[i] || i < required_.size()) connection_.hard.push_back(std::move(all[i]));
    }
    for (Relationship& inequality : inequalities_) {
      connection_.hard.push_back(std::move(inequality));
    }
  }

  // ---- Soft relationships

  void AddSoft(int element, Axis axis) {
    AddMargins(Reference(element), axis, PositionOf(element, {"", axis, -0.5}),
               PositionOf(element, {"", axis, 0.5}), absl::StrCat("'", At(element).name, "'"));
  }

  void AddSoftJoint(int joint, Axis axis) {
    const LinearForm center =
        LinearForm::Variable(JointVariable(connection_.elements.size(), joint, axis));
    AddMargins(
        0, axis, center, center,
        absl::StrCat("the centre of '",
                     connection_.assembly.joints[static_cast<std::size_t>(joint)].name, "'"));
  }

  // The nearer edge of the patch counts most, each in inverse proportion to how far it is: a row
  // that ends 20 mm from an edge goes on doing so, what is in the middle stays there.
  void AddMargins(int patch, Axis axis, const LinearForm& lower, const LinearForm& upper,
                  const std::string& what) {
    std::array<LinearForm, 2> margins = {
        lower - PatchEdge(connection_, patch, axis, false),
        PatchEdge(connection_, patch, axis, true) - upper,
    };
    std::array<double, 2> drawn = {margins[0].At(drawn_), margins[1].At(drawn_)};
    const double both = std::abs(drawn[0]) + std::abs(drawn[1]);
    const auto distance = [&](std::size_t side) {
      return both <= connection_.tolerance ? 1 : std::max(std::abs(drawn[side]), kMinWeight * both);
    };
    const double nearer = std::min(distance(0), distance(1));
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
      margins[side].constant -= drawn[side];
      connection_.soft.push_back(
          {patch, margins[side], nearer / distance(side),
           absl::StrCat(what, " ", AxisName(axis), side == 0 ? " minimum " : " maximum ",
                        drawn[side], " m within that of ", Describe(patch))});
    }
  }

  const Contacts& contacts_;
  ElementConnection& connection_;
  const Eigen::VectorXd drawn_;
  const std::set<std::pair<int, int>> touching_;
  std::vector<int> reference_;  // patch, of each connecting element
  std::vector<Relationship> required_;
  std::vector<Relationship> alignments_;
  std::vector<Relationship> inequalities_;
};

}  // namespace

std::vector<bool> IndependentRows(const Eigen::MatrixXd& rows) {
  std::vector<bool> independent(static_cast<std::size_t>(rows.rows()), false);
  Eigen::MatrixXd kept(rows.cols(), std::min(rows.rows(), rows.cols()));
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < rows.rows() && count < kept.cols(); ++i) {
    const double length = rows.row(i).norm();
    if (length == 0) continue;
    Eigen::VectorXd rest = rows.row(i).transpose() / length;
    // Twice, so that rounding leaves nothing of the others in it.
    for (int pass = 0; pass < 2; ++pass) {
      rest -= kept.leftCols(count) * (kept.leftCols(count).transpose() * rest);
    }
    if (rest.norm() <= kDependent) continue;
    kept.col(count++) = rest.normalized();
    independent[static_cast<std::size_t>(i)] = true;
  }
  return independent;
}

void RelateConnection(const Contacts& contacts, const std::vector<Relationship>& joint_ties,
                      ElementConnection& connection) {
  ConnectionRelationships(contacts, connection).Relate(joint_ties);
}

}  // namespace mortise::parametric
