// A surface as people have it: triangles in named components, with what is known of their unit and
// of which way is up. It need not be the boundary of a solid: it may be open, flipped, doubled,
// flat, or cross itself.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mortise::mesh {

// A group, object or node of a file, or a connected piece of one (mesh_components.h).
struct SceneComponent {
  std::string name;            // UTF-8; empty where the file has none
  Eigen::Matrix3Xd vertices;   // 3 × V, in the scene's unit
  Eigen::Matrix3Xi triangles;  // 3 × T, columns of vertex indices
};

// The axis that points upwards.
enum class UpAxis { kUnknown, kX, kY, kZ };

// Returns the axis of a number as contracts have it: 1, 2 and 3 are x, y and z, all else is
// unknown.
UpAxis UpAxisOf(int number);

struct Scene {
  std::vector<SceneComponent> components;
  std::optional<double> unit;  // metres for each unit of length, where the file or somebody says so
  UpAxis up = UpAxis::kUnknown;
  std::vector<std::string> notes;  // whole sentences: what people should know of the reading
};

// Returns the triangles of all components together.
std::int64_t TriangleCount(const Scene& scene);

// Returns the box around all triangles, in the scene's unit; empty (Eigen's isEmpty()) without any.
Eigen::AlignedBox3d BoxOf(const Scene& scene);

// Returns all components in one, without a name; vertices and triangles keep their order.
SceneComponent Joined(const Scene& scene);

// Returns the scene in metres, if a unit of its coordinates is `unit` metres (0.001 for
// millimetres). What the scene itself says of its unit is overruled. `unit` must be positive and
// finite.
Scene Scaled(Scene scene, double unit);

// Returns the scene turned, not mirrored, so that what was along `up` is along +z: y up by a
// quarter turn about x (y becomes z, z becomes -y), x up by one about y (x becomes z, z becomes
// -x). A scene whose up axis is kUnknown stays as it is, and so does its `up`.
Scene TurnedUpright(Scene scene, UpAxis up);

// A unit that nobody stated, guessed by the size of the scene, and the sentence to say so.
struct UnitGuess {
  double unit = 1;     // metres
  std::string remark;  // "The unit is a guess: millimetres, as the surface measures 812 across."
};

// Guesses the unit by the diagonal of the box around the scene, for designs of furniture's size:
//
//   0.1 … 20        metres        10 cm to 20 m
//   20 … 300        centimetres   20 cm to 3 m
//   300 … 20,000    millimetres   30 cm to 20 m
//
// (each range with its lower end). Nothing for other sizes, which no unit makes likely, and for a
// scene without triangles. The rule is our own; a scene's stated unit is not looked at.
std::optional<UnitGuess> GuessUnit(const Scene& scene);

// Returns the scene in metres with z upwards. `up` and `unit`, metres, are what somebody says of
// it; where they say nothing the scene itself counts, and then the guess of its unit, which a note
// tells. Where nothing tells the unit, the scene is not scaled, has no unit, and a note says so;
// where nothing tells what is up, z is.
Scene Settled(Scene scene, UpAxis up, std::optional<double> unit);

}  // namespace mortise::mesh
