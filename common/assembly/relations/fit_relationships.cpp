#include "common/assembly/relations/fit_relationships.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/model/oriented_box.h"
#include "common/mesh/shapes/drawn_shape.h"

namespace mortise::parametric {
namespace {

// m, by which triangles may miss the curved faces of a part as drawn.
double DeflectionOf(const AssemblyPart& part) {
  return part.shape == nullptr ? 0 : mesh::DeflectionIn(*part.shape, part.box.size());
}

bool HasFlatEnds(const mesh::DrawnShape& shape, Axis axis) {
  const auto is_face = [&](const std::string& name) {
    return std::any_of(shape.face_names.begin(), shape.face_names.end(), [&](const auto& names) {
      return std::find(names.begin(), names.end(), name) != names.end();
    });
  };
  return is_face(absl::StrCat(AxisName(axis), "_min")) &&
         is_face(absl::StrCat(AxisName(axis), "_max"));
}

// The size of an element along an axis of a pose that turns it to right angles, to these axes.
LinearForm SizeAlong(int element, const Eigen::Matrix3d& axes, Axis axis) {
  Eigen::Index own = 0;
  axes.row(static_cast<int>(axis)).cwiseAbs().maxCoeff(&own);
  return LinearForm::Variable(SizeVariable(element, static_cast<Axis>(own)));
}

class FitSearch {
 public:
  FitSearch(const Pose& pose, const Assembly& assembly, const std::vector<Element>& elements,
            double tolerance)
      : pose_(pose),
        assembly_(assembly),
        elements_(elements),
        tolerance_(tolerance),
        drawn_(DrawnParameters(assembly, elements)) {
    for (PosedPosition& position : PositionsIn(pose, assembly, elements)) {
      if (!position.is_center) {
        Note(Kind::kPlane, std::move(position));
      } else if (IsTouchedAtMiddle(pose, position)) {
        Note(Kind::kMiddle, std::move(position));
      }
    }
    for (PosedPosition& level : LevelsIn(pose, assembly, elements)) {
      if (!IsOfBox(level)) Note(Kind::kLevel, std::move(level));
    }
  }

  std::vector<Relationship> Find(const std::set<std::pair<int, int>>& neighbours) {
    for (const auto& [a, b] : neighbours) {
      if (PartOf(a).shape == nullptr && PartOf(b).shape == nullptr) continue;
      const double near = tolerance_ + DeflectionOf(PartOf(a)) + DeflectionOf(PartOf(b));
      for (const Axis axis : kAxes) {
        RelateFaces(a, b, axis, near);
        RelateMiddles(a, b, axis, near);
        RelateMiddles(b, a, axis, near);
      }
    }
    return std::move(found_);
  }

 private:
  enum class Kind { kPlane, kLevel, kMiddle };
  struct Place {
    Kind kind = Kind::kPlane;
    PosedPosition at;
  };

  const Element& At(int element) const { return elements_[static_cast<std::size_t>(element)]; }
  const AssemblyPart& PartOf(int element) const {
    return assembly_.parts[static_cast<std::size_t>(At(element).parts.front())];
  }

  // Whether a level is a plane of its own element's box, which triangles of round ones just miss.
  bool IsOfBox(const PosedPosition& level) const {
    const auto places = places_.find({level.element, level.axis});
    if (places == places_.end()) return false;
    const double missed = DeflectionOf(PartOf(level.element));
    return std::any_of(places->second.begin(), places->second.end(), [&](const Place& place) {
      return (place.at.is_minimum || place.at.is_maximum) &&
             std::abs(place.at.drawn - level.drawn) <= missed;
    });
  }

  // Whether what lies beside a shape along an axis may touch it at its middle only, as it does what
  // is round. Where the shape ends in flat faces, these say all.
  bool IsTouchedAtMiddle(const Pose& pose, const PosedPosition& middle) const {
    const mesh::DrawnShape* shape = PartOf(middle.element).shape.get();
    if (shape == nullptr) return false;
    const Eigen::Matrix3d axes = BoxIn(pose, assembly_, elements_, middle.element, drawn_).axes;
    Eigen::Index own = 0;
    const double along = axes.row(static_cast<int>(middle.axis)).cwiseAbs().maxCoeff(&own);
    return along < 1 || !HasFlatEnds(*shape, static_cast<Axis>(own));
  }

  void Note(Kind kind, PosedPosition position) {
    std::vector<Place>& places = places_[{position.element, position.axis}];
    places.push_back({kind, std::move(position)});
  }

