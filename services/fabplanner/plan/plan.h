// A plan says how a design is made: what planning produces, as plain structs. Lengths are in
// metres.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/end_cuts.h"

namespace mortise::fabplanner {

// Rules of the workshop, metres and radians.
struct WorkshopRules {
  double kerf = 0.003;           // width of a saw cut, >= 0
  double board_trim = 0.010;     // cut off each end of a board: 0 or at least the kerf
  double sheet_trim = 0.010;     // left off each edge of a sheet, >= 0
  double sheet_spacing = 0.010;  // least distance between outlines on a sheet, >= the kerf

  // What the machines can do.
  double mitre_limit = 50 * M_PI / 180;  // how far the chop saw's table turns to either side
  double bevel_limit = 45 * M_PI / 180;  // how far its blade tilts
  bool compound_cuts = true;             // whether it does both in one cut
  double jigsaw_radius = 0.010;          // least radius of the inner arcs that the jigsaw follows
};

// Why a machine cannot make a part as it is.
struct MachineLimit {
  // The rule that is passed: mitre_limit, bevel_limit, compound_cuts, jigsaw_radius.
  enum class Kind { kMitre, kBevel, kCompound, kRadius };
  Kind kind = Kind::kMitre;
  std::string place;   // where on the part, for people: "front end", "inner corner at 120, 40 mm"
  double value = 0;    // what the part needs: rad, or m; of kCompound the bevel
  double limit = 0;    // what the rules allow: rad, or m; of kCompound 0
  std::string reason;  // for people

  // Changes of one parameter each by which the part is made as it is: names, and values in the
  // parameters' units.
  std::vector<std::pair<std::string, double>> nearest_parameters = {};
};

// The ways in which a part is come by.
enum class Making {
  kCrosscut,   // cut to length by the chop saw
  kOutline,    // cut to outline by the jigsaw
  kBought,     // used as it is bought
  kToDrawing,  // made to a drawing, of no item
};

// Says how one part is come by; it is the same for every copy.
struct PlannedPart {
  std::string part;  // name
  Making making = Making::kBought;
  // The length, width and thickness in its item's axes; along x, y and z where there is no item.
  Eigen::Vector3d size = Eigen::Vector3d::Zero();
  std::string handwork;               // what people do to it besides; empty for nothing
  bool to_shape = false;              // what it looks like takes a drawing to tell
  std::vector<std::string> drawings;  // file names

  // Of a part that is crosscut: how its ends are cut, in its own axes. Of square stock that is
  // turned by a quarter the width counts as its thickness.
  CutEnds ends = {};
  std::vector<MachineLimit> beyond_machines = {};
};

// A part on a board. Where ends are not square it may begin before the part in front of it ends: of
// two ends that run alike, one cut makes both.
struct BoardSegment {
  std::string part;   // label
  double start = 0;   // of its foremost point, from the board's front end
  double length = 0;  // to its last point
  CutEnds ends = {};  // as it lies on the board
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

  // Of a strip that a wider plank is ripped into.
  std::string plank = {};     // the plank's label, "plank-1"; empty for a board that is not ripped
  double plank_position = 0;  // from the plank's edge to the strip's
};

// Whether an end of any of the board's parts is not square.
inline bool HasSlopedEnds(const BoardLayout& board) {
  return std::any_of(board.segments.begin(), board.segments.end(),
                     [](const BoardSegment& segment) { return !AreSquare(segment.ends); });
}

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

  // Of designs whose connectors are parts.
  std::vector<std::string> connectors;  // names of the connecting parts that come in
  std::string subassembly;              // what is built; empty for the whole
  std::vector<std::string> standing;    // parts and connectors of it that stand before the step
  // Parts that come in at once, in one piece.
  struct Move {
    std::vector<std::string> parts;                    // with their connectors
    Eigen::Vector3d way_in = Eigen::Vector3d::Zero();  // unit; zero for what the rest comes onto
  };
  std::vector<Move> moves;
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
  Money unit_price;  // of one piece; without a currency where no price is known
  Money price;       // of the line; likewise

