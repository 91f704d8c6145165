#include "services/interpolator/service/shape_verification.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "common/base/errors.h"
#include "services/interpolator/service/map_shape.h"

namespace mortise::interpolator {
namespace {

// Of numbers that are stored with 24 bits and blended, over their magnitude.
constexpr double kRounding = 1e-6;

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

// What errors of a field are divided by: how far it ranges in the map, or, where it does not at
// all, in the map and the true design together. 0 of what is the same everywhere, rounding apart.
double WholeOf(const v1::MapShapes::Field& field, const FieldRange& truth) {
  FieldRange range{field.minimum(), field.maximum()};
  if (range.length() > 0) return range.length();
  range.Include(truth);
  const double magnitude = std::max(std::abs(range.minimum), std::abs(range.maximum));
  return range.length() > kRounding * magnitude ? range.length() : 0;
}

}  // namespace

void ShapeVerification::Figures::Add(const Spread& spread, double whole) {
  // What varies nowhere, neither in the map nor in truth, has no errors but of rounding.
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
  const std::pair wanted(structure, mesh);
  if (prepared_ == nullptr || prepared_of_ != wanted) {
    prepared_.reset();  // before there is another: each takes much memory
    prepared_ = std::make_unique<PreparedMesh>(canonical);
    prepared_of_ = wanted;
  }
  return *prepared_;
}

std::vector<std::size_t> ShapeVerification::OrderByMesh(const std::vector<std::size_t>& structures,
                                                        const Eigen::MatrixXd& places) const {
  std::vector<std::pair<std::size_t, int>> meshes;
  for (std::size_t i = 0; i < structures.size(); ++i) {
    const Eigen::VectorXd place = places.col(static_cast<Eigen::Index>(i));
    meshes.emplace_back(structures[i], MeshAt(map_, structures[i], place));
  }
  std::vector<std::size_t> order(meshes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return meshes[i]; });
  return order;
}

absl::StatusOr<bool> ShapeVerification::Compare(std::size_t structure, const Eigen::VectorXd& place,
                                                const fields::DesignFields& truth) {
  std::vector<int> fields(fields_.size());
  std::iota(fields.begin(), fields.end(), 0);
  BlendedShape blended;
  MORTISE_ASSIGN_OR_RETURN(
      const std::optional<ShapePlace> there,
      BlendAt(map_, shapes_, structure, place, /*surface_only=*/false, fields, blended));
  if (!there) {
    shapeless_ += HasMetricsAt(map_, structure, place) ? 1 : 0;
    return false;
  }
  const auto brought = Prepared(structure, there->mesh, there->canonical).Bring(truth);
  MORTISE_ASSIGN_OR_RETURN(
      const ShapeDifference difference,
      Difference(blended, *there->canonical, truth, brought.ok() ? &brought->shape : nullptr));
  shape_.Add(difference.shape, difference.size);
  if (!brought.ok()) {
    ++unmapped_;
    return true;
  }
  const std::vector<FieldRange> ranges = RangesOf(brought->shape);
  for (std::size_t f = 0; f < difference.fields.size(); ++f) {
    const auto number = static_cast<std::size_t>(blended.field_numbers[f]);
    const int at = PlaceOf(map_.record.shapes(), there->canonical->fields[number]);
    fields_[static_cast<std::size_t>(at)].Add(
        difference.fields[f], WholeOf(map_.record.shapes().fields(at), ranges[number]));
  }
  return true;
}

void ShapeVerification::Report(v1::MapVerification& verification) const {
  verification.set_shapeless(shapeless_);
  verification.set_unmapped(unmapped_);
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
