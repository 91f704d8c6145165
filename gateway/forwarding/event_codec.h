// Events of the bus as mortise.v1.Event, and back.
#pragma once

#include "common/bus/event.h"

namespace mortise::v1 {
class Event;
}

namespace mortise::gateway {

v1::Event ToProto(const bus::Event& event);
bus::Event FromProto(const v1::Event& event);

}  // namespace mortise::gateway
