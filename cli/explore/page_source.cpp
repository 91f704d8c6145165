#include "cli/explore/page_source.h"

#include "common/pages/embedded_page.h"

#include MORTISE_EXPLORE_PAGE_DIGEST

MORTISE_EMBED_PAGE(mortise_explore_page, MORTISE_EXPLORE_PAGE)

namespace mortise::cli {

std::string_view PageSource() { return MORTISE_EMBEDDED_PAGE(mortise_explore_page); }

}  // namespace mortise::cli
