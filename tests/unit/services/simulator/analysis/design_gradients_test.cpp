// Exact gradients of designs under loads: held against beam theory, against central differences on
// the mesh that moves along, and against those of new meshes.
#include "services/simulator/analysis/design_gradients.h"

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "common/design/parameter_values.h"
#include "common/templates/template_codec.h"
#include "services/simulator/analysis/custom_metrics.h"
#include "services/simulator/analysis/design_solver.h"
#include "services/simulator/worker/design_motion.h"
#include "services/simulator/worker/subject_metrics.h"
#include "services/simulator/worker/template_model.h"
#include "tests/unit/common/templates/conditioned_bars.h"

namespace mortise::simulator {
namespace {

constexpr char kTip[] =
    "expressions { name: 'tip' unit: 'm' expression: "
    "\"mean_displacement_z('end')\" } "
    "expressions { name: 'trade' unit: 'J kg' expression: "
    "\"compliance * mass * (1 + length / width) + mass * '1 N' * tip\" } ";

// A cantilever of length x width x height along x, clamped at x = 0, with forces at its end that
// may depend on its length.
v1::TemplateBundle Cantilever(const std::string& force, const std::string& more = "") {
  const auto parameter = [](const std::string& name, double low, double high, double value) {
    return absl::StrCat("parameters { name: '", name, "' unit: 'm' minimum: ", low,
                        " maximum: ", high, " default_value: ", value, " } ");
  };
  return templates::BarOf(
      absl::StrCat(
          "title: 'Beam' ", parameter("length", 0.2, 0.8, 0.6),
          parameter("width", 0.02, 0.06, 0.04), parameter("height", 0.02, 0.06, 0.03),
          "parts { name: 'bar' item: 'items/spruce-planed-2400' length_axis: X thickness_axis: Z "
          "box { x { from: '0' to: 'length' } y { from: '0' to: 'width' } "
          "z { from: '0' to: 'height' } } } "
          "boundary_conditions { name: 'wall' kind: FIXED part: 'bar' face: 'x_min' } "
          "boundary_conditions { name: 'end' kind: FORCE part: 'bar' face: 'x_max' "
          "components: '0' components: '0' components: '",
          force, "' } ", more),
      {.poissons_ratio = 0.3});
}

struct Subject {
  EvaluatedTemplate compiled;
  parametric::MetricExpressions own;

  Eigen::VectorXd Defaults() const {
    return parametric::Defaults(compiled.design_template->parameters());
  }
  parametric::EvaluatedDesign At(const Eigen::VectorXd& q) const {
    auto design = compiled.design_template->Evaluate(q);
    EXPECT_TRUE(design.ok()) << design.status();
    return *std::move(design);
  }
  // Without `joined` it is for meshes that are there.
  DesignModel ModelAt(const Eigen::VectorXd& q, bool joined = true) const {
    auto model = MakeDesignModel(*compiled.design_template, q, At(q), {.is_wanted = joined});
    EXPECT_TRUE(model.ok()) << model.status();
    return *std::move(model);
  }
};

Subject SubjectOf(v1::TemplateBundle bundle, const std::string& definitions = kTip) {
  EXPECT_EQ(templates::FillAndCheck(bundle, templates::Trial::kDefaults), absl::OkStatus());
  Subject subject;
  auto function = templates::Compile(bundle);
  EXPECT_TRUE(function.ok()) << function.status();
  subject.compiled.design_template = *function;
  v1::MetricDefinitions asked;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(definitions, &asked));
  auto own = CustomMetricsOf(subject.compiled, asked);
  EXPECT_TRUE(own.ok()) << own.status();
  subject.own = *std::move(own);
  return subject;
}

DesignAnalysisOptions OptionsOf(const Subject& subject, const Eigen::VectorXd& q,
                                double element_size, bool quadratic) {
  DesignAnalysisOptions options;
  options.mesh.element_size = element_size;
  options.mesh.quadratic = quadratic;
  options.elasticity.solver.kind = SolverKind::kDirect;
  options.custom_metrics = subject.own;
  options.parameters = q;
  return options;
}

DesignAnalysis WithGradients(const Subject& subject, const Eigen::VectorXd& q,
                             const std::vector<std::string>& metrics, double element_size,
                             bool quadratic) {
  const DesignModel model = subject.ModelAt(q);
  const DesignMotion motion =
      KnownMotion(*subject.compiled.design_template, q, subject.At(q), model);
  EXPECT_FALSE(motion.faces.empty());
  DesignAnalysisOptions options = OptionsOf(subject, q, element_size, quadratic);
  options.motion = &motion;
  auto analysis = AnalyzeDesign(model, metrics, false, options);
  EXPECT_TRUE(analysis.ok()) << analysis.status();
  return *std::move(analysis);
}

double ValueOf(const DesignAnalysis& analysis, const std::string& name) {
  for (const Metric& metric : analysis.metrics) {
    if (metric.name == name) return metric.value;
  }
  ADD_FAILURE() << "there is no " << name;
  return 0;
}

// The mesh of an analysis as its nodes follow the parameters.
class MovingMesh {
 public:
  MovingMesh(const Subject& subject, const Eigen::VectorXd& q, const DesignAnalysis& analysis)
      : subject_(subject), q_(q), mesh_(*analysis.mesh) {
    const auto motion =
        MotionOf(*subject.compiled.design_template, q, subject.At(q), subject.ModelAt(q, false));
    EXPECT_TRUE(motion.ok()) << motion.status();
    auto velocities = NodeVelocities(mesh_, motion->faces, static_cast<int>(q.size()), 1e9);
    EXPECT_TRUE(velocities.ok()) << velocities.status();
    velocities_ = *std::move(velocities);
  }

