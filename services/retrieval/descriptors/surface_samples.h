// Points spread evenly over a surface, which stay where they are on its triangles when its vertices
// move.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace mortise::retrieval {

// Points on a surface and the share of its area that each stands for.
struct WeightedPoints {
  Eigen::Matrix3Xd positions;  // 3 × n
  Eigen::VectorXd weights;     // n, ≥ 0, of sum 1
};

// How those change by unit of a parameter.
struct PointVelocities {
  Eigen::Matrix3Xd positions;  // 3 × n
  Eigen::VectorXd weights;     // n, of sum 0
};

// Points chosen once by area, each given by a triangle and its barycentric coordinates there, so
// that the points are linear functions of the vertices (thesis §4.6.2). When the vertices move, a
// point's weight grows with its triangle: the points stand for the area of the surface as it is
// then, whatever it was when they were chosen.
//
// The i-th of n points stands in the middle of the i-th of n equal shares of the area, taken
// triangle by triangle in the order given, and within a triangle by a sequence of low discrepancy
// (Roberts' R2, folded into the triangle): the error of a mean over the points falls faster than
// that of random points, in particular if triangles that follow each other lie close together.
class SurfaceSamples {
 public:
  // `triangles`, 3 × T, of positive area in all at `vertices`, 3 × V; `count` > 0. Another `seed`
  // gives other points of the same kind.
  SurfaceSamples(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles,
                 Eigen::Index count, std::uint64_t seed);

  Eigen::Index size() const { return triangle_of_.size(); }

  // Returns the triangle that point i lies on, by its place among those given, and where on it.
  int TriangleOf(Eigen::Index i) const { return numbers_[triangle_of_[i]]; }
  Eigen::Vector3d BarycentricOf(Eigen::Index i) const { return barycentric_.col(i); }

  // Returns the points at these vertices. The weights are all zero if the points' triangles have no
  // area.
  WeightedPoints At(const Eigen::Matrix3Xd& vertices) const;

  // Returns how they move there, exactly, if the vertices move with `velocities`, 3 × V.
  PointVelocities Differentiate(const Eigen::Matrix3Xd& vertices,
                                const Eigen::Matrix3Xd& velocities) const;

 private:
  Eigen::VectorXd Areas(const Eigen::Matrix3Xd& vertices) const;

  Eigen::Matrix3Xi triangles_;    // 3 × T', those that have points
  Eigen::VectorXi numbers_;       // T', their places among those given
  Eigen::VectorXd first_areas_;   // T', when the points were chosen
  Eigen::VectorXi triangle_of_;   // n, index into triangles_
  Eigen::Matrix3Xd barycentric_;  // 3 × n
};

}  // namespace mortise::retrieval
