// The linear solvers against each other, and what they promise of threads, sizes, limits and
// misuse.
#include "common/fem/linear/linear_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "common/base/errors.h"
#include "common/fem/elements/stiffness.h"
#include "common/fem/linear/multigrid.h"
#include "common/fem/linear/tridiagonal.h"
#include "tests/unit/common/fem/problems/clamped_box.h"

namespace mortise::simulator {
namespace {

// A clamped box with its stiffness.
struct Problem {
  mesh::TetrahedralMesh mesh;
  NodeFrames frames;
  Eigen::Array3Xi fixed;
  Eigen::Matrix3Xd load;
  std::shared_ptr<const BlockMatrix> stiffness;

  Problem(const Eigen::Vector3d& size, const Eigen::Vector3i& cells, bool quadratic,
          const Material& material = Steel())
      : mesh(BoxMesh(size, cells, quadratic)), fixed(ClampedEnd(mesh)), load(EndLoad(mesh)) {
    Assemble(material);
  }

  void Assemble(const Material& material) {
    ThreadTeam alone(1);
    auto matrix = AssembleStiffness(mesh, {material}, frames, alone);
    ASSERT_TRUE(matrix.ok()) << matrix.status();
    stiffness = std::make_shared<BlockMatrix>(*std::move(matrix));
  }

