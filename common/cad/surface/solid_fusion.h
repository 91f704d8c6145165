// Makes a general fuse of solids and tells what came of it. Private to this folder: it brings Open
// CASCADE.
#pragma once

#include <BOPAlgo_Builder.hxx>
#include <TopTools_DataMapOfShapeInteger.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "common/cad/solid.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::cad {

// A solid of its own, so that the kernel may keep triangles in it.
struct FusedPart {
  std::string name;
  TopoDS_Shape solid;
  std::vector<TopoDS_Face> faces;
  std::vector<std::string> face_names;  // of each face
  double diagonal = 0;                  // m, of its box
};

FusedPart CopyOf(const Solid& solid);

// A face of the fused assembly as the part of lowest index sees it.
struct FusedFace {
  TopoDS_Face face;  // oriented outwards from back_part
  mesh::AssemblyFace description;
};

// Two parts that are in the same place.
struct Overlap {
  int first = 0;
  int second = 0;
  double depth = 0;  // m, twice the volume of what is in both over its surface: a slab's thickness
};

class SolidFusion {
 public:
  // Fuses the parts; vertices, edges and faces nearer than `tolerance`, m, become one. The parts
  // must outlive it. Parts that overlap are told of by overlaps(), and there are no faces then.
  // INVALID_ARGUMENT naming "parts[i]"; INTERNAL if the kernel reports an error.
  static absl::StatusOr<SolidFusion> Create(const std::vector<FusedPart>& parts, double tolerance);

  const std::vector<Overlap>& overlaps() const { return overlaps_; }
  const std::vector<FusedFace>& faces() const { return faces_; }

  // Whether two parts have a face, an edge or a vertex in common.
  bool Meet(int first, int second) const;

  // Whether two of faces() have an edge or a vertex in common.
  bool Touch(int first, int second) const;

 private:
  SolidFusion() = default;
  void FindOverlaps(const std::vector<std::vector<TopoDS_Shape>>& pieces);
  absl::Status CollectFaces(int part, const FusedPart& source, const TopoDS_Shape& piece);
  void NameFaces(int part, const FusedPart& source, BOPAlgo_Builder& fuse);
  void NoteMeetings(const std::vector<std::vector<TopoDS_Shape>>& pieces);
  void NoteCorners();

  std::vector<Overlap> overlaps_;
  std::vector<FusedFace> faces_;
  TopTools_DataMapOfShapeInteger index_;  // of a face, whatever its orientation
  std::set<std::pair<int, int>> meeting_;
  std::vector<std::vector<int>> corners_;  // of each face, the vertices in rising order
};

}  // namespace mortise::cad
