#include "common/fem/mechanisms/free_motions.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/base/units.h"
#include "common/fem/linear/null_space.h"

namespace mortise::simulator {
namespace {

// Enough of them to tell of one.
constexpr int kMotionsToTell = 60;

// What moves by less than this share of a motion's size stays where it is.
constexpr double kAtRest = 1e-4;

// Bodies that equations connect, beside those that are held.
std::vector<std::vector<int>> ConnectedBodies(const JoinedBodies& joined) {
  std::vector<int> parent(joined.bodies.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int b) {
    while (parent[b] != b) b = parent[b] = parent[parent[b]];
    return b;
  };
  for (const JointEquation& equation : joined.equations) {
    if (equation.second >= 0) parent[root(equation.second)] = root(equation.first);
  }
  std::map<int, std::size_t> number;
  std::vector<std::vector<int>> groups;
  for (int b = 0; b < static_cast<int>(joined.bodies.size()); ++b) {
    if (joined.bodies[b].is_held) continue;
    const auto [at, is_new] = number.try_emplace(root(b), groups.size());
    if (is_new) groups.emplace_back();
    groups[at->second].push_back(b);
  }
  return groups;
}

// Bodies that hang together, and what their joints let happen or not.
struct Group {
  std::vector<int> bodies;
  std::vector<JointEquation> equations, slips;
};

std::vector<Group> GroupsOf(const JoinedBodies& joined) {
  std::vector<Group> groups;
  std::vector<int> group_of(joined.bodies.size(), -1);
  for (std::vector<int>& bodies : ConnectedBodies(joined)) {
    for (const int b : bodies) group_of[b] = static_cast<int>(groups.size());
    groups.push_back({std::move(bodies), {}, {}});
  }
  for (const JointEquation& equation : joined.equations) {
    groups[group_of[equation.first]].equations.push_back(equation);
  }
  for (const JointEquation& slip : joined.slips) {
    groups[group_of[slip.first]].slips.push_back(slip);
  }
  return groups;
}

// The matrix of equations between bodies at these places, each divided by one of `scales`.
Eigen::SparseMatrix<double> RowsOf(const std::vector<JointEquation>& equations,
                                   const std::map<int, int>& place,
                                   const std::vector<double>& scales) {
  std::vector<Eigen::Triplet<double>> entries;
  int row = 0;
  for (const JointEquation& equation : equations) {
    const double scale = scales.empty() ? 1 : scales[equation.joint];
    for (int k = 0; k < 6; ++k) {
      entries.emplace_back(row, 6 * place.at(equation.first) + k, equation.of_first[k] / scale);
      if (equation.second < 0) continue;
      entries.emplace_back(row, 6 * place.at(equation.second) + k, equation.of_second[k] / scale);
    }
    ++row;
  }
  Eigen::SparseMatrix<double> rows(row, 6 * place.size());
  rows.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

NullSpace MotionsOf(const Group& group, const std::vector<double>& tolerances, int most) {
  std::map<int, int> place;
  for (const int b : group.bodies) place.try_emplace(b, static_cast<int>(place.size()));
  JointRows rows;
  rows.misfits = RowsOf(group.equations, place, tolerances);
  rows.slips = RowsOf(group.slips, place, {});
  return FindNullSpace(rows, most);
}

// The directions, orthonormal, that the columns of `vectors` span.
Eigen::MatrixXd Span(const Eigen::MatrixXd& vectors) {
  if (vectors.cols() == 0) return vectors;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(vectors, Eigen::ComputeThinU);
  return svd.matrixU().leftCols((svd.singularValues().array() > kAtRest).count());
}

// Combinations of the columns of `motions` that do not move the rows from `first` on.
Eigen::MatrixXd Resting(const Eigen::MatrixXd& motions, Eigen::Index first, Eigen::Index count) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(motions.middleRows(first, count),
                                              Eigen::ComputeFullV);
  const Eigen::Index moving = (svd.singularValues().array() > kAtRest).count();
  return motions * svd.matrixV().rightCols(motions.cols() - moving);
}

// Picks one of the directions that `span` holds: an axis of space if it can, or else any.
Eigen::Vector3d SimplestDirection(const Eigen::MatrixXd& span) {
  for (int k = 0; k < 3; ++k) {
    if (span.row(k).norm() > 1 - 1e-6) return Eigen::Vector3d::Unit(k);
  }
  return (span.col(0).sum() < 0 ? -1 : 1) * span.col(0);
}

// The point that rotations (6 × any number) leave where it is, as an offset from the body's centre
// in units of its size, the nearest one if there are several; false if there is none.
bool FindFixedPoint(const Eigen::MatrixXd& motions, Eigen::Vector3d& point) {
  Eigen::MatrixXd turns(3 * motions.cols(), 3);
  Eigen::VectorXd shifts(3 * motions.cols());
  for (Eigen::Index k = 0; k < motions.cols(); ++k) {
    const Eigen::Vector3d turn = motions.col(k).tail<3>();
    for (int c = 0; c < 3; ++c) {
      turns.block<3, 1>(3 * k, c) = turn.cross(Eigen::Vector3d::Unit(c));
    }
    shifts.segment<3>(3 * k) = motions.col(k).head<3>();
  }
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(turns, Eigen::ComputeThinU | Eigen::ComputeThinV);
  svd.setThreshold(kAtRest);
  point = svd.solve(-shifts);
  return (turns * point + shifts).norm() < kAtRest;
}

std::string AxisText(const Eigen::Vector3d& direction) {
  static constexpr const char* kNames[] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    if (std::abs(direction[k]) > 0.9999) return kNames[k];
  }
  return absl::StrFormat("(%.3g, %.3g, %.3g)", direction.x(), direction.y(), direction.z());
}

// The simplest of a body's motions (6 × any number): "move along x", "rotate about z through
// (20, 0, 0) mm".
std::string MotionText(const JoinedBody& body, Eigen::MatrixXd motions) {
  motions /= motions.norm();
  const Eigen::MatrixXd shifts = Span(Resting(motions, 3, 3).topRows<3>());
  if (shifts.cols() > 0) return "move along " + AxisText(SimplestDirection(shifts));
  const Eigen::Vector3d axis = SimplestDirection(Span(motions.bottomRows<3>()));
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(motions.bottomRows<3>(),
                                        Eigen::ComputeThinU | Eigen::ComputeThinV);
  svd.setThreshold(kAtRest);
  const Eigen::Vector3d shift = motions.topRows<3>() * svd.solve(axis);
  Eigen::Vector3d offset;
  if (!FindFixedPoint(motions, offset)) offset = axis.cross(shift);
  Eigen::Vector3d point = body.centre + body.size * offset;
  // Rounding is no place.
  const double least = 1e-6 * std::max(body.size, point.norm());
  for (double& coordinate : point) coordinate = std::abs(coordinate) < least ? 0 : coordinate;
  point /= kMillimetre;
  return absl::StrFormat("rotate about %s through (%.4g, %.4g, %.4g) mm%s", AxisText(axis),
                         point.x(), point.y(), point.z(),
                         std::abs(axis.dot(shift)) > kAtRest ? ", moving along it" : "");
}

// The place in the group of those bodies that `motions` move, the largest first.
std::vector<int> Moving(const MovingBodies& group, const JoinedBodies& joined,
                        const Eigen::MatrixXd& motions) {
  std::vector<int> moving;
  for (std::size_t k = 0; k < group.bodies.size(); ++k) {
    if (motions.middleRows(6 * k, 6).norm() > kAtRest) moving.push_back(static_cast<int>(k));
  }
  std::stable_sort(moving.begin(), moving.end(), [&](int a, int b) {
    return joined.bodies[group.bodies[a]].size > joined.bodies[group.bodies[b]].size;
  });
  return moving;
}

}  // namespace

