// Templates, items and materials as plain structs: what an expert writes, before evaluation.
// They mirror mortise/v1/item.proto and template.proto, where every field is described;
// template_codec.h converts.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace mortise::terrain {
class HeightField;
}

namespace mortise::parametric {

// A coordinate axis. X is the design's width, Y its depth, Z points upwards; for items X is the
// length, Y the width, Z the thickness.
enum class Axis { kX = 0, kY = 1, kZ = 2 };

// Returns "x", "y" or "z".
const char* AxisName(Axis axis);

// How a dimension of an item is brought to size; kNone if it is fixed.
enum class Process { kNone = 0, kChopSaw = 1, kJigsaw = 2, kMill = 3, kRipSaw = 4 };

enum class ItemKind {
  kBoard = 1,
  kSheet = 2,
  kDowel = 3,
  kScrew = 4,
  kHardware = 5,
  kBolt = 6,
  kNut = 7,
  kWasher = 8,
  kHinge = 9,
  kBracket = 10,
  kDrawerSlide = 11,
  kBearing = 12,
  kWheel = 13,
  kThreadedRod = 14,
  kProfile = 15,
  kTube = 16,
};

enum class PriceBasis { kPerPiece = 1, kPerVolume = 2 };

// Elasticity of a material with a grain: L along it, R across the growth rings, T along them.
struct OrthotropicElasticity {
  double youngs_modulus_l = 0;  // Pa
  double youngs_modulus_r = 0;
  double youngs_modulus_t = 0;
  double shear_modulus_lr = 0;  // Pa
  double shear_modulus_lt = 0;
  double shear_modulus_rt = 0;
  double poissons_ratio_lr = 0;  // contraction along R over stretch along L under stress along L
  double poissons_ratio_lt = 0;
  double poissons_ratio_rt = 0;
};

struct Material {
  std::string name;  // materials/{id}
  std::string title;
  double density = 0;         // kg/m³
  double youngs_modulus = 0;  // Pa
  double poissons_ratio = 0;
  double strength = 0;              // Pa
  double thermal_conductivity = 0;  // W/(m·K); 0 where unknown
  double thermal_expansion = 0;     // 1/K; 0 where unknown
  int64_t revision = 0;
  std::optional<OrthotropicElasticity> orthotropic = {};  // of what has a grain
  std::optional<bool> grain = {};                         // which parts keep their direction to

  // Whether the material may have a grain: it may where nothing is said.
  bool HasGrain() const { return grain.value_or(true); }
};

struct ItemDimension {
  double size = 0;  // m, as sold; stock length for a dimension that is cut
  Process process = Process::kNone;
  double minimum = 0;     // m, of a resizable dimension
  double maximum = 0;     // m
  std::string name = {};  // "diameter"; "length", "width" or "thickness" by axis if empty
  double nominal = 0;     // m, what it is called in the trade; 0 where that is its size
};

// A fixed dimension besides those of the bounding box, such as "bore_diameter".
struct ItemMeasure {
  std::string name;
  double size = 0;     // m, nominal
  double minimum = 0;  // m, smallest permitted; 0 if not stated
  double maximum = 0;  // m, largest permitted; 0 if not stated
};

// A size that an item is sold in.
struct StockSize {
  double length = 0;                 // m
  double width = 0;                  // m; 0 for what is sold by length
  std::optional<double> price = {};  // of a piece, in the currency of the item's; if it is known
};

struct SupplierLink {
  std::string supplier;
  std::string url;
  std::string number;
};

struct Money {
  std::string currency;  // ISO 4217
  double amount = 0;     // whole units
};

struct Item {
  std::string name;  // items/{id}
  std::string title;
  ItemKind kind = ItemKind::kHardware;
  std::string material;                     // materials/{id}
  std::array<ItemDimension, 3> dimensions;  // by Axis: length, width, thickness
  Money price;
  PriceBasis price_basis = PriceBasis::kPerPiece;
  std::string price_date;  // ISO 8601
  std::string supplier;
  std::string supplier_url;
  std::string supplier_number;
  int64_t revision = 0;
  bool price_is_example = false;
  std::string standard = {};     // "ISO 4014"
  std::string designation = {};  // "ISO 4014 - M8 x 40 - 8.8"
  std::vector<ItemMeasure> measures = {};
  std::vector<StockSize> stock_sizes = {};
  std::vector<SupplierLink> more_suppliers = {};
  std::optional<Axis> grain_axis = {};   // along which the material's L lies; X if none
  std::optional<Axis> radial_axis = {};  // along which its R lies; Z if none
  std::string shape = {};                // shapes/{digest}, in the item's axes; empty for none
};

struct Parameter {
  std::string name;  // identifier of expressions
  std::string title;
  std::string description;
  std::string unit;  // "m"; "1" where dimensionless
  double minimum = 0;
  double maximum = 0;
  double default_value = 0;
  double step = 0;  // 0 for none
  std::vector<std::string> choices =
      {};  // names of the values 0, 1 … of a choice, which have no order

