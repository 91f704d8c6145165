#include "common/maps/interpolation_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/maps/coefficients.h"

namespace mortise::maps {
namespace {

absl::Status CheckShapes(const MapContent& content, const RefinementTree& tree) {
  const bool has_none = content.values.rows() == 0 && content.errors.rows() != 0;
  if (content.values.cols() != tree.sample_count() || has_none) {
    return InvalidField("values", absl::StrCat("is not of ", tree.sample_count(), " samples"));
  }
  if (!content.values.allFinite())
    return InvalidField("values", "holds numbers that are not finite");
  const int elements = tree.element_count();
  if (content.errors.cols() != elements || content.errors.rows() != content.values.rows()) {
    return InvalidField("errors", absl::StrCat("is not of ", elements, " elements"));
  }
  if (static_cast<int>(content.cut_off.size()) != elements) {
    return InvalidField("cut_off", absl::StrCat("is not of ", elements, " elements"));
  }
  return absl::OkStatus();
}

// The flags by node rather than by the order of elements.
std::vector<std::uint8_t> ByNode(const MapContent& content, const RefinementTree& tree) {
  std::vector<std::uint8_t> cut_off(tree.elements().node_count(), 0);
  std::size_t order = 0;
  for (const int element : tree.Elements()) cut_off[element] = content.cut_off[order++];
  return cut_off;
}

}  // namespace

absl::StatusOr<InterpolationMap> InterpolationMap::Create(MapContent content) {
  absl::StatusOr<RefinementTree> tree =
      RefinementTree::Replay(content.dimension, content.basis, content.options, content.splits);
  if (!tree.ok()) return tree.status();
  if (absl::Status status = CheckShapes(content, *tree); !status.ok()) return status;
  return InterpolationMap(std::move(content), *std::move(tree));
}

InterpolationMap::InterpolationMap(MapContent content, RefinementTree tree)
    : content_(std::move(content)),
      tree_(std::move(tree)),
      turns_(tree_.elements().node_count()),
      packed_(tree_, ComputeCoefficients(tree_, content_.values, ByNode(content_, tree_))) {
  int order = 0;
  for (int node = 0; node < tree_.elements().node_count(); ++node) {
    turns_[node].next = tree_.elements().IsElement(node) ? order++ : 0;
  }
  // The n-th split makes nodes 2n - 1 and 2n.
  for (std::size_t n = 0; n < content_.splits.size(); ++n) {
    const auto [element, direction] = content_.splits[n];
    const int child = 2 * static_cast<int>(n) + 1;
    turns_[element] = {ToUnit(tree_.LatticeBoxOf(child).high[direction]), child, direction};
  }
}

Eigen::MatrixXd InterpolationMap::Coefficients() const {
  return ComputeCoefficients(tree_, content_.values, ByNode(content_, tree_));
}

MapValues InterpolationMap::Evaluate(const Eigen::Ref<const Eigen::MatrixXd>& points,
                                     bool gradients) const {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  MapValues result;
  result.values.setConstant(outputs(), points.cols(), kNone);
  result.errors.setConstant(outputs(), points.cols(), std::numeric_limits<double>::infinity());
  if (gradients) result.gradients.setConstant(outputs() * dimension(), points.cols(), kNone);
  for (Eigen::Index n = 0; n < points.cols(); ++n) {
    EvaluateOne(points.col(n).data(), result.values.col(n).data(), result.errors.col(n).data(),
                gradients ? result.gradients.col(n).data() : nullptr);
  }
  return result;
}

bool InterpolationMap::EvaluateOne(const double* point, double* values, double* errors,
                                   double* gradient) const {
  std::array<double, kMostDirections> inside{};
  for (int d = 0; d < dimension(); ++d) {
    if (!std::isfinite(point[d])) return false;
    inside[d] = std::clamp(point[d], 0.0, 1.0);
  }
  int element = 0;
  while (turns_[element].direction >= 0) {
    const Turn& turn = turns_[element];
    element = turn.next + (inside[turn.direction] >= turn.middle ? 1 : 0);
  }
  const int order = turns_[element].next;
  if (content_.cut_off[order]) return false;
  packed_.Evaluate(element, inside.data(), values, gradient);
  if (errors != nullptr) {
    for (int o = 0; o < outputs(); ++o) errors[o] = content_.errors(o, order);
  }
  return true;
}

std::size_t InterpolationMap::BytesRead(const Eigen::Ref<const Eigen::MatrixXd>& points) const {
  std::size_t bytes = 0;
  for (Eigen::Index n = 0; n < points.cols(); ++n) {
    bytes += packed_.BytesRead(tree_.Locate(points.col(n)), points.col(n).data());
  }
  return bytes;
}

}  // namespace mortise::maps