  absl::StatusOr<std::unique_ptr<LinearSolver>> Solver(const SolverOptions& options) const {
    auto solver = LinearSolver::Create(mesh, stiffness->pattern(), fixed, frames, options);
    if (!solver.ok()) return solver;
    const absl::Status prepared = (*solver)->Prepare(stiffness, mesh.nodes);
    if (!prepared.ok()) return prepared;
    return solver;
  }
};

Problem Bar(bool quadratic) { return Problem({0.4, 0.1, 0.1}, {12, 4, 4}, quadratic); }

SolverOptions Of(SolverKind kind, int threads = 1) {
  SolverOptions options;
  options.kind = kind;
  options.threads = threads;
  return options;
}

Eigen::VectorXd Noise(const Eigen::Array3Xi& fixed, unsigned seed) {
  std::srand(seed);
  return (Eigen::ArrayXd::Random(fixed.size()) * (fixed == 0).cast<double>().reshaped()).matrix();
}

// The displacement by iteration, compared with that by a factor. The number of iterations.
int CompareKinds(const Problem& problem, double accuracy) {
  auto direct = problem.Solver(Of(SolverKind::kDirect));
  auto iterative = problem.Solver(Of(SolverKind::kIterative));
  EXPECT_TRUE(direct.ok() && iterative.ok()) << direct.status() << iterative.status();
  const auto expected = (*direct)->Solve(problem.load);
  const auto found = (*iterative)->Solve(problem.load);
  EXPECT_TRUE(expected.ok() && found.ok()) << expected.status() << found.status();
  EXPECT_LT((*found - *expected).norm(), accuracy * expected->norm());
  EXPECT_EQ((problem.fixed != 0).select(*found, 0.0).norm(), 0);
  EXPECT_LT(expected->row(2).minCoeff(), 0);
  return (*iterative)->summary().iterations;
}

class Solvers : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Elements, Solvers, testing::Bool(),
                         [](const auto& which) { return which.param ? "Quadratic" : "Linear"; });

TEST_P(Solvers, AgreeOnABar) { EXPECT_LT(CompareKinds(Bar(GetParam()), 1e-8), 40); }

TEST_P(Solvers, AgreeOnAThinPlate) {
  const Problem plate({1, 1, 0.04}, {12, 12, 1}, GetParam());
  EXPECT_LT(CompareKinds(plate, 1e-6), 400);
}

TEST_P(Solvers, AgreeOnANearlyIncompressibleBody) {
  Material rubber = Steel();
  rubber.youngs_modulus = 5e6;
  rubber.poissons_ratio = 0.45;
  EXPECT_LT(CompareKinds(Problem({0.4, 0.1, 0.1}, {12, 4, 4}, GetParam(), rubber), 1e-8), 80);
}

TEST_P(Solvers, AgreeOnWoodAcrossItsGrain) {
  Material spruce = Steel();
  Orthotropy wood;
  wood.youngs_modulus = {11e9, 0.9e9, 0.5e9};
  wood.poissons_ratio = {0.37, 0.47, 0.42};
  wood.shear_modulus = {0.7e9, 0.06e9, 0.75e9};
  wood.axes = Eigen::AngleAxisd(0.6, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  spruce.orthotropy = wood;
  EXPECT_LT(CompareKinds(Problem({0.4, 0.1, 0.1}, {12, 4, 4}, GetParam(), spruce), 1e-8), 150);
}

// Nodes of the long edges slide along inclined planes only.
TEST_P(Solvers, AgreeWhereSupportsAreInclined) {
  Problem problem = Bar(GetParam());
  problem.frames.index.assign(problem.mesh.nodes.cols(), -1);
  problem.frames.axes = {
      Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()).toRotationMatrix(),
      Eigen::AngleAxisd(-0.9, Eigen::Vector3d(1, 1, 0).normalized()).toRotationMatrix()};
  for (Eigen::Index v = 0; v < problem.mesh.nodes.cols(); ++v) {
    const Eigen::Vector3d p = problem.mesh.nodes.col(v);
    if (p.x() < 0.15 || p.y() > 1e-9) continue;
    problem.frames.index[v] = p.z() > 0.05 ? 1 : 0;
    problem.fixed(1, v) = p.z() < 1e-9;
  }
  problem.Assemble(Steel());
  EXPECT_LT(CompareKinds(problem, 1e-8), 80);
}

TEST_P(Solvers, TakeFewIterationsOnMeshesOfAnySize) {
  std::vector<int> iterations;
  for (const int side : {2, 4, 6}) {
    const Problem problem({0.4, 0.1, 0.1}, {4 * side, side, side}, GetParam());
    auto solver = problem.Solver(Of(SolverKind::kIterative));
    ASSERT_TRUE(solver.ok()) << solver.status();
    ASSERT_TRUE((*solver)->Solve(problem.load).ok());
    iterations.push_back((*solver)->summary().iterations);
  }
  EXPECT_LE(iterations.back(), 40);
  EXPECT_LE(iterations[2], iterations[1] + 12);
}

TEST_P(Solvers, GiveTheSameBitsOnAnyNumberOfThreads) {
  const Problem problem = Bar(GetParam());
  Eigen::Matrix3Xd first;
  for (const int threads : {1, 2, 3}) {
    auto solver = problem.Solver(Of(SolverKind::kIterative, threads));
    ASSERT_TRUE(solver.ok()) << solver.status();
    const auto solution = (*solver)->Solve(problem.load);
    ASSERT_TRUE(solution.ok()) << solution.status();
    if (threads == 1) first = *solution;
    EXPECT_EQ(first, *solution);
  }
}

TEST_P(Solvers, PreconditionBySomethingSymmetricAndPositive) {
  const Problem problem = Bar(GetParam());
  ThreadTeam team(2);
  Multigrid multigrid(problem.mesh, problem.fixed, {}, {}, team);
  ASSERT_TRUE(multigrid.Prepare(*problem.stiffness, problem.mesh.nodes).ok());
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Eigen::VectorXd a = Noise(problem.fixed, seed), b = Noise(problem.fixed, seed + 100);
    Eigen::VectorXd of_a, of_b, of_sum;
    multigrid.Correct(a, of_a);
    multigrid.Correct(b, of_b);
    multigrid.Correct(a + 2 * b, of_sum);
    EXPECT_GT(a.dot(of_a), 0);
    EXPECT_NEAR(b.dot(of_a), a.dot(of_b), 1e-10 * std::sqrt(a.dot(of_a) * b.dot(of_b)));
    EXPECT_LT((of_sum - of_a - 2 * of_b).norm(), 1e-10 * of_sum.norm());
    const Eigen::ArrayXd held = (problem.fixed != 0).cast<double>().reshaped();
    EXPECT_EQ((of_a.array() * held).matrix().norm(), 0);
  }
}

class Kinds : public testing::TestWithParam<SolverKind> {};
INSTANTIATE_TEST_SUITE_P(Linear, Kinds,
                         testing::Values(SolverKind::kDirect, SolverKind::kIterative),
                         [](const auto& which) {
                           return which.param == SolverKind::kDirect ? "Direct" : "Iterative";
                         });

