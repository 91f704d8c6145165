#include "services/retrieval/descriptors/descriptor.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "services/retrieval/descriptors/d2_descriptor.h"
#include "services/retrieval/descriptors/light_field_descriptor.h"
#include "services/retrieval/descriptors/voxel_descriptor.h"

namespace mortise::retrieval {

absl::StatusOr<Eigen::VectorXd> Descriptor::Describe(const mesh::SurfaceMesh& surface) const {
  MORTISE_ASSIGN_OR_RETURN(const std::unique_ptr<BoundDescriptor> bound, Bind(surface));
  return bound->Describe(surface.vertices);
}

Eigen::MatrixXd Descriptor::QuarterTurns(const Eigen::VectorXd& vector) const { return vector; }

double Descriptor::Distance(const Eigen::VectorXd& query, const Eigen::VectorXd& stored) const {
  return (QuarterTurns(query).colwise() - stored).colwise().norm().minCoeff();
}

std::string FormatOf(const Descriptor& descriptor) {
  return absl::StrCat(descriptor.properties().name, "/", descriptor.properties().version);
}

std::vector<std::string> DescriptorNames() { return {"d2", "voxel", "light-field"}; }

absl::StatusOr<std::unique_ptr<Descriptor>> MakeDescriptor(std::string_view name) {
  if (name == "d2") return std::make_unique<D2Descriptor>();
  if (name == "voxel") return std::make_unique<VoxelDescriptor>();
  if (name == "light-field") return std::make_unique<LightFieldDescriptor>();
  return InvalidField("descriptor",
                      absl::StrCat("there is no descriptor '", std::string(name), "', only ",
                                   absl::StrJoin(DescriptorNames(), ", ")));
}

}  // namespace mortise::retrieval
