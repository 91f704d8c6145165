// Who a call is by, for what it changes.
#pragma once

#include "common/resources/author.h"
#include "common/rpc/call.h"

namespace mortise::rpc {

inline resources::Author AuthorOf(const Call& call) {
  return {.user = call.identity().subject, .trace_id = call.identity().trace_id};
}

}  // namespace mortise::rpc
