// Points and paths on the surface of a model whose names stay when its parameters change (thesis
// §6.6.2): what says which place of one mesh is which of another one of the same design.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace mortise::mesh {

struct ControlVariables {
  struct Point {
    std::string name;                                    // of one point only
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
    int vertex = -1;                                     // that lies there; -1 if none is known
  };
  // A piece of an edge of the model, between points that follow each other along it.
  struct Path {
    std::string edge;      // the pieces of one edge share its name
    int from = -1;         // points
    int to = -1;           // and
    Eigen::Matrix3Xd way;  // 3 × at least 2, m, from the one to the other along the edge
  };
  std::vector<Point> points;
  std::vector<Path> paths;
};

}  // namespace mortise::mesh
