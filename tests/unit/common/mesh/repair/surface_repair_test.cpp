// Repair of surfaces: what becomes of each kind of damage, and of many at once.
#include "common/mesh/repair/surface_repair.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/mesh/mass_properties.h"
#include "common/mesh/surface_check.h"
#include "tests/unit/common/mesh/box_assembly.h"
#include "tests/unit/common/mesh/round_solids.h"

namespace mortise::mesh {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

SurfaceMesh Box() { return BoxSurface({0, 0, 0}, {0.1, 0.2, 0.3}); }
constexpr double kBoxVolume = 0.1 * 0.2 * 0.3;

double VolumeOf(const SurfaceMesh& surface) { return ComputeMassProperties(surface).volume; }

// Every triangle with corners of its own, as STL has them.
SurfaceMesh Loose(const SurfaceMesh& surface) {
  SurfaceMesh loose;
  loose.vertices = surface.vertices(Eigen::all, surface.triangles.reshaped());
  loose.triangles.resize(3, surface.triangles.cols());
  for (int i = 0; i < static_cast<int>(loose.triangles.size()); ++i) loose.triangles(i) = i;
  return loose;
}

SurfaceMesh With(SurfaceMesh surface, const Eigen::Vector3i& triangle) {
  surface.triangles.conservativeResize(3, surface.triangles.cols() + 1);
  surface.triangles.rightCols(1) = triangle;
  return surface;
}

SurfaceMesh Without(SurfaceMesh surface, Eigen::Index triangle) {
  surface.triangles.col(triangle) = surface.triangles.rightCols(1).eval();
  surface.triangles.conservativeResize(3, surface.triangles.cols() - 1);
  return surface;
}

Eigen::Vector3i Turned(const Eigen::Vector3i& triangle) {
  return {triangle[1], triangle[0], triangle[2]};
}

SurfaceMesh Both(const SurfaceMesh& a, const SurfaceMesh& b) {
  SurfaceMesh both;
  both.vertices.resize(3, a.vertices.cols() + b.vertices.cols());
  both.vertices << a.vertices, b.vertices;
  both.triangles.resize(3, a.triangles.cols() + b.triangles.cols());
  both.triangles << a.triangles, b.triangles.array() + static_cast<int>(a.vertices.cols());
  return both;
}

SurfaceMesh InsideOut(SurfaceMesh surface) {
  surface.triangles.row(0).swap(surface.triangles.row(1));
  return surface;
}

// With a vertex in the middle of the first edge of a triangle, which its neighbour there does not
// have.
SurfaceMesh WithJunction(SurfaceMesh surface, Eigen::Index triangle) {
  const Eigen::Vector3i t = surface.triangles.col(triangle);
  const int middle = static_cast<int>(surface.vertices.cols());
  surface.vertices.conservativeResize(3, middle + 1);
  surface.vertices.col(middle) = 0.5 * (surface.vertices.col(t[0]) + surface.vertices.col(t[1]));
  surface.triangles(1, triangle) = middle;
  return With(surface, {middle, t[1], t[2]});
}

SurfaceRepairs Repaired(const SurfaceMesh& surface, double volume) {
  const auto repaired = RepairSurface(surface);
  EXPECT_TRUE(repaired.ok()) << repaired.status();
  if (!repaired.ok()) return {};
  EXPECT_THAT(CheckSurface(repaired->surface), IsEmpty());
  EXPECT_TRUE(FindIntersections(repaired->surface.vertices, repaired->surface.triangles).empty());
  EXPECT_NEAR(VolumeOf(repaired->surface), volume, 1e-9 * volume);
  return repaired->repairs;
}

std::string Refused(const SurfaceMesh& surface, const RepairOptions& options = {}) {
  const absl::Status status = RepairSurface(surface, options).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
  EXPECT_EQ(DetailOf(status).field, "surface") << status;
  return std::string(status.message());
}

TEST(RepairSurface, LeavesWhatIsClosedAsItIs) {
  SurfaceMesh unused = Box();
  unused.vertices.conservativeResize(3, 9);
  unused.vertices.col(8).setZero();
  const SurfaceMesh hollow =
      Both(Box(), InsideOut(BoxSurface({0.02, 0.02, 0.02}, {0.05, 0.05, 0.05})));
  for (const SurfaceMesh& surface : {Box(), unused, hollow, Torus(1, 0.3, 20), Sphere(3, 12)}) {
    const auto same = RepairSurface(surface);
    ASSERT_TRUE(same.ok()) << same.status();
    EXPECT_EQ(same->surface.vertices, surface.vertices);
    EXPECT_EQ(same->surface.triangles, surface.triangles);
    EXPECT_THAT(Describe(same->repairs), IsEmpty());
  }
}

TEST(RepairSurface, JoinsTrianglesWithCornersOfTheirOwn) {
  const auto box = RepairSurface(Loose(Box()));
  ASSERT_TRUE(box.ok()) << box.status();
  EXPECT_EQ(box->surface.vertices.cols(), 8);
  EXPECT_EQ(box->surface.triangles.cols(), 12);
  EXPECT_DOUBLE_EQ(VolumeOf(box->surface), kBoxVolume);
  EXPECT_THAT(Describe(box->repairs),
              ElementsAre("merged 28 vertices with others within 0.0003742 mm"));
}

TEST(RepairSurface, JoinsCornersThatDifferByRounding) {
  std::mt19937_64 random(2);
  SurfaceMesh loose = Loose(Torus(0.1, 0.03, 16));
  const double volume = VolumeOf(loose);
  for (double& coordinate : loose.vertices.reshaped()) {
    coordinate += 1e-8 * (static_cast<double>(random() >> 11) * 0x1p-53 - 0.5);
  }
  const auto torus = RepairSurface(loose);
  ASSERT_TRUE(torus.ok()) << torus.status();
  EXPECT_TRUE(IsWatertight(torus->surface));
  EXPECT_EQ(torus->surface.vertices.cols(), 256);
  EXPECT_NEAR(VolumeOf(torus->surface), volume, 1e-5 * volume);
}

TEST(RepairSurface, TurnsTrianglesAsTheirNeighboursAndOutwards) {
  SurfaceMesh box = Box();
  box.triangles.col(4) = Turned(box.triangles.col(4));
  EXPECT_THAT(Describe(Repaired(box, kBoxVolume)), ElementsAre("turned 1 triangle around"));
  EXPECT_EQ(Repaired(InsideOut(Box()), kBoxVolume).turned_triangles, 12);
  // Two solids, of which one has the wrong side outwards.
  EXPECT_EQ(Repaired(Both(Box(), InsideOut(BoxSurface({1, 0, 0}, {1.1, 0.2, 0.3}))), 2 * kBoxVolume)
                .turned_triangles,
            12);
  // A hollow belongs inside out, however its triangles lie.
  const Eigen::Vector3d low(0.02, 0.02, 0.02), high(0.05, 0.05, 0.05);
  SurfaceMesh hollow = Both(InsideOut(Box()), BoxSurface(low, high));
  hollow.triangles.col(15) = Turned(hollow.triangles.col(15));
  const SurfaceRepairs repairs = Repaired(hollow, kBoxVolume - (high - low).prod());
  EXPECT_EQ(repairs.turned_triangles, 23);
}

TEST(RepairSurface, DropsTrianglesThatAreDrawnTwice) {
  const Eigen::Vector3i first = Box().triangles.col(0);
  EXPECT_THAT(Describe(Repaired(With(Box(), first), kBoxVolume)),
              ElementsAre("dropped 1 triangle drawn more than once"));
  EXPECT_EQ(Repaired(With(Box(), Turned(first)), kBoxVolume).drawn_twice, 1);
  // Everything twice, and everything from both sides.
  EXPECT_EQ(Repaired(Loose(Both(Box(), Box())), kBoxVolume).drawn_twice, 12);
  EXPECT_EQ(Repaired(Loose(Both(Box(), InsideOut(Box()))), kBoxVolume).drawn_twice, 12);
}

TEST(RepairSurface, TakesOutTheWallBetweenTwoSolids) {
  const SurfaceMesh two = Loose(Both(Box(), BoxSurface({0.1, 0, 0}, {0.25, 0.2, 0.3})));
  const SurfaceRepairs repairs = Repaired(two, 0.25 * 0.2 * 0.3);
  EXPECT_EQ(repairs.merged_vertices, 3 * 24 - 12);
  EXPECT_EQ(repairs.drawn_twice, 4);
}

TEST(RepairSurface, DropsTrianglesWithoutAreaAndClosesWhatTheyLeave) {
  // One triangle is divided at the middle of an edge, and a triangle without area lies between it
  // and its neighbour.
  const SurfaceMesh junction = WithJunction(Box(), 3);
  const Eigen::Vector3i t = Box().triangles.col(3);
  const SurfaceMesh filled = With(junction, {t[0], t[1], 8});
  EXPECT_EQ(CheckSurface(filled)[0].kind, SurfaceFault::Kind::kDegenerate);
  EXPECT_THAT(Describe(Repaired(filled, kBoxVolume)),
              ElementsAre("dropped 1 triangle without area",
                          "divided 1 triangle at vertices on their edges"));
  EXPECT_THAT(Describe(Repaired(junction, kBoxVolume)),
              ElementsAre("divided 1 triangle at vertices on their edges"));
  EXPECT_EQ(Repaired(With(Box(), {0, 1, 1}), kBoxVolume).without_area, 1);
}

TEST(RepairSurface, DividesEdgesAtSeveralVertices) {
  // A plate whose top is in narrow strips and whose sides are not.
  constexpr int kStrips = 7;
  SurfaceMesh plate = Box();
  std::vector<Eigen::Vector3i> triangles;
  std::vector<Eigen::Vector3d> points(plate.vertices.colwise().begin(),
                                      plate.vertices.colwise().end());
  for (const auto& corners : plate.triangles.colwise()) {
    const bool is_top = (plate.vertices(2, corners).array() == 0.3).all();
    if (!is_top) triangles.emplace_back(corners);
  }
  ASSERT_EQ(triangles.size(), 10u);
  for (int i = 0; i <= kStrips; ++i) {
    points.emplace_back(0.1 * i / kStrips, 0, 0.3);
    points.emplace_back(0.1 * i / kStrips, 0.2, 0.3);
    if (i == kStrips) break;
    const int near = 8 + 2 * i;
    triangles.emplace_back(near, near + 2, near + 3);
    triangles.emplace_back(near, near + 3, near + 1);
  }
  plate.vertices.resize(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    plate.vertices.col(static_cast<Eigen::Index>(i)) = points[i];
  }
  plate.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    plate.triangles.col(static_cast<Eigen::Index>(t)) = triangles[t];
  }
  const SurfaceRepairs repairs = Repaired(plate, kBoxVolume);
  EXPECT_EQ(repairs.split_triangles, 2);
  EXPECT_EQ(repairs.merged_vertices, 4);
}

