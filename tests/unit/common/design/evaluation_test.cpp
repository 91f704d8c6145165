// F(q) of the shipped table against numbers worked out by hand, and invariants at random points.
#include "common/design/evaluation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/design/contact.h"
#include "common/design/parameter_values.h"
#include "tests/unit/common/files/table.h"

namespace mortise::parametric {
namespace {

class TableTest : public testing::Test {
 protected:
  void SetUp() override {
    auto function = TemplateFunction::Create(TableBundle());
    ASSERT_TRUE(function.ok()) << function.status();
    table_.emplace(*std::move(function));
  }

  EvaluatedDesign At(const std::vector<NamedValue>& values) {
    const auto q = table_->CompleteParameters(values);
    EXPECT_TRUE(q.ok()) << q.status();
    auto design = table_->Evaluate(*q);
    EXPECT_TRUE(design.ok()) << design.status();
    return *std::move(design);
  }

  Eigen::VectorXd RandomPoint(std::mt19937& random) {
    Eigen::VectorXd q = table_->Defaults();
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const Parameter& parameter = table_->parameters()[static_cast<std::size_t>(i)];
      q(i) = std::uniform_real_distribution<double>(parameter.minimum, parameter.maximum)(random);
    }
    return q;
  }

  std::optional<TemplateFunction> table_;
};

TEST_F(TableTest, HasTheSizesItsParametersSay) {
  const EvaluatedDesign design = At({{"length", 1.6},
                                     {"width", 0.8},
                                     {"height", 0.75},
                                     {"leg_section", 0.07},
                                     {"apron_height", 0.1},
                                     {"top_thickness", 0.03}});
  ASSERT_EQ(design.parts.size(), 9u);
  std::map<std::string, EvaluatedPart> parts;
  for (const EvaluatedPart& part : design.parts) parts[part.name] = part;
  EXPECT_TRUE(parts["leg_front_left"].size.isApprox(Eigen::Vector3d(0.72, 0.07, 0.07), 1e-12));
  EXPECT_TRUE(parts["leg_front_left"].minimum.isApprox(Eigen::Vector3d(-0.77, -0.37, 0), 1e-12));
  EXPECT_TRUE(parts["apron_front"].size.isApprox(Eigen::Vector3d(1.4, 0.1, 0.022), 1e-12));
  EXPECT_TRUE(parts["apron_left"].size.isApprox(Eigen::Vector3d(0.6, 0.1, 0.022), 1e-12));
  EXPECT_TRUE(parts["top"].size.isApprox(Eigen::Vector3d(1.6, 0.8, 0.03), 1e-12));
  EXPECT_EQ(parts["apron_left"].process, Process::kChopSaw);
  EXPECT_EQ(parts["top"].process, Process::kJigsaw);

  // Each rounded corner: a square of 0.06 less the 12-sided quarter disc within it,
  // 3 triangles of r² sin 30° / 2.
  const double corner = 0.06 * 0.06 - 3 * 0.06 * 0.06 * 0.5 / 2;
  const double top = (1.6 * 0.8 - 4 * corner) * 0.03;
  EXPECT_NEAR(parts["top"].volume, top, 1e-12);
  const double timber = 4 * 0.07 * 0.07 * 0.72 + 2 * 0.1 * 0.022 * (1.4 + 0.6);
  EXPECT_NEAR(design.mass, timber * 420 + top * 430, 1e-9);
}

TEST_F(TableTest, PutsPegsWhereTheRulesSay) {
  const EvaluatedDesign design = At({{"length", 1.4},
                                     {"width", 0.75},
                                     {"height", 0.74},
                                     {"leg_section", 0.06},
                                     {"apron_height", 0.09},
                                     {"top_thickness", 0.027}});
  std::map<std::string, std::vector<EvaluatedConnector>> rows;
  for (const EvaluatedConnector& peg : design.connectors) rows[peg.connection].push_back(peg);
  ASSERT_EQ(rows.size(), 16u);

  // Patch of 22 x 90 mm, from z = 0.623 to 0.713: pegs 25 mm from its ends, 40 mm apart.
  const auto& frame = rows["frame_left_front"];
  ASSERT_EQ(frame.size(), 2u);
  EXPECT_TRUE(frame[0].direction.isApprox(-Eigen::Vector3d::UnitY()));
  for (const EvaluatedConnector& peg : frame) {
    EXPECT_NEAR(peg.position.x(), -0.653, 1e-12);
    EXPECT_NEAR(peg.position.y(), -0.285, 1e-12);
    EXPECT_NEAR(peg.depth_in_part, 0.66 * 0.035, 1e-12);
    EXPECT_EQ(peg.priority, 1);
  }
  EXPECT_NEAR(std::min(frame[0].position.z(), frame[1].position.z()), 0.648, 1e-12);
  EXPECT_NEAR(std::max(frame[0].position.z(), frame[1].position.z()), 0.688, 1e-12);

  // A leg of 60 mm has no room for two pegs at 25 mm from the edges: one in the middle.
  ASSERT_EQ(rows["top_leg_front_left"].size(), 1u);
  EXPECT_TRUE(rows["top_leg_front_left"][0].position.isApprox(Eigen::Vector3d(-0.64, -0.315, 0.713),
                                                              1e-12));

  // A long apron of 1.22 m: 1.06 m between the outer pegs, at most 0.2 m apart: six gaps.
  EXPECT_EQ(rows["top_apron_front"].size(), 7u);
  // A short one of 0.57 m: 0.41 m, three gaps.
  EXPECT_EQ(rows["top_apron_left"].size(), 4u);
}

TEST_F(TableTest, CarriesItsBoundaryConditions) {
  const EvaluatedDesign design = At({});
  ASSERT_EQ(design.boundary_conditions.size(), 5u);
  EXPECT_EQ(design.boundary_conditions[0].kind, BoundaryConditionKind::kFixed);
  EXPECT_EQ(design.boundary_conditions[0].face, "z_min");
  EXPECT_TRUE(design.boundary_conditions[4].force.isApprox(Eigen::Vector3d(0, 0, -1000)));
  EXPECT_GE(FindFace(design.parts[8], "cap"), 0);
}

TEST_F(TableTest, CanBeBuiltAtRandomPoints) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::VectorXd q = RandomPoint(random);
    const auto design = table_->Evaluate(q);
    ASSERT_TRUE(design.ok()) << design.status();
    for (std::size_t i = 0; i < design->parts.size(); ++i) {
      for (std::size_t j = i + 1; j < design->parts.size(); ++j) {
        EXPECT_EQ(PenetrationDepth(design->parts[i], design->parts[j]), 0)
            << design->parts[i].name << " and " << design->parts[j].name << " at " << q.transpose();
      }
    }
    for (const EvaluatedConnector& peg : design->connectors) {
      const EvaluatedPart& part =
          design->parts[static_cast<std::size_t>(FindPart(*design, peg.part))];
      const EvaluatedPart& other =
          design->parts[static_cast<std::size_t>(FindPart(*design, peg.other_part))];
      EXPECT_TRUE(ContainsCylinder(part, peg.position, -peg.direction, peg.depth_in_part,
                                   peg.diameter / 2));
      EXPECT_TRUE(ContainsCylinder(other, peg.position, peg.direction,
                                   peg.length - peg.depth_in_part, peg.diameter / 2));
    }
  }
}

