#include "common/cad/step/step_soundness.h"

#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
#include <Eigen/Core>
#include <GProp_GProps.hxx>
#include <ShapeAnalysis_ShapeTolerance.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"
#include "common/cad/solid_box.h"

namespace mortise::cad {
namespace {

constexpr int kLargest = 1;            // which of the tolerances the kernel is to give
constexpr double kVolumeShare = 1e-2;  // of the volume, that is in doubt
constexpr double kMinFault = 1e-5;     // m; programs that draw splines are no more exact
constexpr double kMinNote = 1e-6;      // m
constexpr double kNoteShare = 1e-5;    // of the diagonal
constexpr double kMillimetre = 1e-3;   // m

double AreaOf(const TopoDS_Shape& face) {
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(face, properties);
  return std::abs(properties.Mass());
}

double LengthOf(const TopoDS_Edge& edge) {
  if (BRep_Tool::Degenerated(edge)) return 0;
  GProp_GProps properties;
  BRepGProp::LinearProperties(edge, properties);
  return std::abs(properties.Mass());
}

// m, by which an edge misses what it bounds: half of what each of its ends does, as ends miss at
// least what their edges do.
double MissOf(const TopoDS_Edge& edge) {
  double miss = 0;
  for (TopExp_Explorer end(edge, TopAbs_VERTEX); end.More(); end.Next()) {
    miss += BRep_Tool::Tolerance(TopoDS::Vertex(end.Current())) / 2;
  }
  return std::max(miss, BRep_Tool::Tolerance(edge));
}

// m³, of which one cannot say whether the solid has it: each face may lie elsewhere by what its
// edges miss it by.
double VolumeInDoubt(const TopoDS_Shape& solid) {
  double volume = 0;
  for (TopExp_Explorer face(solid, TopAbs_FACE); face.More(); face.Next()) {
    double length = 0, missed = 0;
    for (TopExp_Explorer edge(face.Current(), TopAbs_EDGE); edge.More(); edge.Next()) {
      const double one = LengthOf(TopoDS::Edge(edge.Current()));
      length += one;
      missed += one * MissOf(TopoDS::Edge(edge.Current()));
    }
    if (length > 0) volume += AreaOf(face.Current()) * missed / length;
  }
  return volume;
}

double VolumeOf(const TopoDS_Shape& solid) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(solid, properties);
  return std::abs(properties.Mass());
}

}  // namespace

Soundness SoundnessOf(const TopoDS_Shape& solid) {
  Soundness found;
  const double miss = ShapeAnalysis_ShapeTolerance().Tolerance(solid, kLargest);
  const SolidBox box = BoxOf(solid, Eigen::Matrix3d::Identity());
  const double note_from = std::max(kMinNote, kNoteShare * (box.maximum - box.minimum).norm());
  const std::string text = absl::StrFormat(
      "its faces, edges and vertices contradict each other by up to %.3g mm", miss / kMillimetre);
  if (!(miss <= kMinFault) && !(VolumeInDoubt(solid) <= kVolumeShare * VolumeOf(solid))) {
    found.fault = text;
  } else if (!BRepCheck_Analyzer(solid).IsValid()) {
    found.fault = "is no valid solid: faces that do not meet, or cross each other";
  } else if (miss > note_from) {
    found.note = text;
  }
  return found;
}

}  // namespace mortise::cad
