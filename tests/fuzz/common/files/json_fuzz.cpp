// Any text given as a design in JSON is read or refused with what is wrong, never a crash.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "common/files/design_file.h"
#include "common/files/message_checks.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mortise::parametric;
  const DesignFile file =
      ParseDesignJson(std::string_view(reinterpret_cast<const char*>(data), size));
  for (const mortise::FieldViolation& finding : file.findings) {
    if (finding.message.empty()) std::abort();
  }
  for (const auto& placed : file.materials) {
    (void)ValidateMaterialMessage(placed.message, placed.unread);
  }
  for (const auto& placed : file.items) {
    (void)ValidateItemMessage(placed.message, {}, placed.unread);
  }
  return 0;
}
