// The shapes of all structures' maps while they are built. Private to this folder.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/maps/map_sampling.h"
#include "services/interpolator/building/mesh_noise.h"
#include "services/interpolator/building/shape_work.h"
#include "services/interpolator/building/structure_shapes.h"

namespace mortise::interpolator {

// All but CheckDesign is called on the thread that builds.
class ShapeBuilding {
 public:
  // `options` and `structures` outlive it. `post` as of ShapeWork: GoOn is to be called after the
  // event.
  ShapeBuilding(const ShapeOptions& options,
                const std::vector<std::unique_ptr<maps::MapSampling>>& structures,
                std::function<void(ShapeWork::Event)> post);

  void SetKnown(KnownShapes known) { work_.SetKnown(std::move(known)); }
  // Noise floors beside those of the options, before anything is told.
  void SetNoise(const MeshNoise& noise);
  // As ShapeWork::CheckDesign.
  absl::Status CheckDesign(const std::string& file, absl::Status& fault) {
    return work_.CheckDesign(file, fault);
  }
  // To be called when a point has been told, with the file of its design; empty where it failed.
  absl::Status Told(int structure, int number, const std::string& file);
  // Keeps what has been found out, and goes on from there.
  absl::Status GoOn();
  // Only keeps it.
  absl::Status Keep() { return work_.Keep(); }
  // As ShapeWork's.
  void Hold() { work_.Hold(); }
  void Release() { work_.Release(); }
  bool IsHeldUp() const { return work_.IsHeldUp(); }
  void Stop() { work_.Stop(); }
  bool IsIdle() const { return work_.under_way() == 0; }

  const ShapeWork& work() const { return work_; }
  int mesh_count() const;
  absl::StatusOr<ShapedStructure> Result(std::size_t structure) const {
    return structures_[structure]->Result();
  }

 private:
  ShapeWork work_;
  std::vector<std::unique_ptr<StructureShapes>> structures_;
};

}  // namespace mortise::interpolator
