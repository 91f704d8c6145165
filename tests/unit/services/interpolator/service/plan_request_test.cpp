// Plans of maps: what varies, what is fixed, which structures there are. What is refused by name is
// in tests/integration/services/interpolator/map_refusals_test.cpp.
#include "services/interpolator/service/plan_request.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/base/errors.h"
#include "mortise/v1/evaluator.pb.h"
#include "mortise/v1/interpolator.pb.h"

namespace mortise::interpolator {
namespace {

// Numbers a, b, ... in [0, 1] with default 0.25, then a whole number and a choice.
v1::DesignSpace SpaceOf(int numbers) {
  v1::DesignSpace space;
  for (int i = 0; i < numbers; ++i) {
    auto& parameter = *space.add_parameters();
    parameter.set_name(std::string(1, static_cast<char>('a' + i)));
    parameter.set_maximum(1);
    parameter.set_default_value(0.25);
  }
  auto& shelves = *space.add_parameters();
  shelves.set_name("shelves");
  shelves.set_minimum(2);
  shelves.set_maximum(5);
  shelves.set_default_value(3);
  shelves.set_step(1);
  auto& wood = *space.add_parameters();
  wood.set_name("wood");
  wood.set_maximum(1);
  wood.set_step(1);
  for (const char* name : {"oak", "birch"}) wood.add_choices(name);
  space.add_metrics()->set_name("mass");
  space.mutable_metrics(0)->set_unit("kg");
  return space;
}

v1::MapSpecification SpecificationOf(int evaluations = 500) {
  v1::MapSpecification specification;
  specification.set_subject("templates/shelf");
  specification.add_metrics()->set_name("mass");
  specification.set_evaluations(evaluations);
  return specification;
}

TEST(PlanRequestTest, RefusesMapsThatWouldNotFitIntoMemory) {
  const v1::DesignSpace space = SpaceOf(5);
  v1::MapSpecification specification = SpecificationOf(1'000'000);
  EXPECT_TRUE(MakePlan(specification, space).ok());  // 32 coefficients in each element
  specification.set_basis(v1::MapSpecification::CUBIC);
  const auto cubic = MakePlan(specification, space);
  EXPECT_EQ(cubic.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(DetailOf(cubic.status()).field, "specification.evaluations");
  specification.set_evaluations(20'000);
  EXPECT_TRUE(MakePlan(specification, space).ok());
}

TEST(PlanRequestTest, VariesAllNumbersThatAreNotFixed) {
  v1::MapSpecification specification = SpecificationOf();
  auto& fixed = *specification.add_fixed();
  fixed.set_name("b");
  fixed.set_value(0.75);
  const auto plan = MakePlan(specification, SpaceOf(3));
  ASSERT_TRUE(plan.ok()) << plan.status();
  ASSERT_EQ(plan->parameters.size(), 2u);
  EXPECT_EQ(plan->parameters[0].name, "a");
  EXPECT_EQ(plan->parameters[1].name, "c");
  EXPECT_EQ(plan->structures.cols(), 1);
  Eigen::VectorXd base(5);
  base << 0.25, 0.75, 0.25, 3, 0;
  EXPECT_EQ(plan->base, base);
  EXPECT_EQ(plan->metrics[0].unit, "kg");
}

TEST(PlanRequestTest, CombinesWholeNumbersAndChoices) {
  v1::MapSpecification specification = SpecificationOf();
  auto& wood = *specification.add_variations();
  wood.set_parameter("wood");
  auto& shelves = *specification.add_variations();
  shelves.set_parameter("shelves");
  shelves.set_minimum(4);
  specification.add_variations()->set_parameter("b");
  const auto plan = MakePlan(specification, SpaceOf(2));
  ASSERT_TRUE(plan.ok()) << plan.status();
  // In the order of the subject, whatever that of the request.
  ASSERT_EQ(plan->parameters.size(), 3u);
  EXPECT_EQ(plan->parameters[0].name, "b");
  Eigen::MatrixXd structures(2, 4);
  structures << 4, 4, 5, 5, 0, 1, 0, 1;
  EXPECT_EQ(plan->structures, structures);
}

TEST(PlanRequestTest, RefusesMoreNumbersThanMapsCanHave) {
  const absl::Status many = MakePlan(SpecificationOf(), SpaceOf(7)).status();
  EXPECT_EQ(DetailOf(many).field, "specification.variations");
  EXPECT_TRUE(MakePlan(SpecificationOf(), SpaceOf(6)).ok());
  v1::MapSpecification cubic = SpecificationOf();
  cubic.set_basis(v1::MapSpecification::CUBIC);
  EXPECT_TRUE(MakePlan(cubic, SpaceOf(5)).ok());
  EXPECT_EQ(DetailOf(MakePlan(cubic, SpaceOf(6)).status()).field, "specification.basis");
}

TEST(PlanRequestTest, WantsEvaluationsForEveryCorner) {
  const absl::Status few = MakePlan(SpecificationOf(65), SpaceOf(6)).status();
  EXPECT_EQ(DetailOf(few).field, "specification.evaluations");
  EXPECT_TRUE(MakePlan(SpecificationOf(66), SpaceOf(6)).ok());
}

TEST(PlanRequestTest, AsksTheEvaluatorAsTheMapIsAskedFor) {
  v1::MapSpecification specification = SpecificationOf();
  specification.set_revision(4);
  specification.mutable_mesh()->set_element_size(0.1);
  specification.mutable_metric_definitions()->add_expressions()->set_name("mass");
  const v1::EvaluateBatchRequest question = QuestionOf(specification, SpaceOf(2));
  EXPECT_EQ(question.subject(), "templates/shelf");
  EXPECT_EQ(question.revision(), 4);
  EXPECT_EQ(question.metrics(0), "mass");
  EXPECT_EQ(question.mesh().element_size(), 0.1);
  EXPECT_FALSE(question.has_airflow());
  EXPECT_EQ(question.metric_definitions().expressions_size(), 1);
  EXPECT_FALSE(question.has_design_fields());
  EXPECT_EQ(DescriptionOf(specification).metric_definitions().expressions_size(), 1);
}

// A space whose designs have a shape, stresses at nodes and heat flux in elements.
v1::DesignSpace ShapedSpace(v1::GeometryKind geometry) {
  v1::DesignSpace space = SpaceOf(2);
  space.set_geometry(geometry);
  space.add_fields()->set_name("von_mises");
  space.add_fields()->set_name("heat_flux");
  space.mutable_fields(1)->set_of_elements(true);
  return space;
}

TEST(PlanRequestTest, AsksForShapesAndFieldsBesideAMetricThatNobodyWants) {
  v1::MapSpecification specification = SpecificationOf();
  specification.clear_metrics();
  v1::MapSpecification::ShapeChoice& shape = *specification.mutable_shape();
  shape.set_geometry(v1::TETRAHEDRA);
  shape.add_fields()->set_name("von_mises");
  shape.add_regions("cap");
  shape.set_modes(3);
  v1::DesignSpace space = ShapedSpace(v1::TETRAHEDRA);
  space.mutable_metrics(0)->set_name("stiffness");
  const auto plan = MakePlan(specification, space);
  ASSERT_TRUE(plan.ok()) << plan.status();
  EXPECT_TRUE(plan->metrics.empty());
  v1::EvaluateBatchRequest question = QuestionOf(specification, space);
  ASSERT_EQ(question.metrics_size(), 1);
  EXPECT_EQ(question.metrics(0), "stiffness");
  EXPECT_EQ(question.design_fields().geometry(), v1::TETRAHEDRA);
  EXPECT_EQ(question.design_fields().fields(0), "von_mises");
  EXPECT_EQ(question.design_fields().regions(0), "cap");
  EXPECT_EQ(question.design_fields().modes(), 3);
  // Mass costs no analysis.
  space.add_metrics()->set_name("mass");
  EXPECT_EQ(QuestionOf(specification, space).metrics(0), "mass");
}

TEST(PlanRequestTest, RefusesShapesThatTheSubjectDoesNotOffer) {
  v1::MapSpecification specification = SpecificationOf();
  v1::MapSpecification::ShapeChoice& shape = *specification.mutable_shape();
  shape.set_geometry(v1::TETRAHEDRA);
  const auto field_of = [&](v1::GeometryKind offered) {
    return DetailOf(MakePlan(specification, ShapedSpace(offered)).status()).field;
  };
  EXPECT_EQ(field_of(v1::GEOMETRY_KIND_UNSPECIFIED), "specification.shape.geometry");
  EXPECT_EQ(field_of(v1::SURFACE), "specification.shape.geometry");
  EXPECT_EQ(field_of(v1::TETRAHEDRA), "");
  shape.add_fields()->set_name("heat_flux");
  EXPECT_EQ(field_of(v1::TETRAHEDRA), "");
  shape.set_geometry(v1::SURFACE);
  EXPECT_EQ(field_of(v1::TETRAHEDRA), "specification.shape.fields[0].name");
  shape.mutable_fields(0)->set_name("strain");
  EXPECT_EQ(field_of(v1::TETRAHEDRA), "specification.shape.fields[0].name");
  shape.mutable_fields(0)->set_name("von_mises");
  EXPECT_EQ(field_of(v1::SURFACE), "");
}

TEST(PlanRequestTest, EstimatesNoiseThatNobodyHasGivenOfWhatHasMeshes) {
  v1::MapSpecification specification = SpecificationOf(100);
  const auto estimates = [&] {
    return EstimatesNoise(specification, MakePlan(specification, SpaceOf(2)).value());
  };
  EXPECT_TRUE(estimates());
  EXPECT_EQ(NoiseWantedOf(specification).of_metrics, std::vector<bool>{true});
  specification.set_exact_evaluations(true);
  EXPECT_FALSE(estimates());
  specification.clear_exact_evaluations();
  specification.set_subject("evaluators/beam");
  EXPECT_FALSE(estimates());
  specification.set_subject("templates/shelf");
  specification.mutable_metrics(0)->set_noise_floor(0);
  EXPECT_FALSE(estimates());
  v1::MapSpecification::ShapeChoice& shape = *specification.mutable_shape();
  shape.set_noise_floor(0.01);
  shape.add_fields()->set_name("von_mises");
  shape.mutable_fields(0)->set_noise_floor(0.05);
  shape.add_fields()->set_name("heat_flux");
  EXPECT_EQ(NoiseWantedOf(specification).of_fields, std::vector<std::string>{"heat_flux"});
  EXPECT_FALSE(NoiseWantedOf(specification).of_shape);
  shape.clear_noise_floor();
  EXPECT_TRUE(NoiseWantedOf(specification).of_shape);
}

TEST(PlanRequestTest, EstimatesNoNoiseWhereTheBudgetHasNoRoomForIt) {
  const v1::MapSpecification least = SpecificationOf(10), more = SpecificationOf(11);
  EXPECT_FALSE(EstimatesNoise(least, MakePlan(least, SpaceOf(2)).value()));
  EXPECT_TRUE(EstimatesNoise(more, MakePlan(more, SpaceOf(2)).value()));
}

TEST(PlanRequestTest, AsksForOtherMeshesAndOtherCellsOfTheAir) {
  v1::MapSpecification specification = SpecificationOf();
  specification.mutable_metrics(0)->set_name("of_my_own");  // which may be of the air
  specification.mutable_mesh()->set_element_size(0.1);
  v1::MapSpecification other = OnOtherMeshes(specification);
  EXPECT_EQ(other.mesh().element_size(), 0.1);
  EXPECT_EQ(other.mesh().size_scale(), 0.8);
  EXPECT_EQ(other.airflow().cells(), 58593);
  specification.mutable_mesh()->set_size_scale(0.5);
  specification.mutable_airflow()->set_cells(5'000'000);
  other = OnOtherMeshes(specification);
  EXPECT_EQ(other.mesh().size_scale(), 0.625);
  EXPECT_EQ(other.airflow().cells(), 2'560'000);
}

// A question that says nothing of the air is answered by what is known of designs already.
TEST(PlanRequestTest, SaysNothingOfTheAirWhereNothingFeelsIt) {
  v1::MapSpecification specification = SpecificationOf();
  specification.clear_metrics();
  specification.add_metrics()->set_name("max_displacement");
  specification.mutable_shape()->add_fields()->set_name("von_mises");
  EXPECT_FALSE(OnOtherMeshes(specification).has_airflow());
  EXPECT_EQ(OnOtherMeshes(specification).mesh().size_scale(), 0.8);
  specification.mutable_shape()->add_fields()->set_name("air_pressure");
  EXPECT_TRUE(OnOtherMeshes(specification).has_airflow());
  specification.clear_shape();
  specification.add_metrics()->set_name("airflow_drag");
  EXPECT_TRUE(OnOtherMeshes(specification).has_airflow());
}

}  // namespace
}  // namespace mortise::interpolator
