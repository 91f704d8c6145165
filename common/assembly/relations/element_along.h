// One element along one axis, as drawn, and the neighbours beside it, by which its levels may go.
#pragma once

#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "common/assembly/model/assembly.h"
#include "common/assembly/model/element.h"
#include "common/assembly/polyhedra/linear_form.h"

namespace mortise::parametric {

// A place of an element along an axis: a plane or a level.
struct DrawnPlace {
  double at = 0;  // m
  ElementPlane plane;
};

// Returns pairs of elements that touch, or whose boxes overlap by more than `tolerance`, m; lower
// first. O(e²) for e elements.
std::set<std::pair<int, int>> NeighboursOf(const std::vector<Element>& elements,
                                           const std::vector<std::pair<int, int>>& contacts,
                                           double tolerance);

// Keeps references to what it is made of, all of which must outlive it.
class ElementAlong {
 public:
  ElementAlong(const Assembly& assembly, const std::vector<Element>& elements,
               const std::set<std::pair<int, int>>& neighbours, int element, Axis axis,
               double tolerance);

  const std::vector<Element>& elements() const { return elements_; }
  int index() const { return element_; }
  Axis axis() const { return axis_; }
  double tolerance() const { return tolerance_; }
  double center() const { return center_; }  // m
  double size() const { return size_; }      // m
  const Element& element() const { return At(element_); }
  const AssemblyPart& part() const { return PartOf(element_); }
  const Element& At(int element) const { return elements_[static_cast<std::size_t>(element)]; }

  // Returns the element's part; in a row the first.
  const AssemblyPart& PartOf(int element) const {
    return assembly_.parts[static_cast<std::size_t>(At(element).parts.front())];
  }

  // Returns the levels that divide its shape, as fractions, in order.
  const std::vector<double>& dividing() const { return dividing_; }
  double PlaceOf(double fraction) const { return center_ + fraction * size_; }  // m
  double FractionAt(double at) const { return (at - center_) / size_; }
  // Returns the fraction of the dividing level at a place, m.
  std::optional<double> DividingAt(double at) const;

  // Whether the levels of this element can go by the planes of another, which must be a neighbour.
  // Rows that lead along this axis cannot be gone by.
  bool IsNeighbour(int other) const;
  // Whether the other's box reaches into this one's, and does not only touch it.
  bool Overlaps(int other) const;
  // Whether `inner`, but along the axis, is no wider than `outer` where they meet.
  bool Enters(int inner, int outer) const;
  // Returns how far apart places of this element and of the other may be drawn and yet count as
  // one, m: triangles miss some.
  double NearTo(int other) const;

  // Returns all planes and levels of an element along the axis, in order.
  std::vector<DrawnPlace> PlacesOf(int element) const;
  // Returns a place within an element's box, m.
  DrawnPlace PlaceIn(int element, double at) const;
  // Returns the lower or upper face of an element's box.
  DrawnPlace BoxFace(int element, bool upper) const;
  // Returns where `at`, m, goes if it keeps the distance that it has as drawn from a place of an
  // element.
  LinearForm AtDrawnDistance(int element, const DrawnPlace& place, double at) const;

 private:
  int Index() const { return static_cast<int>(axis_); }
  const Assembly& assembly_;
  const std::vector<Element>& elements_;
  const std::set<std::pair<int, int>>& neighbours_;
  const int element_;
  const Axis axis_;
  const double tolerance_;
  const double center_, size_;
  std::vector<double> dividing_;
};

}  // namespace mortise::parametric
