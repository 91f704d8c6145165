#include "services/interpolator/shapes/bring_into.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <thread>

#include "common/base/errors.h"
#include "tests/unit/services/interpolator/shapes/block_designs.h"
#include "tests/unit/services/interpolator/shapes/brought_design.h"

namespace mortise::interpolator {
namespace {

const BlockCells kCoarse{.along = 4, .across = 3, .high = 3, .unrest = 0.1};
const BlockCells kOther{.along = 5, .across = 4, .high = 4, .is_mirrored = true, .unrest = 0.15};

fields::DesignFields Box(const Eigen::Vector3d& size, const BlockCells& cells) {
  return BlockDesign(BoxShape(size), cells);
}

// Nodes and elements may be numbered in any way as long as it is the same way.
TEST(PreparedMesh, TakesTheSameElementsOverAsTheyAre) {
  const CanonicalMesh mesh = CanonicalMesh::Create(Box({2, 1, 0.5}, kCoarse)).value();
  const fields::DesignFields design = Box({3, 1.1, 0.4}, kCoarse);
  for (const fields::DesignFields& same : {design, Quadratic(design)}) {
    const BroughtShape brought = Brought(same, mesh).value();
    EXPECT_TRUE(brought.is_identity);
    EXPECT_EQ(brought.inverted, 0);
    EXPECT_EQ(brought.outside, 0);
    EXPECT_EQ(brought.shape.nodes, design.nodes(Eigen::all, mesh.given_node));
    ASSERT_EQ(brought.shape.fields.size(), 4u);
    for (std::size_t f = 0; f < 3; ++f) {
      EXPECT_EQ(brought.shape.fields[f], design.fields[f].values(Eigen::all, mesh.given_node));
    }
    EXPECT_EQ(brought.shape.fields[3], design.fields[3].values);
  }
}

TEST(PreparedMesh, GivesTheCanonicalDesignItself) {
  const fields::DesignFields design = Box({2, 1, 0.5}, kCoarse);
  const CanonicalMesh mesh =
      ReadMesh(WriteMesh(CanonicalMesh::Create(design).value()).value()).value();
  const BroughtShape brought = Brought(design, mesh).value();
  EXPECT_TRUE(brought.is_identity);
  EXPECT_EQ(brought.shape.nodes, mesh.nodes);
}

TEST(PreparedMesh, SaysWhichElementsOfTheSameMeshAreTurnedOver) {
  const CanonicalMesh mesh = CanonicalMesh::Create(Box({2, 1, 0.5}, kCoarse)).value();
  fields::DesignFields design = Box({2, 1, 0.5}, kCoarse);
  design.nodes.row(0) *= -1;
  EXPECT_EQ(Brought(design, mesh).value().inverted, mesh.element_count());
}

TEST(PreparedMesh, MapsOtherElementsOntoTheShape) {
  const CanonicalMesh mesh = CanonicalMesh::Create(Box({2, 1, 0.5}, kCoarse)).value();
  const BroughtShape brought = Brought(Box({3, 1.1, 0.4}, kOther), mesh).value();
  EXPECT_FALSE(brought.is_identity);
  EXPECT_EQ(brought.inverted, 0);
  const Eigen::Vector3d size(3, 1.1, 0.4);
  EXPECT_LT(brought.shape.nodes.rowwise().minCoeff().norm(), 1e-9);
  EXPECT_LT((brought.shape.nodes.rowwise().maxCoeff() - size).norm(), 1e-9);
  // What is on the surface stays on it.
  for (int node = 0; node < mesh.surface_nodes; ++node) {
    const Eigen::Array3d at = brought.shape.nodes.col(node).array();
    EXPECT_LT(at.abs().min((at - size.array()).abs()).minCoeff(), 1e-9) << node;
  }
}

void ExpectLinear(const Eigen::MatrixXd& values, const Eigen::Matrix3Xd& nodes,
                  const std::function<Eigen::VectorXd(const Eigen::Vector3d&)>& at) {
  ASSERT_EQ(values.cols(), nodes.cols());
  const double scale = values.cwiseAbs().maxCoeff();
  for (Eigen::Index node = 0; node < nodes.cols(); ++node) {
    ASSERT_LT((values.col(node) - at(nodes.col(node))).norm(), 1e-9 * scale) << node;
  }
}

// Fields that are linear in space are carried over exactly.
TEST(PreparedMesh, CarriesLinearFieldsOverExactly) {
  const CanonicalMesh mesh = CanonicalMesh::Create(Box({2, 1, 0.5}, kCoarse)).value();
  const BroughtShape brought = Brought(Box({3, 1.1, 0.4}, kOther), mesh).value();
  EXPECT_EQ(brought.outside, 0);
  ExpectLinear(brought.shape.fields[0], brought.shape.nodes, [](const Eigen::Vector3d& at) {
    return Eigen::VectorXd::Constant(1, TemperatureAt(at));
  });
  ExpectLinear(brought.shape.fields[1], brought.shape.nodes, DisplacementAt);
  ExpectLinear(brought.shape.fields[2], brought.shape.nodes, StressAt);
}

// Middles of edges have no say in what corners get.
TEST(PreparedMesh, MapsQuadraticElementsAsWell) {
  const CanonicalMesh mesh = CanonicalMesh::Create(Quadratic(Box({2, 1, 0.5}, kCoarse))).value();
  const BroughtShape brought = Brought(Quadratic(Box({3, 1.1, 0.4}, kOther)), mesh).value();
  EXPECT_FALSE(brought.is_identity);
  EXPECT_EQ(brought.inverted, 0);
  ExpectLinear(brought.shape.fields[1], brought.shape.nodes, DisplacementAt);
}

// What is of elements comes from the one that the centre lies in: no farther off than it is large.
TEST(PreparedMesh, CarriesFieldsOfElementsOverByTheirCentres) {
  const CanonicalMesh mesh = CanonicalMesh::Create(Box({2, 1, 0.5}, kCoarse)).value();
  const BroughtShape brought = Brought(Box({3, 1.1, 0.4}, kOther), mesh).value();
  const double cell = Eigen::Vector3d(3.0 / 5, 1.1 / 4, 0.4 / 4).norm() * 1.3;
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    const Eigen::MatrixXd corners = brought.shape.nodes(Eigen::all, mesh.tetrahedra.col(e));
    const Eigen::Vector3d expected = HeatFluxAt(corners.rowwise().mean());
    EXPECT_LT((brought.shape.fields[3].col(e) - expected).norm(), 100 * cell);
  }
}

// A natural mode is found with either sign.
TEST(PreparedMesh, GivesModesTheSignOfTheMesh) {
  const auto with_mode = [](fields::DesignFields design, double sign) {
    design.fields = {
        {"mode_shape", "1", "mode 1", fields::FieldPlace::kNodes, sign * design.fields[1].values}};
    return design;
  };
  const fields::DesignFields own = with_mode(Box({2, 1, 0.5}, kCoarse), 1);
  const CanonicalMesh mesh =
      ReadMesh(WriteMesh(CanonicalMesh::Create(own).value()).value()).value();
  for (const BlockCells& cells : {kCoarse, kOther}) {
    const fields::DesignFields design = with_mode(Box({2.2, 1, 0.5}, cells), 1);
    const fields::DesignFields turned = with_mode(Box({2.2, 1, 0.5}, cells), -1);
    const ConsistentShape plain = Brought(design, mesh).value().shape;
    EXPECT_EQ(Brought(turned, mesh).value().shape.fields[0], plain.fields[0]);
    ExpectLinear(plain.fields[0], plain.nodes, DisplacementAt);
  }
}

// Round faces: the design's and the mesh's facets are not the same, so some nodes lie outside.
TEST(PreparedMesh, CarriesFieldsOverOnRoundFaces) {
  const BlockCells fine{.along = 4, .across = 5, .high = 3};
  const BlockCells other{.along = 5, .across = 4, .high = 2, .is_mirrored = true};
  const CanonicalMesh mesh =
      CanonicalMesh::Create(BlockDesign(PlateShape(0.3, 0.2, 0.03, 0.05), fine)).value();
  const BroughtShape brought =
      Brought(BlockDesign(PlateShape(0.3, 0.2, 0.03, 0.06), other), mesh).value();
  EXPECT_EQ(brought.inverted, 0);
  EXPECT_LT(brought.furthest, 0.01);
  for (Eigen::Index node = 0; node < mesh.nodes.cols(); ++node) {
    // Nowhere is it off by more than the field changes over what the place is off.
    EXPECT_NEAR(brought.shape.fields[0](0, node), TemperatureAt(brought.shape.nodes.col(node)),
                1e-9 + 110 * brought.furthest);
  }
}

TEST(PreparedMesh, MapsSurfacesAlone) {
  const CanonicalMesh mesh = CanonicalMesh::Create(SurfaceOnly(Box({2, 1, 0.5}, kCoarse))).value();
  // A design with elements will do: it has a surface.
  fields::DesignFields design = Box({3, 1.1, 0.4}, kOther);
  design.fields.pop_back();
  for (const fields::DesignFields& other : {SurfaceOnly(design), design}) {
    const BroughtShape brought = Brought(other, mesh).value();
    EXPECT_FALSE(brought.is_identity);
    EXPECT_EQ(brought.shape.nodes.cols(), mesh.surface_nodes);
    EXPECT_LT((brought.shape.nodes.rowwise().maxCoeff() - Eigen::Vector3d(3, 1.1, 0.4)).norm(),
              1e-9);
    ExpectLinear(brought.shape.fields[1], brought.shape.nodes, DisplacementAt);
  }
}

TEST(PreparedMesh, GivesTheSameInAnyOrderOnAnyThread) {
  const auto mesh = std::make_shared<const CanonicalMesh>(
      CanonicalMesh::Create(Box({2, 1, 0.5}, kCoarse)).value());
  const fields::DesignFields first = Box({3, 1.1, 0.4}, kOther), second = Box({1, 2, 1}, kOther);
  const BroughtShape alone = Brought(first, *mesh).value();
  const PreparedMesh prepared(mesh);
  ASSERT_TRUE(prepared.Bring(second).ok());
  std::vector<BroughtShape> brought(2);
  std::thread beside([&] { brought[0] = prepared.Bring(first).value(); });
  brought[1] = prepared.Bring(first).value();
  beside.join();
  for (const BroughtShape& shape : brought) {
    EXPECT_EQ(shape.shape.nodes, alone.shape.nodes);
    EXPECT_EQ(shape.shape.fields, alone.shape.fields);
  }
}

class BadDesign : public testing::Test {
 protected:
  absl::Status StatusOf(const fields::DesignFields& design) const {
    return Brought(design, mesh_).status();
  }