  // From neighbour to neighbour in their order along the axis: what is of one element keeps its
  // order anyway, and planes have been related already.
  void RelateFaces(int a, int b, Axis axis, double near) {
    std::vector<const Place*> faces;
    for (const int element : {a, b}) {
      for (const Place& place : places_[{element, axis}]) {
        if (place.kind != Kind::kMiddle) faces.push_back(&place);
      }
    }
    std::stable_sort(faces.begin(), faces.end(), [](const Place* first, const Place* second) {
      return first->at.drawn < second->at.drawn;
    });
    const Place* tied = nullptr;  // once: twice would fix the distance of the other's two
    for (std::size_t i = 0; i + 1 < faces.size(); ++i) {
      const Place& low = *faces[i];
      const Place& high = *faces[i + 1];
      if (low.at.element == high.at.element) continue;
      if (low.kind == Kind::kPlane && high.kind == Kind::kPlane) continue;
      if (high.at.drawn - low.at.drawn > near) {
        Add(RelationshipKind::kOrder, low.at, high.at);
      } else if (tied != &low) {
        if ((low.at.position - high.at.position).terms.empty()) {
          // One is held by the other.
        } else if (low.kind == Kind::kLevel) {
          Add(RelationshipKind::kCoplanar, MovedOnto(high.at, low.at), high.at);
        } else {
          Add(RelationshipKind::kCoplanar, low.at, MovedOnto(low.at, high.at));
        }
        tied = &high;
      }
    }
  }

  // A level where a place of another element is, which it is in truth: triangles may miss it. It is
  // as large a share of its element's size there, so that both stay together in every size. What is
  // stretched in pieces is exact, and what is between it and the place is meant.
  PosedPosition MovedOnto(const PosedPosition& place, const PosedPosition& level) const {
    const auto& held = At(level.element).feature_anchors;
    if (std::any_of(held.begin(), held.end(), [](const auto& along) { return !along.empty(); })) {
      return level;
    }
    const OrientedBox box = BoxIn(pose_, assembly_, elements_, level.element, drawn_);
    const LinearForm size = SizeAlong(level.element, box.axes, level.axis);
    PosedPosition moved = level;
    moved.position =
        Combine(1, level.position, (place.drawn - level.drawn) / size.At(drawn_), size);
    moved.drawn = place.drawn;
    return moved;
  }

  void RelateMiddles(int of, int other, Axis axis, double near) {
    for (const Place& middle : places_[{of, axis}]) {
      if (middle.kind != Kind::kMiddle) continue;
      const Place* below = nullptr;
      const Place* above = nullptr;
      for (const Place& place : places_[{other, axis}]) {
        if (place.kind == Kind::kMiddle) continue;
        if (middle.at.drawn - place.at.drawn > near) {
          if (below == nullptr || place.at.drawn > below->at.drawn) below = &place;
        } else if (place.at.drawn - middle.at.drawn > near) {
          if (above == nullptr || place.at.drawn < above->at.drawn) above = &place;
        }
      }
      if (below != nullptr) Add(RelationshipKind::kOrder, below->at, middle.at);
      if (above != nullptr) Add(RelationshipKind::kOrder, middle.at, above->at);
    }
  }

  void Add(RelationshipKind kind, const PosedPosition& low, const PosedPosition& high) {
    const bool equality = kind == RelationshipKind::kCoplanar;
    LinearForm form = low.position - high.position;
    if (form.terms.empty()) return;                  // true whatever q is
    if (equality) form.constant -= form.At(drawn_);  // rounding
    const int group = GroupIn(pose_, assembly_, elements_, At(low.element), At(high.element), form);
    found_.push_back(
        {kind, equality, std::move(form), group,
         absl::StrCat(low.label, equality ? " in one plane with " : " before ", high.label)});
  }

  const Pose& pose_;
  const Assembly& assembly_;
  const std::vector<Element>& elements_;
  const double tolerance_;
  const Eigen::VectorXd drawn_;
  std::map<std::pair<int, Axis>, std::vector<Place>> places_;
  std::vector<Relationship> found_;
};

// Two elements in a pose that are to be stretched by one map.
class Stretch {
 public:
  Stretch(const Pose& pose, const Assembly& assembly, const std::vector<Element>& elements, int a,
          int b)
      : pose_(pose),
        assembly_(assembly),
        elements_(elements),
        drawn_(DrawnParameters(assembly, elements)),
        a_(a),
        b_(b) {}

