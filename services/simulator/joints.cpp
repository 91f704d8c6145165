#include "services/simulator/joints.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

namespace mortise::simulator {
namespace {

// In larger and farther meshes than this many sizes of a body its coordinates are less exact.
constexpr double kCoordinateDigits = 1e-6;
constexpr double kMostTolerance = 1e-4;

using Rows = Eigen::Matrix<double, 6, Eigen::Dynamic>;

// An orthonormal basis of what `rows` (columns here) span, but for what is shorter than
// `tolerance`. The longest rest is taken first: how many rows there are makes no difference.
Rows IndependentRows(std::vector<RigidMotion> rows, double tolerance) {
  Rows basis(6, 0);
  while (basis.cols() < 6) {
    const auto longest =
        std::max_element(rows.begin(), rows.end(), [](const RigidMotion& a, const RigidMotion& b) {
          return a.squaredNorm() < b.squaredNorm();
        });
    if (longest == rows.end() || longest->norm() < tolerance) break;
    RigidMotion next = longest->normalized();
    next -= basis * (basis.transpose() * next);
    next.normalize();
    basis.conservativeResize(Eigen::NoChange, basis.cols() + 1);
    basis.rightCols(1) = next;
    for (RigidMotion& row : rows) row -= next * next.dot(row);
  }
  return basis;
}

// How a displacement along `direction` at `arm` from a centre, in units of the size, follows from
// the motion.
RigidMotion Row(const Eigen::Vector3d& direction, const Eigen::Vector3d& arm) {
  RigidMotion row;
  row << direction, arm.cross(direction);
  return row;
}

// The joints as they are between the bodies found so far.
class Joiner {
 public:
  Joiner(const mesh::TetrahedralMesh& mesh, const Constraints& constraints)
      : mesh_(mesh),
        constraints_(constraints),
        extent_(mesh.nodes.size() > 0 ? mesh.nodes.cwiseAbs().maxCoeff() : 0) {
    for (Body& body : FindBodies(mesh)) bodies_.emplace_back().body = std::move(body);
  }

  JoinedBodies Join() {
    do {
      Measure();
    } while (Merge());
    JoinedBodies joined;
    for (int b = 0; b < Count(); ++b) {
      if (bodies_[b].is_held) continue;
      const Rows rows = IndependentRows(HoldsOf(b), ToleranceOf(bodies_[b].size));
      for (const auto& row : rows.colwise()) joined.equations.push_back({b, -1, row});
    }
    for (const auto& [pair, nodes] : shared_) {
      if (bodies_[pair.first].is_held || bodies_[pair.second].is_held) continue;
      AddJoint(pair.first, pair.second, nodes, joined.equations);
    }
    joined.bodies = std::move(bodies_);
    return joined;
  }

 private:
  int Count() const { return static_cast<int>(bodies_.size()); }

  double ToleranceOf(double size) const {
    return std::clamp(kCoordinateDigits * extent_ / size, kJointTolerance, kMostTolerance);
  }

  // Places, sizes and shared nodes.
  void Measure() {
    std::vector<int> first(mesh_.nodes.cols(), -1);
    std::map<int, std::vector<int>> all;  // bodies of nodes that have several
    for (int b = 0; b < Count(); ++b) {
      Eigen::AlignedBox3d box;
      for (const int v : bodies_[b].body.nodes) {
        box.extend(mesh_.nodes.col(v));
        if (first[v] < 0) {
          first[v] = b;
        } else {
          all.try_emplace(v, 1, first[v]).first->second.push_back(b);
        }
      }
      bodies_[b].centre = box.center();
      bodies_[b].size = std::max(0.5 * box.diagonal().norm(), 1e-300);
      bodies_[b].is_joined = false;
    }
    shared_.clear();
    for (const auto& [v, bodies] : all) {
      for (std::size_t k = 0; k < bodies.size(); ++k) {
        bodies_[bodies[k]].is_joined = true;
        for (std::size_t l = k + 1; l < bodies.size(); ++l) {
          shared_[{bodies[k], bodies[l]}].push_back(v);
        }
      }
    }
    with_held_.assign(bodies_.size(), nullptr);
    for (const auto& [pair, nodes] : shared_) {
      if (bodies_[pair.first].is_held) with_held_[pair.second] = &nodes;
      if (bodies_[pair.second].is_held) with_held_[pair.first] = &nodes;
    }
  }

