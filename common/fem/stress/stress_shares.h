// A stress that is made of several round it, each turned first.
//
// What lies on a surface is turned along with it: pulled along its own facet, a piece of a curved
// surface seems to be pressed across its neighbours', and the mean of facets that turn by φ would
// lose sin²(φ/2) of a stress along their curve.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "common/fem/elements/material.h"
#include "common/fem/stress/part_surface.h"

namespace mortise::simulator {

// Says how much of a stress counts, and how it is turned.
struct StressShare {
  double weight = 0;
  Eigen::Matrix3d turn;
};

// Returns all of them together: xx yy zz xy yz xz, Pa.
Vector6d StressOf(std::span<const StressShare> shares, std::span<const Vector6d> stresses);

// Returns what multiplies each stress in direction · StressOf.
std::vector<Vector6d> DirectionsOf(std::span<const StressShare> shares, const Vector6d& direction);

// Faces of a surface, and where their nodes are.
struct PlacedFaces {
  std::vector<int> faces;
  std::vector<GradientMatrix> positions;
};

// Adds the derivative of direction · StressOf by the places of the faces' nodes, 3 × nodes, for
// stresses that stay as they are: by central differences, to nine digits or so, as only geometry is
// in it. `shares_at`: for other positions of the faces.
void AddShareDerivative(
    const PartSurface& surface, const PlacedFaces& at,
    const std::function<std::vector<StressShare>(const std::vector<GradientMatrix>&)>& shares_at,
    const Vector6d& direction, std::span<const Vector6d> stresses, Eigen::Matrix3Xd& by_position);

}  // namespace mortise::simulator
