// What a structure's map is made of, message by message.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "mortise/v1/evaluator.pb.h"
#include "mortise/v1/interpolator.pb.h"
#include "services/interpolator/records/loaded_shapes.h"
#include "services/interpolator/service/loaded_maps.h"
#include "services/interpolator/service/map_shape.h"
#include "services/interpolator/shapes/blend.h"

namespace mortise::interpolator {

// First the tree, then the canonical meshes, then the shapes of samples, each read when it is its
// turn.
class MapStream {
 public:
  // `shapes` outlives it; demand.geometry GEOMETRY_KIND_UNSPECIFIED: metrics alone.
  MapStream(std::shared_ptr<const LoadedMap> map, LoadedShapes* shapes, std::size_t structure,
            ShapeDemand demand);

  // Returns the next message; nothing after the last. DATA_LOSS where a file of the map is damaged.
  absl::StatusOr<std::optional<v1::MapExportPart>> Next();

 private:
  void AddTree();
  absl::Status AddMesh(int mesh);
  absl::Status AddSample(int mesh, int sample);

  const std::shared_ptr<const LoadedMap> map_;
  LoadedShapes* const shapes_;
  const std::size_t structure_;
  const ShapeDemand demand_;
  std::deque<v1::MapExportPart> ready_;
  int next_mesh_ = 0;
  std::vector<std::pair<int, int>> samples_;  // mesh and sample of each shape
  std::size_t next_sample_ = 0;
  BlendedShape scratch_;
};

}  // namespace mortise::interpolator