TEST(RepairSurface, FillsSmallHoles) {
  EXPECT_THAT(Describe(Repaired(Without(Box(), 7), kBoxVolume)),
              ElementsAre(HasSubstr("filled 1 hole, up to ")))
      << "one triangle can be missing in one way only";
  // Two triangles that touch in a vertex, one that does not, and two neighbours.
  const SurfaceMesh cylinder = Cylinder(0.1, 0.3, 64);
  SurfaceMesh torn = cylinder;
  for (const int triangle : {200, 130, 120, 40, 39}) torn = Without(torn, triangle);
  const auto filled = RepairSurface(torn);
  ASSERT_TRUE(filled.ok()) << filled.status();
  EXPECT_EQ(filled->surface.triangles.cols(), cylinder.triangles.cols());
  EXPECT_NEAR(VolumeOf(filled->surface), VolumeOf(cylinder), 1e-3 * VolumeOf(cylinder));
  // A flat lid of many edges.
  SurfaceMesh pin = Cylinder(0.002, 0.3, 40);
  for (Eigen::Index t = pin.triangles.cols() - 1; t >= 0; --t) {
    if ((pin.vertices(2, pin.triangles.col(t)).array() == 0.3).all()) pin = Without(pin, t);
  }
  const auto closed = RepairSurface(pin);
  ASSERT_TRUE(closed.ok()) << closed.status();
  EXPECT_EQ(closed->repairs.filled_holes, 1);
  EXPECT_NEAR(closed->repairs.widest_hole, 0.004 * std::numbers::sqrt2, 1e-9);
  EXPECT_NEAR(VolumeOf(closed->surface), VolumeOf(Cylinder(0.002, 0.3, 40)), 1e-12);
}

