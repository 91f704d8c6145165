// Shape descriptors: what turns a surface into one point of R^N, so that surfaces that look alike
// lie close together (thesis §4.3, §4.6.2).
//
// Three are known: "d2" (d2_descriptor.h), "voxel" (voxel_descriptor.h) and "light-field"
// (light_field_descriptor.h). All are made for surfaces as people have them: open, not manifold,
// with triangles that face either way, without area or there twice. They depend neither on the
// order nor on the orientation of triangles, nor on vertices that no triangle uses, and splitting
// triangles changes them by no more than their sampling noise. z points upwards.
//
// The distance of two shapes is the Euclidean one of their vectors (thesis §4.3). Where a
// descriptor tells a shape from itself turned about the vertical, it is the least over the four
// quarter turns of one of them (§4.6.2): QuarterTurns gives the four vectors of a query, and what
// is stored has one vector each. A quarter turn permutes the vector's numbers, hence keeps
// distances, hence the least over the turns is a metric on shapes up to quarter turns: balls,
// bounds by the triangle inequality and trees work with each of a query's vectors, and with the
// least of the four.
//
// Results depend on nothing but the surface: not on threads, and between machines only by how they
// round.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::retrieval {

// What a caller must know of a descriptor.
struct DescriptorProperties {
  std::string name;  // "d2", "voxel" or "light-field"
  // Raised with every change of the numbers: vectors of another version say other things.
  int version = 1;
  Eigen::Index dimension = 0;   // N
  bool compares_turns = false;  // whether the distance is the least over four quarter turns
  // How far apart two shapes typically are (the median over pairs of 249 shapes of furniture,
  // vehicles and lamps): δ of the thesis is a small part of it.
  double natural_scale = 1;
  // How far apart the vectors of one shape may be if it is meshed or placed differently.
  double sampling_noise = 0;
  // What a bound descriptor's value is off a smooth function by, when vertices move: its rounding
  // and its kinks.
  double bound_noise = 0;
  // Whether BoundDescriptor::Differentiate is exact, and no difference of values.
  bool differentiates_exactly = false;
  // What leaves the vector as it is but for the sampling noise.
  bool ignores_translation = true;
  bool ignores_scale = true;
  bool ignores_rotation = false;
  bool ignores_mirroring = false;
};

// A descriptor at some vertices, and its derivatives.
struct DescriptorDerivatives {
  Eigen::VectorXd value;     // N
  Eigen::MatrixXd jacobian;  // N × K, a column for each field of velocities
};

// A descriptor for all surfaces that share their triangles with one reference surface and differ
// in their vertices, such as those of one family. What a descriptor chooses (points on triangles)
// is chosen once, on the reference, so that the descriptor is as smooth in the vertices as can be.
class BoundDescriptor {
 public:
  virtual ~BoundDescriptor() = default;

  // Returns the descriptor at vertices (3 × V, m), V as in the reference. INVALID_ARGUMENT,
  // "vertices": of another number, not finite, or so placed that the surface has no area.
  virtual absl::StatusOr<Eigen::VectorXd> Describe(const Eigen::Matrix3Xd& vertices) const = 0;

  // The same with the derivative along each of K fields of velocities, each 3 × V: how the vertices
  // move, m by unit of a parameter. INVALID_ARGUMENT as Describe, or "velocities[k]".
  virtual absl::StatusOr<DescriptorDerivatives> Differentiate(
      const Eigen::Matrix3Xd& vertices, std::span<const Eigen::Matrix3Xd> velocities) const = 0;
};

class Descriptor {
 public:
  virtual ~Descriptor() = default;

  virtual const DescriptorProperties& properties() const = 0;

  // Binds the descriptor to the triangles of a surface (m, z upwards). The surface may be flat.
  // INVALID_ARGUMENT, "surface…": no triangles, an index of no vertex, a coordinate of a triangle
  // that is not finite or beyond 1e100 m, or no area: all triangles together, in units of the box's
  // largest side, have less than 1e-10.
  virtual absl::StatusOr<std::unique_ptr<BoundDescriptor>> Bind(
      const mesh::SurfaceMesh& surface) const = 0;

  // Returns the vector of a surface, N. Errors as Bind.
  absl::StatusOr<Eigen::VectorXd> Describe(const mesh::SurfaceMesh& surface) const;

  // From the vector of a shape, N, to those of the shape turned by 0, 1, 2 and 3 quarter turns
  // about z, counter-clockwise seen from above: N × 4; N × 1 where turns are not compared.
  virtual Eigen::MatrixXd QuarterTurns(const Eigen::VectorXd& vector) const;

  // Returns the distance of two shapes from their vectors, over the turns of `query`.
  double Distance(const Eigen::VectorXd& query, const Eigen::VectorXd& stored) const;
};

// Returns what vectors of a descriptor are to be compared with: "d2/1", its name and version.
std::string FormatOf(const Descriptor& descriptor);

// Returns the names that MakeDescriptor knows.
std::vector<std::string> DescriptorNames();

// Returns a descriptor by its name, with the thesis's settings. INVALID_ARGUMENT, "descriptor", for
// a name that is not known, with those that are.
absl::StatusOr<std::unique_ptr<Descriptor>> MakeDescriptor(std::string_view name);

}  // namespace mortise::retrieval