TEST_P(Kinds, SolveForNewValuesOnTheSamePattern) {
  const Problem problem = Bar(true);
  auto solver = problem.Solver(Of(GetParam()));
  ASSERT_TRUE(solver.ok()) << solver.status();
  const auto before = (*solver)->Solve(problem.load);
  auto stiffer = std::make_shared<BlockMatrix>(*problem.stiffness);
  for (Eigen::Matrix3d& block : stiffer->blocks()) block *= 4;
  ASSERT_TRUE((*solver)->Prepare(stiffer, problem.mesh.nodes).ok());
  const auto after = (*solver)->Solve(problem.load);
  ASSERT_TRUE(before.ok() && after.ok());
  EXPECT_LT((4 * *after - *before).norm(), 1e-8 * before->norm());
}

// What modal analysis of a body without supports solves with.
TEST_P(Kinds, SolveWithAStiffnessShiftedByAMass) {
  Problem problem = Bar(true);
  problem.fixed.setZero();
  ThreadTeam alone(1);
  const auto mass = AssembleMass(problem.mesh, {Steel()}, {}, problem.stiffness->pattern(), alone);
  ASSERT_TRUE(mass.ok());
  auto shifted = std::make_shared<BlockMatrix>(*problem.stiffness);
  for (std::size_t k = 0; k < shifted->blocks().size(); ++k) {
    shifted->blocks()[k] += 1e6 * mass->blocks()[k];
  }
  problem.stiffness = shifted;
  auto solver = problem.Solver(Of(GetParam()));
  ASSERT_TRUE(solver.ok()) << solver.status();
  const auto solution = (*solver)->Solve(problem.load);
  ASSERT_TRUE(solution.ok()) << solution.status();
  EXPECT_LT((shifted->Multiply(*solution) - problem.load).norm(), 1e-7 * problem.load.norm());
}

TEST_P(Kinds, SolveSeveralLoadsAsEachByItself) {
  const Problem problem = Bar(false);
  auto solver = problem.Solver(Of(GetParam()));
  ASSERT_TRUE(solver.ok()) << solver.status();
  const Eigen::Matrix3Xd none = Eigen::Matrix3Xd::Zero(3, problem.load.cols());
  Eigen::Matrix3Xd sideways = none;
  sideways.row(1) = problem.load.row(2);
  const auto all = (*solver)->SolveAll({problem.load, none, sideways});
  ASSERT_TRUE(all.ok()) << all.status();
  ASSERT_EQ(all->size(), 3u);
  EXPECT_TRUE((*all)[1].isZero(0));
  const auto alone = (*solver)->Solve(sideways);
  ASSERT_TRUE(alone.ok());
  EXPECT_LT(((*all)[2] - *alone).norm(), 1e-9 * alone->norm());
}

TEST_P(Kinds, SolveNothingWhereEverythingIsHeld) {
  Problem problem = Bar(true);
  problem.fixed.setOnes();
  auto solver = problem.Solver(Of(GetParam()));
  ASSERT_TRUE(solver.ok()) << solver.status();
  const auto solution = (*solver)->Solve(problem.load);
  ASSERT_TRUE(solution.ok()) << solution.status();
  EXPECT_TRUE(solution->isZero(0));
}

TEST_P(Kinds, RefuseWhatTheyCannotHold) {
  SolverOptions options = Of(GetParam());
  options.memory_limit = 1e5;
  const absl::Status status = Bar(true).Solver(options).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted) << status;
}

TEST_P(Kinds, RefuseLoadsThatDoNotFit) {
  const Problem problem = Bar(false);
  auto solver = problem.Solver(Of(GetParam()));
  ASSERT_TRUE(solver.ok());
  Eigen::Matrix3Xd bad = problem.load;
  bad(1, 5) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(DetailOf((*solver)->SolveAll({problem.load, bad}).status()).field, "loads[1]");
  EXPECT_EQ(DetailOf((*solver)->Solve(problem.load.leftCols(7)).status()).field, "loads[0]");
  auto raw = LinearSolver::Create(problem.mesh, problem.stiffness->pattern(), problem.fixed, {},
                                  Of(GetParam()));
  ASSERT_TRUE(raw.ok());
  EXPECT_EQ(DetailOf((*raw)->Solve(problem.load).status()).reason, "NOT_PREPARED");
  EXPECT_EQ(DetailOf(LinearSolver::Create(problem.mesh, problem.stiffness->pattern(),
                                          problem.fixed.leftCols(3), {}, Of(GetParam()))
                         .status())
                .field,
            "fixed");
}