  // What comes of the design when parameter k is changed by `step`.
  DesignAnalysis At(int k, double step) const {
    Eigen::VectorXd q = q_;
    q[k] += step;
    const DesignModel model = subject_.ModelAt(q, false);
    DesignAnalysis moved;
    moved.mesh = mesh_;
    moved.mesh->nodes += step * velocities_[static_cast<std::size_t>(k)];
    const DesignAnalysisOptions options = OptionsOf(subject_, q, 1, mesh_.IsQuadratic());
    auto solved = DesignSolver(model, options, {.spread = true}).Solve(*moved.mesh, false);
    EXPECT_TRUE(solved.ok()) << solved.status();
    moved.cases = std::move(solved->cases);
    return moved;
  }

 private:
  const Subject& subject_;
  const Eigen::VectorXd q_;
  const mesh::TetrahedralMesh mesh_;
  std::vector<Eigen::Matrix3Xd> velocities_;
};

double ComplianceOf(const DesignAnalysis& analysis) {
  double largest = 0;
  for (const SolvedCase& solved : analysis.cases) {
    largest = std::max(largest, solved.solution.summary.compliance);
  }
  return largest;
}

double LargestDisplacement(const DesignAnalysis& analysis) {
  return analysis.cases.at(0).solution.summary.maximum_displacement;
}

// Euler and Bernoulli: F L³ / (3 E I), I = b h³ / 12, so the logarithmic derivatives are 3, -1, -3.
TEST(DesignGradients, OfACantileverAreThoseOfBeamTheory) {
  const Subject beam = SubjectOf(Cantilever("-10"));
  const Eigen::VectorXd q = beam.Defaults();
  const DesignAnalysis analysis = WithGradients(beam, q, {"tip", "mass"}, 0.02, true);
  ASSERT_EQ(analysis.gradients.size(), 2u);
  const Eigen::Vector3d powers(3, -1, -3);
  for (int k = 0; k < 3; ++k) {
    const double power = analysis.gradients[0].values[k] * q[k] / ValueOf(analysis, "tip");
    EXPECT_NEAR(power, powers[k], 0.02 * std::abs(powers[k])) << k;
    const double mass = analysis.gradients[1].values[k] * q[k] / ValueOf(analysis, "mass");
    EXPECT_NEAR(mass, 1, 1e-9) << k;
  }
}

// Along a choice, and a whole number that counts parts, nothing changes; along the others all is as
// without them.
TEST(DesignGradients, LeaveChoicesAndCountsAsTheyAre) {
  v1::TemplateBundle bundle = Cantilever(
      "-20",
      "parameters { name: 'bars' unit: '1' minimum: 1 maximum: 3 default_value: 1 step: 1 } "
      "parameters { name: 'load' choices: 'light' choices: 'heavy' default_value: 1 } ");
  v1::Template& varied = *bundle.mutable_template_();
  varied.mutable_parts(0)->add_repeat()->set_count("bars");
  varied.mutable_parts(0)->mutable_repeat(0)->set_y("1");
  varied.mutable_boundary_conditions(1)->set_components(2, "if(load == 'heavy', -20, -10)");
  const Subject beam = SubjectOf(bundle, "");
  const Subject plain = SubjectOf(Cantilever("-20"), "");
  const std::vector<std::string> metrics = {"compliance", "mass"};
  const DesignAnalysis analysis = WithGradients(beam, beam.Defaults(), metrics, 0.04, true);
  const DesignAnalysis alike = WithGradients(plain, plain.Defaults(), metrics, 0.04, true);
  for (std::size_t m = 0; m < metrics.size(); ++m) {
    const Eigen::VectorXd& gradient = analysis.gradients[m].values;
    ASSERT_EQ(gradient.size(), 5);
    for (int k = 0; k < 3; ++k) {
      const double expected = alike.gradients[m].values[k];
      EXPECT_NEAR(gradient[k], expected, 1e-6 * std::abs(expected));
    }
    EXPECT_EQ(gradient[3], 0);
    EXPECT_EQ(gradient[4], 0);
  }
}

TEST(DesignGradients, AreThoseOfDifferencesOnTheMeshThatMovesAlong) {
  const std::string pressed =
      "boundary_conditions { name: 'wind' kind: PRESSURE part: 'bar' face: 'y_max' "
      "components: '30 / width' } boundary_conditions { name: 'down' kind: GRAVITY "
      "components: '0' components: '0' components: '-9.81 * length' } ";
  for (const bool quadratic : {false, true}) {
    const Subject beam = SubjectOf(Cantilever("-10 * length ^ 2", pressed));
    const Eigen::VectorXd q = beam.Defaults();
    const DesignAnalysis analysis = WithGradients(
        beam, q, {"compliance", "max_displacement", "strain_energy"}, 0.04, quadratic);
    ASSERT_EQ(analysis.gradients.size(), 3u);
    const MovingMesh moving(beam, q, analysis);
    for (int k = 0; k < q.size(); ++k) {
      // The solver's rounding is some 1e-11, by the processor's kernels, and counts 1 / step times;
      // what differences leave out some step^2.
      const double step = 1e-4 * q[k];
      const DesignAnalysis plus = moving.At(k, step);
      const DesignAnalysis minus = moving.At(k, -step);
      const double compliance = (ComplianceOf(plus) - ComplianceOf(minus)) / (2 * step);
      EXPECT_NEAR(analysis.gradients[0].values[k], compliance, 1e-6 * std::abs(compliance));
      const double largest = (LargestDisplacement(plus) - LargestDisplacement(minus)) / (2 * step);
      EXPECT_NEAR(analysis.gradients[1].values[k], largest, 1e-6 * std::abs(largest));
      EXPECT_NEAR(analysis.gradients[2].values[k], compliance / 2, 1e-6 * std::abs(compliance));
    }
  }
}

double LargestStress(const DesignAnalysis& analysis) {
  return analysis.cases.at(0).solution.part_maximum_von_mises.maxCoeff();
}

double LargestPrincipal(const DesignAnalysis& analysis) {
  return analysis.cases.at(0).solution.maximum_principal.maxCoeff();
}

TEST(DesignGradients, OfStressesAreThoseOfDifferencesOnTheMeshThatMovesAlong) {
  const std::string pressed =
      "boundary_conditions { name: 'wind' kind: PRESSURE part: 'bar' face: 'y_max' "
      "components: '3000 / width' } ";
  for (const bool quadratic : {false, true}) {
    const Subject beam = SubjectOf(Cantilever("-10 * length ^ 2", pressed));
    const Eigen::VectorXd q = beam.Defaults();
    const std::vector<std::string> metrics{"max_von_mises", "max_principal", "stress_ratio"};
    const DesignAnalysis analysis = WithGradients(beam, q, metrics, 0.04, quadratic);
    ASSERT_EQ(analysis.gradients.size(), 3u);
    const double strength = ValueOf(analysis, "max_von_mises") / ValueOf(analysis, "stress_ratio");
    const MovingMesh moving(beam, q, analysis);
    for (int k = 0; k < q.size(); ++k) {
      const double step = 1e-4 * q[k];
      const DesignAnalysis plus = moving.At(k, step);
      const DesignAnalysis minus = moving.At(k, -step);
      const double stress = (LargestStress(plus) - LargestStress(minus)) / (2 * step);
      const double principal = (LargestPrincipal(plus) - LargestPrincipal(minus)) / (2 * step);
      // Where the stress hardly depends on a parameter, differences have the rounding of the
      // stress.
      const double tolerance = 1e-6 * ValueOf(analysis, "max_von_mises") / q[k];
      EXPECT_NEAR(analysis.gradients[0].values[k], stress, tolerance) << k;
      EXPECT_NEAR(analysis.gradients[1].values[k], principal, tolerance) << k;
      EXPECT_NEAR(analysis.gradients[2].values[k], stress / strength, tolerance / strength) << k;
    }
  }
}

// Of the metric of all parts, and of the function of one.
TEST(DesignGradients, OfSpreadStressAreThoseOfDifferencesOnTheMeshThatMovesAlong) {
  const std::string definitions =
      "expressions { name: 'of_bar' unit: 'N m' expression: \"von_mises_integral('bar')\" } "
      "expressions { name: 'uneven' unit: '1' expression: "
      "\"rms_von_mises('bar') / mean_von_mises\" } ";
  const std::vector<std::string> metrics{"mean_von_mises", "rms_von_mises", "von_mises_integral",
                                         "of_bar", "uneven"};
  for (const bool quadratic : {false, true}) {
    const Subject beam = SubjectOf(Cantilever("-10 * length ^ 2"), definitions);
    const Eigen::VectorXd q = beam.Defaults();
    const DesignAnalysis analysis = WithGradients(beam, q, metrics, 0.04, quadratic);
    ASSERT_EQ(analysis.gradients.size(), metrics.size());
    EXPECT_EQ(ValueOf(analysis, "of_bar"), ValueOf(analysis, "von_mises_integral"));
    const MovingMesh moving(beam, q, analysis);
    for (int k = 0; k < q.size(); ++k) {
      const double step = 1e-4 * q[k];
      const auto values = [&](double by) {
        const StressSpread spread = *moving.At(k, by).cases.at(0).spread;
        return Eigen::Vector<double, 5>(spread.Mean(), spread.RootMeanSquare(), spread.Integral(),
                                        spread.Integral(), spread.RootMeanSquare() / spread.Mean());
      };
      const Eigen::Vector<double, 5> slopes = (values(step) - values(-step)) / (2 * step);
      for (int i = 0; i < 5; ++i) {
        const std::string& name = metrics[static_cast<std::size_t>(i)];
        EXPECT_NEAR(analysis.gradients[static_cast<std::size_t>(i)].values[k], slopes[i],
                    1e-6 * ValueOf(analysis, name) / q[k])
            << name << " by parameter " << k;
      }
    }
  }
}

// Of what may be a face, and of percentiles, there is none.
TEST(DesignGradients, OfPercentilesAndFacesOfStressAreNotOffered) {
  const Subject beam =
      SubjectOf(Cantilever("-10"),
                "expressions { name: 'p' unit: 'Pa' expression: \"von_mises_p99('bar')\" } "
                "expressions { name: 'm' unit: 'Pa' expression: \"mean_von_mises('bar')\" } "
                "expressions { name: 'r' unit: 'Pa' expression: \"rms_von_mises('bar')\" } ");
  EXPECT_FALSE(HasGradient("von_mises_p99"));
  EXPECT_FALSE(HasGradient("p", beam.own));
  EXPECT_FALSE(HasGradient("m", beam.own));
  EXPECT_TRUE(HasGradient("r", beam.own));
  EXPECT_TRUE(HasGradient("mean_von_mises"));
}

// A bar that is pulled and may contract has the stress F / (b h) everywhere, to rounding.
TEST(DesignGradients, OfTheStressOfAPulledBarAreExact) {
  std::string supports;
  for (const char* face : {"y_min", "z_min"}) {
    absl::StrAppend(&supports, "boundary_conditions { name: '", face,
                    "' kind: SYMMETRIC part: 'bar' face: '", face, "' } ");
  }
  v1::TemplateBundle bundle = Cantilever("0", supports);
  for (auto& condition : *bundle.mutable_template_()->mutable_boundary_conditions()) {
    if (condition.name() == "wall") condition.set_kind(v1::BoundaryCondition::SYMMETRIC);
    if (condition.name() == "end") condition.set_components(0, "500");
  }
  for (const bool quadratic : {false, true}) {
    const Subject bar = SubjectOf(bundle);
    const Eigen::VectorXd q = bar.Defaults();
    const DesignAnalysis analysis =
        WithGradients(bar, q, {"max_von_mises", "max_principal"}, 0.05, quadratic);
    ASSERT_EQ(analysis.gradients.size(), 2u);
    const double stress = 500 / (q[1] * q[2]);
    EXPECT_NEAR(ValueOf(analysis, "max_von_mises"), stress, 1e-7 * stress);
    const Eigen::Vector3d expected(0, -stress / q[1], -stress / q[2]);
    for (const MetricGradient& gradient : analysis.gradients) {
      EXPECT_NEAR((gradient.values - expected).norm(), 0, 1e-6 * expected.norm());
    }
  }
}

// Of displacements of faces and points, also of points that move with the parameters.
TEST(DesignGradients, OfPlacesAreThoseOfDifferences) {
  const std::string definitions =
      "points { name: 'middle' x: 'length / 2' y: 'width / 3' z: 'height / 2' } "
      "points { name: 'fixed' x: '0.33' y: '0.011' z: '0.013' } "
      "expressions { name: 'a' unit: 'm' expression: \"mean_displacement('end')\" } "
      "expressions { name: 'b' unit: 'm' expression: \"max_displacement('end')\" } "
      "expressions { name: 'c' unit: 'm' expression: \"max_displacement_x('end')\" } "
      "expressions { name: 'd' unit: 'm' expression: \"mean_displacement_z('middle')\" } "
      "expressions { name: 'e' unit: 'm' expression: \"max_displacement('middle')\" } "
      "expressions { name: 'f' unit: 'm' expression: \"mean_displacement_x('fixed')\" } ";
  const std::vector<std::string> names{"a", "b", "c", "d", "e", "f"};
  for (const bool quadratic : {false, true}) {
    const Subject beam = SubjectOf(Cantilever("-10 * length ^ 2"), definitions);
    const Eigen::VectorXd q = beam.Defaults();
    const DesignAnalysis analysis = WithGradients(beam, q, names, 0.04, quadratic);
    ASSERT_EQ(analysis.gradients.size(), names.size());
    const MovingMesh moving(beam, q, analysis);
    for (int k = 0; k < q.size(); ++k) {
      const double step = 1e-4 * q[k];
      const auto values = [&](double by) {
        Eigen::VectorXd moved = q;
        moved[k] += by;
        const DesignModel model = beam.ModelAt(moved);
        const DesignAnalysis there = moving.At(k, by);
        const CustomMetrics own(beam.own, moved, names, model, there,
                                [](const std::string&) { return absl::UnknownError("none"); });
        std::vector<double> of_names;
        for (const std::string& name : names) of_names.push_back(own.Compute(name)->value);
        return of_names;
      };
      const std::vector<double> plus = values(step), minus = values(-step);
      for (std::size_t i = 0; i < names.size(); ++i) {
        const double difference = (plus[i] - minus[i]) / (2 * step);
        EXPECT_NEAR(analysis.gradients[i].values[k], difference,
                    2e-6 * std::abs(difference) + 1e-12)
            << names[i] << " by parameter " << k;
      }
    }
  }
}

// Against differences of new designs, which need no mesh.
TEST(DesignGradients, OfAreasAndDistancesAreThoseOfDifferences) {
  v1::TemplateBundle bundle = Cantilever("-10");
  const std::string definitions =
      "points { name: 'eye' x: '2 * length' y: '3 * width' z: '0.2' } "
      "expressions { name: 'a' unit: 'm^2' expression: \"area('end')\" } "
      "expressions { name: 'b' unit: 'm' expression: \"centroid_y('z_max')\" } "
      "expressions { name: 'c' unit: 'm' expression: \"distance('x_max', 'y_min')\" } "
      "expressions { name: 'd' unit: 'm' expression: \"distance('eye', 'end')\" } "
      "expressions { name: 'e' unit: 'm^3' expression: \"area('z_min') * centroid_x('eye')\" } ";
  const std::vector<std::string> names{"a", "b", "c", "d", "e"};
  const Subject beam = SubjectOf(bundle, definitions);
  const Eigen::VectorXd q = beam.Defaults();
  const DesignAnalysis analysis = WithGradients(beam, q, names, 0.1, false);
  ASSERT_EQ(analysis.gradients.size(), names.size());
  for (int k = 0; k < q.size(); ++k) {
    const double step = 1e-5 * q[k];
    const auto at = [&](double by) {
      Eigen::VectorXd moved = q;
      moved[k] += by;
      auto analyzed =
          AnalyzeDesign(beam.ModelAt(moved), names, false, OptionsOf(beam, moved, 0.1, false));
      EXPECT_TRUE(analyzed.ok()) << analyzed.status();
      return *std::move(analyzed);
    };
    const DesignAnalysis plus = at(step), minus = at(-step);
    for (std::size_t i = 0; i < names.size(); ++i) {
      const double difference = (ValueOf(plus, names[i]) - ValueOf(minus, names[i])) / (2 * step);
      EXPECT_NEAR(analysis.gradients[i].values[k], difference, 1e-7) << names[i] << k;
    }
  }
}

// A design of nine parts, whose legs move with the corners of its top.
TEST(DesignGradients, OfPartsThatTouchAreThoseOfDifferences) {
  const Subject table = SubjectOf(templates::ShippedTemplate("templates/table"), "");
  const Eigen::VectorXd q = table.Defaults();
  const DesignAnalysis analysis = WithGradients(table, q, {"compliance", "mass"}, 0.3, false);
  ASSERT_EQ(analysis.gradients.size(), 2u);
  const MovingMesh moving(table, q, analysis);
  for (int k = 0; k < q.size(); ++k) {
    const double step = 1e-5 * q[k];
    const double difference =
        (ComplianceOf(moving.At(k, step)) - ComplianceOf(moving.At(k, -step))) / (2 * step);
    EXPECT_NEAR(analysis.gradients[0].values[k], difference, 2e-6 * std::abs(difference)) << k;
  }
}

TEST(DesignGradients, AreNearThoseOfNewMeshes) {
  const Subject beam = SubjectOf(Cantilever("-10"));
  const Eigen::VectorXd q = beam.Defaults();
  const std::vector<std::string> metrics{"compliance", "tip", "max_displacement", "trade"};
  const DesignAnalysis analysis = WithGradients(beam, q, metrics, 0.03, true);
  ASSERT_EQ(analysis.gradients.size(), metrics.size());
  for (int k = 0; k < q.size(); ++k) {
    const double step = 0.02 * q[k];
    const auto at = [&](double by) {
      Eigen::VectorXd moved = q;
      moved[k] += by;
      auto analyzed =
          AnalyzeDesign(beam.ModelAt(moved), metrics, false, OptionsOf(beam, moved, 0.03, true));
      EXPECT_TRUE(analyzed.ok()) << analyzed.status();
      return *std::move(analyzed);
    };
    const DesignAnalysis plus = at(step), minus = at(-step);
    for (std::size_t i = 0; i < metrics.size(); ++i) {
      const double difference =
          (ValueOf(plus, metrics[i]) - ValueOf(minus, metrics[i])) / (2 * step);
      EXPECT_NEAR(analysis.gradients[i].values[k], difference, 0.02 * std::abs(difference))
          << metrics[i];
    }
  }
}

TEST(DesignGradients, AreLeftOutWhereNobodyKnowsThem) {
  const Subject beam = SubjectOf(Cantilever("-10"));
  const Eigen::VectorXd q = beam.Defaults();
  const DesignAnalysis analysis =
      WithGradients(beam, q, {"mass", "relative_error", "compliance"}, 0.04, false);
  ASSERT_EQ(analysis.gradients.size(), 2u);
  EXPECT_EQ(analysis.gradients[0].metric, "mass");
  EXPECT_EQ(analysis.gradients[1].metric, "compliance");
  EXPECT_TRUE(GradientsOf(*beam.compiled.design_template, true).loads);
  const Subject turning =
      SubjectOf(Cantilever("-10",
                           "boundary_conditions { name: 'spin' kind: ROTATION components: '0' "
                           "components: '0' components: '0' components: '0' components: '0' "
                           "components: '1' } "));
  EXPECT_FALSE(GradientsOf(*turning.compiled.design_template, true).loads);
  EXPECT_TRUE(GradientsOf(*turning.compiled.design_template, true).mass);
  const Subject boat = SubjectOf(templates::ShippedTemplate("templates/boat"), "");
  EXPECT_FALSE(GradientsOf(*boat.compiled.design_template, false).loads);
  EXPECT_FALSE(GradientsOf(*boat.compiled.design_template, false).shape);
  EXPECT_TRUE(GradientsOf(*boat.compiled.design_template, false).mass);
  const Subject wrench = SubjectOf(templates::ShippedTemplate("templates/wrench"), "");
  EXPECT_FALSE(GradientsOf(*wrench.compiled.design_template, false).mass);
}

}  // namespace
}  // namespace mortise::simulator
