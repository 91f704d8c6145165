// A small table to test with: four legs, four aprons, a top; pegs in two priorities.
#pragma once

#include "services/fabplanner/plan/design.h"

namespace mortise::fabplanner {

inline Part BoxPart(const std::string& name, const std::string& item, CutProcess process,
                    const Eigen::Vector3d& lower, const Eigen::Vector3d& upper, int length_axis,
                    int thickness_axis) {
  Part part;
  part.name = name;
  part.title = name;
  part.item = item;
  part.process = process;
  part.length_axis = length_axis;
  part.thickness_axis = thickness_axis;
  const Eigen::Vector3d extent = upper - lower;
  part.size = {extent[length_axis], extent[3 - length_axis - thickness_axis],
               extent[thickness_axis]};
  part.outline = {{lower.x(), lower.y()},
                  {upper.x(), lower.y()},
                  {upper.x(), upper.y()},
                  {lower.x(), upper.y()}};
  part.from = lower.z();
  part.to = upper.z();
  return part;
}

inline Items ExampleItems() {
  Items items;
  items["items/leg-45"] = {.name = "items/leg-45",
                           .title = "Planed pine 45 × 45",
                           .kind = ItemKind::kBoard,
                           .size = {2.4, 0.045, 0.045},
                           .price = {"EUR", 9.5},
                           .supplier = "Timber, Nails & \"Co\"",
                           .supplier_number = "P-4545",
                           .supplier_url = "https://example.com/p"};
  items["items/apron-20"] = {.name = "items/apron-20",
                             .title = "Planed pine 20 × 90",
                             .kind = ItemKind::kBoard,
                             .size = {2.4, 0.09, 0.02},
                             .price = {"EUR", 1500},
                             .price_per_volume = true};
  items["items/plywood-18"] = {.name = "items/plywood-18",
                               .title = "Birch plywood 18",
                               .kind = ItemKind::kSheet,
                               .size = {2.5, 1.25, 0.018},
                               .price = {"EUR", 89}};
  items["items/dowel-8x35"] = {.name = "items/dowel-8x35",
                               .title = "Beech dowel",
                               .kind = ItemKind::kDowel,
                               .size = {0.035, 0.008, 0.008},
                               .price = {"EUR", 0.042}};
  items["items/screw-4x40"] = {.name = "items/screw-4x40",
                               .title = "Wood screw 4 × 40",
                               .kind = ItemKind::kScrew,
                               .size = {0.04, 0.004, 0.004},
                               .price = {"EUR", 0.05},
                               .round = true};
  return items;
}

// Joins `part` to `other_part` at `position` along `direction` by one peg.
inline Peg MakePeg(const std::string& connection, const std::string& part,
                   const std::string& other_part, const Eigen::Vector3d& position,
                   const Eigen::Vector3d& direction, double depth_in_part, int priority) {
  return {connection, "items/dowel-8x35", part,    other_part, position, direction, 0.008,
          0.035,      depth_in_part,      priority};
}

inline Design ExampleTable() {
  const double length = 1.2, width = 0.7, height = 0.72, leg = 0.045, apron = 0.09, thick = 0.02;
  Design design;
  const auto leg_at = [&](const std::string& name, double x, double y) {
    design.parts.push_back(BoxPart(name, "items/leg-45", CutProcess::kChopSaw, {x, y, 0},
                                   {x + leg, y + leg, height}, 2, 0));
  };
  leg_at("leg_1", 0, 0);
  leg_at("leg_2", length - leg, 0);
  leg_at("leg_3", length - leg, width - leg);
  leg_at("leg_4", 0, width - leg);
  const auto along_x = [&](const std::string& name, double y) {
    design.parts.push_back(BoxPart(name, "items/apron-20", CutProcess::kChopSaw,
                                   {leg, y, height - apron}, {length - leg, y + thick, height}, 0,
                                   1));
  };
  along_x("apron_front", 0.0125);
  along_x("apron_back", width - 0.0125 - thick);
  const auto along_y = [&](const std::string& name, double x) {
    design.parts.push_back(BoxPart(name, "items/apron-20", CutProcess::kChopSaw,
                                   {x, leg, height - apron}, {x + thick, width - leg, height}, 1,
                                   0));
  };
  along_y("apron_left", 0.0125);
  along_y("apron_right", length - 0.0125 - thick);
  design.parts.push_back(BoxPart("top", "items/plywood-18", CutProcess::kJigsaw,
                                 {-0.05, -0.05, height},
                                 {length + 0.05, width + 0.05, height + 0.018}, 0, 2));

  const auto join = [&](const std::string& apron_name, const std::string& leg_name, bool at_start,
                        int priority) {
    const Part* part = nullptr;
    for (const Part& candidate : design.parts) {
      if (candidate.name == apron_name) part = &candidate;
    }
    const Eigen::AlignedBox3d box = BoundsOf(*part);
    Eigen::Vector3d position = box.center();
    position[part->length_axis] =
        at_start ? box.min()[part->length_axis] : box.max()[part->length_axis];
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();
    direction[part->length_axis] = at_start ? -1 : 1;
    for (double offset : {-0.025, 0.025}) {
      Eigen::Vector3d place = position;
      place.z() += offset;
      design.pegs.push_back(MakePeg(apron_name + "_" + leg_name, apron_name, leg_name, place,
                                    direction, 0.021, priority));
    }
  };
  join("apron_front", "leg_1", true, 1);
  join("apron_front", "leg_2", false, 1);
  join("apron_back", "leg_4", true, 1);
  join("apron_back", "leg_3", false, 1);
  join("apron_left", "leg_1", true, 2);
  join("apron_left", "leg_4", false, 2);
  join("apron_right", "leg_2", true, 2);
  join("apron_right", "leg_3", false, 2);
  for (const std::string apron_name : {"apron_front", "apron_back"}) {
    const double y = apron_name == "apron_front" ? 0.0225 : width - 0.0225;
    for (double x : {0.2, 0.6, 1.0}) {
      design.pegs.push_back(MakePeg("top_" + apron_name, "top", apron_name, {x, y, height},
                                    -Eigen::Vector3d::UnitZ(), 0.011, 3));
    }
  }
  return design;
}

// A screw from `head` along an axis, upwards or downwards, by its length.
inline Part ScrewPart(const std::string& name, const Eigen::Vector3d& head, int axis, int sign,
                      double length = 0.04, double diameter = 0.004,
                      const std::string& item = "items/screw-4x40") {
  Eigen::Vector3d tip = head;
  tip[axis] += sign * length;
  Eigen::Vector3d half = Eigen::Vector3d::Constant(diameter / 2);
  half[axis] = 0;
  Part part = BoxPart(name, item, CutProcess::kNone, head.cwiseMin(tip) - half,
                      head.cwiseMax(tip) + half, axis, (axis + 2) % 3);
  part.connecting = true;
  return part;
}

// Two sides with two shelves between them, all of plywood, each shelf held by a screw at either
// end.
inline Design ExampleRack() {
  const double width = 0.6, depth = 0.3, height = 0.8, thick = 0.018;
  Design design;
  const auto add_board = [&](const std::string& name, const Eigen::Vector3d& lower,
                             const Eigen::Vector3d& upper, int length_axis, int thickness_axis) {
    design.parts.push_back(BoxPart(name, "items/plywood-18", CutProcess::kJigsaw, lower, upper,
                                   length_axis, thickness_axis));
  };
  add_board("side 1", {0, 0, 0}, {thick, depth, height}, 2, 0);
  add_board("side 2", {width - thick, 0, 0}, {width, depth, height}, 2, 0);
  for (int i = 1; i <= 2; ++i) {
    const double z = 0.3 * i;
    const std::string shelf = "shelf " + std::to_string(i);
    add_board(shelf, {thick, 0, z}, {width - thick, depth, z + thick}, 0, 2);
    design.parts.push_back(ScrewPart(shelf + " screw left", {0, depth / 2, z + thick / 2}, 0, 1));
    design.parts.push_back(
        ScrewPart(shelf + " screw right", {width, depth / 2, z + thick / 2}, 0, -1));
  }
  return design;
}

}  // namespace mortise::fabplanner
