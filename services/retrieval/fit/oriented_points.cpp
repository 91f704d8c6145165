#include "services/retrieval/fit/oriented_points.h"

#include <CGAL/Kd_tree.h>
#include <CGAL/Orthogonal_k_neighbor_search.h>
#include <CGAL/Search_traits.h>

#include <array>
#include <utility>
#include <vector>

namespace mortise::retrieval {
namespace {

struct Place {
  std::array<double, 6> coordinates;
  Eigen::Index index = 0;
};

// Walks over the coordinates, as CGAL's searches ask for it.
struct CoordinatesOf {
  using result_type = const double*;
  const double* operator()(const Place& place) const { return place.coordinates.data(); }
  const double* operator()(const Place& place, int) const { return place.coordinates.data() + 6; }
};

using Traits =
    CGAL::Search_traits<double, Place, const double*, CoordinatesOf, CGAL::Dimension_tag<6>>;
using Search = CGAL::Orthogonal_k_neighbor_search<Traits>;

Place PlaceOf(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double normal_length,
              Eigen::Index index) {
  const Eigen::Vector3d way = normal_length * normal;
  return {{point.x(), point.y(), point.z(), way.x(), way.y(), way.z()}, index};
}

}  // namespace

struct OrientedPoints::Tree {
  explicit Tree(const std::vector<Place>& places) : search(places.begin(), places.end()) {
    search.build();
  }
  Search::Tree search;
};

OrientedPoints::OrientedPoints(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& normals,
                               double normal_length)
    : normal_length_(normal_length) {
  std::vector<Place> places;
  places.reserve(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    places.push_back(PlaceOf(points.col(i), normals.col(i), normal_length, i));
  }
  tree_ = std::make_unique<const Tree>(places);
}

OrientedPoints::~OrientedPoints() = default;
OrientedPoints::OrientedPoints(OrientedPoints&&) noexcept = default;
OrientedPoints& OrientedPoints::operator=(OrientedPoints&&) noexcept = default;

OrientedPoints::Nearest OrientedPoints::Find(const Eigen::Vector3d& point,
                                             const Eigen::Vector3d& normal) const {
  const Search search(tree_->search, PlaceOf(point, normal, normal_length_, 0), 1);
  return {search.begin()->first.index, search.begin()->second};
}

OrientedPoints::Nearest OrientedPoints::FindEitherWay(const Eigen::Vector3d& point,
                                                      const Eigen::Vector3d& normal) const {
  const Nearest same = Find(point, normal);
  const Nearest opposite = Find(point, -normal);
  return opposite.squared < same.squared ? opposite : same;
}

}  // namespace mortise::retrieval