FreeMotions FindFreeMotions(const mesh::TetrahedralMesh& mesh, const Constraints& constraints,
                            int most) {
  FreeMotions free;
  free.joined = JoinBodies(mesh, constraints);
  for (Group& group : GroupsOf(free.joined)) {
    NullSpace space = MotionsOf(group, free.joined.tolerances, most);
    if (space.dimension == 0) continue;
    free.count += space.dimension;
    const bool is_loose =
        std::none_of(group.equations.begin(), group.equations.end(),
                     [](const JointEquation& equation) { return equation.second < 0; });
    free.groups.push_back(
        {std::move(group.bodies), space.dimension, is_loose, std::move(space.basis)});
  }
  return free;
}

std::string MotionText(const FreeMotions& free, const mesh::TetrahedralMesh& mesh) {
  const MovingBodies& group = free.groups.front();
  const std::vector<JoinedBody>& bodies = free.joined.bodies;
  std::vector<Body> all;
  for (const JoinedBody& body : bodies) all.push_back(body.body);
  Eigen::MatrixXd motions = group.motions;
  if (group.is_loose) {
    const std::vector<int> moving = Moving(group, free.joined, motions);
    std::set<int> parts;
    for (const int b : group.bodies) parts.insert(all[b].parts.begin(), all[b].parts.end());
    const std::string what = group.bodies.size() == 1 ? BodyText(all[group.bodies[0]], all, mesh)
                                                      : PartsText(parts, mesh);
    return absl::StrCat(
        what, " free to ",
        MotionText(bodies[group.bodies[moving[0]]], motions.middleRows(6 * moving[0], 6)),
        " and in ", group.count - 1, " other ways");
  }
  // One body after the other is kept where it is, the largest first, as long as something moves.
  for (const int k : Moving(group, free.joined, motions)) {
    Eigen::MatrixXd others = Resting(motions, 6 * k, 6);
    if (others.cols() > 0) motions = std::move(others);
  }
  const std::vector<int> moving = Moving(group, free.joined, motions);
  const JoinedBody& body = bodies[group.bodies[moving[0]]];
  const auto ways = motions.cols();
  return absl::StrCat(
      BodyText(all[group.bodies[moving[0]]], all, mesh), " free to ",
      MotionText(body, motions.middleRows(6 * moving[0], 6)),
      ways > 1 ? absl::StrCat(" and in ", ways - 1, ways > 2 ? " other ways" : " other way") : "",
      moving.size() > 1
          ? absl::StrCat(", and ", moving.size() - 1,
                         moving.size() > 2 ? " other bodies with it" : " other body with it")
          : "");
}

