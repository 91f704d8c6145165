#include "common/parametric/fits.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include "absl/strings/str_cat.h"
#include "common/mesh/drawn_shape.h"

namespace mortise::parametric {
namespace {

// m, by which triangles may miss the curved faces of a part as drawn.
double DeflectionOf(const AssemblyPart& part) {
  return part.shape == nullptr ? 0 : mesh::DeflectionIn(*part.shape, part.box.size());
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
      } else if (PartOf(position.element).shape != nullptr) {
        Note(Kind::kMiddle, std::move(position));
      }
    }
    for (PosedPosition& level : LevelsIn(pose, assembly, elements)) {
      Note(Kind::kLevel, std::move(level));
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
        Add(RelationshipKind::kCoplanar, low.at, high.at);
        tied = &high;
      }
    }
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
    if (form.terms.empty()) return;  // true whatever q is
    // What is apart by less than triangles may miss stays as it was drawn.
    if (equality) form.constant -= form.At(drawn_);
    found_.push_back(
        {kind, equality, std::move(form),
         GroupIn(pose_, assembly_, At(low.element), At(high.element)),
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

// Along one axis: the smaller's size, and how far its centre is from the larger's, as shares of the
// larger's size, which are better known than the other way round.
void StretchAlong(const Assembly& assembly, const std::vector<Element>& elements, int a, int b,
                  Axis axis, std::vector<Relationship>& found) {
  const auto at = [&](int element) -> const Element& {
    return elements[static_cast<std::size_t>(element)];
  };
  const int i = static_cast<int>(axis);
  if (at(a).box.size()[i] > at(b).box.size()[i]) std::swap(a, b);
  const double whole = at(b).box.size()[i];
  const double share = at(a).box.size()[i] / whole;
  const double offset = (at(a).box.center()[i] - at(b).box.center()[i]) / whole;
  const LinearForm size = LinearForm::Variable(SizeVariable(b, axis));
  const std::string label = absl::StrCat("'", at(a).name, "' stretches along ", AxisName(axis),
                                         " with '", at(b).name, "'");
  const int group = LowestCommonGroup(assembly, at(a).group, at(b).group);
  found.push_back({RelationshipKind::kProportion, true,
                   Combine(1, LinearForm::Variable(SizeVariable(a, axis)), -share, size), group,
                   label});
  found.push_back({RelationshipKind::kProportion, true,
                   Combine(1,
                           LinearForm::Variable(CenterVariable(a, axis)) -
                               LinearForm::Variable(CenterVariable(b, axis)),
                           -offset, size),
                   group, label});
}

}  // namespace

std::vector<Relationship> FindFits(const Pose& pose, const Assembly& assembly,
                                   const std::vector<Element>& elements,
                                   const std::set<std::pair<int, int>>& neighbours,
                                   double tolerance) {
  return FitSearch(pose, assembly, elements, tolerance).Find(neighbours);
}

std::vector<Relationship> StretchTogether(const Assembly& assembly,
                                          const std::vector<Element>& elements,
                                          const std::set<std::pair<int, int>>& fitted) {
  const std::vector<int> element_of = ElementsOfParts(assembly, elements);
  std::vector<Relationship> found;
  for (const auto& [first, second] : fitted) {
    const int a = element_of[static_cast<std::size_t>(first)];
    const int b = element_of[static_cast<std::size_t>(second)];
    if (elements[static_cast<std::size_t>(a)].pattern ||
        elements[static_cast<std::size_t>(b)].pattern) {
      continue;
    }
    for (const Axis axis : kAxes) StretchAlong(assembly, elements, a, b, axis, found);
  }
  return found;
}

}  // namespace mortise::parametric
