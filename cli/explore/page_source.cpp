// Puts the joined page (MORTISE_EXPLORE_PAGE, see CMakeLists.txt) into the program.
#include "cli/explore/page_source.h"

__asm__(
    ".section .rodata\n"
    ".balign 16\n"
    "mortise_explore_page_begin:\n"
    ".incbin \"" MORTISE_EXPLORE_PAGE
    "\"\n"
    "mortise_explore_page_end:\n"
    ".byte 0\n"
    ".previous\n");

extern "C" {
extern const char mortise_explore_page_begin[];
extern const char mortise_explore_page_end[];
}

namespace mortise::cli {

std::string_view PageSource() {
  return {mortise_explore_page_begin,
          static_cast<std::size_t>(mortise_explore_page_end - mortise_explore_page_begin)};
}

}  // namespace mortise::cli
