// Puts a page that mortise_page (cmake/MortisePages.cmake) has joined into the program.
//
//   #include MORTISE_EXPLORE_PAGE_DIGEST
//   MORTISE_EMBED_PAGE(mortise_explore_page, MORTISE_EXPLORE_PAGE)
//   std::string_view PageSource() { return MORTISE_EMBEDDED_PAGE(mortise_explore_page); }
#pragma once

#include <cstddef>
#include <string_view>

// Defines the page: `symbol` is a name of its own in the whole program, `file` the path of the
// joined page, a string. Stands outside of all namespaces, in a file that is compiled apart.
#define MORTISE_EMBED_PAGE(symbol, file) \
  __asm__(                               \
      ".section .rodata\n"               \
      ".balign 16\n" #symbol             \
      "_begin:\n"                        \
      ".incbin \"" file "\"\n" #symbol   \
      "_end:\n"                          \
      ".byte 0\n"                        \
      ".previous\n");                    \
  extern "C" {                           \
  extern const char symbol##_begin[];    \
  extern const char symbol##_end[];      \
  }

// The text of a page so defined, as std::string_view.
#define MORTISE_EMBEDDED_PAGE(symbol) \
  std::string_view(symbol##_begin, static_cast<std::size_t>(symbol##_end - symbol##_begin))
