#include "services/interpolator/service/shape_verification.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "common/base/errors.h"
#include "common/fields/fields_file.h"
#include "services/interpolator/service/map_shape.h"

namespace mortise::interpolator {
namespace {

// The place of a mesh's field among those of the map, or -1.
int PlaceOf(const v1::MapShapes& shapes, const FieldKind& kind) {
  for (int f = 0; f < shapes.fields_size(); ++f) {
    if (shapes.fields(f).name() == kind.name && shapes.fields(f).load_case() == kind.load_case) {
      return f;
    }
  }
  return -1;
}

void Add(const std::string& field, const std::string& load_case, const Spread& worst, double mean,
         v1::MapVerification& verification) {
  v1::MapVerification::ShapeDifference& to = *verification.add_shapes();
  to.set_field(field);
  to.set_load_case(load_case);
  to.set_largest(worst.largest);
  to.set_largest_99(worst.of_99);
  to.set_mean(mean);
}

}  // namespace

void ShapeVerification::Figures::Add(const Spread& spread, double whole) {
  // What does not vary at all has no errors either, but of rounding.
  const double scale = whole > 0 ? 1 / whole : 0;
  worst.largest = std::max(worst.largest, scale * spread.largest);
  worst.of_99 = std::max(worst.of_99, scale * spread.of_99);
  mean += scale * spread.mean;
  ++designs;
}

ShapeVerification::ShapeVerification(const LoadedMap& map, LoadedShapes& shapes)
    : map_(map),
      shapes_(shapes),
      fields_(static_cast<std::size_t>(map.record.shapes().fields_size())) {}

ShapeVerification::~ShapeVerification() = default;

const PreparedMesh& ShapeVerification::Prepared(
    std::size_t structure, int mesh, const std::shared_ptr<const CanonicalMesh>& canonical) {
  std::unique_ptr<PreparedMesh>& prepared = prepared_[{structure, mesh}];
  if (prepared == nullptr) prepared = std::make_unique<PreparedMesh>(canonical);
  return *prepared;
}

absl::StatusOr<bool> ShapeVerification::Compare(std::size_t structure, const Eigen::VectorXd& place,
                                                const std::string& file) {
  std::vector<int> fields(fields_.size());
  std::iota(fields.begin(), fields.end(), 0);
  BlendedShape blended;
  MORTISE_ASSIGN_OR_RETURN(
      const std::optional<ShapePlace> there,
      BlendAt(map_, shapes_, structure, place, /*surface_only=*/false, fields, blended));
  if (!there) return false;
  MORTISE_ASSIGN_OR_RETURN(const fields::DesignFields truth, fields::ReadFields(file));
  const auto brought = Prepared(structure, there->mesh, there->canonical).Bring(truth);
  MORTISE_ASSIGN_OR_RETURN(
      const ShapeDifference difference,
      Difference(blended, *there->canonical, truth, brought.ok() ? &brought->shape : nullptr));
  shape_.Add(difference.shape, difference.size);
  for (std::size_t f = 0; f < difference.fields.size(); ++f) {
    const auto number = static_cast<std::size_t>(blended.field_numbers[f]);
    const int at = PlaceOf(map_.record.shapes(), there->canonical->fields[number]);
    const v1::MapShapes::Field& field = map_.record.shapes().fields(at);
    fields_[static_cast<std::size_t>(at)].Add(difference.fields[f],
                                              field.maximum() - field.minimum());
  }
  return true;
}

void ShapeVerification::Report(v1::MapVerification& verification) const {
  if (shape_.designs == 0) return;
  Add("", "", shape_.worst, shape_.mean / shape_.designs, verification);
  for (std::size_t f = 0; f < fields_.size(); ++f) {
    if (fields_[f].designs == 0) continue;
    const v1::MapShapes::Field& field = map_.record.shapes().fields(static_cast<int>(f));
    Add(field.name(), field.load_case(), fields_[f].worst, fields_[f].mean / fields_[f].designs,
        verification);
  }
}

}  // namespace mortise::interpolator
