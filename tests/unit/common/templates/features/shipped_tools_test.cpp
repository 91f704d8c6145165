// The CAD templates of tools and machine parts are valid solids all over their parameter boxes.
#include "tests/unit/common/templates/features/shipped_templates.h"

namespace mortise::cad {
namespace {

INSTANTIATE_TEST_SUITE_P(Tools, ShippedTemplateTest,
                         testing::Values(ShippedTemplate{"wrench", 3},
                                         ShippedTemplate{"bike_rocker_arm", 4},
                                         ShippedTemplate{"camera_mount", 5},
                                         ShippedTemplate{"drum_brake", 3},
                                         ShippedTemplate{"arbor_press", 5}),
                         NameOf);

}  // namespace
}  // namespace mortise::cad
