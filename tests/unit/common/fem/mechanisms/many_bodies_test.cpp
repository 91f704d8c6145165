// Structures of hundreds and thousands of bodies on hinges: sound ones, however slender, and
// mechanisms.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <random>
#include <utility>

#include "common/fem/mechanisms/free_motions.h"
#include "common/fem/problems/modal_analysis.h"
#include "tests/unit/common/fem/problems/clamped_box.h"

namespace mortise::simulator {
namespace {

// Bars in a plane, each of two tetrahedra between two pins: edges along z, which bars share. With
// rounding the plane is inclined, and coordinates are as exact as the digits of a file.
class Frame {
 public:
  explicit Frame(double rounding = 0) : rounding_(rounding) {}

  int AddPin(double x, double y) {
    pins_.push_back({AddNode(x, y, 0), AddNode(x, y, 0.5)});
    return static_cast<int>(pins_.size()) - 1;
  }

  void AddBar(int first, int second) {
    const auto [a, b] = pins_[first];
    const auto [c, d] = pins_[second];
    const Eigen::Vector3d along = nodes_[c] - nodes_[a];
    const Eigen::Vector3d side =
        (nodes_[a] + nodes_[d]) / 2 + 0.1 * Eigen::Vector3d(-along.y(), along.x(), 0);
    const int e = AddNode(side.x(), side.y(), side.z());
    tetrahedra_.push_back({a, b, c, e});
    tetrahedra_.push_back({b, d, c, e});
  }

  std::array<int, 2> NodesOf(int pin) const { return pins_[pin]; }

  mesh::TetrahedralMesh Mesh() const {
    mesh::TetrahedralMesh mesh;
    mesh.part_names = {"frame"};
    mesh.nodes.resize(3, static_cast<Eigen::Index>(nodes_.size()));
    for (std::size_t v = 0; v < nodes_.size(); ++v) mesh.nodes.col(v) = nodes_[v];
    mesh.tetrahedra.resize(4, static_cast<Eigen::Index>(tetrahedra_.size()));
    for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
      for (int k = 0; k < 4; ++k) mesh.tetrahedra(k, e) = tetrahedra_[e][k];
    }
    mesh.part = Eigen::VectorXi::Zero(mesh.tetrahedra.cols());
    mesh.face_triangles.resize(3, 0);
    return mesh;
  }

 private:
  int AddNode(double x, double y, double z) {
    Eigen::Vector3d node(x, y, z);
    if (rounding_ > 0) {
      node = Eigen::AngleAxisd(0.4, Eigen::Vector3d(3, 1, 2).normalized()) * node;
      node = rounding_ * (node / rounding_).array().round();
    }
    nodes_.push_back(node);
    return static_cast<int>(nodes_.size()) - 1;
  }

