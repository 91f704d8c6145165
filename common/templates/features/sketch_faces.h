// Turns the curves of a sketch into the kernel's wires and faces. Private to this folder: it brings
// Open CASCADE's headers. Lengths in the kernel are in millimetres.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Wire.hxx>
#include <gp_Ax3.hxx>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "common/templates/features/sketch_curves.h"

namespace mortise::cad {

// A region of material in a sketch, with the role of each edge around it.
struct SketchRegion {
  TopoDS_Face face;
  std::vector<std::pair<TopoDS_Edge, std::string>> edges;
};

struct BuiltSketch {
  gp_Ax3 frame;  // mm
  std::vector<CurveLoop> loops;
  std::vector<SketchRegion> regions;  // none if it is an open path
  TopoDS_Wire path;                   // null unless it is one
};

// Returns where the sketch lies. INVALID_ARGUMENT naming "sketch.plane…" if a direction has no
// length or the x axis is along the normal. `face_frame` is that of SketchPlane::face, if there is
// one.
absl::StatusOr<gp_Ax3> FrameOf(const SketchPlane& plane, const Numbers& numbers,
                               const gp_Ax3* face_frame);

// Makes wires and faces. INVALID_ARGUMENT naming "sketch.profiles[i]" that crosses itself, another
// or has a hole outside.
absl::StatusOr<BuiltSketch> BuildSketch(std::vector<CurveLoop> loops, const gp_Ax3& frame);

// Returns a point of space in the kernel's unit.
gp_Pnt KernelPoint(const Eigen::Vector3d& metres);

}  // namespace mortise::cad