absl::Status CheckRigidMotion(const mesh::TetrahedralMesh& mesh, const Constraints& constraints) {
  MORTISE_RETURN_IF_ERROR(CheckNodesAreUsed(mesh));
  const FreeMotions free = FindFreeMotions(mesh, constraints, kMotionsToTell);
  if (free.count == 0) return absl::OkStatus();
  const MovingBodies& group = free.groups.front();
  const bool is_joined = std::any_of(group.bodies.begin(), group.bodies.end(),
                                     [&](int b) { return free.joined.bodies[b].is_joined; });
  return PreconditionFailed(
      "RIGID_MOTION",
      absl::StrCat(MotionText(free, mesh), ": not held by supports or bonded parts",
                   is_joined ? ", as an edge or a point that bodies share is but a hinge" : ""),
      "supports");
}

std::vector<Eigen::Matrix3Xd> Displacements(const FreeMotions& free,
                                            const mesh::TetrahedralMesh& mesh) {
  // Bodies agree at the nodes they share but for rounding, of which the mean is taken.
  Eigen::ArrayXd shares = Eigen::ArrayXd::Zero(mesh.nodes.cols());
  for (const JoinedBody& body : free.joined.bodies) {
    for (const int v : body.body.nodes) ++shares[v];
  }
  std::vector<Eigen::Matrix3Xd> displacements;
  for (const MovingBodies& group : free.groups) {
    for (const auto& motion : group.motions.colwise()) {
      Eigen::Matrix3Xd& sum = displacements.emplace_back(3, mesh.nodes.cols());
      sum.setZero();
      for (std::size_t k = 0; k < group.bodies.size(); ++k) {
        const JoinedBody& body = free.joined.bodies[group.bodies[k]];
        const Eigen::Vector3d shift = motion.segment<3>(6 * k);
        const Eigen::Vector3d turn = motion.segment<3>(6 * k + 3) / body.size;
        for (const int v : body.body.nodes) {
          sum.col(v) +=
              (shift + turn.cross(Eigen::Vector3d(mesh.nodes.col(v) - body.centre))) / shares[v];
        }
      }
    }
  }
  return displacements;
}

}  // namespace mortise::simulator
