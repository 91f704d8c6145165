#include "common/assembly/relations/element_along.h"

#include <algorithm>
#include <cmath>

namespace mortise::parametric {
namespace {

bool Overlap(const BoundingBox& a, const BoundingBox& b, double tolerance) {
  const Eigen::Array3d overlap = a.maximum.cwiseMin(b.maximum) - a.minimum.cwiseMax(b.minimum);
  return overlap.minCoeff() > tolerance;
}

}  // namespace

std::set<std::pair<int, int>> NeighboursOf(const std::vector<Element>& elements,
                                           const std::vector<std::pair<int, int>>& contacts,
                                           double tolerance) {
  std::set<std::pair<int, int>> neighbours(contacts.begin(), contacts.end());
  const int count = static_cast<int>(elements.size());
  for (int a = 0; a < count; ++a) {
    const BoundingBox& one = elements[static_cast<std::size_t>(a)].box;
    for (int b = a + 1; b < count; ++b) {
      if (Overlap(one, elements[static_cast<std::size_t>(b)].box, tolerance)) {
        neighbours.emplace(a, b);
      }
    }
  }
  return neighbours;
}

ElementAlong::ElementAlong(const Assembly& assembly, const std::vector<Element>& elements,
                           const std::set<std::pair<int, int>>& neighbours, int element, Axis axis,
                           double tolerance)
    : assembly_(assembly),
      elements_(elements),
      neighbours_(neighbours),
      element_(element),
      axis_(axis),
      tolerance_(tolerance),
      center_(At(element).box.center()[Index()]),
      size_(At(element).box.size()[Index()]) {
  for (const DrawnPlace& place : PlacesOf(element)) {
    if (place.plane.divides) dividing_.push_back(place.plane.fraction);
  }
  std::sort(dividing_.begin(), dividing_.end());
}

std::optional<double> ElementAlong::DividingAt(double at) const {
  for (const double fraction : dividing_) {
    if (std::abs(PlaceOf(fraction) - at) <= tolerance_) return fraction;
  }
  return std::nullopt;
}

bool ElementAlong::IsNeighbour(int other) const {
  return neighbours_.count(std::minmax(element_, other)) != 0 &&
         !(At(other).pattern && LeadsAlong(*At(other).pattern, Index()));
}

bool ElementAlong::Overlaps(int other) const {
  return Overlap(element().box, At(other).box, tolerance_);
}

bool ElementAlong::Enters(int inner, int outer) const {
  const BoundingBox& own = At(inner).box;
  const BoundingBox& box = At(outer).box;
  for (int axis = 0; axis < 3; ++axis) {
    if (axis == Index()) continue;
    for (const int one : {inner, outer}) {
      if (At(one).pattern && LeadsAlong(*At(one).pattern, axis)) return false;
    }
    if (own.minimum[axis] < box.minimum[axis] - tolerance_ ||
        own.maximum[axis] > box.maximum[axis] + tolerance_) {
      return false;
    }
  }
  return true;
}

double ElementAlong::NearTo(int other) const {
  double near = tolerance_;
  for (const int element : {element_, other}) {
    const AssemblyPart& part = PartOf(element);
    if (part.shape != nullptr) near += mesh::DeflectionIn(*part.shape, part.box.size());
  }
  return near;
}

std::vector<DrawnPlace> ElementAlong::PlacesOf(int element) const {
  std::vector<DrawnPlace> places;
  const BoundingBox& box = At(element).box;
  for (const auto* planes : {&At(element).planes, &At(element).levels}) {
    for (const ElementPlane& plane : *planes) {
      if (plane.axis != axis_) continue;
      places.push_back({box.center()[Index()] + plane.fraction * box.size()[Index()], plane});
    }
  }
  std::sort(places.begin(), places.end(),
            [](const DrawnPlace& a, const DrawnPlace& b) { return a.at < b.at; });
  return places;
}

DrawnPlace ElementAlong::PlaceIn(int element, double at) const {
  const BoundingBox& box = At(element).box;
  if (at == box.minimum[Index()]) return BoxFace(element, false);
  if (at == box.maximum[Index()]) return BoxFace(element, true);
  return {at, {"", axis_, (at - box.center()[Index()]) / box.size()[Index()], false}};
}

DrawnPlace ElementAlong::BoxFace(int element, bool upper) const {
  const BoundingBox& box = At(element).box;
  return {(upper ? box.maximum : box.minimum)[Index()], {"", axis_, upper ? 0.5 : -0.5, false}};
}

LinearForm ElementAlong::AtDrawnDistance(int element, const DrawnPlace& place, double at) const {
  LinearForm form = PositionOf(elements_, element, place.plane);
  form.constant += at - place.at;
  return form;
}

}  // namespace mortise::parametric