// Every directed edge of a closed surface is matched by its opposite, exactly once.
void ExpectWatertight(const mesh::SurfaceMesh& surface) {
  std::map<std::pair<int, int>, int> edges;
  for (const auto& triangle : surface.triangles.colwise()) {
    for (int i = 0; i < 3; ++i) ++edges[{triangle(i), triangle((i + 1) % 3)}];
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
  }
}

double EnclosedVolume(const mesh::SurfaceMesh& surface) {
  double six = 0;
  for (const auto& triangle : surface.triangles.colwise()) {
    six += surface.vertices.col(triangle(0))
               .dot(surface.vertices.col(triangle(1)).cross(surface.vertices.col(triangle(2))));
  }
  return six / 6;
}

TEST_F(TableTest, HasWatertightPartsAtRandomPoints) {
  std::mt19937 random(6);
  for (int trial = 0; trial < 200; ++trial) {
    const auto design = table_->Evaluate(RandomPoint(random));
    ASSERT_TRUE(design.ok()) << design.status();
    for (const EvaluatedPart& part : design->parts) {
      const mesh::SurfaceMesh surface = PartSurface(part);
      ExpectWatertight(surface);
      EXPECT_NEAR(EnclosedVolume(surface), part.volume, 1e-12);
    }
  }
}

