// Connections as messages of mortise/v1/connection.proto. Target mortise_assembly_codec; only
// adapters link it.
#pragma once

#include "common/assembly/connections/connection.h"
#include "mortise/v1/connection.pb.h"

namespace mortise::parametric {

// Elements and groups are named as the messages of the design name them. O(size of the connection)
// but for its degrees of freedom: ConnectionOptimizer.
v1::ElementConnection ToProto(const ElementConnection& connection);

}  // namespace mortise::parametric
