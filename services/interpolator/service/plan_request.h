// From what a client asks for, and what the evaluator says of its subject, to the plan of a map.
#pragma once

#include "absl/status/statusor.h"
#include "services/interpolator/building/map_plan.h"
#include "services/interpolator/building/mesh_noise.h"

namespace mortise::v1 {
class DescribeDesignSpaceRequest;
class DesignSpace;
class EvaluateBatchRequest;
class MapSpecification;
}  // namespace mortise::v1

namespace mortise::interpolator {

// Returns the plan for a specification that CheckSpecification passes. INVALID_ARGUMENT naming the
// field: a name that the subject does not have, a range beyond its own, a value that is none,
// nothing that varies or too much, more structures than are allowed, geometry or a field that the
// subject does not offer.
absl::StatusOr<MapPlan> MakePlan(const v1::MapSpecification& specification,
                                 const v1::DesignSpace& described);

// Returns what to ask about the subject of a map.
v1::DescribeDesignSpaceRequest DescriptionOf(const v1::MapSpecification& specification);

// Returns whether any noise floor is to be estimated by a second mesh: one that nobody has given,
// of a subject that has meshes, where the budget has room for it.
bool EstimatesNoise(const v1::MapSpecification& specification, const MapPlan& plan);

// Returns what is to be estimated, without how.
MeshNoiseOptions NoiseWantedOf(const v1::MapSpecification& specification);

// Returns the specification with other meshes: elements of 0.8 of their size, or where that would
// be less than half of the default of 1.25; where anything may depend on the air, in it so many
// cells more, or fewer.
v1::MapSpecification OnOtherMeshes(const v1::MapSpecification& specification);

// Returns what to ask about every design of a map: all but the points. The metrics of the map come
// first; where it has none, one that nobody wants stands for them.
v1::EvaluateBatchRequest QuestionOf(const v1::MapSpecification& specification,
                                    const v1::DesignSpace& described);

}  // namespace mortise::interpolator
