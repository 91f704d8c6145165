// Vectors as messages hold them.
#pragma once

#include <Eigen/Core>

#include "mortise/v1/types.pb.h"

namespace mortise {

inline v1::Vector3 VectorToProto(const Eigen::Vector3d& vector) {
  v1::Vector3 message;
  message.set_x(vector.x());
  message.set_y(vector.y());
  message.set_z(vector.z());
  return message;
}

inline Eigen::Vector3d VectorFromProto(const v1::Vector3& message) {
  return {message.x(), message.y(), message.z()};
}

}  // namespace mortise
