#include "services/fabplanner/documents/guide_page_source.h"

#include "common/pages/embedded_page.h"

#include MORTISE_GUIDE_PAGE_DIGEST

MORTISE_EMBED_PAGE(mortise_guide_page, MORTISE_GUIDE_PAGE)

namespace mortise::fabplanner {

std::string_view GuidePageSource() { return MORTISE_EMBEDDED_PAGE(mortise_guide_page); }

}  // namespace mortise::fabplanner
