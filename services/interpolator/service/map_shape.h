// Shapes of designs, interpolated: what EvaluateMapShape and FollowMapShape answer from.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "mortise/v1/evaluator.pb.h"
#include "mortise/v1/interpolator.pb.h"
#include "services/interpolator/records/loaded_shapes.h"
#include "services/interpolator/service/loaded_maps.h"
#include "services/interpolator/shapes/blend.h"
#include "services/interpolator/shapes/canonical_mesh.h"

namespace mortise::interpolator {

// Which canonical mesh a design is in, and what the map says of its own errors there.
struct ShapePlace {
  int mesh = 0;             // of the structure
  int element = 0;          // in the order of RefinementTree::Elements
  std::vector<int> fields;  // of DesignMap.shapes.fields: those that there are, as blended
  std::shared_ptr<const CanonicalMesh> canonical;
};

// Blends the shape of a structure's design at a place of the unit box (K), with those fields of
// DesignMap.shapes.fields that `fields` names, as far as the structure has them. Returns nothing
// where the map has no shape, be there metrics or not. What `out` had is used again. DATA_LOSS
// where a file of the map is damaged or lacks what it should have.
absl::StatusOr<std::optional<ShapePlace>> BlendAt(const LoadedMap& map, LoadedShapes& shapes,
                                                  std::size_t structure,
                                                  const Eigen::VectorXd& place, bool surface_only,
                                                  const std::vector<int>& fields,
                                                  BlendedShape& out);

// Returns the canonical mesh of a structure's design there, or -1 where the map has no shape.
int MeshAt(const LoadedMap& map, std::size_t structure, const Eigen::VectorXd& place);

// Whether the map has metrics of a structure's design there.
bool HasMetricsAt(const LoadedMap& map, std::size_t structure, const Eigen::VectorXd& place);

// What is wanted of every shape.
struct ShapeDemand {
  v1::GeometryKind geometry = v1::SURFACE;
  std::vector<int> fields;   // of DesignMap.shapes.fields, in their order
  std::vector<int> metrics;  // of DesignMap.metrics
};

// Reads it of EvaluateMapShapeRequest or FollowMapShapeRequest.Begin. FAILED_PRECONDITION,
// MAP_WITHOUT_SHAPES; INVALID_ARGUMENT naming "geometry", "fields[0]", "without_fields" or
// "metrics[0]".
template <typename Request>
absl::StatusOr<ShapeDemand> ReadShapeDemand(const v1::DesignMap& map, const Request& asked);

// A shape as it is answered, all but `new_mesh`, and its canonical mesh; none where it is
// `uncovered` or `shapeless`.
struct AnsweredShape {
  v1::MapShape shape;
  std::shared_ptr<const CanonicalMesh> canonical;
};

// Answers at a point (P). INVALID_ARGUMENT naming "point"; fails as BlendAt.
absl::StatusOr<AnsweredShape> ShapeAt(const LoadedMap& map, LoadedShapes& shapes,
                                      const ShapeDemand& demand,
                                      const google::protobuf::RepeatedField<double>& point,
                                      BlendedShape& scratch);

// Fails where a message cannot hold the shape: RESOURCE_EXHAUSTED, TOO_LARGE, naming "fields" where
// it could without them, else "geometry".
absl::Status CheckMessageSize(const v1::MapShape& shape);

// Answers one request, with the mesh if the caller has not got it.
absl::StatusOr<v1::MapShape> EvaluateShape(const LoadedMap& map, LoadedShapes& shapes,
                                           const v1::EvaluateMapShapeRequest& asked);

}  // namespace mortise::interpolator
