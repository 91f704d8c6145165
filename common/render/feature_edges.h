// Finds the edges of a triangulated surface that a draughtsman would draw. Internal to the
// renderer.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace mortise::render {

struct FeatureEdge {
  Eigen::Vector3d start;
  Eigen::Vector3d end;
};

// Edges with one triangle, or more than two, or whose two triangles' normals differ by more than
// `feature_angle` (rad; negative for all), or of which `faces_eye` holds for one triangle and not
// for the other (the outline). Vertices at the same position count as one, so that surfaces made
// face by face join.
std::vector<FeatureEdge> FindFeatureEdges(
    const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles, double feature_angle,
    const std::function<bool(const Eigen::Vector3d& centre, const Eigen::Vector3d& normal)>&
        faces_eye);

// For each vertex, the index of the first vertex at the same position.
std::vector<int> MergeVertices(const Eigen::Matrix3Xd& vertices);

}  // namespace mortise::render