  std::vector<Relationship> Find() {
    const Eigen::Matrix3d turn_a = BoxIn(pose_, assembly_, elements_, a_, drawn_).axes;
    const Eigen::Matrix3d turn_b = BoxIn(pose_, assembly_, elements_, b_, drawn_).axes;
    if (!IsAtRightAngles(turn_a) || !IsAtRightAngles(turn_b)) {
      KeepInProportion({SizesOf(a_), SizesOf(b_)}, {kAxes.begin(), kAxes.end()});
      return std::move(found_);
    }
    for (const Axis axis : kAxes) {
      KeepInProportion({std::vector{SizeAlong(a_, turn_a, axis)}, {SizeAlong(b_, turn_b, axis)}},
                       {axis});
    }
    return std::move(found_);
  }

 private:
  const Element& At(int element) const { return elements_[static_cast<std::size_t>(element)]; }

  static std::vector<LinearForm> SizesOf(int element) {
    std::vector<LinearForm> sizes;
    for (const Axis axis : kAxes) {
      sizes.push_back(LinearForm::Variable(SizeVariable(element, axis)));
    }
    return sizes;
  }

  // Sizes of both, and how far their centres are apart along axes of the pose, as shares of the
  // largest size, which are better known than the other way round.
  void KeepInProportion(const std::array<std::vector<LinearForm>, 2>& sizes,
                        const std::vector<Axis>& axes) {
    const LinearForm* largest = &sizes[0].front();
    bool is_of_a = true;
    for (std::size_t of = 0; of < 2; ++of) {
      for (const LinearForm& size : sizes[of]) {
        if (size.At(drawn_) <= largest->At(drawn_)) continue;
        largest = &size;
        is_of_a = of == 0;
      }
    }
    std::string label = absl::StrCat("'", At(is_of_a ? b_ : a_).name, "' stretches along ",
                                     axes.size() == 1 ? AxisName(axes.front()) : "all axes",
                                     " with '", At(is_of_a ? a_ : b_).name, "'");
    if (pose_.joint >= 0) absl::StrAppend(&label, " in '", pose_.name, "'");
    for (const std::vector<LinearForm>& of : sizes) {
      for (const LinearForm& size : of) {
        if (&size != largest) Tie(size, *largest, label);
      }
    }
    for (const Axis axis : axes) {
      const Eigen::Vector3d along = Eigen::Vector3d::Unit(static_cast<int>(axis));
      const Eigen::Vector3d middle = Eigen::Vector3d::Zero();
      Tie(PlaceIn(pose_, assembly_, elements_, a_, middle, along) -
              PlaceIn(pose_, assembly_, elements_, b_, middle, along),
          *largest, label);
    }
  }

  void Tie(const LinearForm& length, const LinearForm& whole, const std::string& label) {
    const double share = length.At(drawn_) / whole.At(drawn_);
    LinearForm form = Combine(1, length, -share, whole);
    const int group = GroupIn(pose_, assembly_, elements_, At(a_), At(b_), form);
    found_.push_back({RelationshipKind::kProportion, true, std::move(form), group, label});
  }

  const Pose& pose_;
  const Assembly& assembly_;
  const std::vector<Element>& elements_;
  const Eigen::VectorXd drawn_;
  const int a_, b_;
  std::vector<Relationship> found_;
};

}  // namespace

std::vector<Relationship> FindFits(const Pose& pose, const Assembly& assembly,
                                   const std::vector<Element>& elements,
                                   const std::set<std::pair<int, int>>& neighbours,
                                   double tolerance) {
  return FitSearch(pose, assembly, elements, tolerance).Find(neighbours);
}

std::vector<Relationship> StretchTogether(const Pose& pose, const Assembly& assembly,
                                          const std::vector<Element>& elements,
                                          const std::set<PosedPair>& fitted) {
  const std::vector<int> element_of = ElementsOfParts(assembly, elements);
  std::vector<Relationship> found;
  for (const PosedPair& pair : fitted) {
    if (pair.pose != pose.name) continue;
    const int a = element_of[static_cast<std::size_t>(pair.first)];
    const int b = element_of[static_cast<std::size_t>(pair.second)];
    if (elements[static_cast<std::size_t>(a)].pattern ||
        elements[static_cast<std::size_t>(b)].pattern) {
      continue;
    }
    for (Relationship& together : Stretch(pose, assembly, elements, a, b).Find()) {
      found.push_back(std::move(together));
    }
  }
  return found;
}

}  // namespace mortise::parametric