TEST_P(Kinds, RefuseWhatIsNotPositiveDefinite) {
  Problem problem = Bar(false);
  auto negative = std::make_shared<BlockMatrix>(*problem.stiffness);
  for (Eigen::Matrix3d& block : negative->blocks()) block *= -1;
  problem.stiffness = negative;
  auto solver = problem.Solver(Of(GetParam()));
  const absl::Status status =
      solver.ok() ? (*solver)->Solve(problem.load).status() : solver.status();
  EXPECT_EQ(DetailOf(status).reason, "SINGULAR") << status;
}

TEST_P(Kinds, RefuseBodiesThatFlyAway) {
  Problem problem = Bar(true);
  problem.fixed.setZero();
  auto solver = problem.Solver(Of(GetParam()));
  const absl::Status status =
      solver.ok() ? (*solver)->Solve(problem.load).status() : solver.status();
  EXPECT_EQ(DetailOf(status).reason, "SINGULAR") << status;
}

// Two blocks that share an edge only, the outer one pushed round it.
TEST_P(Kinds, RefuseHinges) {
  mesh::TetrahedralMesh mesh = BoxMesh({0.2, 0.2, 0.1}, {8, 8, 4}, true);
  // The edge is straight again.
  for (Eigen::Index v = 0; v < mesh.nodes.cols(); ++v) {
    const Eigen::Vector2d edge(0.1, 0.1);
    if ((mesh.nodes.col(v).head<2>() - edge).norm() < 0.005) mesh.nodes.col(v).head<2>() = edge;
  }
  Eigen::MatrixXi kept(mesh.tetrahedra.rows(), 0);
  Eigen::Array3Xi fixed = Eigen::Array3Xi::Ones(3, mesh.nodes.cols());
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (int a = 0; a < 4; ++a) centre += mesh.nodes.col(mesh.tetrahedra(a, e)) / 4;
    if ((centre.x() < 0.1) != (centre.y() < 0.1)) continue;
    kept.conservativeResize(Eigen::NoChange, kept.cols() + 1);
    kept.rightCols(1) = mesh.tetrahedra.col(e);
    for (Eigen::Index a = 0; a < mesh.tetrahedra.rows(); ++a) {
      fixed.col(mesh.tetrahedra(a, e)).setZero();
    }
  }
  mesh.tetrahedra = kept;
  mesh.part = Eigen::VectorXi::Zero(kept.cols());
  Problem problem = Bar(false);
  problem.fixed = (ClampedEnd(mesh) != 0).select(1, fixed);
  problem.load = EndLoad(mesh);
  problem.load.row(1) = problem.load.row(2);
  problem.mesh = mesh;
  problem.Assemble(Steel());
  auto solver = problem.Solver(Of(GetParam()));
  const absl::Status status =
      solver.ok() ? (*solver)->Solve(problem.load).status() : solver.status();
  EXPECT_EQ(DetailOf(status).reason, "SINGULAR") << status;
}

TEST_P(Kinds, StopWhenToldTo) {
  const Problem problem = Bar(true);
  SolverOptions options = Of(GetParam());
  int calls = 0;
  options.progress = [&](int, double) {
    return ++calls > 1 || GetParam() == SolverKind::kDirect ? absl::CancelledError("enough")
                                                            : absl::OkStatus();
  };
  auto solver = problem.Solver(options);
  const absl::Status status =
      solver.ok() ? (*solver)->Solve(problem.load).status() : solver.status();
  EXPECT_EQ(status.code(), absl::StatusCode::kCancelled) << status;
}

TEST(Choice, FactorisesWhatIsSmallOrThin) {
  EXPECT_EQ(ChooseSolver(*Bar(false).stiffness->pattern()).kind, SolverKind::kDirect);
  const Problem plate({1, 1, 0.02}, {40, 40, 1}, false);
  EXPECT_EQ(ChooseSolver(*plate.stiffness->pattern()).kind, SolverKind::kDirect);
}

