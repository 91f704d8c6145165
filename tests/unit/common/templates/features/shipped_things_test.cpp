// The CAD templates of furniture and toys are valid solids all over their parameter boxes.
#include "tests/unit/common/templates/features/shipped_templates.h"

namespace mortise::cad {
namespace {

INSTANTIATE_TEST_SUITE_P(Things, ShippedTemplateTest,
                         testing::Values(ShippedTemplate{"chair", 6}, ShippedTemplate{"plane", 4},
                                         ShippedTemplate{"swing_castle", 3},
                                         ShippedTemplate{"lamp", 21}),
                         NameOf);

}  // namespace
}  // namespace mortise::cad
