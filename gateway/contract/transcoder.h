// JSON (the proto3 mapping) to serialised messages and back, from the contract's descriptors.
//
// In JSON, 64-bit integers are strings, bytes are base64, enums are their names, times are RFC 3339
// text, field names are camelCase (snake_case is understood too), and fields that have their
// default value are left out.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace google::protobuf {
class Descriptor;
namespace util {
class TypeResolver;
}
}  // namespace google::protobuf

namespace mortise::gateway {

class Contract;

// Thread safe. `contract` must outlive it.
class Transcoder {
 public:
  explicit Transcoder(const Contract& contract);
  ~Transcoder();

  // Returns the message of type `type` that `json` describes, serialised. INVALID_ARGUMENT naming
  // every field that is unknown, has a value of the wrong type or is there twice, and "request",
  // saying where, for text that is not JSON.
  absl::StatusOr<std::string> ToBinary(const google::protobuf::Descriptor& type,
                                       std::string_view json) const;

  // INTERNAL if `message` is not a serialised message of type `type`.
  absl::StatusOr<std::string> ToJson(const google::protobuf::Descriptor& type,
                                     std::string_view message) const;

 private:
  std::unique_ptr<google::protobuf::util::TypeResolver> resolver_;
};

}  // namespace mortise::gateway
