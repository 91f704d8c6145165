#include "services/simulator/airflow/wall_pressure.h"

#include <CGAL/Orthogonal_k_neighbor_search.h>
#include <CGAL/Search_traits_3.h>
#include <CGAL/Search_traits_adapter.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <locale>
#include <sstream>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::simulator {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using PointAndIndex = std::pair<Point, int>;
using Traits =
    CGAL::Search_traits_adapter<PointAndIndex, CGAL::First_of_pair_property_map<PointAndIndex>,
                                CGAL::Search_traits_3<Kernel>>;
using Search = CGAL::Orthogonal_k_neighbor_search<Traits>;

constexpr std::size_t kNeighbours = 4;
constexpr double kSameWay = 0.5;  // cosine

absl::Status Unreadable(std::string_view what) {
  return absl::InternalError(absl::StrCat("OpenFOAM's surface has no readable ",
                                          absl::string_view(what.data(), what.size())));
}

// The rest of the next line that begins with the word `name`; the text goes on behind that line.
// Fails as a stream where there is none.
std::istringstream LineOf(std::istream& text, const std::string& name) {
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with(name + " ")) return std::istringstream(line.substr(name.size()));
  }
  std::istringstream none;
  none.setstate(std::ios::failbit);
  return none;
}

}  // namespace

absl::StatusOr<WallFaces> ReadWallFaces(std::string_view vtk) {
  std::istringstream text{std::string(vtk)};
  text.imbue(std::locale::classic());
  std::size_t points = 0, polygons = 0;
  if (!(LineOf(text, "POINTS") >> points) || points > vtk.size()) return Unreadable("points");
  Eigen::Matrix3Xd corners(3, points);
  for (double& coordinate : corners.reshaped()) text >> coordinate;
  if (!(LineOf(text, "POLYGONS") >> polygons) || polygons > vtk.size()) {
    return Unreadable("polygons");
  }
  WallFaces faces;
  faces.centers.setZero(3, polygons);
  faces.areas.setZero(3, polygons);
  faces.values.setZero(polygons);
  std::vector<std::size_t> polygon;
  for (std::size_t f = 0; f < polygons; ++f) {
    std::size_t count = 0;
    if (!(text >> count) || count < 3 || count > points) return Unreadable("polygons");
    polygon.resize(count);
    for (std::size_t& corner : polygon) {
      if (!(text >> corner) || corner >= points) return Unreadable("polygons");
      faces.centers.col(f) += corners.col(corner) / static_cast<double>(count);
    }
    for (std::size_t k = 0; k < count; ++k) {
      const Eigen::Vector3d a = corners.col(polygon[k]) - faces.centers.col(f);
      const Eigen::Vector3d b = corners.col(polygon[(k + 1) % count]) - faces.centers.col(f);
      // The faces of a wall look out of the cells, into the body.
      faces.areas.col(f) -= 0.5 * a.cross(b);
    }
  }
  if (!LineOf(text, "CELL_DATA") || !LineOf(text, "FIELD")) return Unreadable("values");
  std::string name, type;
  std::size_t components = 0, values = 0;
  if (!(text >> name >> components >> values >> type) || components != 1 || values != polygons) {
    return Unreadable("values");
  }
  for (double& value : faces.values) text >> value;
  if (!text || !faces.values.allFinite() || !corners.allFinite()) return Unreadable("numbers");
  return faces;
}

mesh::SurfaceMesh DividedTriangles(const mesh::SurfaceMesh& surface, double length) {
  using Triangle = std::array<Eigen::Vector3d, 3>;
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Triangle> left;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    left.push_back({surface.vertices.col(surface.triangles(0, t)),
                    surface.vertices.col(surface.triangles(1, t)),
                    surface.vertices.col(surface.triangles(2, t))});
    while (!left.empty()) {
      const Triangle triangle = left.back();
      left.pop_back();
      // The longest edge goes from a to b.
      std::size_t longest = 0;
      std::array<double, 3> lengths;
      for (std::size_t k = 0; k < 3; ++k) {
        lengths[k] = (triangle[(k + 1) % 3] - triangle[k]).norm();
        if (lengths[k] > lengths[longest]) longest = k;
      }
      const auto& [a, b, c] =
          Triangle{triangle[longest], triangle[(longest + 1) % 3], triangle[(longest + 2) % 3]};
      if (lengths[longest] > length) {
        const Eigen::Vector3d middle = 0.5 * (a + b);
        left.push_back({a, middle, c});
        left.push_back({middle, b, c});
      } else {
        vertices.insert(vertices.end(), triangle.begin(), triangle.end());
      }
    }
  }
  mesh::SurfaceMesh divided;
  const auto count = static_cast<Eigen::Index>(vertices.size());
  divided.vertices.resize(3, count);
  for (Eigen::Index v = 0; v < count; ++v) {
    divided.vertices.col(v) = vertices[static_cast<std::size_t>(v)];
  }
  divided.triangles =
      Eigen::VectorXi::LinSpaced(count, 0, static_cast<int>(count) - 1).reshaped(3, count / 3);
  return divided;
}

