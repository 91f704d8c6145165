#include "common/fem/mechanisms/joints.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace mortise::simulator {
namespace {

// In larger and farther meshes than this many sizes of a body its coordinates are less exact.
constexpr double kCoordinateDigits = 1e-6;
constexpr double kMaxTolerance = 1e-4;

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

// A basis of what is perpendicular to an orthonormal one.
Rows Complement(const Rows& basis) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> all{Eigen::MatrixXd(basis)};
  const Eigen::MatrixXd directions = all.householderQ() * Eigen::MatrixXd::Identity(6, 6);
  return directions.rightCols(6 - basis.cols());
}

// The joints as they are between the bodies found so far.
class Joiner {
 public:
  Joiner(const mesh::TetrahedralMesh& mesh, const Constraints& constraints)
      : mesh_(mesh),
        constraints_(constraints),
        extent_(mesh.nodes.size() > 0 ? mesh.nodes.cwiseAbs().maxCoeff() : 0) {
    std::vector<Body> bodies = FindBodies(mesh);
    ground_ = static_cast<int>(bodies.size());
    pieces_.resize(bodies.size() + 1);
    for (int b = 0; b < ground_; ++b) {
      pieces_[b].body = std::move(bodies[b]);
      Measure(b);
    }
    Meet();
  }

  JoinedBodies Join() {
    // What is told by the first look is told by the next ones only where something has changed.
    for (int b = 0; b < ground_; ++b) supported_.insert(b);
    for (const auto& [pair, nodes] : shared_) meeting_.insert(pair);
    while (!supported_.empty() || !meeting_.empty()) {
      for (const auto& [into, from] : Firm()) Unite(Root(into), Root(from));
    }
    return Result();
  }

 private:
  using Pair = std::pair<int, int>;  // ascending

  // A body found so far, or one that has become part of another.
  struct Piece {
    Body body;  // its nodes are in no order any more once it has grown
    Eigen::AlignedBox3d box;
    std::vector<int> fixed;    // its nodes that supports hold in some direction
    std::set<int> neighbours;  // bodies that share nodes with it
    int part_of = -1;          // none: it is by itself
    double size = 1;
  };

