// Bodies that share edges, parts of edges or points, cut out of regular meshes.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "tests/unit/common/fem/problems/structured_mesh.h"

namespace mortise::simulator {

// Whether an element is kept, by its middle.
using Region = std::function<bool(const Eigen::Vector3d& middle)>;

// The elements of `mesh` in a region, without the nodes that they leave unused. It has no faces.
mesh::TetrahedralMesh Cut(const mesh::TetrahedralMesh& mesh, const Region& region);

// A box of unit cubes from the origin, each divided into `cells`³ cells of six tetrahedra.
mesh::TetrahedralMesh Cubes(const Eigen::Vector3i& cubes, int cells, bool quadratic);

// Nodes whose place satisfies a condition.
std::vector<int> NodesAt(const mesh::TetrahedralMesh& mesh, const Region& condition);

// Two bodies and how the second, held by nothing else, moves against the first, whose nodes at its
// far end are held.
struct Hinge {
  std::string name;
  std::function<mesh::TetrahedralMesh(int cells, bool quadratic)> mesh;
  Region held;         // nodes
  Region outer;        // nodes of the free body that lie apart from the joint
  int motions = 0;     // that are free
  std::string motion;  // what the first of them is called
};

std::vector<Hinge> Hinges();

}  // namespace mortise::simulator
