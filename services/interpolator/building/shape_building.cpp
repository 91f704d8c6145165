#include "services/interpolator/building/shape_building.h"

#include <utility>

#include "common/base/errors.h"

namespace mortise::interpolator {

ShapeBuilding::ShapeBuilding(const ShapeOptions& options,
                             const std::vector<std::unique_ptr<maps::MapSampling>>& structures,
                             std::function<void(ShapeWork::Event)> post)
    : work_(options, std::move(post)) {
  for (const auto& sampling : structures) {
    structures_.push_back(std::make_unique<StructureShapes>(static_cast<int>(structures_.size()),
                                                            *sampling, work_, options));
  }
}

void ShapeBuilding::SetNoise(const MeshNoise& noise) {
  for (const auto& structure : structures_) structure->SetNoise(noise);
}

absl::Status ShapeBuilding::Told(int structure, int number, const std::string& file) {
  StructureShapes& shapes = *structures_[static_cast<std::size_t>(structure)];
  if (!file.empty()) {
    work_.AddDesign(structure, number, file);
    MORTISE_RETURN_IF_ERROR(shapes.Told(number));
  }
  return shapes.Advance();
}

absl::Status ShapeBuilding::GoOn() {
  MORTISE_RETURN_IF_ERROR(work_.Keep());
  for (const auto& structure : structures_) MORTISE_RETURN_IF_ERROR(structure->Advance());
  return absl::OkStatus();
}

int ShapeBuilding::mesh_count() const {
  int count = 0;
  for (const auto& structure : structures_) count += structure->mesh_count();
  return count;
}

}  // namespace mortise::interpolator
