// A bookcase of any size, of which no two boards are alike.
#pragma once

#include <Eigen/Core>
#include <random>
#include <string>

#include "common/assembly/model/assembly.h"

namespace mortise::parametric {

// A board whose sizes may be half to twice as large as drawn.
inline AssemblyPart Board(const std::string& name, const Eigen::Vector3d& minimum,
                          const Eigen::Vector3d& maximum, int group) {
  AssemblyPart part;
  part.name = name;
  part.item = "items/board";
  part.group = group;
  part.box = {minimum, maximum};
  for (int axis = 0; axis < 3; ++axis) {
    const double size = maximum[axis] - minimum[axis];
    part.limits[static_cast<std::size_t>(axis)] = {size / 2, 2 * size};
  }
  return part;
}

// `columns` uprights with shelves between them, each at a height of its own: nothing repeats, so
// that every part is an element by itself.
inline Assembly Bookcase(int columns, int shelves_each) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> shift(0, 0.5);
  Assembly bookcase;
  bookcase.name = "bookcase";
  bookcase.groups = {{"bookcase", -1}};
  bookcase.parts.push_back(Board("floor", {0, 0, 0}, {0.1 * columns, 0.3, 0.018}, 0));
  for (int column = 0; column < columns; ++column) {
    const double x = 0.1 * column;
    const std::string name = std::to_string(column);
    bookcase.parts.push_back(Board("upright " + name, {x, 0, 0.018}, {x + 0.018, 0.3, 2.018}, 0));
    if (column + 1 == columns) break;
    for (int shelf = 0; shelf < shelves_each; ++shelf) {
      const double z = 0.1 + 1.8 * (shelf + shift(random)) / shelves_each;
      bookcase.parts.push_back(Board("shelf " + name + " " + std::to_string(shelf),
                                     {x + 0.018, 0, z}, {x + 0.1, 0.3, z + 0.018}, 0));
    }
  }
  return bookcase;
}

}  // namespace mortise::parametric