  double rounding_;
  std::vector<Eigen::Vector3d> nodes_;
  std::vector<std::array<int, 2>> pins_;
  std::vector<std::array<int, 4>> tetrahedra_;
};

// Warren's girder, and what of it is left out or held.
struct Girder {
  int bays = 0;
  bool is_held = true;      // at both pins of its first bar, or else at the first one only
  int without = -1;         // the bay whose diagonal is missing
  double rounding = 0;      // m
  double height = 0.75;     // m
  std::vector<int> held{};  // nodes
};

mesh::TetrahedralMesh MeshOf(Girder& girder) {
  Frame frame(girder.rounding);
  std::vector<int> low, high;
  for (int k = 0; k < girder.bays; ++k) {
    low.push_back(frame.AddPin(k, 0));
    high.push_back(frame.AddPin(k + 0.5, girder.height));
  }
  low.push_back(frame.AddPin(girder.bays, 0));
  for (int k = 0; k < girder.bays; ++k) {
    frame.AddBar(low[k], low[k + 1]);
    if (k + 1 < girder.bays) frame.AddBar(high[k], high[k + 1]);
    frame.AddBar(low[k], high[k]);
    if (k != girder.without) frame.AddBar(high[k], low[k + 1]);
  }
  girder.held.clear();
  for (const int v : frame.NodesOf(low[0])) girder.held.push_back(v);
  if (girder.is_held) {
    for (const int v : frame.NodesOf(high[0])) girder.held.push_back(v);
  }
  return frame.Mesh();
}

FreeMotions MotionsOf(const mesh::TetrahedralMesh& mesh, const std::vector<int>& held) {
  Support support;
  support.nodes = held;
  const auto constraints =
      CollectConstraints(mesh, held.empty() ? std::vector<Support>{} : std::vector{support});
  EXPECT_TRUE(constraints.ok()) << constraints.status();
  return FindFreeMotions(mesh, *constraints);
}

int CountMotions(Girder girder) {
  const mesh::TetrahedralMesh mesh = MeshOf(girder);
  return MotionsOf(mesh, girder.held).count;
}

class Girders : public testing::TestWithParam<int> {};

INSTANTIATE_TEST_SUITE_P(Bays, Girders, testing::Values(3, 8, 101),
                         testing::PrintToStringParamName());

TEST_P(Girders, OfTrianglesAreSound) {
  EXPECT_EQ(CountMotions({.bays = GetParam()}), 0);
  EXPECT_EQ(CountMotions({.bays = GetParam(), .rounding = 1e-6}), 0);
  EXPECT_EQ(CountMotions({.bays = GetParam(), .height = 0.02}), 0);
}

TEST_P(Girders, WithoutADiagonalAreMechanisms) {
  for (const double rounding : {0.0, 1e-6}) {
    for (const int without : {0, GetParam() / 2, GetParam() - 2}) {
      EXPECT_EQ(CountMotions({.bays = GetParam(), .without = without, .rounding = rounding}), 1)
          << without << " " << rounding;
    }
  }
}

TEST_P(Girders, HeldByOnePinTurnAsAWhole) {
  Girder girder{.bays = GetParam(), .is_held = false};
  const mesh::TetrahedralMesh mesh = MeshOf(girder);
  const FreeMotions free = MotionsOf(mesh, girder.held);
  ASSERT_EQ(free.count, 1);
  // About that pin, as far as they are from it.
  const Eigen::Matrix3Xd motion = Displacements(free, mesh)[0];
  Eigen::Matrix3Xd turn(3, mesh.nodes.cols());
  for (Eigen::Index v = 0; v < mesh.nodes.cols(); ++v) {
    turn.col(v) = Eigen::Vector3d::UnitZ().cross(Eigen::Vector3d(mesh.nodes.col(v)));
  }
  turn *= motion.cwiseProduct(turn).sum() / turn.squaredNorm();
  EXPECT_LT((motion - turn).norm(), 1e-6 * turn.norm());
  girder.without = GetParam() / 2;
  EXPECT_EQ(CountMotions(girder), 2);
}

TEST_P(Girders, InSpaceHaveTheirSixMotions) {
  Girder girder{.bays = GetParam()};
  EXPECT_EQ(MotionsOf(MeshOf(girder), {}).count, 6);
  girder.without = GetParam() / 2;
  EXPECT_EQ(MotionsOf(MeshOf(girder), {}).count, 7);
}

TEST(LongGirder, IsSoundOrNot) {
  EXPECT_EQ(CountMotions({.bays = 1000}), 0);
  EXPECT_EQ(CountMotions({.bays = 1000, .without = 500, .rounding = 1e-6}), 1);
}

// Bars of a hanging chain turn one by one.
TEST(Chains, HaveAMotionForEachBar) {
  for (const int bars : {3, 8, 1000}) {
    Frame frame;
    Support support;
    int before = frame.AddPin(0, 0);
    for (const int v : frame.NodesOf(before)) support.nodes.push_back(v);
    for (int k = 0; k < bars; ++k) {
      const int next = frame.AddPin(k + 1, k % 2 == 0 ? 0.3 : 0);
      frame.AddBar(before, next);
      before = next;
    }
    const mesh::TetrahedralMesh mesh = frame.Mesh();
    const auto constraints = CollectConstraints(mesh, {support});
    ASSERT_TRUE(constraints.ok()) << constraints.status();
    // Where there are more than are asked for, some that are but soft may be counted.
    const FreeMotions free = FindFreeMotions(mesh, *constraints, 10);
    EXPECT_GE(free.count, bars);
    EXPECT_LE(free.count, 1.01 * bars);
    ASSERT_EQ(free.groups.size(), 1u);
    EXPECT_EQ(free.groups[0].motions.cols(), std::min(bars, 10));
  }
}

TEST(LongGirder, HasTheModesOfABeam) {
  // Modes of one that is twice as long are a quarter as high, none of them at 0 Hz.
  std::vector<double> lowest;
  for (const int bays : {200, 400}) {
    Girder girder{.bays = bays};
    const mesh::TetrahedralMesh mesh = MeshOf(girder);
    Support support;
    support.nodes = girder.held;
    const auto modes = FindModes(mesh, {Steel()}, {support}, {.count = 2});
    ASSERT_TRUE(modes.ok()) << modes.status();
    EXPECT_EQ(modes->rigid_motions, 0);
    lowest.push_back(modes->modes[0].frequency);
  }
  EXPECT_GT(lowest[1], 0.2 * lowest[0]);
  EXPECT_LT(lowest[1], 0.3 * lowest[0]);
}

// Levers of ten to one, each of which moves the next: the last end moves by a thousandth of what
// the first does, or not at all where it is held.
TEST(Levers, AreSoundWhereTheLastOneIsHeld) {
  for (const int levers : {1, 2, 3}) {
    for (const bool is_held : {true, false}) {
      Frame frame;
      std::vector<int> held;
      const auto hold = [&](int pin) {
        for (const int v : frame.NodesOf(pin)) held.push_back(v);
      };
      int input = -1;
      double x = 0;
      for (int k = 0; k < levers; ++k, x += 1.1) {
        // A lever about its pin below, with a long arm to the left and a short one to the right.
        const double y = 10.0 * k;
        const int pivot = frame.AddPin(x + 1, y - 0.5);
        const int far = frame.AddPin(x, y), near = frame.AddPin(x + 1.1, y);
        hold(pivot);
        frame.AddBar(far, near);
        frame.AddBar(pivot, near);
        frame.AddBar(far, pivot);
        if (input >= 0) frame.AddBar(input, far);
        input = near;
      }
      if (is_held) {
        const int ground = frame.AddPin(x, 10.0 * levers);
        hold(ground);
        frame.AddBar(input, ground);
      }
      EXPECT_EQ(MotionsOf(frame.Mesh(), held).count, is_held ? 0 : 1) << levers;
    }
  }
}

// Tetrahedra that share but points with each other, no two of them more than one, the first of
// which is held: each holds the next, at three points.
TEST(LooseTetrahedra, HoldEachOtherOneAfterTheOther) {
  const int count = 4000;
  mesh::TetrahedralMesh mesh;
  mesh.part_names = {"loose"};
  mesh.nodes.resize(3, count + 6);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> spread(0, 1);
  for (double& value : mesh.nodes.reshaped()) value = spread(random);
  mesh.tetrahedra.resize(4, count);
  for (int k = 0; k < count; ++k) {
    mesh.tetrahedra.col(k) << k, k + 1, k + 4, k + 6;
    const Eigen::Vector3d first = mesh.nodes.col(k);
    Eigen::Matrix3d sides;
    for (int c = 1; c < 4; ++c) {
      sides.col(c - 1) = mesh.nodes.col(mesh.tetrahedra(c, k)) - first;
    }
    if (sides.determinant() < 0) std::swap(mesh.tetrahedra(2, k), mesh.tetrahedra(3, k));
  }
  mesh.part = Eigen::VectorXi::Zero(count);
  mesh.face_triangles.resize(3, 0);
  std::vector<int> held;
  for (int v = 0; v < 6; ++v) held.push_back(v);
  EXPECT_EQ(MotionsOf(mesh, held).count, 0);
  // Without one of them the last is held at two points only, and turns about them.
  mesh.tetrahedra.col(count - 3) = mesh.tetrahedra.col(count - 1).eval();
  mesh.tetrahedra.conservativeResize(4, count - 1);
  mesh.part.conservativeResize(count - 1);
  EXPECT_EQ(MotionsOf(mesh, held).count, 1);
}

}  // namespace
}  // namespace mortise::simulator
