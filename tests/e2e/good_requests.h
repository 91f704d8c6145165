// A request for every method of the house that is right, to make bad ones of.
#pragma once

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <grpcpp/channel.h>

#include <memory>
#include <string>
#include <vector>

namespace mortise::e2e {

// What comes of sending it.
enum class Outcome {
  kOk,       // OK
  kChanges,  // OK, and something is stored
  kRefused,  // a failure: what it speaks of is not there
};

struct GoodRequest {
  std::string method;  // "mortise.v1.CatalogService/GetItem"
  const google::protobuf::MethodDescriptor* descriptor = nullptr;
  std::unique_ptr<google::protobuf::Message> message;
  Outcome outcome = Outcome::kOk;
};

// Every method of the protos, in their order, but for those of which no request is known; the test
// asks the gateway whether that is any. Makes a plan, a work order, an analysis and a front first,
// for requests to name; aborts the program with the reason if that fails.
std::vector<GoodRequest> MakeGoodRequests(const std::shared_ptr<grpc::Channel>& channel);

}  // namespace mortise::e2e
