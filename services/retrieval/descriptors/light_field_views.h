// From where the light field descriptor looks at a shape.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace mortise::retrieval {

// The plane of a picture: a point p is seen at (right·p, up·p). `right` is level.
struct View {
  Eigen::Vector3d right;
  Eigen::Vector3d up;
  // rad: turned by so much, counter-clockwise, no axis of space is seen parallel to a row of the
  // picture, or nearly: edges of furniture would otherwise pass all of a row at once when a shape
  // is changed.
  double slant = 0;
  double weight = 1;  // of what is seen there, in the descriptor's vector
};

// Returns the views from the vertices of two regular dodecahedra, which a quarter turn about z maps
// onto each other: the one with the vertices (±1, ±1, ±1), (0, ±1/φ, ±φ), (±1/φ, ±φ, 0), (±φ, 0,
// ±1/φ), and its turn. Opposite vertices see mirrored silhouettes, and the eight cube vertices
// belong to both: that leaves 4 + 6 + 6 = 16 views. The weights make the square of a distance the
// mean of the squares that the views of one dodecahedron find, and of that the mean of both.
std::vector<View> LightFieldViews();

// In which view a shape showed before a quarter turn, counter-clockwise seen from above, what it
// shows in another after it: exactly, or, where the turn leads to the opposite vertex, with right
// and left exchanged.
struct EarlierView {
  int view = 0;
  bool mirrored = false;
};

// Returns that of each view.
std::vector<EarlierView> ViewsBeforeQuarterTurn();

}  // namespace mortise::retrieval
