#include "services/interpolator/shapes/shape_difference.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/interpolator/mapping/nearest_place.h"
#include "services/interpolator/shapes/corner_design.h"

namespace mortise::interpolator {
namespace {

constexpr int kTensorNumbers = 6;  // xx, yy, zz, xy, yz, xz

// Returns the Frobenius length of a scalar, vector or symmetric tensor.
double LengthOf(const Eigen::Ref<const Eigen::VectorXd>& value) {
  if (value.size() != kTensorNumbers) return value.norm();
  return std::sqrt(value.head<3>().squaredNorm() + 2 * value.tail<3>().squaredNorm());
}

absl::StatusOr<Spread> DistancesFrom(const Eigen::Matrix3Xd& points,
                                     const mesh::SurfaceMesh& surface) {
  MORTISE_ASSIGN_OR_RETURN(const NearestPlaces nearest, NearestPlaces::Create(surface));
  std::vector<double> distances(static_cast<std::size_t>(points.cols()));
  for (std::size_t p = 0; p < distances.size(); ++p) {
    MORTISE_ASSIGN_OR_RETURN(distances[p],
                             nearest.Distance(points.col(static_cast<Eigen::Index>(p))));
  }
  return SpreadOf(distances);
}

Spread LargerOf(const Spread& a, const Spread& b) {
  return {std::max(a.largest, b.largest), std::max(a.of_99, b.of_99), std::max(a.mean, b.mean)};
}

absl::StatusOr<Eigen::Matrix3Xd> SurfaceNodes(const BlendedShape& blended,
                                              const CanonicalMesh& mesh) {
  const int count = blended.node_count();
  const bool is_of_mesh = count == mesh.surface_nodes || count == mesh.node_count();
  if (!is_of_mesh || blended.fields.size() != blended.field_numbers.size()) {
    return InvalidField("blended", "is of another mesh");
  }
  const Eigen::Matrix3Xd nodes =
      Eigen::Map<const Eigen::Matrix3Xf>(blended.positions.data(), 3, mesh.surface_nodes)
          .cast<double>();
  if (!nodes.allFinite()) return InvalidField("blended.positions", "must be finite");
  return nodes;
}

absl::StatusOr<Spread> DifferenceOf(const std::vector<float>& blended, const FieldKind& kind,
                                    const Eigen::MatrixXd& truth, const std::string& field) {
  const auto count = std::ssize(blended) / kind.components;
  if (truth.rows() != kind.components || truth.cols() < count) {
    return InvalidField(field, "has another size");
  }
  std::vector<double> lengths(static_cast<std::size_t>(count));
  const Eigen::Map<const Eigen::MatrixXf> values(blended.data(), kind.components, count);
  for (Eigen::Index n = 0; n < count; ++n) {
    lengths[static_cast<std::size_t>(n)] = LengthOf(values.col(n).cast<double>() - truth.col(n));
  }
  return SpreadOf(lengths);
}

absl::StatusOr<std::vector<Spread>> FieldDifferences(const BlendedShape& blended,
                                                     const CanonicalMesh& mesh,
                                                     const ConsistentShape& truth) {
  if (truth.fields.size() != mesh.fields.size()) {
    return InvalidField("truth_brought.fields", absl::StrCat("must be ", mesh.fields.size()));
  }
  std::vector<Spread> spreads;
  for (std::size_t i = 0; i < blended.fields.size(); ++i) {
    const auto number = static_cast<std::size_t>(blended.field_numbers[i]);
    if (number >= mesh.fields.size()) return InvalidField("blended", "is of another mesh");
    MORTISE_ASSIGN_OR_RETURN(
        const Spread spread,
        DifferenceOf(blended.fields[i], mesh.fields[number], truth.fields[number],
                     absl::StrCat("truth_brought.fields[", number, "]")));
    spreads.push_back(spread);
  }
  return spreads;
}

}  // namespace

absl::StatusOr<ShapeDifference> Difference(const BlendedShape& blended, const CanonicalMesh& mesh,
                                           const fields::DesignFields& truth,
                                           const ConsistentShape* truth_brought) {
  if (const absl::Status good = fields::Check(truth); !good.ok()) return UnderField("truth", good);
  MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3Xd nodes, SurfaceNodes(blended, mesh));
  const OuterTriangles outer = FindOuterTriangles(truth);
  if (outer.triangles.cols() == 0) {
    return InvalidField("truth.triangles", "must be some on the outside");
  }
  const Eigen::Matrix3Xd true_nodes = SurfaceOf(truth.nodes, outer.triangles).surface.vertices;
  ShapeDifference difference;
  difference.size = (true_nodes.rowwise().maxCoeff() - true_nodes.rowwise().minCoeff()).norm();
  MORTISE_ASSIGN_OR_RETURN(difference.to_truth, DistancesFrom(nodes, FineSurface(truth, outer)));
  MORTISE_ASSIGN_OR_RETURN(difference.from_truth,
                           DistancesFrom(true_nodes, {nodes, mesh.triangles}));
  difference.shape = LargerOf(difference.to_truth, difference.from_truth);
  if (truth_brought == nullptr) return difference;
  MORTISE_ASSIGN_OR_RETURN(difference.fields, FieldDifferences(blended, mesh, *truth_brought));
  return difference;
}

Spread SpreadOf(std::vector<double>& numbers) {
  if (numbers.empty()) return {};
  // The best 99 of 100 are at least that share of them.
  const std::size_t best = (99 * numbers.size() + 99) / 100;
  const auto last = numbers.begin() + static_cast<std::ptrdiff_t>(best) - 1;
  Spread spread;
  spread.mean =
      std::accumulate(numbers.begin(), numbers.end(), 0.0) / static_cast<double>(numbers.size());
  spread.largest = *std::max_element(numbers.begin(), numbers.end());
  std::nth_element(numbers.begin(), last, numbers.end());
  spread.of_99 = *last;
  return spread;
}

void FieldRange::Include(const FieldRange& other) {
  minimum = std::min(minimum, other.minimum);
  maximum = std::max(maximum, other.maximum);
}

std::vector<FieldRange> RangesOf(const ConsistentShape& shape) {
  std::vector<FieldRange> ranges;
  for (const Eigen::MatrixXd& values : shape.fields) {
    FieldRange& range = ranges.emplace_back();
    if (values.size() > 0) range = {values.minCoeff(), values.maxCoeff()};
  }
  return ranges;
}

std::vector<FieldRange> RangesOf(const PackedShape& shape) {
  std::vector<FieldRange> ranges;
  for (const PackedField& field : shape.fields) {
    ranges.push_back({field.minimum, field.maximum()});
  }
  return ranges;
}

}  // namespace mortise::interpolator