TEST(RepairSurface, RefusesWhatCannotBeRepairedWithThePlace) {
  EXPECT_THAT(Refused(Without(Without(Box(), 1), 0)), HasSubstr("is too large to be filled, at ("));
  EXPECT_THAT(Refused(Without(Without(Sphere(0.1, 12), 1), 0), {.largest_hole = 0}),
              HasSubstr("mm across, is too large"));
  // A fin.
  SurfaceMesh fin = Box();
  fin.vertices.conservativeResize(3, 9);
  fin.vertices.col(8) = Eigen::Vector3d(-0.1, -0.1, 0.1);
  EXPECT_THAT(Refused(With(fin, {fin.triangles(0, 0), fin.triangles(1, 0), 8})),
              HasSubstr("more than two triangles meet at an edge at ("));
  // A band with half a turn.
  SurfaceMesh band;
  constexpr int kPieces = 20;
  band.vertices.resize(3, 2 * kPieces);
  band.triangles.resize(3, 2 * kPieces);
  for (int i = 0; i < kPieces; ++i) {
    const double angle = 2 * std::numbers::pi * i / kPieces;
    const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0);
    const Eigen::Vector3d across =
        0.2 * (std::cos(angle / 2) * Eigen::Vector3d::UnitZ() + std::sin(angle / 2) * out);
    band.vertices.col(2 * i) = out + across;
    band.vertices.col(2 * i + 1) = out - across;
    const bool is_last = i + 1 == kPieces;
    const int left = is_last ? 1 : 2 * i + 2, right = is_last ? 0 : 2 * i + 3;
    band.triangles.col(2 * i) << 2 * i, 2 * i + 1, right;
    band.triangles.col(2 * i + 1) << 2 * i, right, left;
  }
  EXPECT_THAT(Refused(band), HasSubstr("one side only, no inside and no outside"));
  SurfaceMesh broken = Box();
  broken.vertices(0, 1) = INFINITY;
  EXPECT_THAT(Refused(broken), HasSubstr("not finite"));
  broken = Box();
  broken.triangles(2, 2) = 8;
  EXPECT_THAT(Refused(broken), HasSubstr("does not exist"));
  EXPECT_THAT(Refused({}), HasSubstr("no triangles"));
  broken = Box();
  broken.vertices.setZero();
  EXPECT_THAT(Refused(broken), HasSubstr("is a point"));
  broken.vertices.row(0).setLinSpaced(8, 0, 1);
  EXPECT_THAT(Refused(broken), HasSubstr("no triangles with an area"));
  SurfaceMesh sheet;
  sheet.vertices = Box().vertices;
  sheet.triangles = Box().triangles.leftCols(1);
  EXPECT_THAT(Refused(sheet), HasSubstr("all around a single triangle, at ("));
  EXPECT_EQ(Repaired(Loose(Both(Box(), sheet)), kBoxVolume).drawn_twice, 1);
  sheet.vertices.array() += 1;
  EXPECT_THAT(Refused(Both(Box(), sheet)), HasSubstr("all around a single triangle, at ("));
  // The same four corners closed from both sides.
  SurfaceMesh flat;
  flat.vertices.resize(3, 4);
  flat.vertices << 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0;
  flat.triangles.resize(3, 4);
  flat.triangles << 0, 0, 1, 3, 1, 2, 0, 1, 2, 3, 3, 2;
  EXPECT_THAT(Refused(flat), HasSubstr("encloses nothing"));
  broken = Box();
  broken.vertices *= 1e200;
  broken.triangles.col(4) = Turned(broken.triangles.col(4));
  EXPECT_THAT(Refused(broken), HasSubstr("larger than anything"));
}

