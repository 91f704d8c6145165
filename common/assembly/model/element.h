// Elements are the leaves of a parametric tree, each one part or one pattern of parts. This says
// which of the parameters q belong to them (thesis §3.4, §3.5).
//
// Element e has the centre q[6e … 6e+2] and the size q[6e+3 … 6e+5] of its bounding box, in metres.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/assembly/model/assembly.h"
#include "common/assembly/model/pattern.h"
#include "common/assembly/model/shape_features.h"
#include "common/assembly/polyhedra/linear_form.h"
#include "common/mesh/shapes/drawn_shape.h"

namespace mortise::parametric {

inline constexpr std::array<Axis, 3> kAxes = {Axis::kX, Axis::kY, Axis::kZ};

// Return the index into q of an element's centre or size along an axis.
inline int CenterVariable(int element, Axis axis) { return 6 * element + static_cast<int>(axis); }
inline int SizeVariable(int element, Axis axis) { return 6 * element + 3 + static_cast<int>(axis); }

// A plane of an element, at centre + fraction · size along its axis. The faces of the box lie at
// -1/2 and +1/2. In an element with feature anchors the plane lies between these as PositionOf
// says.
struct ElementPlane {
  std::string name;
  Axis axis = Axis::kX;
  double fraction = 0;
  bool divides = false;  // its shape can be stretched by itself on either side (ShapeLevel)
};

// A level of an element's shape that lies where q says, as the side of a bore does that goes by its
// rod. Between such levels, and the faces of the box, the shape is stretched in proportion.
struct FeatureAnchor {
  double fraction = 0;
  LinearForm place;  // m, along its axis
};

struct Element {
  std::string name;  // of its part, or of a pattern's first part
  std::string item;  // items/{id}
  int group = 0;     // of the assembly
  bool connecting = false;
  std::vector<int> parts;          // of the assembly
  std::optional<Pattern> pattern;  // of an element of more than one part
  BoundingBox box;                 // as the expert drew it
  std::array<SizeLimits, 3> limits;
  // The six planes of the box, then the prominent ones. A pattern has those that all its parts have
  // in common.
  std::vector<ElementPlane> planes;
  // The further levels where its shape turns back (mesh/shapes/shape_levels.h), by which neighbours
  // that fit into it are held. A pattern has none along its directions.
  std::vector<ElementPlane> levels;
  // The looks of its parts; null if they look as their item's kind says.
  std::shared_ptr<const mesh::DrawnShape> shape;
  // The axis that it may be turned about without reaching further: the axis of its shape, if that
  // is round from one side of its box to the other.
  std::optional<Axis> round_about;
  // The anchors by axis, in order (feature_anchors.h). `shape` is divided at them. A pattern has
  // none along its directions.
  std::array<std::vector<FeatureAnchor>, 3> feature_anchors;
};

// Returns the elements of a valid assembly: its patterns, largest first, then the remaining parts
// in their order. Along a pattern's directions the limits are those of LengthsOf. `exclusions` are
// as in FindPatterns.
std::vector<Element> MakeElements(const Assembly& assembly, double tolerance,
                                  const PatternExclusions& exclusions = {});
std::vector<Element> MakeElements(const Assembly& assembly, double tolerance,
                                  const PatternExclusions& exclusions, ShapeFeatures& known);

// Returns the index of the element of each part of the assembly; -1 for a part that is in none.
std::vector<int> ElementsOfParts(const Assembly& assembly, const std::vector<Element>& elements);

// Returns q as the expert drew the design: 6 · elements numbers, m.
Eigen::VectorXd DrawnParameters(const std::vector<Element>& elements);

// Returns where a plane of the box of element `element` lies along its axis, as a function of q.
// For a plane of its shape it is where that would lie if the shape were stretched in proportion.
LinearForm PositionOf(int element, const ElementPlane& plane);

// Returns where a plane of element `element` lies along its axis, as a function of q, with the
// element's feature anchors taken into account.
LinearForm PositionOf(const std::vector<Element>& elements, int element, const ElementPlane& plane);

}  // namespace mortise::parametric
