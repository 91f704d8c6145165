// How far a map's shapes and fields are off designs that were evaluated for the sake of knowing it
// (thesis, Table 6.2).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "common/fields/design_fields.h"
#include "mortise/v1/interpolator.pb.h"
#include "services/interpolator/records/loaded_shapes.h"
#include "services/interpolator/service/loaded_maps.h"
#include "services/interpolator/shapes/bring_into.h"
#include "services/interpolator/shapes/shape_difference.h"

namespace mortise::interpolator {

class ShapeVerification {
 public:
  // Both outlive it; `map` has shapes.
  ShapeVerification(const LoadedMap& map, LoadedShapes& shapes);
  ~ShapeVerification();

  // Returns the numbers of places of the unit box (K x places) of structures, those that are in one
  // mesh one after another: in this order they are best compared, as a mesh is prepared for designs
  // of other elements, and only the last one is kept so.
  std::vector<std::size_t> OrderByMesh(const std::vector<std::size_t>& structures,
                                       const Eigen::MatrixXd& places) const;

  // Compares the map at a place of the unit box (K) of a structure with the design that is truly
  // there, its shape and fields. Of one that cannot be brought into the canonical mesh, as its
  // topology is another one, the shape alone is compared. Returns whether the map has a shape
  // there, and counts where it has metrics instead. DATA_LOSS where files of the map are damaged;
  // fails as fields::Check, "truth".
  absl::StatusOr<bool> Compare(std::size_t structure, const Eigen::VectorXd& place,
                               const fields::DesignFields& truth);

  // Adds what was found: of the shape over the size of each design, of each field over its range in
  // the map, or where that is none over how far it and the design range together. Nothing of what
  // could not be compared at any design.
  void Report(v1::MapVerification& verification) const;

 private:
  // Of all designs together, as shares.
  struct Figures {
    Spread worst;
    double mean = 0;  // sum
    int designs = 0;

    void Add(const Spread& spread, double whole);
  };

  const PreparedMesh& Prepared(std::size_t structure, int mesh,
                               const std::shared_ptr<const CanonicalMesh>& canonical);

  const LoadedMap& map_;
  LoadedShapes& shapes_;
  // The last mesh that was prepared: its structure and number.
  std::pair<std::size_t, int> prepared_of_;
  std::unique_ptr<PreparedMesh> prepared_;
  Figures shape_;
  int shapeless_ = 0;            // designs that the map has metrics of, and no shape
  int unmapped_ = 0;             // of those compared, designs whose fields could not be
  std::vector<Figures> fields_;  // in the order of DesignMap.shapes.fields
};

}  // namespace mortise::interpolator
