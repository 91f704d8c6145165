// Says how firmly a model stands on a level floor, in every rest pose (thesis §5.1: "so that once
// it is built it will not topple").
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/design/template_definition.h"
#include "common/mesh/measures/standing_solid.h"
#include "services/composer/model/design.h"

namespace mortise::composer {

// How a design stands in one pose.
struct PoseStanding {
  std::string pose;  // empty as drawn; else "joint: pose" (rest_pose.h)
  Eigen::Vector3d center_of_mass = Eigen::Vector3d::Zero();  // m
  mesh::Support support;
  mesh::Standing standing;
};

struct ModelStanding {
  double mass = 0;                        // kg, of all parts, those that connect included
  std::vector<PoseStanding> poses;        // as drawn, then one joint in one of its rest poses each
  std::vector<std::string> without_mass;  // parts whose item or material is not known
};

// Weighs all parts of a design by the densities of their items' materials, and stands it on its
// lowest point in each rest pose. Parts of which no density is known weigh nothing, but support.
// Masses are exact, centres those of the triangles that parts are drawn with. O(poses · vertices).
ModelStanding StandingInPoses(const Design& design, const std::vector<parametric::Item>& items,
                              const std::vector<parametric::Material>& materials);

// Returns the index of the pose with the smallest margin; of several the first.
std::size_t WorstPose(const ModelStanding& standing);

// Says for people which way something falls: "to the front (-y)".
std::string DirectionName(const Eigen::Vector2d& falls_towards);

}  // namespace mortise::composer
