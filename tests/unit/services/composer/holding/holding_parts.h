// Boards and fasteners for the tests of whether models hold.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "services/composer/holding/joints.h"
#include "tests/unit/common/assembly/model/assemblies.h"

namespace mortise::composer {

inline constexpr double kWood = 700;  // kg/m³

inline std::vector<parametric::Material> TestMaterials() {
  parametric::Material wood, steel;
  wood.name = "materials/wood";
  wood.density = kWood;
  steel.name = "materials/steel";
  steel.density = 7850;
  return {wood, steel};
}

inline parametric::Item TestItem(const std::string& name, parametric::ItemKind kind,
                                 const std::string& material, double diameter) {
  parametric::Item item;
  item.name = name;
  item.kind = kind;
  item.material = material;
  item.dimensions[1].size = diameter;
  item.dimensions[2].size = diameter;
  return item;
}

inline std::vector<parametric::Item> TestItems() {
  using parametric::ItemKind;
  return {TestItem("items/board", ItemKind::kBoard, "materials/wood", 0),
          TestItem("items/panel", ItemKind::kSheet, "materials/wood", 0),
          TestItem("items/plate", ItemKind::kSheet, "materials/steel", 0),
          TestItem("items/fastener-screw", ItemKind::kScrew, "materials/steel", 0.004),
          TestItem("items/fastener-dowel", ItemKind::kDowel, "materials/wood", 0.008),
          TestItem("items/fastener-bracket", ItemKind::kBracket, "materials/steel", 0)};
}

inline JoinedPart Joined(const std::string& name, const Eigen::Vector3d& minimum,
                         const Eigen::Vector3d& maximum) {
  JoinedPart part;
  part.name = name;
  part.box = {minimum, maximum};
  return part;
}

// A pin along z whose axis is at (x, y), from one height to another.
inline Fastener Pin(const std::string& name, FastenerKind kind, double diameter, double x, double y,
                    double from, double to) {
  Fastener pin;
  pin.name = name;
  pin.item = "items/" + name;
  pin.kind = kind;
  pin.axis = 2;
  pin.diameter = diameter;
  const double r = diameter / 2;
  pin.box = {{x - r, y - r, from}, {x + r, y + r, to}};
  return pin;
}

inline Fastener Bracket(const std::string& name, const Eigen::Vector3d& minimum,
                        const Eigen::Vector3d& maximum) {
  Fastener bracket;
  bracket.name = name;
  bracket.item = "items/" + name;
  bracket.item_kind = parametric::ItemKind::kBracket;
  bracket.box = {minimum, maximum};
  return bracket;
}

}  // namespace mortise::composer
