// Two parametrisations that must be the same, to the bit.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/assembly/parametric_assembly.h"

namespace mortise::parametric {

inline void ExpectSame(const std::vector<Relationship>& a, const std::vector<Relationship>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    SCOPED_TRACE(a[i].description);
    ASSERT_EQ(a[i].description, b[i].description);
    ASSERT_EQ(a[i].kind, b[i].kind);
    ASSERT_EQ(a[i].equality, b[i].equality);
    ASSERT_EQ(a[i].group, b[i].group);
    ASSERT_EQ(a[i].form.constant, b[i].form.constant);
    ASSERT_EQ(a[i].form.terms.size(), b[i].form.terms.size());
    for (std::size_t term = 0; term < a[i].form.terms.size(); ++term) {
      ASSERT_EQ(a[i].form.terms[term].variable, b[i].form.terms[term].variable);
      ASSERT_EQ(a[i].form.terms[term].coefficient, b[i].form.terms[term].coefficient);
    }
  }
}

// Elements, contacts, relationships, the feasible set, its random designs and the faults of what is
// none.
inline void ExpectSame(const ParametricAssembly& a, const ParametricAssembly& b) {
  ASSERT_EQ(a.elements().size(), b.elements().size());
  for (std::size_t e = 0; e < a.elements().size(); ++e) {
    ASSERT_EQ(a.elements()[e].name, b.elements()[e].name);
    ASSERT_EQ(a.elements()[e].parts, b.elements()[e].parts);
  }
  EXPECT_EQ(a.contacts(), b.contacts());
  ExpectSame(a.relationships(), b.relationships());
  ExpectSame(a.feasible_set().equalities(), b.feasible_set().equalities());
  ExpectSame(a.feasible_set().inequalities(), b.feasible_set().inequalities());
  ASSERT_EQ(a.drawn(), b.drawn());
  ASSERT_EQ(a.feasible_set().basis().cols(), b.feasible_set().basis().cols());
  EXPECT_EQ(a.feasible_set().basis(), b.feasible_set().basis());
  const auto samples = a.Sample(2, 5), others = b.Sample(2, 5);
  ASSERT_TRUE(samples.ok() && others.ok());
  EXPECT_EQ(*samples, *others);
  const Eigen::VectorXd wrong = 1.01 * a.drawn();
  const auto faults = a.FaultsAt(wrong), other_faults = b.FaultsAt(wrong);
  ASSERT_TRUE(faults.ok() && other_faults.ok());
  ASSERT_EQ(faults->size(), other_faults->size());
  for (std::size_t i = 0; i < faults->size(); ++i) {
    EXPECT_EQ(Describe((*faults)[i]), Describe((*other_faults)[i]));
  }
}

}  // namespace mortise::parametric
