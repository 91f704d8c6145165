#include "services/simulator/settings_text.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/digest.h"

namespace mortise::simulator {

std::string RefinementText(const v1::MeshSettings& settings) {
  if (settings.relative_error() == 0) return "";
  return absl::StrFormat(" to %a", settings.relative_error());
}

std::string AirflowText(const v1::AirflowSettings& settings) {
  const std::string bytes = settings.SerializeAsString();
  return bytes.empty() ? "" : absl::StrCat(" in ", Sha256Hex(bytes));
}

}  // namespace mortise::simulator
