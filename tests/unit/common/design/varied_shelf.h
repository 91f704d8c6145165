// A shelf that says everything a template can say: choices, absent parts, rows, items by condition,
// pegs in rows. Plain structs, for tests.
#pragma once

#include <string>
#include <vector>

#include "common/design/template_definition.h"

namespace mortise::parametric {

inline Material Wood(const std::string& id, double density) {
  return {.name = "materials/" + id,
          .title = id,
          .density = density,
          .youngs_modulus = 1e10,
          .poissons_ratio = 0.3,
          .strength = 4e7};
}

inline Item ItemOf(const std::string& id, ItemKind kind, const std::string& material) {
  Item item;
  item.name = "items/" + id;
  item.title = id;
  item.kind = kind;
  item.material = "materials/" + material;
  return item;
}

// Cut to any length, width and thickness from 5 mm to 10 m.
inline Item Board(const std::string& id, const std::string& material) {
  Item item = ItemOf(id, ItemKind::kBoard, material);
  item.dimensions[0] = {10, Process::kChopSaw, 0.005, 10};
  item.dimensions[1] = {2, Process::kMill, 0.005, 2};
  item.dimensions[2] = {2, Process::kMill, 0.005, 2};
  return item;
}

inline Item Peg(const std::string& id, double diameter, double length) {
  Item item = ItemOf(id, ItemKind::kDowel, "oak");
  item.dimensions[0] = {length};
  item.dimensions[1] = {diameter};
  item.dimensions[2] = {diameter};
  return item;
}

inline Parameter Number(const std::string& name, const std::string& unit, double minimum,
                        double maximum, double value, double step = 0) {
  return {.name = name,
          .title = name,
          .description = "",
          .unit = unit,
          .minimum = minimum,
          .maximum = maximum,
          .default_value = value,
          .step = step};
}

inline Parameter Choice(const std::string& name, std::vector<std::string> choices,
                        double value = 0) {
  return {.name = name,
          .title = name,
          .description = "",
          .unit = "1",
          .minimum = 0,
          .maximum = static_cast<double>(choices.size()) - 1,
          .default_value = value,
          .step = 1,
          .choices = std::move(choices)};
}

inline PartTemplate BoxPart(const std::string& name, Extent x, Extent y, Extent z) {
  return {.name = name,
          .title = name,
          .item = "items/pine",
          .length_axis = Axis::kX,
          .thickness_axis = Axis::kZ,
          .body = Box{std::move(x), std::move(y), std::move(z)}};
}

inline Connection Pegs(const std::string& name, const std::string& part, const std::string& face,
                       const std::string& other) {
  return {.name = name,
          .part = part,
          .face = face,
          .other_part = other,
          .item = "items/peg",
          .priority = 1,
          .end_distance = 0.03,
          .spacing = 0.1,
          .depth_in_part = 0.5};
}

// Two sides, shelves between them one above the other, a top that may be left out, and a back of
// slats, each 1 mm shorter than the one before. Pegs join shelves to sides.
inline TemplateBundle VariedShelf() {
  TemplateBundle bundle;
  bundle.materials = {Wood("oak", 700), Wood("pine", 450)};
  bundle.items = {Board("oak", "oak"), Board("pine", "pine"), Peg("peg", 0.008, 0.03),
                  Peg("thin-peg", 0.005, 0.02)};
  TemplateDefinition& shelf = bundle.definition;
  shelf.name = "templates/varied-shelf";
  shelf.title = "Varied shelf";
  shelf.parameters = {Number("width", "m", 0.5, 1.2, 0.8), Number("depth", "m", 0.2, 0.4, 0.25),
                      Number("shelves", "1", 1, 6, 3, 1), Choice("top", {"none", "flat"}),
                      Choice("wood", {"pine", "oak"})};
  shelf.parts = {
      BoxPart("left", {"0", "0.02"}, {"0", "depth"}, {"0", "0.3 * shelves"}),
      BoxPart("right", {"width - 0.02", "width"}, {"0", "depth"}, {"0", "0.3 * shelves"}),
      BoxPart("shelf", {"0.02", "width - 0.02"}, {"0", "depth"}, {"0.1", "0.12"}),
      BoxPart("top", {"0", "width"}, {"0", "depth"}, {"0.3 * shelves", "0.3 * shelves + 0.02"}),
      BoxPart("slat", {"0", "width - 0.001 * k"}, {"depth", "depth + 0.01"}, {"0", "0.05"})};
  shelf.parts[2].repeat = {{"shelves", "", "", "0.3"}};
  shelf.parts[2].items = {{"wood == 'oak'", "items/oak"}};
  shelf.parts[3].present = "top == 'flat'";
  shelf.parts[4].present = "depth > 0.22 or top == 'flat'";
  shelf.parts[4].repeat = {{"floor(shelves * 3.5)", "", "", "0.06", "k"}};
  shelf.connections = {
      Pegs("left_shelf", "shelf", "x_min", "left"), Pegs("right_shelf", "shelf", "x_max", "right"),
      Pegs("top_left", "top", "z_min", "left"), Pegs("slats", "slat", "y_min", "left")};
  shelf.connections[0].row_spacing = 0;
  shelf.connections[1].items = {{"wood == 'oak'", "items/thin-peg"}};
  shelf.connections[2].present = "top == 'flat'";
  shelf.connections[3].present = "depth > 0.22 or top == 'flat'";
  shelf.connections[3].item = "items/thin-peg";
  shelf.connections[3].end_distance = 0.01;
  shelf.connections[3].spacing = 0.02;
  shelf.boundary_conditions = {
      {"floor", BoundaryConditionKind::kFixed, "left", "z_min", {}, ""},
      {"books", BoundaryConditionKind::kForce, "shelf", "z_max", {"0", "0", "-300"}, ""},
      {"vase",
       BoundaryConditionKind::kForce,
       "top",
       "z_max",
       {"0", "0", "-20"},
       "",
       "top == 'flat'"},
      {"first", BoundaryConditionKind::kPressure, "shelf 1", "z_max", {"100 * width"}, ""}};
  return bundle;
}

}  // namespace mortise::parametric
