// Boundary-representation solids whose faces have names. The kernel (Open CASCADE) does not show in
// this header; its exceptions do not leave this folder.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/shapes/part_shape.h"

namespace mortise::cad {

// An immutable solid. Copies share the kernel's shape.
class Solid {
 public:
  // Builds the prism. INVALID_ARGUMENT naming the field for a degenerate or non-finite shape, or if
  // the kernel's check finds the solid invalid.
  static absl::StatusOr<Solid> FromPart(const mesh::PartShape& part);

  const std::string& name() const;
  const std::vector<std::string>& face_names() const;  // by index of the solid's faces

  double Volume() const;                 // m³, exact for planar faces
  Eigen::Vector3d CentreOfMass() const;  // m

  // The kernel's shape, for the other files of this folder.
  struct Kernel;
  const Kernel& kernel() const { return *kernel_; }
  explicit Solid(std::shared_ptr<const Kernel> kernel);

 private:
  std::shared_ptr<const Kernel> kernel_;
};

// Returns the same solid with other names for its faces, one each.
Solid WithFaceNames(const Solid& solid, std::vector<std::string> face_names);

}  // namespace mortise::cad
