// An assembly as STEP has it: products placed in a tree of sub-assemblies. step_reader.h reads it
// and step_writer.h writes it.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "common/cad/solid.h"
#include "common/mesh/shapes/drawn_shape.h"

namespace mortise::cad {

// What other systems know a product by; what is empty is as the writer has it. Only written.
struct StepIdentity {
  std::string id = {};           // PRODUCT.id; the product's name if empty
  std::string revision = {};     // PRODUCT_DEFINITION_FORMATION.id
  std::string description = {};  // PRODUCT.description: what it is made of
};

// A shape that is drawn once and placed as often as there are parts of it.
struct StepProduct {
  std::string name;
  // The shape in the product's own frame, m. It is absent if another process read the file.
  std::optional<Solid> solid;
  std::optional<Eigen::Vector3d> color;  // linear red, green, blue in 0 … 1
  // How the product differs from the one that the file has under this name. Of its occurrences some
  // may be scaled or mirrored; each such is a product of its own.
  double scale = 1;
  bool is_mirrored = false;
  StepIdentity identity = {};
};

// A sub-assembly where it stands: one that is used twice is two groups.
struct StepGroup {
  std::string name;  // distinct among the groups
  int parent = -1;   // index into StepAssembly::groups; -1 for the root
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();  // in the parent's frame, m
};

// A solid where it stands.
struct StepPart {
  std::string name;                                             // distinct among the parts
  int group = 0;                                                // index into StepAssembly::groups
  int product = 0;                                              // index into StepAssembly::products
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();  // in the group's frame, m
  std::optional<Eigen::Vector3d> color;                         // of this part; else its product's
  // What follows is measured when the file is read.
  std::string drawn_name;  // as in the file, where several parts may have it
  double volume = 0;       // m³
  int faces = 0;
  // The corners of the smallest box along the axes of the assembly's frame that holds the part, m.
  Eigen::Vector3d minimum = Eigen::Vector3d::Zero();
  Eigen::Vector3d maximum = Eigen::Vector3d::Zero();
  bool is_box = false;  // whether it fills that box
  // The index into StepAssembly::shapes of its shape in that box; -1 for boxes, and if there is a
  // fault.
  int shape = -1;
  std::vector<std::string> faults;  // why it has no shape
};

// A thing that stands where a part could, but is no solid.
struct StepLeaf {
  std::string name;  // distinct among parts and leaves
  std::string drawn_name;
  std::string product;      // name of its product
  int group = 0;            // index into StepAssembly::groups
  bool is_surface = false;  // faces that enclose nothing; else only curves or points
};

struct StepAssembly {
  std::string name;
  std::string schema;             // as in FILE_SCHEMA
  std::string length_unit;        // of the file, as it calls it: "millimetre", "INCH"
  std::vector<StepGroup> groups;  // the root first, parents before their children
  std::vector<StepProduct> products;
  std::vector<StepPart> parts;           // in the order of the file
  std::vector<mesh::DrawnShape> shapes;  // of the parts: one for each product and way it is turned
  std::vector<StepLeaf> leaves;          // those that are no parts
  std::vector<std::string> notes;        // what was changed or left out, for people
  // What follows is only written.
  StepIdentity identity = {};   // of the whole
  std::string time_stamp = {};  // when what it says was made, ISO 8601 without a zone, in UTC
};

// Returns the names of the groups above a part or leaf, and its own: "frame/left/post 1".
std::string PathOf(const StepAssembly& assembly, int group, const std::string& name);

// Returns the motion from a group's frame to the assembly's.
Eigen::Isometry3d PlacementOf(const StepAssembly& assembly, int group);

// Returns one name for each of `names`, all of them distinct, in one line and of at most 63 bytes.
// Names that occur once stay as they are; the others are counted: "post 1", "post 2" … Empty ones
// are called `nameless`.
std::vector<std::string> DistinctNames(const std::vector<std::string>& names,
                                       const std::string& nameless);

}  // namespace mortise::cad
