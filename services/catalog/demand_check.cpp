#include "services/catalog/demand_check.h"

#include <algorithm>
#include <string>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/field_violations.h"

namespace mortise::catalog {
namespace {

constexpr std::size_t kMostNamesOffered = 3;

// Elements that are called as `name` but for its case, or begin with it.
std::vector<std::string> CalledLike(const parametric::ParametricAssembly& assembly,
                                    const std::string& name) {
  std::vector<std::string> names;
  for (const parametric::Element& element : assembly.elements()) {
    if (!name.empty() && absl::StartsWithIgnoreCase(element.name, name)) {
      names.push_back(absl::StrCat("'", element.name, "'"));
    }
    if (names.size() == kMostNamesOffered) break;
  }
  return names;
}

}  // namespace

absl::Status CheckElements(const parametric::ParametricAssembly& assembly,
                           const std::vector<parametric::MeasureDemand>& demands) {
  std::vector<FieldViolation> violations;
  for (std::size_t i = 0; i < demands.size(); ++i) {
    const std::string& name = demands[i].measure.element;
    const auto& elements = assembly.elements();
    if (std::any_of(elements.begin(), elements.end(),
                    [&](const parametric::Element& element) { return element.name == name; })) {
      continue;
    }
    std::string message = absl::StrCat("there is no element '", name, "'");
    const std::vector<std::string> like = CalledLike(assembly, name);
    if (!like.empty())
      absl::StrAppend(&message, "; did you mean ", absl::StrJoin(like, " or "), "?");
    violations.push_back({absl::StrCat("demands[", i, "].measure.element"), message});
  }
  return violations.empty() ? absl::OkStatus() : InvalidFields(violations);
}

}  // namespace mortise::catalog
