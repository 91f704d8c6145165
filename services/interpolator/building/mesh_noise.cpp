#include "services/interpolator/building/mesh_noise.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "common/base/errors.h"
#include "common/fields/fields_file.h"
#include "services/interpolator/mapping/guarded.h"
#include "services/interpolator/shapes/blend.h"
#include "services/interpolator/shapes/bring_into.h"
#include "services/interpolator/shapes/packed_shape.h"
#include "services/interpolator/shapes/shape_difference.h"

namespace mortise::interpolator {
namespace {

// How far the second design is off the first as the errors of a map are measured: in the canonical
// mesh of the first, packed and blended.
absl::StatusOr<ShapeDifference> DifferenceOf(const fields::DesignFields& one,
                                             const fields::DesignFields& other,
                                             const MeshMapOptions& mapping,
                                             std::vector<FieldKind>& kinds) {
  MORTISE_ASSIGN_OR_RETURN(CanonicalMesh made, CanonicalMesh::Create(one));
  const auto mesh = std::make_shared<const CanonicalMesh>(std::move(made));
  const PreparedMesh prepared(mesh, mapping);
  MORTISE_ASSIGN_OR_RETURN(const BroughtShape first, prepared.Bring(one));
  MORTISE_ASSIGN_OR_RETURN(const BroughtShape second, prepared.Bring(other));
  MORTISE_ASSIGN_OR_RETURN(const PackedShape packed, Pack(first.shape, *mesh));
  BlendedParts all;
  for (std::size_t f = 0; f < mesh->fields.size(); ++f) all.fields.push_back(static_cast<int>(f));
  const WeightedShape whole{&packed, 1};
  BlendedShape blended;
  MORTISE_RETURN_IF_ERROR(Blend({&whole, 1}, *mesh, all, blended));
  kinds = mesh->fields;
  return Difference(blended, *mesh, other, &second.shape);
}

absl::Status AddShapes(const DesignAnswer& one, const DesignAnswer& other,
                       const ShapeOptions& shapes, const MeshNoiseOptions& options,
                       MeshNoise& noise) {
  const absl::StatusOr<std::string> ours = shapes.get(one.file);
  const absl::StatusOr<std::string> theirs = ours.ok() ? options.get(other.file) : ours;
  // A file that is lost is no reason to have no map.
  if (absl::IsNotFound(theirs.status())) return absl::OkStatus();
  MORTISE_RETURN_IF_ERROR(theirs.status());
  std::vector<FieldKind> kinds;
  const absl::StatusOr<ShapeDifference> difference =
      Guarded([&]() -> absl::StatusOr<ShapeDifference> {
        MORTISE_ASSIGN_OR_RETURN(const fields::DesignFields first, fields::ReadFields(*ours));
        MORTISE_ASSIGN_OR_RETURN(const fields::DesignFields second, fields::ReadFields(*theirs));
        return DifferenceOf(first, second, shapes.mapping, kinds);
      });
  // Want of memory may pass; all else is the designs' own.
  if (absl::IsResourceExhausted(difference.status())) return difference.status();
  if (!difference.ok()) return absl::OkStatus();
  if (options.of_shape) noise.shape = difference->shape.of_99;
  for (std::size_t f = 0; f < kinds.size() && f < difference->fields.size(); ++f) {
    const bool is_wanted = std::ranges::count(options.of_fields, kinds[f].name) > 0;
    if (!is_wanted) continue;
    noise.fields.push_back({kinds[f].name, kinds[f].load_case, difference->fields[f].of_99});
  }
  return absl::OkStatus();
}

}  // namespace

std::optional<double> MeshNoise::OfFieldNamed(const std::string& name,
                                              const std::string& load_case) const {
  for (const OfField& field : fields) {
    if (field.name == name && field.load_case == load_case) return field.floor;
  }
  return std::nullopt;
}

absl::StatusOr<MeshNoise> CompareMeshes(const DesignAnswer& one, const DesignAnswer& other,
                                        const ShapeOptions* shapes,
                                        const MeshNoiseOptions& options) {
  MeshNoise noise;
  noise.metrics.resize(options.of_metrics.size());
  if (!one.status.ok() || !other.status.ok()) return noise;
  for (std::size_t m = 0; m < noise.metrics.size(); ++m) {
    const auto row = static_cast<Eigen::Index>(m);
    const double difference = std::abs(one.values[row] - other.values[row]);
    if (options.of_metrics[m] && std::isfinite(difference)) noise.metrics[m] = difference;
  }
  const bool is_of_shapes = options.of_shape || !options.of_fields.empty();
  if (shapes == nullptr || !is_of_shapes || one.file.empty() || other.file.empty()) return noise;
  MORTISE_RETURN_IF_ERROR(AddShapes(one, other, *shapes, options, noise));
  return noise;
}

}  // namespace mortise::interpolator
