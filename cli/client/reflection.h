// Knows any service by asking the server: gRPC server reflection, without generated code.
#pragma once

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor_database.h>

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "cli/client/gateway_client.h"

namespace mortise::cli {

// Descriptors fetched from a server on demand. Not thread safe.
class Reflection {
 public:
  explicit Reflection(const GatewayClient& client);
  ~Reflection();

  // Full names of the services the server offers.
  absl::StatusOr<std::vector<std::string>> ListServices();

  // Returns the method named "SERVICE.METHOD" or "SERVICE/METHOD", where SERVICE may leave out its
  // package and the ending "Service": "catalog.GetItem" finds mortise.v1.CatalogService/GetItem.
  // NOT_FOUND with the nearest names otherwise.
  absl::StatusOr<const google::protobuf::MethodDescriptor*> FindMethod(const std::string& name);

 private:
  class Database;
  std::unique_ptr<Database> database_;
  std::unique_ptr<google::protobuf::DescriptorPool> pool_;
};

}  // namespace mortise::cli
