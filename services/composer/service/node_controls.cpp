#include "services/composer/service/node_controls.h"

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::composer {
namespace {

struct Named {
  const char* name;
  ControlName control;
};

constexpr Named kNames[] = {
    {"width", {ControlKind::kSize, Axis::kX}},  {"depth", {ControlKind::kSize, Axis::kY}},
    {"height", {ControlKind::kSize, Axis::kZ}}, {"x", {ControlKind::kCenter, Axis::kX}},
    {"y", {ControlKind::kCenter, Axis::kY}},    {"z", {ControlKind::kCenter, Axis::kZ}},
};

}  // namespace

absl::StatusOr<ControlName> ParseControl(const std::string& name) {
  for (const Named& each : kNames) {
    if (name == each.name) return each.control;
  }
  return InvalidField("control",
                      absl::StrCat("'", name, "' is none of width, depth, height, x, y, z"));
}

v1::NodeControl ToProto(const Control& control) {
  v1::NodeControl message;
  for (const Named& each : kNames) {
    if (each.control.kind == control.kind && each.control.axis == control.axis) {
      message.set_name(each.name);
    }
  }
  message.set_value(control.value);
  message.set_minimum(control.minimum);
  message.set_maximum(control.maximum);
  return message;
}

}  // namespace mortise::composer