  bool IsChoice() const { return !choices.empty(); }
};

// An interval along an axis, m, as expressions.
struct Extent {
  std::string from;
  std::string to;
};

// Faces: x_min, x_max, y_min, y_max, z_min, z_max.
struct Box {
  Extent x, y, z;
};

struct OutlinePoint {
  std::string u;  // expression, m
  std::string v;
};

// A polygon, counter-clockwise in (u, v), extruded along `axis`. (u, v) are (y, z), (z, x) or (x,
// y) for X, Y, Z. Faces: base (at `from`), cap (at `to`), side0, side1 … (edge i: point i to i +
// 1).
struct Prism {
  Axis axis = Axis::kZ;
  std::vector<OutlinePoint> outline;
  Extent extent;
};

// Copies of a part along a direction.
struct PartRepeat {
  std::string count;       // expression, of the part in all
  std::string x, y, z;     // expressions, m, from one copy to the next; 0 where empty
  std::string index = {};  // name of the copy's number in the part's body; empty where not needed
};

// An item that is taken where a condition holds.
struct ConditionalItem {
  std::string when;  // expression, a condition
  std::string item;  // items/{id}
};

struct PartTemplate {
  std::string name;
  std::string title;
  std::string item;                // items/{id}
  Axis length_axis = Axis::kX;     // design axis along which the item's X lies
  Axis thickness_axis = Axis::kZ;  // design axis along which the item's Z lies
  std::variant<Box, Prism> body;
  std::string present = {};                 // expression, a condition; always if empty
  std::vector<PartRepeat> repeat = {};      // at most two directions
  std::vector<ConditionalItem> items = {};  // instead of `item`, the first of which holds
};

// Which copies are joined where parts are repeated.
enum class Pairing {
  kUnspecified = 0,  // each copy with the other part; as kByNumber where both are repeated
  kByNumber = 1,
  kTouching = 2,
};

// Rows of pegs where `face` of `part` touches `other_part`. A part that is repeated is meant with
// all of its copies, or with one that is named: "slat 1".
struct Connection {
  std::string name;
  std::string part;
  std::string face;
  std::string other_part;
  std::string item;          // items/{id} of the peg
  int priority = 0;          // assembly order: lower first
  double end_distance = 0;   // m, from the ends of the patch to the first and last peg
  double spacing = 0;        // m, largest distance between neighbours
  double depth_in_part = 0;  // fraction of the peg's length in `part`
  std::string present = {};  // expression, a condition; always if empty
  Pairing pairing = Pairing::kUnspecified;
  std::vector<ConditionalItem> items = {};  // instead of `item`, the first of which holds
  double row_spacing = 0;    // m, largest distance between neighbouring rows; 0 for one row
  double side_distance = 0;  // m, from the sides of the patch to the outer rows; 0: end_distance
};

enum class BoundaryConditionKind {
  kFixed = 1,
  kForce = 2,
  kPressure = 3,
  kHeatFlux = 4,
  kTemperature = 5,
  kConvection = 6,
  kSymmetric = 7,
  kDisplacement = 8,
  kGravity = 9,
  kRotation = 10,
};

struct BoundaryCondition {
  std::string name;
  BoundaryConditionKind kind = BoundaryConditionKind::kFixed;
  std::string part;                     // empty for the whole body
  std::string face;                     // likewise
  std::vector<std::string> components;  // expressions, as many as the kind has
  std::string load_case;                // of a load; empty where it acts in every one
  std::string present = {};             // expression, a condition; always if empty
};

// Ground that a design stands on.
struct Ground {
  std::string name;  // identifier of expressions
  std::string title;
  std::shared_ptr<const terrain::HeightField> heights;  // m, the datum taken off
};

struct TemplateDefinition {
  std::string name;  // templates/{id}
  int64_t revision = 0;
  std::string title;
  std::string description;
  std::vector<Parameter> parameters;
  std::vector<PartTemplate> parts;
  std::vector<Connection> connections;
  std::vector<BoundaryCondition> boundary_conditions;
  std::string reference_temperature = {};  // expression, K; empty if there is no thermal stress
  std::string digest;                      // SHA-256 of the content
  std::vector<Ground> grounds = {};
};

// A template with every item and material it uses: all that F(q) needs.
struct TemplateBundle {
  TemplateDefinition definition;
  std::vector<Item> items;
  std::vector<Material> materials;
};

// What the copies of a repeated part are called: "slat 1", "slat 2" …, in a grid "slat 1.1", "slat
// 1.2" ….
// Returns the name of a copy from its numbers, counted from 1, along each direction; that of the
// part where there are none.
std::string CopyName(std::string_view part, std::span<const int> numbers);

// A part of a template, or one of its copies.
struct CopyReference {
  std::string part;
  std::vector<int> numbers;  // from 1, along each direction; none for the part
};

// Reads a name; nothing if what follows a blank is no numbers from 1 to 1000 such as "3" or "2.7".
std::optional<CopyReference> ReadCopyName(std::string_view name);

// Returns the item or material of this resource name; null if it is not there.
const Item* FindItem(const std::vector<Item>& items, const std::string& name);
const Material* FindMaterial(const std::vector<Material>& materials, const std::string& name);

}  // namespace mortise::parametric