// Each of these triangles would be divided at the corners of all others.
TEST(RepairSurface, RefusesTrianglesThatWouldBecomeTooMany) {
  std::mt19937_64 random(9);
  SurfaceMesh fans;
  fans.vertices.resize(3, 1200);
  fans.triangles.resize(3, 400);
  for (int i = 0; i < 1200; ++i) {
    const double along = static_cast<double>(random() >> 11) * 0x1p-53;
    fans.vertices.col(i) << along, i % 3 == 2 ? along * along : 0, i % 3 == 2 ? i : 0;
    fans.triangles(i) = i;
  }
  EXPECT_THAT(Refused(fans), HasSubstr("too many vertices that lie on edges"));
}

TEST(RepairSurface, RefusesOptionsOutOfRange) {
  const SurfaceMesh open = Without(Box(), 0);
  EXPECT_EQ(DetailOf(RepairSurface(open, {.tolerance = 0}).status()).field, "tolerance");
  EXPECT_EQ(DetailOf(RepairSurface(open, {.tolerance = NAN}).status()).field, "tolerance");
  EXPECT_EQ(DetailOf(RepairSurface(open, {.largest_hole = 2}).status()).field, "largest_hole");
}

// Random damage to random surfaces.
class Damage {
 public:
  explicit Damage(unsigned seed) : random_(seed) {}

