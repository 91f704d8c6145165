#include "common/cad/step_soundness.h"

#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <Eigen/Core>
#include <GProp_GProps.hxx>
#include <ShapeAnalysis_ShapeTolerance.hxx>
#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"
#include "common/cad/solid_box.h"

namespace mortise::cad {
namespace {

constexpr int kLargest = 1;            // which of the tolerances the kernel is to give
constexpr double kVolumeShare = 1e-2;  // of the volume, that is in doubt
constexpr double kLeastFault = 1e-5;   // m; programs that draw splines are no more exact
constexpr double kLeastNote = 1e-6;    // m
constexpr double kNoteShare = 1e-5;    // of the diagonal
constexpr double kMillimetre = 1e-3;   // m

double AreaOf(const TopoDS_Shape& solid) {
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(solid, properties);
  return std::abs(properties.Mass());
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
  const double note_from = std::max(kLeastNote, kNoteShare * (box.maximum - box.minimum).norm());
  const std::string text = absl::StrFormat(
      "its faces, edges and vertices contradict each other by up to %.3g mm", miss / kMillimetre);
  if (!(miss <= kLeastFault) && !(miss * AreaOf(solid) <= kVolumeShare * VolumeOf(solid))) {
    found.fault = text;
  } else if (!BRepCheck_Analyzer(solid).IsValid()) {
    found.fault = "is no valid solid: faces that do not meet, or cross each other";
  } else if (miss > note_from) {
    found.note = text;
  }
  return found;
}

}  // namespace mortise::cad
