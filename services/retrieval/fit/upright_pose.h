// Where a query stands relative to a design: turned about the vertical, moved and scaled.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace mortise::retrieval {

// From the query's frame to the design's: x becomes scale · turned(x) + translation.
struct UprightPose {
  double turn = 0;                                        // rad, counter-clockwise seen from above
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // m
  double scale = 1;                                       // metres for each of the query's units

  Eigen::Matrix3d Rotation() const {
    return Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  }

  // Points, 3 × n, in the design's frame, and back.
  Eigen::Matrix3Xd ToDesign(const Eigen::Matrix3Xd& points) const {
    return (scale * Rotation() * points).colwise() + translation;
  }
  Eigen::Matrix3Xd ToQuery(const Eigen::Matrix3Xd& points) const {
    return Rotation().transpose() / scale * (points.colwise() - translation);
  }
};

}  // namespace mortise::retrieval
