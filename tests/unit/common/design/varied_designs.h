// Designs of a template that is expected to compile, for tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "common/design/evaluation.h"

namespace mortise::parametric {

inline TemplateFunction FunctionOf(const TemplateBundle& bundle) {
  auto function = TemplateFunction::Create(bundle);
  EXPECT_TRUE(function.ok()) << function.status();
  return *std::move(function);
}

inline EvaluatedDesign At(const TemplateBundle& bundle, const std::vector<NamedValue>& values) {
  const TemplateFunction function = FunctionOf(bundle);
  const auto q = function.CompleteParameters(values);
  EXPECT_TRUE(q.ok()) << q.status();
  auto design = function.Evaluate(*q);
  EXPECT_TRUE(design.ok()) << design.status();
  return *std::move(design);
}

inline absl::Status FaultAt(const TemplateBundle& bundle, const std::vector<NamedValue>& values) {
  const TemplateFunction function = FunctionOf(bundle);
  const auto q = function.CompleteParameters(values);
  EXPECT_TRUE(q.ok()) << q.status();
  return function.Evaluate(*q).status();
}

inline const EvaluatedPart& Part(const EvaluatedDesign& design, const std::string& name) {
  const int part = FindPart(design, name);
  EXPECT_GE(part, 0) << name;
  return design.parts[static_cast<std::size_t>(std::max(part, 0))];
}

}  // namespace mortise::parametric
