#include "services/interpolator/building/traits.h"

#include <algorithm>
#include <limits>

namespace mortise::interpolator {
namespace {

std::vector<int> FarNodes(const CanonicalMesh& mesh) {
  const auto surface = mesh.nodes.leftCols(mesh.surface_nodes);
  const Eigen::Vector3d middle = surface.rowwise().mean();
  Eigen::Index next = 0;
  (surface.colwise() - middle).colwise().squaredNorm().maxCoeff(&next);
  Eigen::RowVectorXd distances =
      Eigen::RowVectorXd::Constant(surface.cols(), std::numeric_limits<double>::infinity());
  std::vector<int> nodes;
  while (static_cast<int>(nodes.size()) < std::min(kTraitNodes, mesh.surface_nodes)) {
    nodes.push_back(static_cast<int>(next));
    distances =
        distances.cwiseMin((surface.colwise() - surface.col(next).eval()).colwise().squaredNorm());
    if (distances.maxCoeff(&next) <= 0) break;
  }
  return nodes;
}

}  // namespace

TraitPlaces ChooseTraits(const CanonicalMesh& mesh) {
  TraitPlaces places;
  places.nodes = FarNodes(mesh);
  std::vector<int> first(static_cast<std::size_t>(mesh.node_count()), -1);
  for (int element = mesh.element_count() - 1; element >= 0; --element) {
    for (const int node : mesh.tetrahedra.col(element)) first[node] = element;
  }
  for (const int node : places.nodes) {
    if (first[node] >= 0) places.elements.push_back(first[node]);
  }
  return places;
}

std::vector<float> TraitsOf(const ConsistentShape& shape, const CanonicalMesh& mesh,
                            const TraitPlaces& places) {
  std::vector<float> traits;
  const auto add = [&traits](const auto& values, const std::vector<int>& columns) {
    for (const int column : columns) {
      for (const double value : values.col(column)) traits.push_back(static_cast<float>(value));
    }
  };
  add(shape.nodes, places.nodes);
  for (std::size_t f = 0; f < mesh.fields.size(); ++f) {
    const bool of_nodes = mesh.fields[f].place == fields::FieldPlace::kNodes;
    add(shape.fields[f], of_nodes ? places.nodes : places.elements);
  }
  return traits;
}

}  // namespace mortise::interpolator