// Of two plates of one topology, the one of stretched elements takes very many iterations.
TEST(Choice, LetsAFactorFinishWhatWouldTakeTooManyIterations) {
  const auto kind_of = [](double thickness) {
    const Problem plate({1, 1, thickness}, {24, 24, 3}, true);
    EXPECT_EQ(ChooseSolver(*plate.stiffness->pattern()).kind, SolverKind::kIterative);
    auto solver = plate.Solver({});
    EXPECT_TRUE(solver.ok()) << solver.status();
    const auto solution = (*solver)->Solve(plate.load);
    EXPECT_TRUE(solution.ok()) << solution.status();
    return (*solver)->summary().kind;
  };
  EXPECT_EQ(kind_of(0.15), SolverKind::kIterative);
  EXPECT_EQ(kind_of(0.01), SolverKind::kDirect);
}

TEST(Choice, FactorisesAtOnceForAsManyLoadsAsItIsWorth) {
  const Problem problem({0.1, 0.1, 0.1}, {20, 20, 20}, false);
  const BlockPattern& pattern = *problem.stiffness->pattern();
  ASSERT_EQ(ChooseSolver(pattern).kind, SolverKind::kIterative);
  EXPECT_EQ(ChooseSolver(pattern, 50).kind, SolverKind::kDirect);
  SolverOptions options;
  options.loads = 50;
  auto solver = problem.Solver(options);
  ASSERT_TRUE(solver.ok()) << solver.status();
  ASSERT_TRUE((*solver)->Solve(problem.load).ok());
  EXPECT_EQ((*solver)->summary().kind, SolverKind::kDirect);
}

TEST(Choice, LetsAFactorFinishWhereThereAreMoreLoadsThanWereTold) {
  const Problem problem({0.1, 0.1, 0.1}, {20, 20, 20}, false);
  const double patience = ChooseSolver(*problem.stiffness->pattern()).patience;
  ASSERT_GT(patience, 30);
  auto solver = problem.Solver({});
  ASSERT_TRUE(solver.ok()) << solver.status();
  int iterated = 0;
  for (int load = 0; load < 50; ++load) {
    const auto solution = (*solver)->Solve((1 + load) * problem.load);
    ASSERT_TRUE(solution.ok()) << solution.status();
    if ((*solver)->summary().kind == SolverKind::kDirect) break;
    iterated += (*solver)->summary().iterations;
  }
  EXPECT_EQ((*solver)->summary().kind, SolverKind::kDirect);
  EXPECT_LT(iterated, 1.5 * patience);
}

TEST(Choice, IteratesOnWhereAFactorDoesNotFit) {
  const Problem plate({1, 1, 0.01}, {24, 24, 3}, true);
  SolverOptions options;
  options.memory_limit = 60e6;
  auto solver = plate.Solver(options);
  ASSERT_TRUE(solver.ok()) << solver.status();
  const auto solution = (*solver)->Solve(plate.load);
  ASSERT_TRUE(solution.ok()) << solution.status();
  EXPECT_EQ((*solver)->summary().kind, SolverKind::kIterative);
  EXPECT_GT((*solver)->summary().iterations, ChooseSolver(*plate.stiffness->pattern()).patience);
}

TEST(Choice, FallsBackToAFactorWhereIterationFails) {
  const Problem problem({0.1, 0.1, 0.1}, {20, 20, 20}, false);
  SolverOptions options;
  options.maximum_iterations = 3;
  auto solver = problem.Solver(options);
  ASSERT_TRUE(solver.ok()) << solver.status();
  ASSERT_EQ(ChooseSolver(*problem.stiffness->pattern()).kind, SolverKind::kIterative);
  const auto solution = (*solver)->Solve(problem.load);
  ASSERT_TRUE(solution.ok()) << solution.status();
  EXPECT_EQ((*solver)->summary().kind, SolverKind::kDirect);
  EXPECT_LT((*solver)->summary().residual, 1e-9);
  options.kind = SolverKind::kIterative;
  auto iterative = problem.Solver(options);
  ASSERT_TRUE(iterative.ok());
  EXPECT_EQ(DetailOf((*iterative)->Solve(problem.load).status()).reason, "NOT_CONVERGED");
}

