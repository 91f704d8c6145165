// The control variables that designs of every kind give with their shape: where they lie, and that
// they keep their names while parameters go to their ends (thesis §6.6.2).
#include "common/fields/control_variables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "common/base/errors.h"
#include "common/design/parameter_values.h"
#include "common/fields/fields_file.h"
#include "common/templates/template_codec.h"
#include "services/simulator/analysis/design_fields.h"
#include "services/simulator/worker/template_model.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/templates/conditioned_bars.h"

namespace mortise::simulator {
namespace {

using Function = std::shared_ptr<const templates::Template>;

absl::StatusOr<Function> FunctionOf(v1::TemplateBundle bundle) {
  if (bundle.template_().has_assembly() && !bundle.has_assembly()) {
    const v1::Template shipped = bundle.template_();
    bundle = templates::ShippedAssembly(shipped.assembly().assembly());
    *bundle.mutable_template_() = shipped;
  }
  MORTISE_RETURN_IF_ERROR(templates::FillAndCheck(bundle, templates::Trial::kDefaults));
  return templates::Compile(bundle);
}

absl::StatusOr<DesignModel> ModelAt(const Function& function, const Eigen::VectorXd& q) {
  MORTISE_ASSIGN_OR_RETURN(const auto design, function->Evaluate(q));
  return MakeDesignModel(*function, q, design, {.control_variables = true});
}

// The surface of a design, through its file and back.
absl::StatusOr<fields::DesignFields> ShapeOf(const DesignModel& model) {
  MORTISE_ASSIGN_OR_RETURN(const auto shape, CollectFields(model, DesignAnalysis(), {}));
  MORTISE_ASSIGN_OR_RETURN(const std::string bytes, fields::WriteFields(shape));
  return fields::ReadFields(bytes);
}

// The parameters with one of them at its lower or upper end.
Eigen::VectorXd AtEnd(const Function& function, const std::string& name, bool upper) {
  Eigen::VectorXd q = parametric::Defaults(function->parameters());
  for (Eigen::Index k = 0; k < q.size(); ++k) {
    const parametric::Parameter& range = function->parameters()[static_cast<std::size_t>(k)];
    if (range.name == name) q[k] = upper ? range.maximum : range.minimum;
  }
  return q;
}

bool IsBetween(const std::string& name) { return name.find(" at ") != std::string::npos; }

std::set<std::string> VerticesOf(const fields::DesignFields& shape) {
  std::set<std::string> names;
  for (const fields::ControlPoint& point : shape.control_points) {
    if (!IsBetween(point.id)) names.insert(point.id);
  }
  return names;
}

std::set<std::string> EdgesOf(const fields::DesignFields& shape) {
  std::set<std::string> names;
  for (const fields::ControlWay& way : shape.ways) names.insert(way.edge);
  return names;
}

void ExpectWaysFromPointToPoint(const fields::DesignFields& shape) {
  const double size = fields::ControlSpacing(shape.nodes);
  for (const fields::ControlWay& way : shape.ways) {
    const auto place = [&](int point) -> const Eigen::Vector3d& {
      return shape.control_points[static_cast<std::size_t>(point)].position;
    };
    EXPECT_LT((way.positions.col(0) - place(way.from)).norm(), 1e-6 * size) << way.edge;
    EXPECT_LT((way.positions.rightCols<1>() - place(way.to)).norm(), 1e-6 * size) << way.edge;
    EXPECT_LE((place(way.to) - place(way.from)).norm(), size * (1 + 1e-9)) << way.edge;
  }
  // Meshes have nodes at vertices; near them where details are too small for a mesh.
  int vertices = 0, nodes = 0;
  for (const fields::ControlPoint& point : shape.control_points) {
    if (point.node >= 0) {
      EXPECT_LT((shape.nodes.col(point.node) - point.position).norm(), 1e-5 * size) << point.id;
    }
    if (IsBetween(point.id)) continue;
    ++vertices;
    if (point.node >= 0) ++nodes;
    EXPECT_LT((shape.nodes.colwise() - point.position).colwise().norm().minCoeff(), 0.01 * size)
        << point.id;
  }
  EXPECT_GT(nodes, vertices / 2);
}

struct Shipped {
  std::string name, parameter;
  std::size_t least_vertices, least_edges;
};

class ShippedVariablesTest : public ::testing::TestWithParam<Shipped> {};

TEST_P(ShippedVariablesTest, KeepTheirNamesToTheEndsOfAParameter) {
  const Shipped& shipped = GetParam();
  ASSERT_OK_AND_ASSIGN(const Function function,
                       FunctionOf(templates::ShippedTemplate(shipped.name)));
  ASSERT_OK_AND_ASSIGN(const DesignModel model,
                       ModelAt(function, parametric::Defaults(function->parameters())));
  ASSERT_OK_AND_ASSIGN(const fields::DesignFields shape, ShapeOf(model));
  ExpectWaysFromPointToPoint(shape);
  const std::set<std::string> vertices = VerticesOf(shape), edges = EdgesOf(shape);
  EXPECT_GE(vertices.size(), shipped.least_vertices);
  EXPECT_GE(edges.size(), shipped.least_edges);
  for (const bool upper : {false, true}) {
    SCOPED_TRACE(upper);
    ASSERT_OK_AND_ASSIGN(const DesignModel other,
                         ModelAt(function, AtEnd(function, shipped.parameter, upper)));
    ASSERT_OK_AND_ASSIGN(const fields::DesignFields moved, ShapeOf(other));
    ExpectWaysFromPointToPoint(moved);
    EXPECT_EQ(VerticesOf(moved), vertices);
    EXPECT_EQ(EdgesOf(moved), edges);
  }
}

INSTANTIATE_TEST_SUITE_P(Collection, ShippedVariablesTest,
                         ::testing::Values(Shipped{"templates/wrench", "handle_length", 16, 24},
                                           Shipped{"templates/camera-mount", "wall_low", 16, 24},
                                           Shipped{"templates/table", "length", 40, 60},
                                           Shipped{"templates/pendant-lamp", "length", 16, 24}),
                         [](const auto& shipped) {
                           std::string name = shipped.param.name.substr(10);
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

// A bar, whatever kind of template it is of, has the corners of a box; they do not depend on the
// mesh, nor on the regions that are asked for.
TEST(ControlVariablesTest, EveryKindOfTemplateHasThem) {
  const std::map<std::string, v1::TemplateBundle> bars = {{"parts", templates::PartsBar("")},
                                                          {"assembly", templates::AssemblyBar("")},
                                                          {"cad", templates::CadBar("")},
                                                          {"cage", templates::CageBar("")}};
  for (const auto& [kind, bundle] : bars) {
    SCOPED_TRACE(kind);
    ASSERT_OK_AND_ASSIGN(const Function function, FunctionOf(bundle));
    ASSERT_OK_AND_ASSIGN(const DesignModel model,
                         ModelAt(function, parametric::Defaults(function->parameters())));
    EXPECT_EQ(model.control_variables.has_value(), kind == "cad");
    ASSERT_OK_AND_ASSIGN(const fields::DesignFields surface, ShapeOf(model));
    EXPECT_EQ(VerticesOf(surface).size(), 8u);
    EXPECT_EQ(EdgesOf(surface).size(), 12u);
    const FieldsDemand demand{.tetrahedra = true, .regions = {"x_max"}};
    DesignAnalysisOptions options;
    DemandFields(demand, options);
    ASSERT_OK_AND_ASSIGN(const DesignAnalysis analysis,
                         AnalyzeDesign(model, {"mass"}, false, options));
    const auto volume = CollectFields(model, analysis, kind == "cad" ? FieldsDemand{true} : demand);
    ASSERT_TRUE(volume.ok()) << volume.status();
    ExpectWaysFromPointToPoint(*volume);
    EXPECT_EQ(VerticesOf(*volume), VerticesOf(surface));
    EXPECT_EQ(EdgesOf(*volume), EdgesOf(surface));
  }
}

TEST(ControlVariablesTest, MetricsDoNotKnowOfThemAndFilesAreTheSameEachTime) {
  ASSERT_OK_AND_ASSIGN(const Function function,
                       FunctionOf(templates::ShippedTemplate("templates/wrench")));
  const Eigen::VectorXd q = parametric::Defaults(function->parameters());
  ASSERT_OK_AND_ASSIGN(const auto design, function->Evaluate(q));
  ASSERT_OK_AND_ASSIGN(const DesignModel without, MakeDesignModel(*function, q, design));
  ASSERT_OK_AND_ASSIGN(const DesignModel with, ModelAt(function, q));
  ASSERT_TRUE(with.control_variables.has_value());
  const std::vector<std::string> metrics = {"mass", "surface_area", "inertia_xx"};
  ASSERT_OK_AND_ASSIGN(const DesignAnalysis a, AnalyzeDesign(without, metrics, false));
  ASSERT_OK_AND_ASSIGN(const DesignAnalysis b, AnalyzeDesign(with, metrics, false));
  for (std::size_t i = 0; i < metrics.size(); ++i) {
    EXPECT_EQ(a.metrics[i].value, b.metrics[i].value) << metrics[i];
  }
  ASSERT_OK_AND_ASSIGN(const Function again,
                       FunctionOf(templates::ShippedTemplate("templates/wrench")));
  ASSERT_OK_AND_ASSIGN(const DesignModel twin, ModelAt(again, q));
  EXPECT_EQ(fields::WriteFields(CollectFields(with, b, {}).value()).value(),
            fields::WriteFields(CollectFields(twin, b, {}).value()).value());
}

}  // namespace
}  // namespace mortise::simulator
