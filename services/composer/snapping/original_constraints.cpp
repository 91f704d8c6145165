#include "services/composer/snapping/original_constraints.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "common/assembly/model/element.h"
#include "common/assembly/trial/drawn_contacts.h"

namespace mortise::composer {
namespace {

using parametric::AssemblyPart;
using parametric::BoundingBox;
using parametric::ParametricAssembly;

constexpr double kSame = 1e-6;  // of a distance, its change over the feasible set

double SharedArea(const BoundingBox& a, const BoundingBox& b, int normal) {
  const Eigen::Vector3d shared =
      (a.maximum.cwiseMin(b.maximum) - a.minimum.cwiseMax(b.minimum)).cwiseMax(0);
  return shared[(normal + 1) % 3] * shared[(normal + 2) % 3];
}

class ConstraintSearch {
 public:
  ConstraintSearch(const Design& original, const std::vector<PrincipalPart>& component_parts,
                   double reach)
      : assembly_(*original.assembly), parts_(component_parts), reach_(reach) {
    const auto& drawn = assembly_.assembly().parts;
    for (std::size_t i = 0; i < drawn.size(); ++i) index_of_[drawn[i].name] = i;
    for (const PrincipalPart& part : parts_) inside_.insert(part.drawn_as);
    element_of_ = parametric::ElementsOfParts(assembly_.assembly(), assembly_.elements());
    for (const auto& [a, b] : assembly_.contacts()) {
      related_.emplace(a, b);
      related_.emplace(b, a);
    }
    for (const parametric::ElementConnection& connection : assembly_.connections()) {
      for (const int a : connection.principals) {
        for (const int b : connection.principals) {
          related_.emplace(a, b);
          if (!connection.connecting.empty()) fastened_.emplace(a, b);
        }
      }
    }
  }

  // The constraint of a plane of the component, if it has one.
  std::optional<OriginalConstraint> Find(const DesignPlane& plane) const {
    if (plane.in_original) return FindInPose(plane, *plane.in_original);
    const std::string& owner =
        plane.part < 0 ? plane.owner : parts_[static_cast<std::size_t>(plane.part)].drawn_as;
    const auto index = index_of_.find(owner);
    if (index == index_of_.end()) return std::nullopt;
    const AssemblyPart& own = PartAt(index->second);
    const std::optional<double> place = PlaceOf(own, plane);
    if (!place) return std::nullopt;
    OriginalConstraint contact, level;
    contact.is_contact = true;
    const auto& parts = assembly_.assembly().parts;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (parts[i].connecting || inside_.contains(parts[i].name)) continue;
      LookAtProminent(plane, *place, parts[i], level);
      if (DistanceBetween(own.box, parts[i].box) > reach_) continue;
      if (!related_.contains({element_of_[index->second], element_of_[i]})) continue;
      if (IsMovedAway(own, parts[i])) continue;
      LookAtFaces(index->second, i, plane, *place, contact, level);
    }
    if (!contact.outside.empty()) return contact;
    if (level.outside.empty()) return std::nullopt;
    level.covers = Covers(index->second, plane.axis, *place);
    return level;
  }

 private:
  // The constraint of a plane in a rest pose.
  std::optional<OriginalConstraint> FindInPose(const DesignPlane& plane,
                                               const PlaneInOriginal& there) const {
    OriginalConstraint contact, level;
    contact.is_contact = true;
    for (const AssemblyPart& part : assembly_.assembly().parts) {
      if (part.connecting || inside_.contains(part.name)) continue;
      if (parametric::IsWithin(assembly_.assembly(), part.group, there.moved_group)) continue;
      LookAtProminent(plane, there.place, part, level);
      if (DistanceBetween(there.box, part.box) > reach_) continue;
      for (const PlaneSide side : {PlaneSide::kMinimum, PlaneSide::kMaximum}) {
        const Meeting meeting = MeetingOf(there.box, part.box, plane, side);
        if (!IsOneTolerance(meeting.its, there.place)) continue;
        Add({side, "", IsBroadAcross(part.box, plane.axis), 0}, meeting.faces ? meeting.area : 0,
            meeting.faces ? contact : level);
      }
    }
    if (!contact.outside.empty()) return contact;
    if (!level.outside.empty()) return level;
    return std::nullopt;
  }

  // Whether no principal part outside that the component's lies against reaches across the plane.
  bool Covers(std::size_t own, Axis axis, double place) const {
    const BoundingBox& box = PartAt(own).box;
    const auto& parts = assembly_.assembly().parts;
    return std::none_of(parts.begin(), parts.end(), [&](const AssemblyPart& part) {
      return !part.connecting && !inside_.contains(part.name) &&
             DistanceBetween(box, part.box) <= assembly_.tolerance() &&
             ReachesAcross(part.box, axis, place, assembly_.tolerance());
    });
  }

  const AssemblyPart& PartAt(std::size_t index) const { return assembly_.assembly().parts[index]; }

  // Whether a joint moves what is outside, and not the component's part.
  bool IsMovedAway(const AssemblyPart& own, const AssemblyPart& outside) const {
    const parametric::Assembly& drawn = assembly_.assembly();
    return std::any_of(drawn.joints.begin(), drawn.joints.end(), [&](const auto& joint) {
      return parametric::IsWithin(drawn, outside.group, joint.group) &&
             !parametric::IsWithin(drawn, own.group, joint.group);
    });
  }