TEST(Threads, ShareALoopAndSumInOrder) {
  std::vector<double> numbers(20000);
  for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] = std::sin(static_cast<double>(k));
  double first = 0;
  for (const int size : {1, 2, 4}) {
    ThreadTeam team(size);
    std::vector<int> visits(numbers.size(), 0);
    team.ForRanges(static_cast<int>(visits.size()), [&](int begin, int end) {
      for (int k = begin; k < end; ++k) ++visits[k];
    });
    EXPECT_EQ(std::count(visits.begin(), visits.end(), 1),
              static_cast<std::ptrdiff_t>(visits.size()));
    const double sum = team.Sum(static_cast<int>(numbers.size()), [&](int begin, int end) {
      double part = 0;
      for (int k = begin; k < end; ++k) part += numbers[k];
      return part;
    });
    if (size == 1) first = sum;
    EXPECT_EQ(sum, first);
    team.ForRanges(0, [](int, int) { ADD_FAILURE(); });
  }
}

TEST(Matrices, MultiplyAndAddAsDenseOnes) {
  const Problem problem({3, 2, 1}, {3, 2, 1}, true);
  const BlockPattern& pattern = *problem.stiffness->pattern();
  const int nodes = pattern.nodes();
  const int elements = pattern.elements(), corners = pattern.corners();
  const auto block_of = [](int e, int a, int b) {
    Eigen::Matrix3d block;
    for (int k = 0; k < 9; ++k) block.data()[k] = std::sin(1.0 + e + 7 * a + 31 * b + 0.3 * k);
    return a == b ? Eigen::Matrix3d(block + block.transpose()) : block;
  };
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * nodes, 3 * nodes);
  for (int e = 0; e < elements; ++e) {
    for (int a = 0; a < corners; ++a) {
      for (int b = a; b < corners; ++b) {
        const int i = problem.mesh.tetrahedra(a, e), j = problem.mesh.tetrahedra(b, e);
        dense.block<3, 3>(3 * i, 3 * j) += block_of(e, a, b);
        if (a != b) dense.block<3, 3>(3 * j, 3 * i) += block_of(e, a, b).transpose();
      }
    }
  }
  const Eigen::VectorXd x = Noise(Eigen::Array3Xi::Zero(3, nodes), 3);
  const Eigen::Matrix3Xd vectors = x.reshaped(3, nodes);
  std::vector<Eigen::Matrix3d> first;
  for (const int threads : {1, 3}) {
    ThreadTeam team(threads);
    BlockMatrix matrix(problem.stiffness->pattern());
    matrix.AddElements(
        [&](int e, Eigen::Matrix3d* blocks) {
          for (int a = 0; a < corners; ++a) {
            for (int b = a; b < corners; ++b) *blocks++ = block_of(e, a, b);
          }
        },
        team);
    Eigen::Matrix3Xd product;
    matrix.Multiply(vectors, product, team);
    EXPECT_LT((product.reshaped() - dense * x).norm(), 1e-12 * (dense * x).norm());
    if (threads == 1) first = matrix.blocks();
    EXPECT_EQ(first, matrix.blocks());
  }
  int coupled = 0;
  for (int j = 0; j < nodes; ++j) {
    for (int i = 0; i <= j; ++i) {
      const bool zero = dense.block<3, 3>(3 * i, 3 * j).isZero(0);
      EXPECT_EQ(pattern.Find(i, j) < 0, zero) << i << " " << j;
      coupled += !zero;
    }
  }
  EXPECT_EQ(coupled, static_cast<int>(pattern.rows().size()));
}

// Eigenvalues 2 − 2 cos(kπ / (n + 1)) of a string of n masses.
TEST(Tridiagonal, FindsTheEndsOfTheSpectrum) {
  for (const int n : {1, 2, 30}) {
    const Spectrum found =
        FindSpectrum(std::vector<double>(n, 2.0), std::vector<double>(n - 1, -1.0));
    EXPECT_NEAR(found.least, 2 - 2 * std::cos(M_PI / (n + 1)), 1e-11);
    EXPECT_NEAR(found.most, 2 - 2 * std::cos(n * M_PI / (n + 1)), 1e-11);
  }
}

}  // namespace
}  // namespace mortise::simulator
