// Metrics as people read them.
#include "cli/files/metric_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace mortise::cli {
namespace {

using ::testing::HasSubstr;

v1::Metric MetricOf(const std::string& name, const std::string& unit, double value) {
  v1::Metric metric;
  metric.set_name(name);
  metric.set_unit(unit);
  metric.set_value(value);
  return metric;
}

Metrics MetricsOf(const std::vector<v1::Metric>& list) { return {list.begin(), list.end()}; }

TEST(MetricReport, GivesErrorsInPerCent) {
  const Metrics all = MetricsOf({MetricOf("relative_error", "1", 0.19433)});
  EXPECT_EQ(MetricReport(all[0], all), "19 %");
}

TEST(MetricReport, GivesRoundingAsNothing) {
  const Metrics all =
      MetricsOf({MetricOf("volume", "m^3", 0.06), MetricOf("center_of_mass_x", "m", 0.45),
                 MetricOf("center_of_mass_y", "m", -9.108e-18), MetricOf("inertia_xx", "kg*m^2", 3),
                 MetricOf("inertia_xy", "kg*m^2", -4e-16), MetricOf("inertia_yz", "kg*m^2", 4e-6),
                 MetricOf("max_displacement", "m", 3e-15)});
  EXPECT_EQ(MetricReport(all[2], all), "0 mm");
  EXPECT_EQ(MetricReport(all[4], all), "0 kg*m^2");
  EXPECT_EQ(MetricReport(all[5], all), "4e-06 kg*m^2");
  EXPECT_EQ(MetricReport(all[6], all), "3e-12 mm") << "it stands by itself";
  // All three may be nothing: the centre is at the origin.
  const Metrics centred =
      MetricsOf({MetricOf("volume", "m^3", 1), MetricOf("center_of_mass_x", "m", 3e-17),
                 MetricOf("center_of_mass_y", "m", 0), MetricOf("center_of_mass_z", "m", -1e-16)});
  EXPECT_EQ(MetricReport(centred[1], centred), "0 mm");
}

TEST(MetricReport, WhatDoesNotFloatUprightHasNoDraught) {
  const Metrics shelf =
      MetricsOf({MetricOf("mass", "kg", 40), MetricOf("draught", "m", 1.2),
                 MetricOf("freeboard", "m", 0.6), MetricOf("metacentric_height", "m", -0.3)});
  EXPECT_TRUE(IsBeside("draught", shelf));
  EXPECT_TRUE(IsBeside("freeboard", shelf));
  EXPECT_FALSE(IsBeside("mass", shelf));
  const Metrics boat =
      MetricsOf({MetricOf("draught", "m", 0.1), MetricOf("metacentric_height", "m", 0.3)});
  EXPECT_FALSE(IsBeside("draught", boat));
  EXPECT_TRUE(IsNoteBeside("draught: it sinks", MetricsOf({})));
  EXPECT_FALSE(IsNoteBeside("cost: nobody says what it costs", MetricsOf({})));
}

TEST(MetricReport, SaysWhatHelpsAgainstALargeError) {
  v1::Analysis analysis;
  *analysis.add_metrics() = MetricOf("relative_error", "1", 0.08);
  EXPECT_EQ(AdviceOnError(analysis), "");
  analysis.mutable_metrics(0)->set_value(0.19433);
  EXPECT_THAT(AdviceOnError(analysis), HasSubstr("about 19 %"));
  EXPECT_THAT(AdviceOnError(analysis), HasSubstr("--relative-error 0.05"));
  analysis.set_mesh_file("0123");
  EXPECT_THAT(AdviceOnError(analysis), HasSubstr("a finer mesh"));
}

}  // namespace
}  // namespace mortise::cli
