// What every design of a parametrised assembly must be.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "common/assembly/parametric_assembly.h"
#include "tests/support/status_assertions.h"

namespace mortise::parametric {

// Random designs, and those at the ends of every size, have no faults in any pose.
inline void ExpectSound(const ParametricAssembly& assembly) {
  ASSERT_OK_AND_ASSIGN(std::vector<Eigen::VectorXd> designs, assembly.Sample(300, 5));
  ASSERT_OK_AND_ASSIGN(const std::vector<MeasureRange> sizes, assembly.AdjustableSizes());
  EXPECT_THAT(sizes, ::testing::Not(::testing::IsEmpty()))
      << "a design that cannot change is always sound";
  for (const MeasureRange& size : sizes) {
    for (const double value : {size.minimum, size.maximum}) {
      ASSERT_OK_AND_ASSIGN(
          const Adjustment end,
          assembly.Adjust(assembly.drawn(), {{size.measure, value}}, DemandPolicy::kNearest));
      designs.push_back(end.q);
    }
  }
  for (const Eigen::VectorXd& q : designs) {
    ASSERT_OK_AND_ASSIGN(const std::vector<ContactFault> faults, assembly.FaultsAt(q));
    for (const ContactFault& fault : faults) ADD_FAILURE() << Describe(fault);
    if (!faults.empty()) return;
  }
}

}  // namespace mortise::parametric
