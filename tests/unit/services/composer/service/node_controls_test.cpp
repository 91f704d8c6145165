#include "services/composer/service/node_controls.h"

#include <gtest/gtest.h>

#include <string>

#include "common/base/errors.h"

namespace mortise::composer {
namespace {

TEST(NodeControls, HaveTheNamesThatTheyAreDraggedBy) {
  for (const char* const name : {"width", "depth", "height", "x", "y", "z"}) {
    const auto control = ParseControl(name);
    ASSERT_TRUE(control.ok()) << control.status();
    EXPECT_EQ(ToProto({.kind = control->kind, .axis = control->axis}).name(), name);
  }
}

TEST(NodeControls, OfOtherNamesAreRefused) {
  for (const char* const name : {"", "Width", "length", "xy"}) {
    EXPECT_EQ(DetailOf(ParseControl(name).status()).field, "control") << name;
  }
}

}  // namespace
}  // namespace mortise::composer