  // Of a line without an item: what is made to drawing.
  std::vector<std::string> parts = {};  // names
  std::string material = {};
  double mass = 0;  // kg, of one
  std::vector<std::string> drawings = {};
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  // to order
};

struct Bill {
  std::vector<BillLine> lines;
  std::vector<Money> totals;  // by currency, of the lines that have a price
};

enum class BillNodeKind {
  kAssembly,     // the whole
  kSubAssembly,  // a group of it
  kPart,         // made in the workshop
  kStock,        // what a part is cut from
  kBought,       // used as it is bought
};

// A node of the bill as a tree. Leaves are what the lines of the bill are of.
struct BillNode {
  std::string id;   // its place among its siblings behind that of its parent: "1.2.1"
  int parent = -1;  // index into BillTree::nodes, before it; -1 for the whole
  BillNodeKind kind = BillNodeKind::kPart;
  std::string name;  // of the template, sub-assembly or first part, of stock and pegs of the item
  std::string title;
  double quantity = 1;             // in one of its parent; of stock the share of its pieces
  double total_quantity = 1;       // in all copies
  std::vector<std::string> parts;  // names of those that are alike and are this node, in one copy
  std::string item;                // that it is, or is made of
  int64_t item_revision = 0;
  std::vector<std::string> external_ids;  // of the template, or of what is bought
  std::string material;
  std::optional<double> mass;                      // kg, of one; nothing where it is not known
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  // of one, of stock to order
  std::string dimensions;                          // the same for people, millimetres
  std::string supplier;
  std::string supplier_number;
  std::string supplier_url;
  Money unit_price;                    // of one; without a currency where none is known
  Money price;                         // of all copies, with all below it; likewise
  std::vector<std::string> artifacts;  // files that show it
};

// The bill as a tree: the whole first, then depth first.
struct BillTree {
  std::string template_name;
  int64_t template_revision = 0;
  std::string assembly;  // that the template is of; may be empty
  int64_t assembly_revision = 0;
  int64_t effective_from = 0;  // seconds since 1970, UTC
  std::vector<BillNode> nodes;
};

enum class HoleKind { kPeg, kPilot, kClearance, kTapped };

// A hole for a peg, a screw or a bolt; the same in every copy of the part.
struct Hole {
  std::string part;                                      // name
  Eigen::Vector3d position = Eigen::Vector3d::Zero();    // in the design's coordinates
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  // unit vector into the part
  double diameter = 0;
  double depth = 0;
  HoleKind kind = HoleKind::kPeg;
  bool through = false;        // comes out at the far side
  std::string connector = {};  // the connection of a peg, or the connecting part
};

// The place where a connecting part that no screw locates lies on a part: a rectangle, in the
// design's axes.
struct Mark {
  std::string part;
  std::string connector;
  Eigen::AlignedBox3d region;
};

// Says how `quantity` copies of a design are made. Counts are over all copies; steps, holes, marks
// and parts are those of one copy.
struct FabricationPlan {
  int quantity = 1;
  WorkshopRules rules;
  std::vector<BoardLayout> boards;
  std::vector<SheetLayout> sheets;
  std::vector<AssemblyStep> steps;
  Bill bill;
  BillTree bill_tree;  // once MakeBillTree has made it
  std::vector<Hole> holes;
  std::vector<Mark> marks;
  std::vector<PlannedPart> parts;     // in the design's order
  std::vector<std::string> handwork;  // what no machine does, for people
  int chop_saw_parts = 0;
  int jigsaw_parts = 0;
  int pegs = 0;
  int planks = 0;  // that are ripped
  // Whether no layout of the boards needs fewer of them; otherwise it was not proven in time.
  bool boards_proven_optimal = true;
};

}  // namespace mortise::fabplanner
