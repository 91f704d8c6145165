// The curves of a sketch at given parameters, in its plane: what its profiles come to when all
// expressions have values, corners are rounded and arcs are found.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/base/field_violations.h"
#include "common/templates/features/cad_template.h"
#include "common/templates/features/feature_numbers.h"

namespace mortise::cad {

enum class CurveKind { kLine, kArc, kCircle };

struct SketchCurve {
  std::string role;  // "outline.right"; "bore" of a circle
  CurveKind kind = CurveKind::kLine;
  Eigen::Vector2d from = Eigen::Vector2d::Zero();  // m
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
  Eigen::Vector2d through = Eigen::Vector2d::Zero();  // of an arc, between its ends
  Eigen::Vector2d center = Eigen::Vector2d::Zero();   // of a circle
  double radius = 0;                                  // of a circle
};

struct CurveLoop {
  std::string profile;
  std::string hole_of;
  std::vector<SketchCurve> curves;  // end to end
  bool open = false;
  bool counterclockwise = true;  // of closed loops
};

// Returns one loop a profile. What cannot be drawn (a line without length, a rounding that does not
// fit, an arc through points on a line) is added to `findings`, at its place within the sketch
// ("profiles[1].path.segments[2].to").
std::vector<CurveLoop> ResolveSketch(const Sketch& sketch, const Numbers& numbers,
                                     std::vector<FieldViolation>& findings);

// Returns points along a curve from its beginning, ends included: 2 × N, m.
Eigen::Matrix2Xd PointsAlong(const SketchCurve& curve, int count);

}  // namespace mortise::cad