  static Pair Of(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

  int Root(int b) {
    int root = b;
    while (pieces_[root].part_of >= 0) root = pieces_[root].part_of;
    while (b != root) b = std::exchange(pieces_[b].part_of, root);
    return root;
  }

  double ToleranceOf(double size) const {
    return std::clamp(kCoordinateDigits * extent_ / size, kJointTolerance, kMaxTolerance);
  }

  void Measure(int b) {
    Piece& piece = pieces_[b];
    for (const int v : piece.body.nodes) {
      piece.box.extend(mesh_.nodes.col(v));
      if ((constraints_.fixed.col(v) != 0).any()) piece.fixed.push_back(v);
    }
    piece.size = SizeOf(piece.box);
  }

  static double SizeOf(const Eigen::AlignedBox3d& box) {
    return std::max(0.5 * box.diagonal().norm(), 1e-300);
  }

  // Finds the nodes that bodies share.
  void Meet() {
    std::vector<int> first(mesh_.nodes.cols(), -1);
    std::map<int, std::vector<int>> all;  // bodies of nodes that have several
    for (int b = 0; b < ground_; ++b) {
      for (const int v : pieces_[b].body.nodes) {
        if (first[v] < 0) {
          first[v] = b;
        } else {
          all.try_emplace(v, 1, first[v]).first->second.push_back(b);
        }
      }
    }
    for (const auto& [v, bodies] : all) {
      for (std::size_t k = 0; k < bodies.size(); ++k) {
        for (std::size_t l = k + 1; l < bodies.size(); ++l) {
          shared_[{bodies[k], bodies[l]}].insert(v);
          pieces_[bodies[k]].neighbours.insert(bodies[l]);
          pieces_[bodies[l]].neighbours.insert(bodies[k]);
        }
      }
    }
  }

  // What supports, and the body that is held, hold of a body.
  std::vector<RigidMotion> HoldsOf(int b) const {
    const Piece& piece = pieces_[b];
    const Eigen::Vector3d centre = piece.box.center();
    std::vector<RigidMotion> rows;
    const auto arm = [&](int v) -> Eigen::Vector3d {
      return (mesh_.nodes.col(v) - centre) / piece.size;
    };
    for (const int v : piece.fixed) {
      const int frame = constraints_.frames.empty() ? -1 : constraints_.frames.index[v];
      for (int k = 0; k < 3; ++k) {
        if (!constraints_.fixed(k, v)) continue;
        rows.push_back(Row(frame < 0 ? Eigen::Vector3d(Eigen::Vector3d::Unit(k))
                                     : Eigen::Vector3d(constraints_.frames.axes[frame].col(k)),
                           arm(v)));
      }
    }
    const auto with_held = shared_.find(Of(b, ground_));
    if (with_held == shared_.end()) return rows;
    for (const int v : with_held->second) {
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

  Joint JointOf(int first, int second, const std::set<int>& nodes) const {
    Joint joint;
    joint.size = std::min(pieces_[first].size, pieces_[second].size);
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

  // Of the bodies that are to be looked at, those that are held and each two that move as one.
  std::vector<Pair> Firm() {
    std::vector<Pair> firm;
    for (const int b : supported_) {
      if (b != Root(b) || b == ground_) continue;
      if (IndependentRows(HoldsOf(b), ToleranceOf(pieces_[b].size)).cols() == 6) {
        firm.emplace_back(ground_, b);
      }
    }
    for (const Pair& pair : meeting_) {
      const auto nodes = shared_.find(pair);  // none, where one of them has become part of another
      if (nodes == shared_.end()) continue;
      if (JointOf(pair.first, pair.second, nodes->second).rows.cols() == 6) firm.push_back(pair);
    }
    supported_.clear();
    meeting_.clear();
    return firm;
  }

  // Makes one body of two. Only those that share nodes with the one of fewer neighbours, which
  // becomes part of the other, may be joined more firmly than before.
  void Unite(int into, int from) {
    if (into == from) return;
    if (from == ground_ ||
        (into != ground_ && pieces_[into].neighbours.size() < pieces_[from].neighbours.size())) {
      std::swap(into, from);
    }
    Piece& whole = pieces_[into];
    Piece part = std::exchange(pieces_[from], {});
    pieces_[from].part_of = into;
    whole.body.parts.merge(part.body.parts);
    if (whole.body.nodes.size() < part.body.nodes.size()) whole.body.nodes.swap(part.body.nodes);
    whole.body.nodes.insert(whole.body.nodes.end(), part.body.nodes.begin(), part.body.nodes.end());
    whole.fixed.insert(whole.fixed.end(), part.fixed.begin(), part.fixed.end());
    whole.box.extend(part.box);
    whole.size = SizeOf(whole.box);
    whole.neighbours.erase(from);
    shared_.erase(Of(into, from));
    supported_.insert(into);
    for (const int other : part.neighbours) {
      if (other == into) continue;
      auto nodes = shared_.extract(Of(from, other));
      shared_[Of(into, other)].merge(nodes.mapped());
      whole.neighbours.insert(other);
      pieces_[other].neighbours.erase(from);
      pieces_[other].neighbours.insert(into);
      meeting_.insert(Of(into, other));
      if (into == ground_) supported_.insert(other);
    }
  }

  // Adds what the rows of a joint let happen or not. `of` makes an equation of a row.
  template <typename MakeEquation>
  static void AddRows(const Rows& rows, double tolerance, const MakeEquation& of,
                      JoinedBodies& joined) {
    for (const auto& row : rows.colwise()) joined.equations.push_back(of(row));
    const Rows slips = Complement(rows);
    for (const auto& row : slips.colwise()) joined.slips.push_back(of(row));
    joined.tolerances.push_back(tolerance);
  }

  // All bodies that are left, in the order of their first elements, and their joints.
  JoinedBodies Result() {
    JoinedBodies joined;
    std::map<int, int> number;
    for (int b = 0; b < ground_; ++b) {
      const int root = Root(b);
      const auto [at, is_new] = number.try_emplace(root, static_cast<int>(joined.bodies.size()));
      if (!is_new) continue;
      Piece& piece = pieces_[root];
      std::vector<int>& nodes = piece.body.nodes;
      std::sort(nodes.begin(), nodes.end());
      nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
      joined.bodies.push_back({std::move(piece.body), piece.box.center(), piece.size,
                               root == ground_, !piece.neighbours.empty()});
    }
    for (const auto& [root, b] : number) {
      if (root != ground_) AddHolds(root, b, joined);
    }
    for (const auto& [pair, nodes] : shared_) {
      if (pair.second == ground_) continue;
      AddJoint(pair, {number.at(pair.first), number.at(pair.second)}, nodes, joined);
    }
    return joined;
  }

  void AddHolds(int piece, int b, JoinedBodies& joined) const {
    const double tolerance = ToleranceOf(pieces_[piece].size);
    const Rows rows = IndependentRows(HoldsOf(piece), tolerance);
    if (rows.cols() == 0) return;
    AddRows(
        rows, tolerance,
        [&](const RigidMotion& row) {
          return JointEquation{static_cast<int>(joined.tolerances.size()), b, -1, row};
        },
        joined);
  }

  void AddJoint(const Pair& pieces, const Pair& bodies, const std::set<int>& nodes,
                JoinedBodies& joined) const {
    const Joint joint = JointOf(pieces.first, pieces.second, nodes);
    const auto of = [&](const JoinedBody& body, const RigidMotion& row) {
      RigidMotion motion;
      motion << row.head<3>(),
          ((joint.middle - body.centre).cross(row.head<3>()) + joint.size * row.tail<3>()) /
              body.size;
      return motion;
    };
    AddRows(
        joint.rows, ToleranceOf(joint.size),
        [&](const RigidMotion& row) {
          JointEquation equation{static_cast<int>(joined.tolerances.size()), bodies.first,
                                 bodies.second, of(joined.bodies[bodies.first], row),
                                 -of(joined.bodies[bodies.second], row)};
          const double length = std::hypot(equation.of_first.norm(), equation.of_second.norm());
          equation.of_first /= length;
          equation.of_second /= length;
          return equation;
        },
        joined);
  }

  const mesh::TetrahedralMesh& mesh_;
  const Constraints& constraints_;
  const double extent_;  // m, the largest coordinate
  int ground_ = 0;       // the body that is held, after all others
  std::vector<Piece> pieces_;
  std::map<Pair, std::set<int>> shared_;  // nodes of each two bodies
  std::set<int> supported_;               // bodies to be looked at: whether they are held,
  std::set<Pair> meeting_;                // and whether these two move as one
};

}  // namespace

JoinedBodies JoinBodies(const mesh::TetrahedralMesh& mesh, const Constraints& constraints) {
  return Joiner(mesh, constraints).Join();
}

}  // namespace mortise::simulator