  const CanonicalMesh mesh_ = CanonicalMesh::Create(Box({2, 1, 0.5}, kCoarse)).value();
  fields::DesignFields design_ = Box({3, 1.1, 0.4}, kOther);
};

TEST_F(BadDesign, IsNamedWhereItLacksAField) {
  design_.fields.erase(design_.fields.begin() + 1);
  const absl::Status status = StatusOf(design_);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(DetailOf(status).field, "fields");
  EXPECT_THAT(std::string(status.message()),
              testing::AllOf(testing::HasSubstr("displacement"), testing::HasSubstr("wind")));
}

TEST_F(BadDesign, IsRefusedWhereAFieldIsAnother) {
  design_.fields[0].unit = "degC";
  EXPECT_EQ(DetailOf(StatusOf(design_)).field, "fields");
  design_ = Box({3, 1.1, 0.4}, kOther);
  design_.fields[1].values = design_.fields[1].values.topRows(2).eval();
  EXPECT_EQ(DetailOf(StatusOf(design_)).field, "fields");
}

TEST_F(BadDesign, MayHaveFieldsThatAreNotWanted) {
  design_.fields.insert(design_.fields.begin(), design_.fields[0]);
  design_.fields[0].load_case = "night";
  EXPECT_TRUE(StatusOf(design_).ok());
}

TEST_F(BadDesign, IsRefusedWhereNumbersAreNotFinite) {
  design_.fields[2].values(3, 5) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(StatusOf(design_).code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(DetailOf(StatusOf(design_)).field, "fields[2].values");
}

TEST_F(BadDesign, IsRefusedWithoutElements) {
  EXPECT_EQ(DetailOf(StatusOf(SurfaceOnly(design_))).field, "tetrahedra");
}

TEST_F(BadDesign, OfAnotherTopologyIsToldAsSuch) {
  const absl::Status holed =
      StatusOf(BlockDesign(PlateShape(0.3, 0.2, 0.03, 0.05), {.along = 2, .across = 2, .high = 2}));
  EXPECT_EQ(holed.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(DetailOf(holed).reason, "TOPOLOGY_DIFFERS");
  design_.parts.push_back("another");
  const absl::Status parts = StatusOf(design_);
  EXPECT_EQ(parts.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(DetailOf(parts).reason, "TOPOLOGY_DIFFERS");
}

TEST_F(BadDesign, WithoutControlVariablesIsToldAsSuch) {
  design_.control_points.clear();
  design_.paths.clear();
  design_.regions.clear();
  const absl::Status status = StatusOf(design_);
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(DetailOf(status).reason, "TOO_FEW_POINTS");
}

}  // namespace
}  // namespace mortise::interpolator
