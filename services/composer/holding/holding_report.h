// Says whether a model will stand and hold (thesis §5.1): "structurally sound, so that once it is
// built it will not topple or collapse".
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/design/template_definition.h"
#include "services/composer/holding/bearing_surfaces.h"
#include "services/composer/holding/finding.h"
#include "services/composer/holding/joints.h"
#include "services/composer/holding/motion_rules.h"
#include "services/composer/holding/standing_in_poses.h"
#include "services/composer/model/design.h"

namespace mortise::composer {

// A surface that bears, and what tips the model over there.
struct SurfaceCheck {
  BearingSurface surface;
  double tipping_force = std::numeric_limits<double>::infinity();  // N; infinite: none does
  double tipping_wanted = 0;                                       // N, that must not
  Eigen::Vector2d tipping_at = Eigen::Vector2d::Zero();            // m, where least does
};

struct HoldingReport {
  ModelStanding standing;
  std::size_t worst_pose = 0;          // index into standing.poses
  std::vector<SurfaceCheck> surfaces;  // the model as drawn, from the floor up
  std::vector<Joint> joints;
  std::vector<Finding> findings;  // the worst first
  // For people: what the report is about, and what it says nothing of.
  std::vector<std::string> judged, not_judged;
};

// Checks a design as it is now. `design_of` is asked of its parts as drawn (motion_rules.h).
//
// Findings, besides those of joint_rules.h: "topples", a fault, of a pose in which the centre of
// mass is not above the support polygon; "tilts-easily", a warning, our own, where a floor that
// tilts by 10 degrees lets it fall; "tips-under-load", a warning, of a surface
// (bearing_surfaces.h); and "mass-unknown", a notice, of parts that no density is known of.
//
// Fails as Redraw and ConnectionsOf. O(parts²), and contact of surfaces: an assembly of 200 parts
// takes some 50 ms.
absl::StatusOr<HoldingReport> CheckHolding(const Design& design,
                                           const std::vector<parametric::Item>& items,
                                           const std::vector<parametric::Material>& materials,
                                           const DesignOf& design_of = nullptr);

}  // namespace mortise::composer
