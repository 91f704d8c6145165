// Sizes, then each entry.
#include "services/retrieval/index/index_check.h"

namespace mortise::retrieval {
namespace {

// Whether `count` numbers from `first` on lie among `size`.
bool Lie(std::int64_t first, std::int64_t count, std::int64_t size) {
  return first >= 0 && count >= 0 && first <= size && count <= size - first;
}

template <typename T>
bool Has(std::span<const T> array, std::int64_t size) {
  return size >= 0 && static_cast<std::int64_t>(array.size()) == size;
}

bool IsConsistent(const PrimitiveEntry& entry, std::int64_t number, const IndexSizes& sizes) {
  return entry.representative >= 0 && entry.representative <= number && entry.axes >= 0 &&
         entry.axes <= sizes.dimension && entry.parameter_count >= 0 &&
         Lie(entry.vectors, (1 + entry.axes) * sizes.dimension, sizes.vectors) &&
         Lie(entry.radii, entry.axes, sizes.radii) &&
         Lie(entry.parameters, entry.parameter_count, sizes.parameters) &&
         Lie(entry.family, 1, sizes.families) && entry.number >= 0;
}

bool IsConsistent(const NodeEntry& node, std::int64_t number, const IndexSizes& sizes) {
  const bool is_leaf = node.left == -1 && node.right == -1;
  const bool has_children = node.left > number && node.left < sizes.nodes && node.right > number &&
                            node.right < sizes.nodes;
  return node.first >= 0 && node.first < node.last && node.last <= sizes.primitives &&
         node.family >= -1 && node.family < sizes.families && (is_leaf || has_children);
}

bool SizesFit(const IndexArrays& arrays) {
  const IndexSizes& sizes = arrays.sizes;
  return sizes.dimension >= 1 && sizes.leading >= 1 && sizes.leading <= sizes.dimension &&
         sizes.primitives >= 1 && sizes.nodes >= 1 && Has(arrays.mean, sizes.dimension) &&
         Has(arrays.components, sizes.dimension * sizes.leading) &&
         Has(arrays.families, sizes.families) && Has(arrays.primitives, sizes.primitives) &&
         Has(arrays.vectors, sizes.vectors) && Has(arrays.radii, sizes.radii) &&
         Has(arrays.parameters, sizes.parameters) &&
         Has(arrays.places, sizes.primitives * (sizes.leading + 2)) &&
         Has(arrays.leading_axes, sizes.radii * (sizes.leading + 1)) &&
         Has(arrays.drifts, sizes.primitives) && Has(arrays.nodes, sizes.nodes) &&
         Has(arrays.balls, sizes.nodes * (sizes.leading + 2)) &&
         Has(arrays.boxes, sizes.nodes * 2 * (sizes.leading + 1));
}

}  // namespace

bool AreConsistent(const IndexArrays& arrays) {
  if (!SizesFit(arrays)) return false;
  for (std::size_t i = 0; i < arrays.nodes.size(); ++i) {
    if (!IsConsistent(arrays.nodes[i], static_cast<std::int64_t>(i), arrays.sizes)) return false;
  }
  for (std::size_t i = 0; i < arrays.primitives.size(); ++i) {
    if (!IsConsistent(arrays.primitives[i], static_cast<std::int64_t>(i), arrays.sizes)) {
      return false;
    }
  }
  return true;
}

}  // namespace mortise::retrieval
