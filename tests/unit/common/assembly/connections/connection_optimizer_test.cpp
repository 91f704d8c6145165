// What becomes of a connection when its principals change. Two boards with dowels are worked out by
// hand.
#include "common/assembly/connections/connection_optimizer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/assembly/polyhedra/polyhedron.h"
#include "common/base/errors.h"
#include "tests/unit/common/assembly/connections/connection_assemblies.h"

namespace mortise::parametric {
namespace {

// ---- By hand

TEST(ConnectionOptimizer, AddsDowelsAsBoardsGrow) {
  const ConnectionOptimizer boards(Only(ParametrizedDesign(DowelledBoards())));
  const auto longer =
      boards.Optimize({{{0, 0, 0}, {1, 0.1, 0.02}}, {{0, 0.04, 0.02}, {1, 0.06, 0.22}}});
  ASSERT_TRUE(longer.ok()) << longer.status();
  // 0.95 m from the first to the last, at most 0.11 m apart: nine spaces.
  ASSERT_EQ(longer->parts.size(), 10U);
  for (int i = 0; i < 10; ++i) {
    const double x = 0.025 + 0.95 / 9 * i;
    ExpectBox(longer->parts[static_cast<std::size_t>(i)].box, {x - 0.004, 0.046, 0.008},
              {x + 0.004, 0.054, 0.038});
  }
  EXPECT_EQ(longer->parts[9].name, "dowel 1 (10)");
  EXPECT_LT(longer->soft_residual, 1e-12) << "all soft relationships can hold";
  EXPECT_LT(longer->hard_residual, 1e-12);
}

TEST(ConnectionOptimizer, FollowsThePatchWhenBoardsAreNotAlike) {
  const ConnectionOptimizer boards(Only(ParametrizedDesign(DowelledBoards())));
  // Thicker below, wider, and the wall is shorter and stands near the back.
  const auto moved =
      boards.Optimize({{{0, 0, 0}, {0.6, 0.2, 0.03}}, {{0.1, 0.14, 0.03}, {0.5, 0.16, 0.2}}});
  ASSERT_TRUE(moved.ok()) << moved.status();
  ExpectBox(moved->patches.front().region, {0.1, 0.14, 0.03}, {0.5, 0.16, 0.03});
  // 0.35 m from the first to the last: four spaces.
  ASSERT_EQ(moved->parts.size(), 5U);
  for (int i = 0; i < 5; ++i) {
    const double x = 0.125 + 0.35 / 4 * i;
    ExpectBox(moved->parts[static_cast<std::size_t>(i)].box, {x - 0.004, 0.146, 0.018},
              {x + 0.004, 0.154, 0.048});
  }
}

// Where a board is thinner than the dowel goes in, the dowel goes as far as it can.
TEST(ConnectionOptimizer, HardRelationshipsComeBeforeSoftOnes) {
  const ConnectionOptimizer boards(Only(ParametrizedDesign(DowelledBoards())));
  const auto thin =
      boards.Optimize({{{0, 0, 0}, {0.6, 0.1, 0.01}}, {{0, 0.04, 0.01}, {0.6, 0.06, 0.21}}});
  ASSERT_TRUE(thin.ok()) << thin.status();
  ExpectBox(thin->parts.front().box, {0.021, 0.046, 0}, {0.029, 0.054, 0.03});
  // Both ends are 2 mm off; the nearer (12 mm) counts fully, the further (18 mm) 12/18.
  EXPECT_NEAR(thin->soft_residual, 0.002 * std::sqrt(1 + 4.0 / 9), 1e-9);
}

TEST(ConnectionOptimizer, NamesWhatCannotHoldTogether) {
  const ConnectionOptimizer boards(Only(ParametrizedDesign(DowelledBoards())));
  const auto refused = [&](const BoundingBox& bottom, const BoundingBox& wall) {
    const absl::Status status = boards.Optimize({bottom, wall}).status();
    EXPECT_EQ(DetailOf(status).reason, "CONNECTION_CONFLICT") << status;
    return std::string(status.message());
  };
  const std::string narrow =
      refused({{0, 0, 0}, {0.6, 0.1, 0.02}}, {{0, 0.047, 0.02}, {0.6, 0.053, 0.22}});
  for (const char* part :
       {"'dowel 1' y size fixed at 0.008 m", "'wall' y minimum before 'dowel 1' y minimum",
        "'dowel 1' y centre level with y centre of the contact of 'bottom' and 'wall'"}) {
    EXPECT_NE(narrow.find(part), std::string::npos) << narrow;
  }
  const std::string flat =
      refused({{0, 0, 0}, {0.6, 0.1, 0.01}}, {{0, 0.04, 0.01}, {0.6, 0.06, 0.025}});
  for (const char* part :
       {"'dowel 1' z size fixed at 0.03 m", "'bottom' z minimum before 'dowel 1' z minimum",
        "'dowel 1' z maximum before 'wall' z maximum"}) {
    EXPECT_NE(flat.find(part), std::string::npos) << flat;
  }
  EXPECT_EQ(flat.find(" x "), std::string::npos) << "nothing superfluous: " << flat;
  const std::string brief =
      refused({{0, 0, 0}, {0.1, 0.1, 0.02}}, {{0, 0.04, 0.02}, {0.1, 0.06, 0.22}});
  EXPECT_NE(brief.find("'dowel 1' x size at least"), std::string::npos) << brief;
}

TEST(ConnectionOptimizer, NamesPrincipalsThatDoNotMeet) {
  const ConnectionOptimizer boards(Only(ParametrizedDesign(DowelledBoards())));
  const auto refused = [&](const BoundingBox& bottom, const BoundingBox& wall) {
    const absl::Status status = boards.Optimize({bottom, wall}).status();
    EXPECT_EQ(DetailOf(status).reason, "CONNECTION_APART") << status;
    return std::string(status.message());
  };
  const BoundingBox bottom{{0, 0, 0}, {0.6, 0.1, 0.02}};
  EXPECT_EQ(refused(bottom, {{0, 0.04, 0.03}, {0.6, 0.06, 0.23}}),
            "'bottom' and 'wall' do not touch");
  EXPECT_EQ(refused(bottom, {{0.6, 0.04, 0.02}, {1.2, 0.06, 0.22}}),
            "'bottom' and 'wall' do not touch");
  EXPECT_EQ(refused(bottom, {{0.6, 0.04, 0}, {1.2, 0.06, 0.2}}),
            "'bottom' and 'wall' meet across x instead of z");
  EXPECT_EQ(refused(bottom, {{0, 0.04, -0.2}, {0.6, 0.06, 0}}),
            "'bottom' and 'wall' have changed sides along z");
}

TEST(ConnectionOptimizer, NamesBadInput) {
  const ConnectionOptimizer boards(Only(ParametrizedDesign(DowelledBoards())));
  const BoundingBox bottom{{0, 0, 0}, {0.6, 0.1, 0.02}};
  const auto field = [&](const std::vector<BoundingBox>& principals) {
    const absl::Status status = boards.Optimize(principals).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
    return DetailOf(status).field;
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(field({}), "principals");
  EXPECT_EQ(field({bottom}), "principals");
  EXPECT_EQ(field({bottom, bottom, bottom}), "principals");
  EXPECT_EQ(field({bottom, {{0, 0, kNaN}, {1, 1, 1}}}), "principals[1]");
  EXPECT_EQ(field({{{0, 0, 0}, {1, kInfinity, 1}}, bottom}), "principals[0]");
  EXPECT_EQ(field({bottom, {{0, 0.04, 0.02}, {0.6, 0.04, 0.22}}}), "principals[1]");
  EXPECT_EQ(field({bottom, {{0, 0.06, 0.02}, {0.6, 0.04, 0.22}}}), "principals[1]");
}

// A lid hinged to the back of a box: the joint is placed with the hinge.
TEST(ConnectionOptimizer, TakesTheJointAlong) {
  Assembly chest;
  chest.name = "chest";
  chest.groups = {{"chest", -1}, {"lid", 0}};
  chest.parts = {ResizablePart("case", {0, 0, 0}, {0.6, 0.3, 0.2}),
                 ResizablePart("cover", {0, 0, 0.2}, {0.6, 0.3, 0.22}, 1),
                 Fastener("hinge", {0.25, 0.3, 0.18}, {0.35, 0.302, 0.22})};
  Joint joint;
  joint.name = "lid hinge";
  joint.group = 1;
  joint.center = {0.3, 0.301, 0.2};
  joint.axis = Eigen::Vector3d::UnitX();
  joint.lower = -1.6;
  joint.rest_poses = {{"open", {-std::acos(0.0), 0, 0}}};
  chest.joints = {joint};
  const ConnectionOptimizer lid(Only(ParametrizedDesign(std::move(chest))));
  ASSERT_EQ(lid.connection().joints.size(), 1U);
  const auto deeper = lid.Optimize({{{0, 0, 0}, {0.8, 0.4, 0.3}}, {{0, 0, 0.3}, {0.8, 0.4, 0.32}}});
  ASSERT_TRUE(deeper.ok()) << deeper.status();
  ExpectBox(deeper->connecting[0], {0.35, 0.4, 0.28}, {0.45, 0.402, 0.32});
  const Eigen::Vector3d center = deeper->q.segment<3>(6 * 3);
  EXPECT_LT((center - Eigen::Vector3d(0.4, 0.401, 0.3)).norm(), 1e-9) << center.transpose();
}

// What is taken out of a design needs nothing of it.
TEST(ConnectionOptimizer, OutlivesTheDesign) {
  std::optional<ConnectionOptimizer> kept;
  {
    const ParametricAssembly corner = ParametrizedDesign(BoltedCorner());
    kept.emplace(Only(corner));
  }
  const Assembly drawn = BoltedCorner();
  const auto same = kept->Optimize({drawn.parts[0].box, drawn.parts[1].box});
  ASSERT_TRUE(same.ok()) << same.status();
  ASSERT_EQ(same->parts.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    ExpectBox(same->parts[i].box, drawn.parts[i + 2].box.minimum, drawn.parts[i + 2].box.maximum);
  }
}

// ---- For any principals

// All hard relationships of a connection over its unknowns, as they are: nothing left out, nothing
// solved for.
struct FullProblem {
  Polyhedron allowed;
  Eigen::MatrixXd soft;  // weighted
  Eigen::VectorXd wish;
};

FullProblem ProblemOf(const ElementConnection& connection, Eigen::VectorXd local) {
  const int first = connection.first_unknown();
  const int unknowns = connection.end_unknown() - first;
  local.segment(first, unknowns).setZero();
  const auto row_of = [&](const LinearForm& form) {
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(unknowns);
    for (const LinearTerm& term : form.terms) {
      const int column = term.variable - first;
      if (column >= 0 && column < unknowns) row[column] = term.coefficient;
    }
    return row;
  };
  const auto append = [](Eigen::MatrixXd& rows, Eigen::VectorXd& ends,
                         const Eigen::RowVectorXd& row, double end) {
    rows.conservativeResize(rows.rows() + 1, row.size());
    rows.bottomRows(1) = row;
    ends.conservativeResize(rows.rows());
    ends.tail(1)[0] = end;
  };
  FullProblem problem;
  for (const Relationship& hard : connection.hard) {
    Polyhedron& allowed = problem.allowed;
    append(hard.equality ? allowed.equalities : allowed.inequalities,
           hard.equality ? allowed.values : allowed.bounds, row_of(hard.form),
           -hard.form.At(local));
  }
  for (const SoftRelationship& soft : connection.soft) {
    append(problem.soft, problem.wish, soft.weight * row_of(soft.form),
           -soft.weight * soft.form.At(local));
  }
  return problem;
}

// The unknowns by Hildreth's method: one relationship after the other, until nothing changes. Slow,
// simple, and nothing like what is tested.
Eigen::VectorXd ByHildreth(const FullProblem& problem) {
  const Polyhedron& allowed = problem.allowed;
  const Eigen::Index equalities = allowed.equalities.rows();
  Eigen::MatrixXd rows(equalities + allowed.inequalities.rows(), problem.soft.cols());
  rows << allowed.equalities, allowed.inequalities;
  Eigen::VectorXd bounds(rows.rows());
  bounds << allowed.values, allowed.bounds;
  const Eigen::MatrixXd inverse = (problem.soft.transpose() * problem.soft).inverse();
  const Eigen::MatrixXd moves = inverse * rows.transpose();
  const Eigen::VectorXd lengths = (rows.transpose().cwiseProduct(moves)).colwise().sum();
  Eigen::VectorXd u = inverse * problem.soft.transpose() * problem.wish;
  Eigen::VectorXd multipliers = Eigen::VectorXd::Zero(rows.rows());
  for (int sweep = 0; sweep < 20000; ++sweep) {
    double change = 0;
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      double step = (rows.row(i).dot(u) - bounds[i]) / lengths[i];
      if (i >= equalities) step = std::max(step, -multipliers[i]);
      if (step == 0) continue;
      multipliers[i] += step;
      u -= step * moves.col(i);
      change = std::max(change, std::abs(step) * std::sqrt(lengths[i]));
    }
    if (change < 1e-12) break;
  }
  return u;
}

// A sill of any size with a post on it, anywhere, of any size.
std::vector<BoundingBox> RandomCorner(std::mt19937& random) {
  const auto number = [&](double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
  };
  const Eigen::Vector3d place(number(-1, 1), number(-1, 1), number(-1, 1));
  BoundingBox sill{place,
                   place + Eigen::Vector3d(number(0.25, 1), number(0.05, 0.2), number(0.03, 0.06))};
  BoundingBox post;
  const double depth = sill.size().y();
  post.minimum =
      place + Eigen::Vector3d(number(-0.02, 0.1), number(-0.3, 0.3) * depth, sill.size().z());
  post.maximum =
      post.minimum + Eigen::Vector3d(number(0.06, 0.2), number(0.05, 0.2), number(0.2, 1));
  return {sill, post};
}

TEST(ConnectionOptimizer, FindsTheOptimumAnotherMethodFinds) {
  const ConnectionOptimizer corner(Only(ParametrizedDesign(BoltedCorner())));
  ASSERT_GT(corner.degrees_of_freedom(), 2);
  std::mt19937 random(7);
  int found = 0;
  int tight = 0;
  for (int i = 0; i < 100; ++i) {
    SCOPED_TRACE(i);
    const auto made = corner.Optimize(RandomCorner(random));
    if (!made.ok()) continue;
    ++found;
    const ElementConnection& connection = corner.connection();
    Eigen::VectorXd other = made->q;
    const Eigen::VectorXd unknowns = ByHildreth(ProblemOf(connection, made->q));
    other.segment(connection.first_unknown(), unknowns.size()) = unknowns;
    ASSERT_LT(HardResidual(connection, other), 1e-7);
    ASSERT_LE(made->soft_residual, SoftResidual(connection, other) + 1e-7);
    ASSERT_LT((made->q - other).cwiseAbs().maxCoeff(), 1e-5);
    tight += made->soft_residual > 1e-6 ? 1 : 0;
  }
  EXPECT_GE(found, 30);
  EXPECT_GE(tight, 15) << "or there is nothing to choose";
}

TEST(ConnectionOptimizer, WhatIsRefusedHasNoSolution) {
  const ConnectionOptimizer corner(Only(ParametrizedDesign(BoltedCorner())));
  const ElementConnection& connection = corner.connection();
  std::mt19937 random(11);
  int refused = 0;
  for (int i = 0; i < 300 && refused < 60; ++i) {
    SCOPED_TRACE(i);
    const std::vector<BoundingBox> principals = RandomCorner(random);
    const auto made = corner.Optimize(principals);
    if (made.ok() || DetailOf(made.status()).reason != "CONNECTION_CONFLICT") continue;
    ++refused;
    Eigen::VectorXd local = DrawnParameters(connection);
    for (int p = 0; p < 2; ++p) {
      local.segment<3>(6 * p) = principals[static_cast<std::size_t>(p)].center();
      local.segment<3>(6 * p + 3) = principals[static_cast<std::size_t>(p)].size();
    }
    const BoundingBox region = PatchAt(connection, 0, principals).region;
    local.segment<3>(connection.PatchVariable(0, Axis::kX)) = region.center();
    local.segment<3>(connection.PatchVariable(0, Axis::kX) + 3) = region.size();
    const FullProblem problem = ProblemOf(connection, local);
    const auto nearest = ProjectOnto(problem.allowed, Eigen::VectorXd::Zero(problem.soft.cols()));
    ASSERT_TRUE(nearest.ok()) << nearest.status();
    EXPECT_FALSE(nearest->point.has_value()) << made.status();
  }
  EXPECT_GE(refused, 5);
}

TEST(ConnectionOptimizer, KeepsWhatMakesItAConnection) {
  const ConnectionOptimizer corner(Only(ParametrizedDesign(BoltedCorner())));
  std::mt19937 random(5);
  int found = 0;
  for (int i = 0; i < 1000; ++i) {
    SCOPED_TRACE(i);
    const std::vector<BoundingBox> principals = RandomCorner(random);
    const auto made = corner.Optimize(principals);
    if (!made.ok()) continue;
    ++found;
    ASSERT_LT(made->hard_residual, 1e-9);
    const auto apart = [](const BoundingBox& a, const BoundingBox& b) {
      return (b.minimum - a.maximum).cwiseMax(a.minimum - b.maximum).maxCoeff();
    };
    const BoundingBox& region = made->patches.front().region;
    for (const std::size_t through : {0, 1, 3}) {  // screws and bolt
      const BoundingBox& box = made->connecting[through];
      ASSERT_LT(apart(box, principals[0]), -0.005);
      ASSERT_LT(apart(box, principals[1]), -0.005);
      for (const int axis : {0, 1}) {
        ASSERT_GE(box.minimum[axis], region.minimum[axis] - 1e-9);
        ASSERT_LE(box.maximum[axis], region.maximum[axis] + 1e-9);
      }
    }
    const BoundingBox& bracket = made->connecting[2];
    ASSERT_NEAR(bracket.minimum.x(), principals[1].maximum.x(), 1e-9) << "against the post";
    ASSERT_NEAR(bracket.minimum.z(), principals[0].maximum.z(), 1e-9) << "on the sill";
    const BoundingBox& washer = made->connecting[4];
    ASSERT_NEAR(washer.maximum.z(), principals[0].minimum.z(), 1e-9) << "under the sill";
    for (std::size_t e = 0; e < made->connecting.size(); ++e) {
      const Element& drawn = corner.connection().elements[e + 2];
      ASSERT_LT((made->connecting[e].size() - drawn.box.size()).norm(), 1e-9) << drawn.name;
    }
  }
  EXPECT_GE(found, 300);
}

TEST(ConnectionOptimizer, MovesAlongWithItsPrincipals) {
  const ConnectionOptimizer corner(Only(ParametrizedDesign(BoltedCorner())));
  std::mt19937 random(3);
  for (int i = 0; i < 100; ++i) {
    std::vector<BoundingBox> principals = RandomCorner(random);
    const auto made = corner.Optimize(principals);
    const Eigen::Vector3d by(0.3, -1.7, 0.1 * i);
    for (BoundingBox& box : principals) box = {box.minimum + by, box.maximum + by};
    const auto moved = corner.Optimize(principals);
    ASSERT_EQ(made.ok(), moved.ok());
    if (!made.ok()) continue;
    for (std::size_t e = 0; e < made->connecting.size(); ++e) {
      ExpectBox(moved->connecting[e], made->connecting[e].minimum + by,
                made->connecting[e].maximum + by);
    }
  }
}

TEST(ConnectionOptimizer, GivesEveryDrawnConnectionAsDrawn) {
  int connections = 0;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    Assembly assembly = RandomAssembly(seed);
    std::mt19937 random(seed);
    for (AssemblyPart& part : assembly.parts) part.connecting = random() % 3 == 0;
    const std::vector<Element> elements = MakeElements(assembly, 1e-6);
    const auto contacts = FindContacts(assembly, elements, 1e-6);
    ASSERT_TRUE(contacts.ok()) << contacts.status();
    const auto relationships = FindRelationships(assembly, elements, *contacts, 1e-6);
    const Eigen::VectorXd drawn = DrawnParameters(assembly, elements);
    std::set<int> connecting;
    for (const ElementConnection& connection :
         FindConnections(assembly, elements, *contacts, relationships, 1e-6)) {
      ++connections;
      for (const int element : connection.connecting) {
        EXPECT_TRUE(connecting.insert(element).second) << "in one connection only";
      }
      const auto made = ConnectionOptimizer(connection).Optimize(PrincipalsAt(connection, drawn));
      ASSERT_TRUE(made.ok()) << made.status();
      EXPECT_LT((made->q - DrawnParameters(connection)).cwiseAbs().maxCoeff(), 1e-9);
      EXPECT_LT(made->hard_residual, 1e-9);
      EXPECT_LT(made->soft_residual, 1e-9);
    }
  }
  EXPECT_GE(connections, 50);
}

// Whatever principals become: what is answered holds, and what is refused says why.
TEST(ConnectionOptimizer, AnswersRightlyOrRefuses) {
  int placed = 0;
  int refused = 0;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    Assembly assembly = RandomAssembly(seed);
    std::mt19937 random(seed + 100);
    std::uniform_real_distribution<double> change(-0.04, 0.04);
    for (AssemblyPart& part : assembly.parts) part.connecting = random() % 2 == 0;
    const std::vector<Element> elements = MakeElements(assembly, 1e-6);
    const auto contacts = FindContacts(assembly, elements, 1e-6);
    ASSERT_TRUE(contacts.ok()) << contacts.status();
    const auto relationships = FindRelationships(assembly, elements, *contacts, 1e-6);
    for (const ElementConnection& connection :
         FindConnections(assembly, elements, *contacts, relationships, 1e-6)) {
      const ConnectionOptimizer optimizer(connection);
      for (int i = 0; i < 10; ++i) {
        std::vector<BoundingBox> principals =
            PrincipalsAt(connection, DrawnParameters(assembly, elements));
        // One face moves; all of them would part whatever touches.
        BoundingBox& box = principals[random() % principals.size()];
        const int axis = static_cast<int>(random() % 3);
        (random() % 2 == 0 ? box.minimum : box.maximum)[axis] += change(random);
        const auto made = optimizer.Optimize(principals);
        if (!made.ok()) {
          ++refused;
          EXPECT_EQ(made.status().code(), absl::StatusCode::kFailedPrecondition) << made.status();
          EXPECT_TRUE(DetailOf(made.status()).reason.starts_with("CONNECTION_"));
          continue;
        }
        ++placed;
        ASSERT_LT(made->hard_residual, 1e-9);
        ASSERT_TRUE(made->q.allFinite());
        for (const BoundingBox& connecting : made->connecting) {
          ASSERT_GT(connecting.size().minCoeff(), 0);
        }
      }
    }
  }
  EXPECT_GE(placed, 200);
  EXPECT_GE(refused, 200);
}

}  // namespace
}  // namespace mortise::parametric
