#include "common/assembly/relations/loose_elements.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/assembly/model/rest_pose.h"
#include "common/base/errors.h"

namespace mortise::parametric {
namespace {

constexpr std::size_t kMaxNamed = 10;
constexpr double kStill = 1e-7;  // of the largest change in a direction

absl::StatusOr<bool> AreBounded(const FeasibleSet& feasible_set,
                                const std::vector<LinearForm>& forms) {
  const absl::Status ranges = feasible_set.RangesOf(forms).status();
  if (DetailOf(ranges).reason == "FEASIBLE_SET_UNBOUNDED") return false;
  MORTISE_RETURN_IF_ERROR(ranges);
  return true;
}

struct LooseElement {
  int element = 0;   // by index
  std::string does;  // what it can do without end: "'lamp' can move along x, z"
};

absl::StatusOr<std::vector<LooseElement>> LooseElements(const std::vector<Element>& elements,
                                                        const FeasibleSet& feasible_set) {
  std::vector<LooseElement> loose;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    std::vector<std::string> moves, grows;
    for (const Axis axis : kAxes) {
      const LinearForm center = LinearForm::Variable(CenterVariable(static_cast<int>(e), axis));
      const LinearForm size = LinearForm::Variable(SizeVariable(static_cast<int>(e), axis));
      MORTISE_ASSIGN_OR_RETURN(const bool holds, AreBounded(feasible_set, {center, size}));
      if (holds) continue;
      MORTISE_ASSIGN_OR_RETURN(const bool is_sized, AreBounded(feasible_set, {size}));
      (is_sized ? moves : grows).push_back(AxisName(axis));
    }
    std::vector<std::string> changes;
    if (!moves.empty()) changes.push_back("move along " + absl::StrJoin(moves, ", "));
    if (!grows.empty()) changes.push_back("grow along " + absl::StrJoin(grows, ", "));
    if (changes.empty()) continue;
    loose.push_back({static_cast<int>(e), absl::StrCat("'", elements[e].name, "' can ",
                                                       absl::StrJoin(changes, " and "))});
  }
  return loose;
}

// A face or the centre of an element's box, or the centre of a joint, along an axis.
struct Place {
  int element = -1;  // -1 for a joint
  LinearForm form;
  double drawn = 0;  // m
  BoundingBox box;   // of what it is of
  bool connecting = false;
  int group = 0;
  std::string name;  // for people
};

std::vector<Place> PlacesAlong(const std::vector<Element>& elements, Axis axis) {
  std::vector<Place> places;
  const auto a = static_cast<int>(axis);
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const Element& element = elements[e];
    const int index = static_cast<int>(e);
    for (const auto& [side, what] :
         {std::pair(-0.5, "minimum"), std::pair(0.5, "maximum"), std::pair(0.0, "centre")}) {
      Place& place = places.emplace_back();
      place.element = index;
      place.form = Combine(1, LinearForm::Variable(CenterVariable(index, axis)), side,
                           LinearForm::Variable(SizeVariable(index, axis)));
      place.box = element.box;
      place.drawn = element.box.center()[a] + side * element.box.size()[a];
      place.connecting = element.connecting;
      place.group = element.group;
      place.name = absl::StrCat("'", element.name, "' ", AxisName(axis), " ", what);
    }
  }
  return places;
}

std::vector<Place> JointsAlong(const Assembly& assembly, std::size_t elements, Axis axis) {
  std::vector<Place> centers;
  for (std::size_t j = 0; j < assembly.joints.size(); ++j) {
    const Joint& joint = assembly.joints[j];
    Place& center = centers.emplace_back();
    center.form = LinearForm::Variable(JointVariable(elements, static_cast<int>(j), axis));
    center.box = {joint.center, joint.center};
    center.drawn = joint.center[static_cast<int>(axis)];
    center.group = joint.group;
    center.name = absl::StrCat("the centre of '", joint.name, "' along ", AxisName(axis));
  }
  return centers;
}

double Apart(const BoundingBox& a, const BoundingBox& b) {
  return (a.minimum - b.maximum).cwiseMax(b.minimum - a.maximum).cwiseMax(0).norm();
}

// Two places of which a direction moves the one only, and how they are preferred: those of one
// element come last, then connecting ones, then distant ones.
struct Pair {
  Place moved, still;
  std::tuple<bool, bool, bool, double, double> rank;
};

void TakeNearest(const std::vector<Place>& moved, const std::vector<Place>& still,
                 std::optional<Pair>& nearest) {
  for (const Place& one : moved) {
    for (const Place& other : still) {
      const std::tuple rank(one.element == other.element, one.connecting, other.connecting,
                            Apart(one.box, other.box), std::abs(one.drawn - other.drawn));
      if (!nearest || rank < nearest->rank) nearest = Pair{one, other, rank};
    }
  }
}

}  // namespace

absl::Status CheckBounded(const Assembly& assembly, const std::vector<Element>& elements,
                          const FeasibleSet& feasible_set,
                          const std::function<std::string(const std::vector<int>&)>& explain) {
  MORTISE_ASSIGN_OR_RETURN(const auto free, feasible_set.UnboundedDirection());
  if (!free) return absl::OkStatus();
  MORTISE_ASSIGN_OR_RETURN(const std::vector<LooseElement> loose_elements,
                           LooseElements(elements, feasible_set));
  std::vector<int> indices;
  std::vector<std::string> loose;
  for (const LooseElement& element : loose_elements) {
    indices.push_back(element.element);
    loose.push_back(element.does);
  }
  if (loose.empty()) {
    for (const Joint& joint : assembly.joints) {
      loose.push_back(absl::StrCat("the centre of '", joint.name, "' can move"));
    }
  }
  std::string more;
  if (loose.size() > kMaxNamed) {
    more = absl::StrCat(" and ", loose.size() - kMaxNamed, " more");
    loose.resize(kMaxNamed);
  }
  const bool is_one = loose.size() == 1;
  return PreconditionFailed(
      "FEASIBLE_SET_UNBOUNDED",
      absl::StrCat(absl::StrJoin(loose, "; "), more, " without end: nothing that ",
                   is_one ? "it touches" : "they touch", ", and no item, holds ",
                   is_one ? "it" : "them", explain(indices)));
}

Relationship HoldWhatMoves(const Assembly& assembly, const std::vector<Element>& elements,
                           const Eigen::VectorXd& direction) {
  const double little = kStill * direction.cwiseAbs().maxCoeff();
  const auto is_still = [&](const Place& place) {
    return std::abs(place.form.At(direction) - place.form.constant) <= little;
  };
  std::optional<Pair> nearest;
  for (const bool of_joints : {false, true}) {
    if (nearest) break;
    for (const Axis axis : kAxes) {
      std::vector<Place> still = PlacesAlong(elements, axis);
      std::vector<Place> moved =
          of_joints ? JointsAlong(assembly, elements.size(), axis) : PlacesAlong(elements, axis);
      std::erase_if(still, [&](const Place& place) { return !is_still(place); });
      std::erase_if(moved, is_still);
      TakeNearest(moved, still, nearest);
    }
  }
  const auto& [moved, still, rank] = *nearest;
  Relationship held;
  held.kind = RelationshipKind::kCoplanar;
  held.form = moved.form - still.form;
  held.form.constant = still.drawn - moved.drawn;
  held.group = LowestCommonGroup(assembly, moved.group, still.group);
  held.description =
      absl::StrCat(moved.name, " keeps its distance from ", still.name, ": nothing else holds it");
  return held;
}

}  // namespace mortise::parametric
