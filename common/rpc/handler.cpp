#include "common/rpc/handler.h"

#include <google/protobuf/descriptor.h>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/logging.h"

namespace mortise::rpc {
namespace {

// A mistake of the adapter's author, not of the caller's.
absl::Status Misused(const std::string& what) {
  return WithDetail(absl::InternalError(what), {"ADAPTER_MISTAKE", ""});
}

bool HasRequestId(const google::protobuf::MethodDescriptor& method) {
  const auto* field = method.input_type()->FindFieldByName("request_id");
  return field != nullptr && field->type() == google::protobuf::FieldDescriptor::TYPE_STRING &&
         !field->is_repeated();
}

}  // namespace

Endpoint::Endpoint(Dispatcher* dispatcher, const std::string& service) : dispatcher_(dispatcher) {
  unknown_.name = absl::StrCat(service, "/?");
  unknown_.usable = Misused("the adapter names a method that the proto does not have");
  misused_.name = absl::StrCat(service, "/?");
  misused_.usable =
      Misused("the adapter wraps a method as query that mutates, or as mutation that does not");
  const auto* descriptor =
      google::protobuf::DescriptorPool::generated_pool()->FindServiceByName(service);
  for (int i = 0; descriptor != nullptr && i < descriptor->method_count(); ++i) {
    const auto* method = descriptor->method(i);
    MethodInfo info = FindMethod(service, method->name());
    if (info.mutates && !method->client_streaming() && !HasRequestId(*method)) {
      info.usable = Misused(absl::StrCat(info.name, " mutates, but its request has no request_id"));
    }
    if (!info.usable.ok()) {
      Log(LogLevel::kError, "a method will refuse every call",
          {{"method", info.name}, {"error", info.usable.message()}});
    }
    methods_[method->name()] = std::move(info);
  }
}

const MethodInfo& Endpoint::Find(const std::string& method, bool mutation) const {
  const auto found = methods_.find(method);
  if (found == methods_.end()) return unknown_;
  if (found->second.usable.ok() && found->second.mutates != mutation) return misused_;
  return found->second;
}

std::shared_ptr<CallState> Endpoint::NewCall(const char* method,
                                             const grpc::CallbackServerContext& context) const {
  const auto found = methods_.find(method);
  return std::make_shared<CallState>(dispatcher_,
                                     found == methods_.end() ? &unknown_ : &found->second, context);
}

}  // namespace mortise::rpc
