// How every connection to another process is kept up, whatever secures it.
#pragma once

#include <grpcpp/support/channel_arguments.h>

namespace mortise::rpc {

// Reconnects within a second or two, as services restart so soon, and notices after half a minute a
// host that vanished without closing the connection.
grpc::ChannelArguments ConnectionArguments();

}  // namespace mortise::rpc
