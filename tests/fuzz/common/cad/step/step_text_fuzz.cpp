// Any bytes given as a STEP file are decoded and judged before the kernel sees them, never a crash.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "common/cad/step/step_encoding.h"
#include "common/cad/step/step_references.h"
#include "common/cad/step/step_statements.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mortise::cad;
  const auto decoded = DecodeStep(std::string_view(reinterpret_cast<const char*>(data), size));
  if (!decoded.ok()) return 0;
  if (StatementFaults(decoded->text, 5).size() > 5) std::abort();
  if (MissingEntities(decoded->text, 5).size() > 5) std::abort();
  return 0;
}
