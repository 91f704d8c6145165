// Says what is to be made: a design at given parameters, and the items it is made of, as plain
// structs.
//
// Two coordinate systems: the design's (x to the right, y to the back, z upwards) and the item's,
// whose axes are length, width and thickness of the stock.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/design/template_definition.h"

namespace mortise::fabplanner {

// The ways in which a part comes out of its stock.
enum class CutProcess {
  kNone,     // used as it is bought
  kChopSaw,  // crosscut from a board
  kJigsaw,   // outline cut from a sheet
};

using parametric::Money;  // an empty currency means that the price is not known
using parametric::StockSize;

// Boards and all other stock sold by length; sheets; pegs and rods of wood; wood screws; bolts and
// whatever else has a metric thread; nuts and washers; hinges, slides, wheels and the rest.
enum class ItemKind { kBoard, kSheet, kDowel, kScrew, kBolt, kNut, kHardware };

// The sizes that parts of an item may have along one of its axes, m; 0 and 0 where that is not
// known.
struct SizeLimits {
  double minimum = 0;
  double maximum = 0;
};

// A thing that can be bought.
struct Item {
  std::string name;   // "items/pine-45x45"
  std::string title;  // for people
  ItemKind kind = ItemKind::kHardware;
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  // m: length, width, thickness as sold
  Money price = {};
  bool price_per_volume = false;  // the price buys a cubic metre instead of a piece
  std::string supplier = {};
  std::string supplier_number = {};
  std::string supplier_url = {};
  std::array<SizeLimits, 3> limits = {};        // of length, width and thickness
  bool ripped = false;                          // to width, by a rip saw
  bool has_grain = true;                        // along its length, which outlines keep to
  bool round = false;                           // about its length, or its thickness
  bool pin = false;                             // hardware that reaches into parts like a dowel
  bool shaped = false;                          // what it looks like is known: no plain box
  std::vector<StockSize> stock = {};            // besides `size`, or with its price
  std::map<std::string, double> measures = {};  // m: "head_diameter" …
  int64_t revision = 0;                         // that the design is made of
  std::vector<std::string> external_ids = {};   // what other systems know it by
  std::string material = {};
};

// A part: a polygon extruded along an axis of the design, or else triangles.
struct Part {
  std::string name;  // identifier, unique in the design
  std::string title;
  std::string item;  // name of the item
  CutProcess process = CutProcess::kNone;
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  // m: length, width, thickness in the item's axes
  int length_axis = 0;     // design axis (0, 1, 2) along which the item's length lies
  int thickness_axis = 2;  // design axis along which the item's thickness lies

  int extrusion_axis = 2;  // axis of the extrusion; (u, v) are the next two, cyclically
  std::vector<Eigen::Vector2d> outline;  // m, counter-clockwise in (u, v), at least 3 points
  double from = 0;                       // m, start along the axis
  double to = 0;                         // m, end along the axis, > from

  // The closed surface of a part that is no prism. It has no outline then.
  Eigen::Matrix3Xd vertices = {};   // 3 × V, m
  Eigen::Matrix3Xi triangles = {};  // 3 × T, counter-clockwise seen from outside
  std::string material = {};
  double mass = 0;          // kg
  bool connecting = false;  // holds other parts together
  int group = 0;            // index into Design::groups
  std::string family = {};  // what it shares with parts that repeat it; empty for its name
  // Assembly order, lower first: of a connecting part, of the connection that it makes; of another,
  // of its coming in. 0 for where its shape lets it.
  int priority = 0;
};

// A sub-assembly. Group 0 is the whole.
struct Group {
  std::string name;
  int parent = -1;  // before it in the list
};

// A peg that joins two parts.
struct Peg {
  std::string connection;                                // the connection it belongs to
  std::string item;                                      // name of the item
  std::string part;                                      // the part that carries the face
  std::string other_part;                                // the part that touches it
  Eigen::Vector3d position = Eigen::Vector3d::Zero();    // m, where it crosses the face
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  // unit, from `part` into `other_part`
  double diameter = 0;                                   // m
  double length = 0;                                     // m
  double depth_in_part = 0;                              // m, 0 < depth < length
  int priority = 0;  // assembly order: lower first; equal ones are one step
};

struct Design {
  std::vector<Part> parts;
  std::vector<Peg> pegs;
  std::vector<Group> groups = {Group{}};
  bool is_drawn = false;  // an assembly, whose parts hold together where they touch
};

// Items by name.
using Items = std::map<std::string, Item>;

// Whether the part is given by triangles.
inline bool IsShaped(const Part& part) { return part.triangles.cols() > 0; }

// Whether the part fills its box.
bool IsBox(const Part& part);

// Returns the volume of a part, m³: for triangles, what their closed surface encloses.
double VolumeOf(const Part& part);

// Whether the part has one section all along the axis (0, 1, 2), between two square ends.
bool IsPrismAlong(const Part& part, int axis);

// Whether a cut at right angles to its thickness gives all of it: SheetOutlineOf is its outline.
bool IsUpright(const Part& part);

// Returns what people call it: its title, or its name.
const std::string& TitleOf(const Part& part);

// Returns the part's box in the design's coordinates.
Eigen::AlignedBox3d BoundsOf(const Part& part);

// Returns the part's outline as it lies on a sheet, seen from its top side: u along the item's
// length, v along its width, lower corner of the bounding rectangle at the origin,
// counter-clockwise, m. The bounding rectangle where the part is extruded along another axis than
// its thickness, or is of triangles that do not all stand upright on it or leave holes.
std::vector<Eigen::Vector2d> SheetOutlineOf(const Part& part);

}  // namespace mortise::fabplanner
