// Ground as people have it in files: what a survey, a raster or a scan gives.
#pragma once

#include <Eigen/Core>
#include <filesystem>

#include "absl/status/statusor.h"
#include "mortise/v1/template.pb.h"

namespace mortise::cli {

// What the numbers of a file are.
struct GroundUnits {
  double unit = 1;  // metres for each
  // m, in the file's axes: what becomes the origin of the design.
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();
};

// Returns the heights in a file, told by its extension, in metres: points on a grid (.csv), an ESRI
// ASCII grid (.asc), a mesh whose z is upwards (.obj, .stl), or a HeightField (.textproto), of
// which the name, title and datum stay as well. As ReadFile; INVALID_ARGUMENT naming each place
// that is at fault: "bank.csv: line 7, column 3".
absl::StatusOr<v1::HeightField> ReadGround(const std::filesystem::path& file,
                                           const GroundUnits& units);

}  // namespace mortise::cli
