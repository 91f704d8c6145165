#include "tests/unit/services/interpolator/mapping/block_shapes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>

namespace mortise::interpolator {
namespace {

using Steps = std::array<int, 3>;

class BlockMesher {
 public:
  BlockMesher(const BlockShape& shape, const BlockCells& cells)
      : shape_(shape),
        cells_(cells),
        count_{cells.along * (static_cast<int>(shape.knots.size()) - 1), cells.across, cells.high} {
  }

  BlockMesh Make() {
    PlaceNodes();
    FillCells();
    MarkSurface();
    TakeSurface();
    return std::move(made_);
  }

 private:
  int NodesAlong() const { return shape_.is_ring ? count_[0] : count_[0] + 1; }

  int Node(int i, int j, int k) const {
    return ((i % NodesAlong()) * (count_[1] + 1) + j) * (count_[2] + 1) + k;
  }

  double Along(double step) const {
    const double interval =
        std::min(std::floor(step / cells_.along), static_cast<double>(shape_.knots.size()) - 2);
    const auto knot = static_cast<std::size_t>(interval);
    const double share = step / cells_.along - interval;
    return (1 - share) * shape_.knots[knot] + share * shape_.knots[knot + 1];
  }

  void PlaceNodes() {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> noise(-cells_.unrest, cells_.unrest);
    const int nodes = NodesAlong() * (count_[1] + 1) * (count_[2] + 1);
    made_.block.resize(3, nodes);
    made_.marked_mesh.mesh.nodes.resize(3, nodes);
    for (int i = 0; i < NodesAlong(); ++i) {
      for (int j = 0; j <= count_[1]; ++j) {
        for (int k = 0; k <= count_[2]; ++k) {
          const bool is_at_knot = i % cells_.along == 0;
          double a = i, b = j, c = k;
          if (!is_at_knot) a += noise(random);
          if (j > 0 && j < count_[1]) b += noise(random);
          if (k > 0 && k < count_[2]) c += noise(random);
          const Eigen::Vector3d at(Along(a), b / count_[1], c / count_[2]);
          made_.block.col(Node(i, j, k)) = at;
          made_.marked_mesh.mesh.nodes.col(Node(i, j, k)) = shape_.image(at);
        }
      }
    }
  }

  // Divides each cell into the six tetrahedra along one of its diagonals (Kuhn).
  void FillCells() {
    std::vector<Eigen::Vector4i> tetrahedra;
    for (int i = 0; i < count_[0]; ++i) {
      for (int j = 0; j < count_[1]; ++j) {
        for (int k = 0; k < count_[2]; ++k) AddCell({i, j, k}, tetrahedra);
      }
    }
    made_.marked_mesh.mesh.tetrahedra.resize(4, static_cast<Eigen::Index>(tetrahedra.size()));
    for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
      made_.marked_mesh.mesh.tetrahedra.col(static_cast<Eigen::Index>(e)) = tetrahedra[e];
    }
    made_.marked_mesh.mesh.part = Eigen::VectorXi::Zero(made_.marked_mesh.mesh.tetrahedra.cols());
    made_.marked_mesh.mesh.part_names = {"body"};
  }

  void AddCell(const Steps& cell, std::vector<Eigen::Vector4i>& tetrahedra) {
    Steps order = {0, 1, 2};
    do {
      Steps corner = {0, 0, 0};
      Eigen::Vector4i element;
      for (int step = 0; step <= 3; ++step) {
        const int j = cells_.is_mirrored ? 1 - corner[1] : corner[1];
        element[step] = Node(cell[0] + corner[0], cell[1] + j, cell[2] + corner[2]);
        if (step < 3) corner[static_cast<std::size_t>(order[static_cast<std::size_t>(step)])] = 1;
      }
      const auto at = [&](int n) -> Eigen::Vector3d {
        return made_.marked_mesh.mesh.nodes.col(element[n]);
      };
      const double volume = (at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0));
      if (volume < 0) std::swap(element[2], element[3]);
      tetrahedra.push_back(element);
      for (int a = 0; a < 4; ++a) {
        for (int b = 0; b < a; ++b) {
          made_.cell_size = std::max(made_.cell_size, (at(a) - at(b)).norm());
        }
      }
    } while (std::next_permutation(order.begin(), order.end()));
  }

  void TakeSurface() {
    OuterSurface outer = OuterSurfaceOf(made_.marked_mesh.mesh);
    made_.marked = std::move(outer.marked);
    made_.node = std::move(outer.node);
    std::map<int, int> vertex_of;
    for (std::size_t v = 0; v < made_.node.size(); ++v) {
      vertex_of.emplace(made_.node[v], static_cast<int>(v));
    }
    for (const ControlPoint& point : made_.marked_mesh.points) {
      made_.marked.points.push_back({point.name, vertex_of.at(point.vertex)});
    }
    for (const ControlPath& path : made_.marked_mesh.paths) {
      ControlPath& marked = made_.marked.paths.emplace_back(ControlPath{path.name, {}});
      for (const int node : path.vertices) marked.vertices.push_back(vertex_of.at(node));
    }
  }

  // A path of the lattice from `start` along `axis`, and the points at its ends.
  void AddEdge(const std::string& name, const Steps& start, std::size_t axis, int steps) {
    ControlPath path;
    path.name = name;
    Steps at = start;
    for (int step = 0; step <= steps; ++step) {
      path.vertices.push_back(Node(at[0], at[1], at[2]));
      ++at[axis];
    }
    for (const int end : {path.vertices.front(), path.vertices.back()}) {
      if (!named_.insert(end).second) continue;
      made_.marked_mesh.points.push_back({PointName(end), end});
    }
    made_.marked_mesh.paths.push_back(std::move(path));
  }

