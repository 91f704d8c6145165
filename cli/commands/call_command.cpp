// mortise call SERVICE.METHOD [JSON]: any method, known by reflection; mortise health.
#include <google/protobuf/dynamic_message.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "cli/client/generic_call.h"
#include "cli/client/json_input.h"
#include "cli/client/reflection.h"
#include "cli/client/session.h"
#include "cli/commands/commands.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"

namespace mortise::cli {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

struct CallOptions {
  std::string method;
  std::string request = "{}";
  double seconds = 60;
};

// Every mutating request has a request_id; a person at a terminal need not think of one.
void FillRequestId(Message& request) {
  const FieldDescriptor* field = request.GetDescriptor()->FindFieldByName("request_id");
  if (field == nullptr || field->cpp_type() != FieldDescriptor::CPPTYPE_STRING) return;
  const auto* reflection = request.GetReflection();
  if (reflection->GetString(request, field).empty()) {
    reflection->SetString(&request, field, NewIdentifier());
  }
}

// The failure of a call, with how to wait for longer where it was not waited for long enough.
absl::Status WithLongerWait(const absl::Status& failure, double seconds) {
  if (!absl::IsDeadlineExceeded(failure) || seconds == 0) return failure;
  return WithDetail(
      absl::DeadlineExceededError(absl::StrCat(
          "there was no answer within ", seconds,
          " s; give it more time with --seconds, such as --seconds 600, or 0 for no end")),
      {"DEADLINE_EXCEEDED", "--seconds"});
}

absl::Status Call(const CallOptions& options, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  Reflection reflection(*client);
  MORTISE_ASSIGN_OR_RETURN(const auto* method, reflection.FindMethod(options.method));
  if (method->client_streaming()) {
    return WithDetail(absl::UnimplementedError(absl::StrCat(
                          method->full_name(), " takes a stream, which has no JSON form here")),
                      {"CLIENT_STREAMING", "method"});
  }
  google::protobuf::DynamicMessageFactory factory;
  const std::unique_ptr<Message> request(factory.GetPrototype(method->input_type())->New());
  std::string json = options.request;
  if (json == "-") json.assign(std::istreambuf_iterator<char>(std::cin), {});
  MORTISE_RETURN_IF_ERROR(ReadJson(json, "request", *request));
  FillRequestId(*request);

  nlohmann::ordered_json responses = nlohmann::ordered_json::array();
  const std::string path = absl::StrCat("/", method->service()->full_name(), "/", method->name());
  const absl::Status called = CallGeneric(
      *client, path, request->SerializeAsString(), options.seconds, [&](const std::string& bytes) {
        const std::unique_ptr<Message> response(factory.GetPrototype(method->output_type())->New());
        if (!response->ParseFromString(bytes)) return false;
        const nlohmann::ordered_json document = ToJson(*response);
        output.Line(document.dump(2));
        if (!output.text()) responses.push_back(document);
        return true;
      });
  MORTISE_RETURN_IF_ERROR(WithLongerWait(called, options.seconds));
  output.Document(method->server_streaming()
                      ? responses
                      : (responses.empty() ? nlohmann::ordered_json::object() : responses.front()));
  return absl::OkStatus();
}

// The answer of a server's health service to an empty request, which asks for the server as a
// whole: one field, number 1, value 1 (SERVING).
constexpr char kServing[] = {0x08, 0x01};

absl::Status Health(double seconds, Session& session, Output& output) {
  session.gateway.patience = seconds;
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  bool serving = false;
  MORTISE_RETURN_IF_ERROR(CallGeneric(*client, "/grpc.health.v1.Health/Check", "", seconds,
                                      [&serving](const std::string& response) {
                                        serving = response == std::string(kServing, 2);
                                        return true;
                                      }));
  if (!serving) return PeerUnavailable(client->address(), "is up but does not serve");
  output.Line(client->address() + " serves");
  output.Document({{"address", client->address()}, {"serving", true}});
  return absl::OkStatus();
}

}  // namespace

void AddCallCommand(CLI::App& app, Session& session) {
  auto options = std::make_shared<CallOptions>();
  CLI::App* call = app.add_subcommand("call", "Call any method of any service");
  call->add_option("method", options->method, "SERVICE.METHOD, such as catalog.GetItem")
      ->required();
  call->add_option("request", options->request, "The request as JSON; - for standard input");
  call->add_option("--seconds", options->seconds, "How long to wait for the answer; 0 for no end")
      ->capture_default_str();
  call->footer(R"(Example: mortise call catalog.GetTemplate '{"name": "templates/table"}')");
  call->callback([&session, options] {
    session.command = [options](Session& s, Output& output) { return Call(*options, s, output); };
  });

  auto seconds = std::make_shared<double>(5);
  CLI::App* health = app.add_subcommand("health", "Ask a server whether it serves");
  health->add_option("--seconds", *seconds, "How long to wait for it")->capture_default_str();
  health->footer("Example: mortise --gateway 127.0.0.1:7701 health");
  health->callback([&session, seconds] {
    session.command = [seconds](Session& s, Output& o) { return Health(*seconds, s, o); };
  });
}

}  // namespace mortise::cli
