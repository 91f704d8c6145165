#include "gateway/forwarding/proxy.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/wire_format_lite.h>

#include <iterator>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "gateway/forwarding/event_hub.h"
#include "gateway/forwarding/health_answers.h"
#include "gateway/forwarding/proxied_call.h"
#include "gateway/forwarding/reflection.h"

namespace mortise::gateway {
namespace {

namespace pb = google::protobuf;

// As no subject of a token is named: those are in a collection.
constexpr char kAnybody[] = "anybody";

// Whose token comes with the call, if a good one does; all others are one.
std::string SubjectOf(Admission& admission, const grpc::GenericCallbackServerContext& context) {
  const auto tokens = context.client_metadata().equal_range("authorization");
  if (std::distance(tokens.first, tokens.second) > 1) return kAnybody;
  const std::string_view token =
      tokens.first == tokens.second
          ? std::string_view()
          : std::string_view(tokens.first->second.data(), tokens.first->second.size());
  const auto caller = admission.Authenticate(token);
  return caller.ok() ? (*caller)->subject : kAnybody;
}

class Proxy final : public grpc::CallbackGenericService {
 public:
  explicit Proxy(const ProxyOptions& options) : options_(options) {}

  grpc::ServerGenericBidiReactor* CreateReactor(
      grpc::GenericCallbackServerContext* context) override {
    const MethodRoute* method = options_.contract->Find(context->method());
    if (method == nullptr && IsForAnybody(context->method())) return AnswerAnybody(*context);
    auto call = std::make_unique<ProxiedCall>(options_, method, context);
    if (const absl::Status admitted = call->Admit(); !admitted.ok()) {
      return MakeRefusal(std::move(call), admitted);
    }
    if (method->client_streaming || method->server_streaming) {
      return MakeStreamForward(std::move(call));
    }
    return MakeUnaryForward(std::move(call));
  }

 private:
  static bool IsForAnybody(const std::string& path) {
    return IsReflection(path) || HealthAnswers::IsCheck(path) || HealthAnswers::IsWatch(path);
  }

  // Who needs no token is counted nevertheless, so that strangers do not hold any number of these.
  grpc::ServerGenericBidiReactor* AnswerAnybody(grpc::GenericCallbackServerContext& context) {
    const bool check = HealthAnswers::IsCheck(context.method());
    auto place = options_.open_calls->Enter(check ? CallKind::kCall : CallKind::kStream,
                                            SubjectOf(*options_.admission, context));
    if (!place.ok()) {
      return MakeRefusal(std::make_unique<ProxiedCall>(options_, nullptr, &context),
                         place.status());
    }
    if (check) return options_.health->Check(context, *std::move(place));
    if (HealthAnswers::IsWatch(context.method())) return options_.health->Watch(*std::move(place));
    return MakeReflection(*options_.contract, context, *std::move(place), options_.reflection_time);
  }

  const ProxyOptions options_;
};

// The value of a string field in a serialised message, the last one if it is repeated; empty if it
// is absent. Nothing if the message is malformed.
std::optional<std::string> StringField(std::string_view message, int number) {
  using pb::internal::WireFormatLite;
  pb::io::CodedInputStream input(reinterpret_cast<const uint8_t*>(message.data()),
                                 static_cast<int>(message.size()));
  std::string value;
  for (;;) {
    const uint32_t tag = input.ReadTag();
    if (tag == 0) return input.ConsumedEntireMessage() ? std::optional(value) : std::nullopt;
    if (tag == WireFormatLite::MakeTag(number, WireFormatLite::WIRETYPE_LENGTH_DELIMITED)) {
      if (!WireFormatLite::ReadBytes(&input, &value)) return std::nullopt;
    } else if (!WireFormatLite::SkipField(&input, tag)) {
      return std::nullopt;
    }
  }
}

}  // namespace

std::unique_ptr<grpc::CallbackGenericService> MakeProxy(const ProxyOptions& options) {
  return std::make_unique<Proxy>(options);
}

absl::Status UnreadableRequest() {
  return InvalidField("request", "is not a message of the method's type");
}

absl::StatusOr<std::string> ServiceOf(const MethodRoute& method, std::string_view request,
                                      const Upstreams& upstreams) {
  if (method.destination == Destination::kService) {
    if (upstreams.addresses().count(method.service) != 0) return method.service;
    return NotBuilt(absl::StrCat("the ", method.service, " service"));
  }
  const std::string& field = method.routing_field->name();
  const std::optional<std::string> value = StringField(request, method.routing_field->number());
  if (!value) return UnreadableRequest();
  const std::string_view service = method.destination == Destination::kByOperation
                                       ? ServiceOfOperation(*value)
                                       : std::string_view(*value);
  if (service.empty()) {
    return InvalidField(field, method.destination == Destination::kByOperation
                                   ? "must have the form operations/{service}/{id}"
                                   : "must name a stream");
  }
  if (upstreams.addresses().count(service) == 0) {
    return method.destination == Destination::kByOperation ? ResourceNotFound(*value)
                                                           : NoSuchStream(*value);
  }
  return std::string(service);
}

}  // namespace mortise::gateway