TEST_F(TableTest, MassGradientMatchesDifferences) {
  std::mt19937 random(8);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::VectorXd q = 0.9 * RandomPoint(random) + 0.1 * table_->Defaults();
    const auto mass = table_->EvaluateMass(q);
    ASSERT_TRUE(mass.ok()) << mass.status();
    EXPECT_NEAR(mass->mass, table_->Evaluate(q)->mass, 1e-9);
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const double step = 1e-6;
      Eigen::VectorXd up = q, down = q;
      up(i) += step;
      down(i) -= step;
      const double difference =
          (table_->EvaluateMass(up)->mass - table_->EvaluateMass(down)->mass) / (2 * step);
      EXPECT_NEAR(mass->mass_gradient(i), difference, 1e-5 * (1 + std::abs(difference)));
    }
  }
}

TEST_F(TableTest, RoundsToWhatAWorkshopCanSet) {
  Eigen::VectorXd q = table_->Defaults();
  q(0) = 1.2344;
  q(1) = 1.0999999;
  const Eigen::VectorXd rounded = table_->RoundToSteps(q);
  EXPECT_NEAR(rounded(0), 1.234, 1e-12);
  EXPECT_LE(rounded(1), 1.1);
}

TEST_F(TableTest, RefusesWrongParameters) {
  const auto field = [](const absl::Status& status) { return DetailOf(status).field; };
  EXPECT_EQ(field(table_->CompleteParameters({{"depth", 1}}).status()), "parameters[0].name");
  EXPECT_THAT(std::string(table_->CompleteParameters({{"lenght", 1}}).status().message()),
              ::testing::HasSubstr("there is no parameter 'lenght'; did you mean 'length'?"));
  EXPECT_EQ(field(table_->CompleteParameters({{"length", 1}, {"length", 1}}).status()),
            "parameters[1].name");
  EXPECT_EQ(field(table_->CompleteParameters({{"length", -1}}).status()), "parameters[0].value");
  EXPECT_EQ(field(table_->CompleteParameters({{"length", NAN}}).status()), "parameters[0].value");
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(field(table_->CompleteParameters({{"length", infinity}}).status()),
            "parameters[0].value");
  EXPECT_EQ(field(table_->Evaluate(Eigen::VectorXd::Zero(2)).status()), "parameters");
  EXPECT_EQ(field(table_->Evaluate(Eigen::VectorXd::Zero(6)).status()), "parameters[0].value");
  EXPECT_EQ(table_->CompleteParameters({{"length", 99}}).status().code(),
            absl::StatusCode::kInvalidArgument);
}

// Parts that stand on different axes.
EvaluatedPart MakePrism(Axis axis, std::initializer_list<std::array<double, 2>> corners,
                        double from, double to) {
  EvaluatedPart part;
  part.axis = axis;
  part.outline.resize(2, static_cast<Eigen::Index>(corners.size()));
  Eigen::Index next = 0;
  for (const auto& [u, v] : corners) {
    part.outline.col(next++) << u, v;
    part.face_names.push_back("side");
  }
  part.face_names.push_back("base");
  part.face_names.push_back("cap");
  part.from = from;
  part.to = to;
  const Eigen::Vector2d low = part.outline.rowwise().minCoeff();
  const Eigen::Vector2d high = part.outline.rowwise().maxCoeff();
  part.minimum = FromPrismAxes(axis, low.x(), low.y(), from);
  part.maximum = FromPrismAxes(axis, high.x(), high.y(), to);
  return part;
}