  std::string PointName(int node) const {
    const Eigen::Vector3d at = made_.block.col(node);
    return "at " + std::to_string(at.x()) + " " + std::to_string(at.y()) + " " +
           std::to_string(at.z());
  }

  void MarkSurface() {
    const int knots = static_cast<int>(shape_.knots.size());
    for (int knot = 0; knot < knots; ++knot) {
      const int i = knot * cells_.along;
      const bool is_end = !shape_.is_ring && (knot == 0 || knot + 1 == knots);
      const std::string number = std::to_string(knot);
      for (int end = 0; end < 2; ++end) {
        const std::string side = std::to_string(end);
        if (is_end) AddEdge("across" + number + side, {i, 0, end * count_[2]}, 1, count_[1]);
        if (shape_.is_ring && knot + 1 == knots) continue;
        if (shape_.has_lines[static_cast<std::size_t>(end)]) {
          AddEdge("high" + number + side, {i, end * count_[1], 0}, 2, count_[2]);
        }
        if (knot + 1 == knots) continue;
        for (int top = 0; top < 2; ++top) {
          AddEdge("along" + number + side + std::to_string(top),
                  {i, end * count_[1], top * count_[2]}, 0, cells_.along);
        }
      }
    }
  }

  const BlockShape& shape_;
  BlockCells cells_;
  Steps count_;
  BlockMesh made_;
  std::set<int> named_;  // nodes that are points
};

}  // namespace

BlockMesh MakeBlockMesh(const BlockShape& shape, const BlockCells& cells) {
  return BlockMesher(shape, cells).Make();
}

ModelMesh ModelOf(const BlockMesh& block) {
  const MarkedMesh& marked = block.marked_mesh;
  ModelMesh model;
  model.mesh = marked.mesh;
  std::map<int, int> point_of;
  for (const ControlPoint& point : marked.points) {
    point_of[point.vertex] = static_cast<int>(model.variables.points.size());
    model.variables.points.push_back({point.name, marked.mesh.nodes.col(point.vertex)});
  }
  for (const ControlPath& path : marked.paths) {
    model.variables.paths.push_back({path.name, point_of.at(path.vertices.front()),
                                     point_of.at(path.vertices.back()),
                                     marked.mesh.nodes(Eigen::all, path.vertices)});
  }
  return model;
}

BlockShape BoxShape(const Eigen::Vector3d& size) {
  BlockShape box;
  box.image = [size](const Eigen::Vector3d& at) -> Eigen::Vector3d {
    return at.cwiseProduct(size);
  };
  return box;
}

BlockShape ArchShape(double radius, double turn, double width, double thickness) {
  BlockShape arch;
  arch.image = [=](const Eigen::Vector3d& at) -> Eigen::Vector3d {
    const double angle = turn * at.x(), r = radius + (at.z() - 0.5) * thickness;
    return {r * std::sin(angle), width * at.y(), r * std::cos(angle)};
  };
  return arch;
}

BlockShape PlateShape(double length, double width, double thickness, double hole) {
  BlockShape plate;
  plate.knots = {0, 0.25, 0.5, 0.75, 1};
  plate.is_ring = true;
  plate.has_lines = {false, true};
  plate.image = [=](const Eigen::Vector3d& at) -> Eigen::Vector3d {
    const double turns = at.x() - std::floor(at.x());
    const double angle = 2 * M_PI * (0.625 - turns);  // clockwise, for the block is right-handed
    const Eigen::Vector2d round(hole * std::cos(angle), hole * std::sin(angle));
    const int side = std::min(static_cast<int>(4 * turns), 3);
    const double share = 4 * turns - side;
    const Eigen::Vector2d corners[5] = {{-1, -1}, {-1, 1}, {1, 1}, {1, -1}, {-1, -1}};
    const Eigen::Vector2d straight = (1 - share) * corners[side] + share * corners[side + 1];
    const Eigen::Vector2d outer(straight.x() * length / 2, straight.y() * width / 2);
    const Eigen::Vector2d place = (1 - at.y()) * round + at.y() * outer;
    return {place.x(), place.y(), thickness * at.z()};
  };
  return plate;
}

BlockShape CylinderShape(double radius, double height) {
  BlockShape cylinder;
  cylinder.has_lines = {false, false};
  cylinder.image = [=](const Eigen::Vector3d& at) -> Eigen::Vector3d {
    const Eigen::Vector2d square(2 * at.x() - 1, 2 * at.y() - 1);
    const Eigen::Vector2d disk(square.x() * std::sqrt(1 - square.y() * square.y() / 2),
                               square.y() * std::sqrt(1 - square.x() * square.x() / 2));
    return {radius * disk.x(), radius * disk.y(), height * at.z()};
  };
  return cylinder;
}

BlockShape BracketShape(double leg, double thickness, double fillet, double depth) {
  BlockShape bracket;
  bracket.knots = {0, 0.4, 0.6, 1};
  bracket.image = [=](const Eigen::Vector3d& at) -> Eigen::Vector3d {
    // From the end of the leg along x, round the bend about (c, c), to the end of that along z; the
    // second coordinate goes from the outer side to the inner one.
    const double c = thickness + fillet, r = fillet + (1 - at.y()) * thickness;
    Eigen::Vector2d place;
    if (at.x() < 0.4) {
      place << leg + (c - leg) * at.x() / 0.4, at.y() * thickness;
    } else if (at.x() <= 0.6) {
      const double angle = M_PI / 2 * (at.x() - 0.4) / 0.2;
      place << c - r * std::sin(angle), c - r * std::cos(angle);
    } else {
      place << at.y() * thickness, c + (leg - c) * (at.x() - 0.6) / 0.4;
    }
    return {place.x(), depth * at.z(), place.y()};
  };
  return bracket;
}

}  // namespace mortise::interpolator
