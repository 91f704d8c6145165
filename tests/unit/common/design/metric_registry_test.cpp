#include "common/design/metric_registry.h"

#include <gtest/gtest.h>

#include <set>

#include "common/expressions/unit.h"

namespace mortise::simulator {
namespace {

TEST(MetricRegistry, SaysOfEachMetricWhatThereIsToSay) {
  std::set<std::string> names;
  for (const MetricDescription& metric : OfferedMetrics()) {
    EXPECT_TRUE(names.insert(metric.name).second) << metric.name << " stands twice";
    EXPECT_EQ(metric.unit.empty(), metric.metric == BuiltInMetric::kCost) << metric.name;
    EXPECT_TRUE(metric.description.ends_with('.')) << metric.name;
  }
}

TEST(MetricRegistry, FindsMetricsByNameAndByNumber) {
  for (const MetricDescription& metric : OfferedMetrics()) {
    EXPECT_EQ(FindMetric(metric.name), &metric);
    EXPECT_EQ(&DescriptionOf(metric.metric), &metric);
  }
  EXPECT_EQ(DescriptionOf(BuiltInMetric::kMaxVonMises).name, "max_von_mises");
  EXPECT_EQ(FindMetric("beauty"), nullptr);
  EXPECT_EQ(FindMetric(""), nullptr);
}

TEST(MetricRegistry, GivesValuesTheirNameAndUnit) {
  const Metric metric = MetricOf(BuiltInMetric::kCompliance, 2.5);
  EXPECT_EQ(metric.name, "compliance");
  EXPECT_EQ(metric.unit, "J");
  EXPECT_EQ(metric.value, 2.5);
}

// Gradients are known of what the shape of the parts or the loads alone decide.
TEST(MetricRegistry, KnowsGradientsOfPartsAndLoadsOnly) {
  for (const MetricDescription& metric : OfferedMetrics()) {
    if (!metric.has_gradient) continue;
    EXPECT_TRUE(metric.source == MetricSource::kParts || metric.source == MetricSource::kLoads)
        << metric.name;
  }
  EXPECT_TRUE(FindMetric("mass")->has_gradient);
  EXPECT_FALSE(FindMetric("relative_error")->has_gradient);
}

TEST(MetricRegistry, UnitsAreThoseThatExpressionsKnow) {
  for (const parametric::NamedUnit& metric : UnitsOf(OfferedMetrics())) {
    EXPECT_TRUE(metric.unit.empty() || parametric::ParseUnit(metric.unit).ok())
        << metric.name << " in " << metric.unit;
  }
}

}  // namespace
}  // namespace mortise::simulator