  // What supports, and the body that is held, hold of a body.
  std::vector<RigidMotion> HoldsOf(int b) const {
    const JoinedBody& body = bodies_[b];
    std::vector<RigidMotion> rows;
    const auto arm = [&](int v) -> Eigen::Vector3d {
      return (mesh_.nodes.col(v) - body.centre) / body.size;
    };
    for (const int v : body.body.nodes) {
      const int frame = constraints_.frames.empty() ? -1 : constraints_.frames.index[v];
      for (int k = 0; k < 3; ++k) {
        if (!constraints_.fixed(k, v)) continue;
        rows.push_back(Row(frame < 0 ? Eigen::Vector3d(Eigen::Vector3d::Unit(k))
                                     : Eigen::Vector3d(constraints_.frames.axes[frame].col(k)),
                           arm(v)));
      }
    }
    if (with_held_[b] == nullptr) return rows;
    for (const int v : *with_held_[b]) {
      for (int k = 0; k < 3; ++k) rows.push_back(Row(Eigen::Vector3d::Unit(k), arm(v)));
    }
    return rows;
  }

  // Of the motion of one body against the other: the shift at the middle of the nodes they share,
  // and the rotation times the size of the smaller one.
  struct Joint {
    Eigen::Vector3d middle;
    double size;
    Rows rows;
  };

  Joint JointOf(int first, int second, const std::vector<int>& nodes) const {
    Joint joint;
    joint.size = std::min(bodies_[first].size, bodies_[second].size);
    joint.middle.setZero();
    for (const int v : nodes) joint.middle += mesh_.nodes.col(v) / nodes.size();
    std::vector<RigidMotion> rows;
    for (const int v : nodes) {
      for (int k = 0; k < 3; ++k) {
        rows.push_back(
            Row(Eigen::Vector3d::Unit(k), (mesh_.nodes.col(v) - joint.middle) / joint.size));
      }
    }
    joint.rows = IndependentRows(std::move(rows), ToleranceOf(joint.size));
    return joint;
  }

  void AddJoint(int first, int second, const std::vector<int>& nodes,
                std::vector<JointEquation>& equations) const {
    const Joint joint = JointOf(first, second, nodes);
    for (const auto& row : joint.rows.colwise()) {
      const auto of = [&](const JoinedBody& body) {
        RigidMotion motion;
        motion << row.head<3>(),
            ((joint.middle - body.centre).cross(row.head<3>()) + joint.size * row.tail<3>()) /
                body.size;
        return motion;
      };
      JointEquation equation{first, second, of(bodies_[first]), -of(bodies_[second])};
      const double length = std::hypot(equation.of_first.norm(), equation.of_second.norm());
      equation.of_first /= length;
      equation.of_second /= length;
      equations.push_back(equation);
    }
  }

  // Makes one body of those that move as one; false if there are none.
  bool Merge() {
    const int ground = Count();
    std::vector<int> parent(ground + 1);
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](int b) {
      while (parent[b] != b) b = parent[b] = parent[parent[b]];
      return b;
    };
    bool merged = false;
    for (int b = 0; b < ground; ++b) {
      if (bodies_[b].is_held) {
        parent[root(b)] = ground;
      } else if (IndependentRows(HoldsOf(b), ToleranceOf(bodies_[b].size)).cols() == 6) {
        parent[root(b)] = ground;
        merged = true;
      }
    }
    for (const auto& [pair, nodes] : shared_) {
      const int first = root(pair.first), second = root(pair.second);
      if (first == second || JointOf(pair.first, pair.second, nodes).rows.cols() < 6) continue;
      parent[first == ground ? second : first] = first == ground ? ground : second;
      merged = true;
    }
    if (!merged) return false;
    std::map<int, int> number;
    std::vector<JoinedBody> rest;
    for (int b = 0; b < ground; ++b) {
      const auto [at, is_new] = number.try_emplace(root(b), static_cast<int>(rest.size()));
      if (is_new) rest.emplace_back().is_held = root(b) == ground;
      Body& into = rest[at->second].body;
      into.parts.insert(bodies_[b].body.parts.begin(), bodies_[b].body.parts.end());
      into.nodes.insert(into.nodes.end(), bodies_[b].body.nodes.begin(),
                        bodies_[b].body.nodes.end());
    }
    for (JoinedBody& body : rest) {
      std::vector<int>& nodes = body.body.nodes;
      std::sort(nodes.begin(), nodes.end());
      nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    }
    bodies_ = std::move(rest);
    return true;
  }

  const mesh::TetrahedralMesh& mesh_;
  const Constraints& constraints_;
  const double extent_;  // m, the largest coordinate
  std::vector<JoinedBody> bodies_;
  std::map<std::pair<int, int>, std::vector<int>> shared_;  // nodes of each two bodies
  std::vector<const std::vector<int>*> with_held_;          // those shared with the held body
};

}  // namespace

JoinedBodies JoinBodies(const mesh::TetrahedralMesh& mesh, const Constraints& constraints) {
  return Joiner(mesh, constraints).Join();
}

}  // namespace mortise::simulator
