// Any text given as a design in JSON is read or refused with what is wrong, never a crash.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "common/parametric/design_file.h"
#include "common/parametric/template_codec.h"
#include "common/parametric/template_validation.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mortise::parametric;
  const DesignFile file =
      ParseDesignJson(std::string_view(reinterpret_cast<const char*>(data), size));
  for (const Finding& finding : file.findings) {
    if (finding.message.empty()) std::abort();
  }
  for (const auto& placed : file.materials) {
    const auto material = FromProto(placed.message);
    if (material.ok()) (void)ValidateMaterial(*material);
  }
  for (const auto& placed : file.items) {
    const auto item = FromProto(placed.message);
    if (item.ok()) (void)ValidateItem(*item, {});
  }
  return 0;
}
