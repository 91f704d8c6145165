// Calls of any method with any bytes.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/support/status.h>

#include <memory>
#include <string>
#include <vector>

namespace mortise::e2e {

struct RawAnswer {
  grpc::Status status;
  std::vector<std::string> messages;  // at most the first ten of a stream
};

// Sends one message to "mortise.v1.CatalogService/GetItem", finishes sending, and reads the answer
// to its end. DEADLINE_EXCEEDED if that takes longer than 10 s.
RawAnswer CallWithBytes(const std::shared_ptr<grpc::Channel>& channel, const std::string& method,
                        const std::string& message);

}  // namespace mortise::e2e
