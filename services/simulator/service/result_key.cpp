#include "services/simulator/service/result_key.h"

#include <cstdint>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "common/base/digest.h"
#include "services/simulator/service/evaluation_tasks.h"
#include "services/simulator/worker/subject_metrics.h"

namespace mortise::simulator {
namespace {

// Length before content, so that no two keys' texts can run into each other.
void Append(const std::string& text, std::string& bytes) {
  const std::uint64_t size = text.size();
  bytes.append(reinterpret_cast<const char*>(&size), sizeof size);
  bytes += text;
}

void Append(double value, std::string& bytes) {
  const double canonical = value == 0 ? 0.0 : value;  // −0 equals 0
  bytes.append(reinterpret_cast<const char*>(&canonical), sizeof canonical);
}

std::string RefinementText(const v1::MeshSettings& settings) {
  std::string text;
  if (settings.relative_error() != 0) text = absl::StrFormat(" to %a", settings.relative_error());
  const bool is_scaled = settings.size_scale() != 0 && settings.size_scale() != 1;
  if (is_scaled) absl::StrAppendFormat(&text, " by %a", settings.size_scale());
  return text;
}

std::string AirflowText(const v1::AirflowSettings& settings) {
  const std::string bytes = settings.SerializeAsString();
  return bytes.empty() ? "" : absl::StrCat(" in ", Sha256Hex(bytes));
}

std::string FieldsText(const v1::Task& task, bool is_ours) {
  if (!task.has_design_fields()) return "";
  return absl::StrCat(" with ", is_ours ? absl::StrCat(kFieldsVersion, " ") : "",
                      Sha256Hex(task.design_fields().SerializeAsString()));
}

}  // namespace

std::string ResultKey(const v1::Task& task, int physics_version) {
  const bool is_ours = task.evaluator() == kSimulatorQueue;
  std::string bytes;
  Append(task.digest(), bytes);
  Append(absl::StrCat(is_ours ? absl::StrCat("physics ", physics_version, ": ") : "",
                      task.gradients() ? "gradients of " : "", absl::StrJoin(task.metrics(), ","),
                      RefinementText(task.mesh()), DefinitionsText(task.metric_definitions()),
                      AirflowText(task.airflow()), FieldsText(task, is_ours)),
         bytes);
  Append(task.mesh().element_size(), bytes);
  Append(task.mesh().linear() ? 1.0 : 0.0, bytes);
  for (const double value : task.point().parameters()) Append(value, bytes);
  return TaskKeyIn(task.evaluator(), Sha256Hex(bytes));
}

}  // namespace mortise::simulator
