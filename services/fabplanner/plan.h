// How a design is made: what planning produces, as plain structs. Lengths in metres.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "services/fabplanner/design.h"

namespace mortise::fabplanner {

// Rules of the workshop, metres.
struct WorkshopRules {
  double kerf = 0.003;           // width of a saw cut, >= 0
  double board_trim = 0.010;     // cut off each end of a board: 0 or at least the kerf
  double sheet_trim = 0.010;     // left off each edge of a sheet, >= 0
  double sheet_spacing = 0.010;  // least distance between outlines on a sheet, >= the kerf
};

// A part on a board.
struct BoardSegment {
  std::string part;  // label
  double start = 0;  // from the board's front end
  double length = 0;
};

// A board and what is cut from it, from its front end.
struct BoardLayout {
  std::string label;  // "board-1"
  std::string item;
  double width = 0;
  double thickness = 0;
  double stock_length = 0;
  std::vector<BoardSegment> segments;
  double offcut = 0;  // left over at the far end
};

// An outline on a sheet.
struct SheetPlacement {
  std::string part;                      // label
  std::vector<Eigen::Vector2d> outline;  // in the sheet's coordinates, counter-clockwise
};

// A sheet and what is cut from it, in cutting order.
struct SheetLayout {
  std::string label;  // "sheet-1"
  std::string item;
  double length = 0;  // along u
  double width = 0;   // along v
  double thickness = 0;
  std::vector<SheetPlacement> placements;
};

// Parts that one step joins, with the pegs between them.
struct StepConnection {
  std::string name;
  std::string part;
  std::string other_part;
  std::string item;  // of the pegs
  int pegs = 0;
};

// A step of the assembly.
struct AssemblyStep {
  int number = 0;                        // 1, 2, 3 …
  int priority = 0;                      // of the connections it makes
  std::vector<std::string> added_parts;  // names of the parts that come in
  std::vector<StepConnection> connections;
  int pegs = 0;
  std::string instruction;  // for people
};

// A line of the bill of materials.
struct BillLine {
  std::string item;
  std::string title;
  double quantity = 0;     // pieces
  std::string dimensions;  // size to order, for people, millimetres
  std::string supplier;
  std::string supplier_number;
  std::string supplier_url;
  Money unit_price;  // of one piece
  Money price;       // of the line
};

struct Bill {
  std::vector<BillLine> lines;
  Money total;
};

// A hole for a peg; the same in every copy of the part.
struct Hole {
  std::string part;                                      // name
  Eigen::Vector3d position = Eigen::Vector3d::Zero();    // in the design's coordinates
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  // unit vector into the part
  double diameter = 0;
  double depth = 0;
};

// How `quantity` copies of a design are made. Counts are over all copies; steps and holes are those
// of one copy.
struct FabricationPlan {
  int quantity = 1;
  WorkshopRules rules;
  std::vector<BoardLayout> boards;
  std::vector<SheetLayout> sheets;
  std::vector<AssemblyStep> steps;
  Bill bill;
  std::vector<Hole> holes;
  int chop_saw_parts = 0;
  int jigsaw_parts = 0;
  int pegs = 0;
  // Whether no layout of the boards needs fewer of them; otherwise it was not proven in time.
  bool boards_proven_optimal = true;
};

}  // namespace mortise::fabplanner
