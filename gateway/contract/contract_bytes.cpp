// Puts the compiled descriptor set (MORTISE_DESCRIPTOR_SET, see CMakeLists.txt) into the program.
#include "gateway/contract/contract.h"

#include MORTISE_DESCRIPTOR_SET_DIGEST

__asm__(
    ".section .rodata\n"
    ".balign 16\n"
    "mortise_descriptor_set_begin:\n"
    ".incbin \"" MORTISE_DESCRIPTOR_SET
    "\"\n"
    "mortise_descriptor_set_end:\n"
    ".byte 0\n"
    ".previous\n");

extern "C" {
extern const char mortise_descriptor_set_begin[];
extern const char mortise_descriptor_set_end[];
}

namespace mortise::gateway {

std::string_view ContractBytes() {
  return {mortise_descriptor_set_begin,
          static_cast<std::size_t>(mortise_descriptor_set_end - mortise_descriptor_set_begin)};
}

}  // namespace mortise::gateway
