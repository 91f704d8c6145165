// Feeds bytes to the reader of files of shape and fields, sealed with the checksum that they should
// have, without which everything would be refused at once: a design that is sound and is written as
// what is read again, or a refusal.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>

#include "absl/strings/escaping.h"
#include "common/base/digest.h"
#include "common/fields/fields_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kHeader = 64;
  std::string bytes(reinterpret_cast<const char*>(data), size);
  if (size >= kHeader) {
    const std::uint64_t all = size;
    std::memcpy(bytes.data() + 16, &all, sizeof all);
    const std::string digest =
        absl::HexStringToBytes(mortise::Sha256Hex(std::string_view(bytes).substr(kHeader)));
    std::copy(digest.begin(), digest.end(), bytes.begin() + 24);
  }
  const auto design = mortise::fields::ReadFields(bytes);
  if (!design.ok()) return 0;
  const auto again = mortise::fields::WriteFields(*design);
  if (!again.ok() || !mortise::fields::ReadFields(*again).ok()) std::abort();
  return 0;
}