  // Where the plane is drawn in the original.
  static std::optional<double> PlaceOf(const AssemblyPart& part, const DesignPlane& plane) {
    const auto axis = static_cast<Eigen::Index>(plane.axis);
    if (plane.side == PlaneSide::kMinimum && plane.part >= 0) return part.box.minimum[axis];
    if (plane.side == PlaneSide::kMaximum && plane.part >= 0) return part.box.maximum[axis];
    for (const parametric::ProminentPlane& prominent : part.prominent_planes) {
      if (prominent.name == plane.name && prominent.axis == plane.axis) return prominent.position;
    }
    return std::nullopt;
  }

  bool IsOneTolerance(double a, double b) const { return std::abs(a - b) <= assembly_.tolerance(); }

  static void Add(const OutsidePlane& outside, double area, OriginalConstraint& constraint) {
    constraint.area = std::max(constraint.area, area);
    auto& known = constraint.outside;
    if (std::find(known.begin(), known.end(), outside) == known.end()) known.push_back(outside);
  }

  void LookAtProminent(const DesignPlane& plane, double place, const AssemblyPart& outside,
                       OriginalConstraint& level) const {
    for (const parametric::ProminentPlane& prominent : outside.prominent_planes) {
      if (prominent.axis != plane.axis || !IsOneTolerance(prominent.position, place)) continue;
      Add({PlaneSide::kNone, prominent.name, false, 0}, 0, level);
    }
  }

  void LookAtFaces(std::size_t own, std::size_t other, const DesignPlane& plane, double place,
                   OriginalConstraint& contact, OriginalConstraint& level) const {
    const BoundingBox& box = PartAt(other).box;
    for (const PlaneSide side : {PlaneSide::kMinimum, PlaneSide::kMaximum}) {
      const Meeting meeting = MeetingOf(PartAt(own).box, box, plane, side);
      OutsidePlane outside{side, "", IsBroadAcross(box, plane.axis), 0};
      if (IsOneTolerance(meeting.its, place)) {
        Add(outside, meeting.faces ? meeting.area : 0, meeting.faces ? contact : level);
      } else if (meeting.faces && IsHeldApart(own, other, plane, meeting.its, place)) {
        outside.offset = place - meeting.its;
        Add(outside, meeting.area, contact);
      }
    }
  }

  // How a face of a part outside meets a plane of the component's part.
  struct Meeting {
    double its = 0;      // m, where the face lies
    double area = 0;     // m², that the boxes share across it
    bool faces = false;  // it looks at the plane, over this area
  };

  static Meeting MeetingOf(const BoundingBox& own, const BoundingBox& other,
                           const DesignPlane& plane, PlaneSide side) {
    const auto axis = static_cast<int>(plane.axis);
    Meeting meeting;
    meeting.its = side == PlaneSide::kMinimum ? other.minimum[axis] : other.maximum[axis];
    meeting.area = SharedArea(own, other, axis);
    meeting.faces = plane.side != PlaneSide::kNone && plane.side != side && meeting.area > 0;
    return meeting;
  }

  // Whether what fastens two parts holds their faces at this distance in all designs, with the
  // component's part on its own side.
  bool IsHeldApart(std::size_t own, std::size_t other, const DesignPlane& plane, double its,
                   double place) const {
    const double gap = plane.side == PlaneSide::kMinimum ? place - its : its - place;
    if (gap <= 0 || gap > reach_) return false;
    const int a = element_of_[own], b = element_of_[other];
    if (!fastened_.contains({a, b})) return false;
    const auto& elements = assembly_.elements();
    for (const int element : {a, b}) {
      if (elements[static_cast<std::size_t>(element)].pattern) return false;
    }
    const double half = plane.side == PlaneSide::kMinimum ? -0.5 : 0.5;
    const parametric::LinearForm apart = parametric::PositionOf(a, {"", plane.axis, half, false}) -
                                         parametric::PositionOf(b, {"", plane.axis, -half, false});
    const Eigen::MatrixXd& basis = assembly_.feasible_set().basis();
    Eigen::RowVectorXd change = Eigen::RowVectorXd::Zero(basis.cols());
    for (const parametric::LinearTerm& term : apart.terms) {
      change += term.coefficient * basis.row(term.variable);
    }
    return change.norm() <= kSame;
  }

  const ParametricAssembly& assembly_;
  const std::vector<PrincipalPart>& parts_;
  const double reach_;
  std::map<std::string, std::size_t> index_of_;
  std::set<std::string> inside_;
  std::vector<int> element_of_;
  std::set<std::pair<int, int>> related_, fastened_;  // elements, both ways round
};

}  // namespace

std::vector<OriginalConstraint> FindOriginalConstraints(
    const Design& original, const std::vector<PrincipalPart>& component_parts,
    const std::vector<DesignPlane>& component_planes, double reach) {
  const ConstraintSearch search(original, component_parts, reach);
  std::vector<OriginalConstraint> constraints;
  for (std::size_t i = 0; i < component_planes.size(); ++i) {
    std::optional<OriginalConstraint> found = search.Find(component_planes[i]);
    if (!found) continue;
    found->plane = static_cast<int>(i);
    constraints.push_back(*std::move(found));
  }
  std::stable_sort(constraints.begin(), constraints.end(), [](const auto& a, const auto& b) {
    return std::pair(!a.is_contact, -a.area) < std::pair(!b.is_contact, -b.area);
  });
  return constraints;
}

}  // namespace mortise::composer
