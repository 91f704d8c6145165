// Request targets, positions in event streams and lists in parameters.
#include <cstdint>
#include <cstdlib>

#include "gateway/contract/query.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mortise::gateway;
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  const auto target = ParseTarget(input);
  if (target.ok()) {
    for (const auto& [name, value] : target->parameters) {
      (void)SplitList(value);
      (void)ParseNumber(value, name);
    }
  }
  const auto position = ParsePosition(input);
  if (position.ok()) {
    const auto again = ParsePosition(FormatPosition(*position));
    if (!again.ok() || *again != *position) std::abort();
  }
  return 0;
}