TEST(ParameterValues, AllThatIsWrongIsToldAtOnce) {
  std::vector<Parameter> parameters(2);
  parameters[0].name = "length";
  parameters[0].maximum = 1;
  parameters[1].name = "width";
  parameters[1].maximum = 1;
  const auto refused = CompleteParameters(
      parameters, {{"length", 2}, {"depth", 0.5}, {"width", NAN}, {"length", 0.5}});
  std::vector<std::string> fields;
  for (const FieldViolation& fault : ViolationsOf(refused.status())) fields.push_back(fault.field);
  EXPECT_THAT(fields, ::testing::ElementsAre("parameters[0].value", "parameters[1].name",
                                             "parameters[2].value", "parameters[3].name"));
  const absl::Status near = CheckParameterValues(parameters, Eigen::Vector2d(1.00000002, 0.5));
  EXPECT_THAT(near.message(), testing::HasSubstr("is 1.00000002, outside its range"));
  const absl::Status out = CheckParameterValues(parameters, Eigen::Vector2d(-1, 2));
  EXPECT_EQ(ViolationsOf(out).size(), 2U);
  EXPECT_EQ(DetailOf(CompleteParameters(parameters, {{"width", 3}}).status()).field,
            "parameters[0].value");
}

TEST(Contact, FacesPointOutwards) {
  for (const Axis axis : {Axis::kX, Axis::kY, Axis::kZ}) {
    const EvaluatedPart part = MakePrism(axis, {{0, 0}, {2, 0}, {1, 1.5}}, 1, 2);
    const Eigen::Vector3d inside = FromPrismAxes(axis, 1, 0.5, 1.5);
    for (int face = 0; face < 5; ++face) {
      const PlanarFace plane = FaceOf(part, face);
      EXPECT_LT(plane.normal.dot(inside - plane.origin), 0) << AxisName(axis) << face;
    }
  }
}

TEST(Contact, PatchIsTheOverlapOfTheFaces) {
  const EvaluatedPart below = MakePrism(Axis::kZ, {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 0, 1);
  // Lies across on top: an x-axis prism in (y, z).
  const EvaluatedPart above =
      MakePrism(Axis::kX, {{0.25, 1}, {0.5, 1}, {0.5, 2}, {0.25, 2}}, -3, 3);
  const ContactPatch patch = FindContact(below, 5, above);
  EXPECT_NEAR(patch.area, 0.25, 1e-12);
  EXPECT_EQ(PenetrationDepth(below, above), 0);
  EXPECT_TRUE(FindContact(below, 4, above).pieces.empty());
}

TEST(Contact, PenetrationIsTheWayOut) {
  const EvaluatedPart a = MakePrism(Axis::kZ, {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 0, 1);
  const EvaluatedPart b =
      MakePrism(Axis::kX, {{0.9, 0.2}, {2, 0.2}, {2, 0.8}, {0.9, 0.8}}, 0.2, 0.8);
  EXPECT_NEAR(PenetrationDepth(a, b), 0.1, 1e-12);
  // A notch that the other part stands in without touching.
  const EvaluatedPart notched =
      MakePrism(Axis::kZ, {{0, 0}, {3, 0}, {3, 2}, {2, 2}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 0, 1);
  const EvaluatedPart post =
      MakePrism(Axis::kZ, {{1.2, 1.2}, {1.8, 1.2}, {1.8, 3}, {1.2, 3}}, 0, 1);
  EXPECT_EQ(PenetrationDepth(notched, post), 0);
}

}  // namespace
}  // namespace mortise::parametric
