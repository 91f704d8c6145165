// A body under construction whose faces know where they come from. Private to this folder: it
// brings Open CASCADE's headers.
//
// The kernel tells after each operation what became of each face (Modified, IsDeleted); names
// follow it. Faces are kept as lists, for an operation may split a face or merge several into one.
// Lengths are in millimetres here, for which the kernel's tolerances are made.
#pragma once

#include <BRepBuilderAPI_MakeShape.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <map>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/templates/features/cad_template.h"
#include "common/templates/features/feature_reference.h"

namespace mortise::cad {

inline constexpr double kModelScale = 1000;  // mm in the kernel for one metre outside

struct NamedFaces {
  FaceName name;
  std::vector<TopoDS_Face> faces;  // as the body's shape has them; empty once all are gone
  std::string removed_by;          // the feature that removed the last one, or "a' or 'b"
};

struct NamedBody {
  std::string name;    // of the feature that made it
  TopoDS_Shape shape;  // never inside out
  std::vector<NamedFaces> names;
};

// Replaces the shape of `body` by `result`, which `operation` made of it, and lets names follow.
// Faces of the result that no name leads to get the name `made`.
void Follow(BRepBuilderAPI_MakeShape& operation, const TopoDS_Shape& result, const FaceName& made,
            NamedBody& body);

// Unites, cuts or intersects `body` with `tools`, whose names it takes over. `feature` is what does
// it (or "a' or 'b" if several do). INVALID_ARGUMENT without a field if the kernel cannot, or
// nothing is left.
absl::Status Combine(Operation operation, const std::vector<NamedBody>& tools,
                     const std::string& feature, NamedBody& body);

// Returns a copy elsewhere: instance `instance` of the pattern `pattern`. `placement` is a rigid
// motion.
NamedBody CopyOf(const NamedBody& body, const gp_Trsf& placement, const std::string& pattern,
                 int instance);

// The state that references are looked up in.
struct ModelState {
  std::vector<NamedBody> bodies;
  struct Pattern {
    std::string source;  // the feature that is repeated
    int count = 1;
  };
  std::map<std::string, Pattern> patterns;
};

struct FoundFaces {
  std::size_t body = 0;
  std::vector<TopoDS_Face> faces;  // at least one
};

struct FoundEdges {
  std::size_t body = 0;
  std::vector<TopoDS_Edge> edges;       // at least one
  std::vector<std::string> references;  // that mean each of them, the first if several do
};

// Returns what references mean at this state. INVALID_ARGUMENT, naming `field` with the index of
// the reference, that says why one means nothing: the feature that removed its faces, a pattern
// with fewer instances, faces that do not meet, several bodies.
absl::StatusOr<FoundFaces> FindFaces(const ModelState& state,
                                     const std::vector<std::string>& references,
                                     const std::string& field);
absl::StatusOr<FoundEdges> FindEdges(const ModelState& state,
                                     const std::vector<std::string>& references,
                                     const std::string& field);

}  // namespace mortise::cad
