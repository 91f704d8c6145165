#include "services/catalog/service/request_demands.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/assembly/model/assembly.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"

namespace mortise::catalog {
namespace {

constexpr int kMaxDemands = 100;
constexpr std::size_t kMaxNamesOffered = 3;

// Elements that are called as `name` but for its case, or begin with it.
std::vector<std::string> CalledLike(const parametric::ParametricAssembly& assembly,
                                    const std::string& name) {
  std::vector<std::string> names;
  for (const parametric::Element& element : assembly.elements()) {
    if (!name.empty() && absl::StartsWithIgnoreCase(element.name, name)) {
      names.push_back(absl::StrCat("'", element.name, "'"));
    }
    if (names.size() == kMaxNamesOffered) break;
  }
  return names;
}

bool HasElement(const parametric::ParametricAssembly& assembly, const std::string& name) {
  const auto& elements = assembly.elements();
  return std::any_of(elements.begin(), elements.end(),
                     [&](const parametric::Element& element) { return element.name == name; });
}

std::string NoSuchElement(const parametric::ParametricAssembly& assembly, const std::string& name) {
  const std::vector<std::string> like = CalledLike(assembly, name);
  return absl::StrCat("there is no element '", name, "'", like.empty() ? "" : "; did you mean ",
                      absl::StrJoin(like, " or "), like.empty() ? "" : "?");
}

}  // namespace

absl::Status CheckDemandCount(const Demands& demands) {
  if (demands.size() <= kMaxDemands) return absl::OkStatus();
  return InvalidField("demands", absl::StrCat("must be at most ", kMaxDemands));
}

absl::Status CheckDemands(const parametric::ParametricAssembly& assembly, const Demands& demands) {
  if (!CheckDemandCount(demands).ok()) return absl::OkStatus();
  std::vector<FieldViolation> violations;
  for (int i = 0; i < demands.size(); ++i) {
    const std::string field = absl::StrCat("demands[", i, "]");
    const std::string& name = demands[i].measure().element();
    if (!HasElement(assembly, name)) {
      violations.push_back({field + ".measure.element", NoSuchElement(assembly, name)});
    }
    if (!(std::abs(demands[i].value()) <= parametric::kMaxFromOrigin)) {
      violations.push_back(
          {field + ".value", absl::StrCat("must be within ", parametric::kMaxFromOrigin, " m")});
    }
  }
  return violations.empty() ? absl::OkStatus() : InvalidFields(violations);
}

}  // namespace mortise::catalog
