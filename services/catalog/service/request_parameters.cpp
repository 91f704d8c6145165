#include "services/catalog/service/request_parameters.h"

#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/model/assembly.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"

namespace mortise::catalog {
namespace {

constexpr std::size_t kMost = 40;  // violations, about as many as an answer holds

// What is wrong with single numbers of q.
void CheckNumbers(const Eigen::VectorXd& q, const parametric::ParametricAssembly& assembly,
                  const std::string& field, std::vector<FieldViolation>& violations) {
  const auto add = [&](int index, const std::string& message) {
    if (violations.size() < kMost) {
      violations.push_back({absl::StrCat(field, "[", index, "]"), message});
    }
  };
  for (int i = 0; i < static_cast<int>(q.size()); ++i) {
    if (!std::isfinite(q[i])) {
      add(i, "must be a finite number");
    } else if (std::abs(q[i]) > parametric::kMaxFromOrigin) {
      add(i, absl::StrCat(q[i], " must be within ", parametric::kMaxFromOrigin, " m"));
    }
  }
  for (int e = 0; e < static_cast<int>(assembly.elements().size()); ++e) {
    for (const parametric::Axis axis : parametric::kAxes) {
      const int index = parametric::SizeVariable(e, axis);
      if (!std::isfinite(q[index]) || q[index] > 0) continue;
      const std::string& name = assembly.elements()[static_cast<std::size_t>(e)].name;
      add(index, absl::StrCat("the size of '", name, "' along ", parametric::AxisName(axis),
                              " must be above 0"));
    }
  }
}

}  // namespace

absl::StatusOr<Eigen::VectorXd> RequestParameters(const google::protobuf::RepeatedField<double>& q,
                                                  const parametric::ParametricAssembly& assembly,
                                                  const std::string& field) {
  if (q.empty()) return assembly.drawn();
  if (q.size() != assembly.drawn().size()) {
    return InvalidField(field,
                        absl::StrCat("has ", q.size(), " numbers, not ", assembly.drawn().size(),
                                     " as q of ParametrizeAssembly"));
  }
  Eigen::VectorXd given = Eigen::Map<const Eigen::VectorXd>(q.data(), q.size());
  std::vector<FieldViolation> violations;
  CheckNumbers(given, assembly, field, violations);
  if (!violations.empty()) return InvalidFields(violations);
  const absl::Status usable = assembly.CheckParameters(given);
  if (absl::IsInvalidArgument(usable)) {
    return InvalidField(field, AllViolationsOf(usable).front().message);
  }
  MORTISE_RETURN_IF_ERROR(usable);
  return given;
}

absl::StatusOr<std::vector<Eigen::VectorXd>> RequestPoints(
    const google::protobuf::RepeatedPtrField<v1::EvaluateAssemblyRequest::Point>& points,
    const parametric::ParametricAssembly& assembly) {
  std::vector<Eigen::VectorXd> asked;
  std::vector<FieldViolation> violations;
  for (int i = 0; i < points.size() && violations.size() < kMost; ++i) {
    absl::StatusOr<Eigen::VectorXd> q =
        RequestParameters(points[i].q(), assembly, absl::StrCat("points[", i, "].q"));
    if (q.ok()) {
      asked.push_back(*std::move(q));
      continue;
    }
    for (FieldViolation& violation : AllViolationsOf(q.status())) {
      if (violations.size() < kMost) violations.push_back(std::move(violation));
    }
  }
  if (!violations.empty()) return InvalidFields(violations);
  return asked;
}

}  // namespace mortise::catalog