Eigen::VectorXd ValuesAtVertices(const WallFaces& faces, const mesh::SurfaceMesh& surface) {
  std::vector<PointAndIndex> points;
  for (int f = 0; f < faces.centers.cols(); ++f) {
    points.emplace_back(Point(faces.centers(0, f), faces.centers(1, f), faces.centers(2, f)), f);
  }
  Search::Tree tree(points.begin(), points.end());
  // Of the `asked` nearest faces; no value if fewer than wanted look the same way.
  const auto value_at = [&](const Eigen::Vector3d& place, const Eigen::Vector3d& normal,
                            std::size_t asked, std::size_t wanted, double& value) {
    const Search search(tree, Point(place.x(), place.y(), place.z()), static_cast<unsigned>(asked));
    double sum = 0, weights = 0;
    std::size_t found = 0;
    for (const auto& [face, squared_distance] : search) {
      if (faces.areas.col(face.second).normalized().dot(normal) < kSameWay) continue;
      const double weight = 1 / std::max(squared_distance, 1e-30);
      sum += weight * faces.values[face.second];
      weights += weight;
      if (++found == kNeighbours) break;
    }
    if (found < wanted) return false;
    value = sum / weights;
    return true;
  };
  Eigen::VectorXd values = Eigen::VectorXd::Zero(surface.vertices.cols());
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Vector3d a = surface.vertices.col(surface.triangles(0, t));
    const Eigen::Vector3d b = surface.vertices.col(surface.triangles(1, t));
    const Eigen::Vector3d c = surface.vertices.col(surface.triangles(2, t));
    const Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
    for (const int v : surface.triangles.col(t)) {
      const Eigen::Vector3d place = surface.vertices.col(v);
      double& value = values[v];
      // Most find enough among a few; the rest take what is nearest of many, whichever way it
      // looks.
      if (value_at(place, normal, 3 * kNeighbours, kNeighbours, value) ||
          value_at(place, normal, 30 * kNeighbours, 1, value) || points.empty()) {
        continue;
      }
      const Search nearest(tree, Point(place.x(), place.y(), place.z()), 1);
      value = faces.values[nearest.begin()->first.second];
    }
  }
  return values;
}

Eigen::VectorXd ValuesAtNodes(const WallFaces& faces, const Eigen::Matrix3Xd& nodes,
                              const Eigen::MatrixXi& triangles) {
  // Triangles with middles are four flat ones.
  std::vector<Eigen::Vector3i> parts = {{0, 1, 2}};
  if (triangles.rows() == 6) parts = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};
  Eigen::VectorXi node(3 * triangles.cols() * std::ssize(parts));
  Eigen::Index count = 0;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    for (const Eigen::Vector3i& part : parts) {
      for (const int k : part) node[count++] = triangles(k, t);
    }
  }
  const mesh::SurfaceMesh apart{
      nodes(Eigen::all, node),
      Eigen::VectorXi::LinSpaced(count, 0, static_cast<int>(count) - 1).reshaped(3, count / 3)};
  const Eigen::VectorXd values = ValuesAtVertices(faces, apart);
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(nodes.cols());
  Eigen::VectorXd weights = sums;
  for (Eigen::Index v = 0; v < count; v += 3) {
    const Eigen::Vector3d a = apart.vertices.col(v);
    const double area =
        (apart.vertices.col(v + 1) - a).cross(apart.vertices.col(v + 2) - a).norm() / 2;
    for (Eigen::Index k = v; k < v + 3; ++k) {
      sums[node[k]] += area * values[k];
      weights[node[k]] += area;
    }
  }
  return (weights.array() > 0).select(sums.cwiseQuotient(weights), 0.0);
}

}  // namespace mortise::simulator