  SurfaceMesh Whole() {
    const int divisions = 8 + Below(10);
    SurfaceMesh surface =
        Below(2) == 0 ? Torus(1, 0.2 + 0.5 * Unit(), divisions) : Sphere(0.5 + Unit(), divisions);
    const Eigen::AngleAxisd turn(6 * Unit(), Eigen::Vector3d(Unit(), Unit(), 1).normalized());
    surface = Rotated(surface, turn.toRotationMatrix());
    surface.vertices *= std::pow(10, 4 * Unit() - 3);
    surface.vertices.colwise() += Eigen::Vector3d(Unit(), Unit(), Unit());
    return surface;
  }

  // `missing`: m³, by which the volume may change for triangles that were taken away.
  SurfaceMesh Of(SurfaceMesh surface, double& missing) {
    missing = 0;
    for (int i = Below(4); i > 0; --i) surface = WithJunction(surface, AnyOf(surface));
    for (int i = Below(4); i > 0; --i) {
      surface = With(surface, surface.triangles.col(AnyOf(surface)));
    }
    for (int i = Below(6); i > 0; --i) {
      const Eigen::Index t = AnyOf(surface);
      surface.triangles.col(t) = Turned(surface.triangles.col(t));
    }
    for (int i = Below(4); i > 0; --i) {
      const Eigen::Index t = AnyOf(surface);
      const Eigen::Matrix3d corners = surface.vertices(Eigen::all, surface.triangles.col(t));
      const double longest = std::max({(corners.col(1) - corners.col(0)).norm(),
                                       (corners.col(2) - corners.col(1)).norm(),
                                       (corners.col(0) - corners.col(2)).norm()});
      missing += std::pow(3 * longest, 3);
      surface = Without(surface, t);
    }
    if (Below(2) == 0) surface = Loose(surface);
    if (Below(3) == 0) surface = InsideOut(surface);
    return surface;
  }

 private:
  int Below(int end) { return static_cast<int>(random_() % static_cast<unsigned>(end)); }
  double Unit() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  Eigen::Index AnyOf(const SurfaceMesh& surface) {
    return Below(static_cast<int>(surface.triangles.cols()));
  }

  std::mt19937_64 random_;
};

TEST(RepairSurface, ClosesOrRefusesWhateverIsDamaged) {
  int closed = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    Damage damage(seed);
    const SurfaceMesh whole = damage.Whole();
    double missing = 0;
    const auto repaired = RepairSurface(damage.Of(whole, missing));
    if (!repaired.ok()) {
      EXPECT_EQ(repaired.status().code(), absl::StatusCode::kInvalidArgument);
      EXPECT_FALSE(repaired.status().message().empty());
      continue;
    }
    ++closed;
    EXPECT_THAT(CheckSurface(repaired->surface), IsEmpty());
    const double volume = VolumeOf(whole);
    EXPECT_NEAR(VolumeOf(repaired->surface), volume, missing + 1e-9 * volume);
    // What is repaired is closed, and so stays as it is.
    const auto again = RepairSurface(repaired->surface);
    ASSERT_TRUE(again.ok());
    EXPECT_EQ(again->surface.triangles, repaired->surface.triangles);
  }
  EXPECT_GT(closed, 180) << "most of such damage can be put right";
}

// Triangles that never were a surface.
TEST(RepairSurface, RefusesOrClosesAnyTriangles) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    SurfaceMesh soup;
    const unsigned vertices = 4 + static_cast<unsigned>(random() % 10);
    soup.vertices.resize(3, vertices);
    // On a coarse grid, so that much is in one place, in one line and in one plane.
    for (double& coordinate : soup.vertices.reshaped()) {
      coordinate = static_cast<double>(random() % 4);
    }
    soup.triangles.resize(3, 1 + static_cast<Eigen::Index>(random() % 30));
    for (int& vertex : soup.triangles.reshaped()) vertex = static_cast<int>(random() % vertices);
    const auto repaired = RepairSurface(soup, {.largest_hole = 1});
    if (repaired.ok()) {
      EXPECT_THAT(CheckSurface(repaired->surface), IsEmpty());
    } else {
      EXPECT_EQ(repaired.status().code(), absl::StatusCode::kInvalidArgument) << repaired.status();
    }
  }
}

}  // namespace
}  // namespace mortise::mesh
