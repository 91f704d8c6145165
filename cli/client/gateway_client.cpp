#include "cli/client/gateway_client.h"

#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <thread>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/strip.h"
#include "cli/client/bearer_token.h"
#include "cli/client/tls_probe.h"
#include "cli/launcher/state_folder.h"
#include "common/base/errors.h"
#include "common/rpc/channel_security.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/operations.grpc.pb.h"

namespace mortise::cli {
namespace {

constexpr std::chrono::milliseconds kPauseBetweenTries{100};
constexpr std::chrono::seconds kConnectPatience{2};
constexpr int kTriesOfCalls = 3;
constexpr std::chrono::milliseconds kPauseBetweenCalls{200};  // times the tries made
constexpr std::chrono::seconds kPatienceForRestarts{60};
// The client makes so many tries at a server that takes connections and ends them; more than one,
// for it may be ending itself.
constexpr int kRefusalsBeforeGivingUp = 6;
constexpr double kSecondsOfWait = 3;  // between two looks at an operation without a stream

std::string Environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

// What gRPC says of a channel that is not connected: UNAVAILABLE with the last failure. Anything
// else: something has answered, or the reason is not known yet.
absl::Status WhyNotConnected(const std::shared_ptr<grpc::Channel>& channel,
                             std::chrono::milliseconds wait) {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + wait);
  v1::Operation ignored;
  return rpc::FromGrpc(
      v1::OperationService::NewStub(channel)->GetOperation(&context, {}, &ignored));
}

// Why a server that takes connections and ends them cannot be talked to.
std::string WhyItRefuses(const std::string& address, bool plain_text) {
  switch (AskForTls(address, kConnectPatience)) {
    case TlsAnswer::kTls:
      return plain_text ? "speaks TLS; name whom to trust with --authority"
                        : "has a certificate that is not from the authority that is trusted, or "
                          "is for another name";
    case TlsAnswer::kOther:
      return plain_text ? "answers, but does not speak gRPC in plain text" : "does not speak TLS";
    case TlsAnswer::kNothing:
      break;
  }
  return "ends connections at once: it may have as many as it takes, or be ending itself";
}

using Heard = std::function<void(const v1::Operation&)>;

// One stream of what becomes of an operation, to its end or until it breaks off.
absl::Status WatchOnce(const GatewayClient& client, const std::string& name, const Heard& heard,
                       const std::stop_token& stop) {
  grpc::ClientContext context;
  client.Prepare(context, 0);
  v1::WatchOperationRequest request;
  request.set_name(name);
  const auto reader =
      v1::OperationService::NewStub(client.channel())->WatchOperation(&context, request);
  const std::stop_callback stopping(stop, [&context] { context.TryCancel(); });
  v1::Operation now;
  while (reader->Read(&now)) {
    heard(now);
    if (HasEnded(now)) context.TryCancel();
  }
  return rpc::FromGrpc(reader->Finish());
}

// How it stands a few seconds from now, or once it has ended.
absl::Status WaitOnce(const GatewayClient& client, const std::string& name, const Heard& heard,
                      const std::stop_token& stop) {
  grpc::ClientContext context;
  client.Prepare(context);
  v1::WaitOperationRequest request;
  request.set_name(name);
  request.set_timeout_seconds(kSecondsOfWait);
  const std::stop_callback stopping(stop, [&context] { context.TryCancel(); });
  v1::Operation now;
  MORTISE_RETURN_IF_ERROR(rpc::FromGrpc(
      v1::OperationService::NewStub(client.channel())->WaitOperation(&context, request, &now)));
  heard(now);
  return absl::OkStatus();
}

// A word for a shell: in quotes where it has characters that mean something there.
std::string ShellWord(const std::string& text) {
  const bool is_plain = std::all_of(text.begin(), text.end(), [](char c) {
    return absl::ascii_isalnum(static_cast<unsigned char>(c)) ||
           std::string_view("-_./:@,+=").find(c) != std::string_view::npos;
  });
  if (is_plain) return text;
  return absl::StrCat("'", absl::StrReplaceAll(text, {{"'", R"('\'')"}}), "'");
}

std::string CommandFor(const GatewayOptions& options) {
  std::string command = "mortise";
  const auto add = [&](const char* flag, const std::string& value) {
    if (!value.empty()) absl::StrAppend(&command, " ", flag, " ", ShellWord(value));
  };
  add("--gateway", options.address);
  add("--token-file", options.token_file);
  add("--authority", options.authority);
  if (options.state != GatewayOptions().state) add("--house", options.state.string());
  return command;
}

}  // namespace

std::string GatewayOfEnvironment() { return Environment("MORTISE_GATEWAY"); }

bool HasEnded(const v1::Operation& operation) {
  return operation.state() == v1::Operation::SUCCEEDED ||
         operation.state() == v1::Operation::FAILED ||
         operation.state() == v1::Operation::CANCELLED;
}

absl::Status ErrorOf(const v1::Operation& operation) {
  if (operation.state() == v1::Operation::CANCELLED) {
    return absl::CancelledError(absl::StrCat(operation.name(), " was cancelled"));
  }
  if (operation.state() != v1::Operation::FAILED) return absl::OkStatus();
  return rpc::FromProto(operation.error());
}

absl::StatusOr<GatewayClient> GatewayClient::Connect(const GatewayOptions& options) {
  std::string address = options.address.empty() ? GatewayOfEnvironment() : options.address;
  std::string authority_of_house;
  if (address.empty()) {
    const absl::StatusOr<RunningHouse> house = ReadRunningHouse(options.state);
    if (!house.ok()) {
      return WithDetail(absl::NotFoundError(absl::StrCat(
                            "no house runs on ", options.state.string(),
                            "; start one with `mortise up`, or name a gateway with --gateway")),
                        {"GATEWAY_UNKNOWN", "--gateway"});
    }
    address = house->gateway_grpc;
    authority_of_house = house->authority;
  }
  rpc::ChannelSecurity security;
  security.authority = options.authority.empty() ? Environment("MORTISE_CA") : options.authority;
  if (security.authority.empty()) security.authority = authority_of_house;
  MORTISE_ASSIGN_OR_RETURN(const auto credentials, rpc::MakeClientCredentials(address, security));
  MORTISE_ASSIGN_OR_RETURN(std::shared_ptr<BearerToken> token,
                           BearerToken::Read(options.token_file));
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 100);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 1000);
  GatewayClient client(grpc::CreateCustomChannel(address, credentials, arguments), address,
                       std::move(token), CommandFor(options));
  MORTISE_RETURN_IF_ERROR(client.AwaitConnection(std::chrono::duration<double>(options.patience),
                                                 security.authority.empty()));
  return client;
}

GatewayClient::GatewayClient(std::shared_ptr<grpc::Channel> channel, std::string address,
                             std::shared_ptr<BearerToken> token, std::string command)
    : channel_(std::move(channel)),
      address_(std::move(address)),
      token_(std::move(token)),
      command_(std::move(command)) {}

absl::Status GatewayClient::AwaitConnection(std::chrono::duration<double> patience,
                                            bool plain_text) const {
  const auto begin = std::chrono::steady_clock::now();
  const std::chrono::milliseconds look(
      std::clamp<long>(static_cast<long>(1000 * patience.count()), 1, 500));
  int refusals_to_talk = 0;
  while (!channel_->WaitForConnected(std::chrono::system_clock::now() + look)) {
    const absl::Status reason = WhyNotConnected(channel_, look);
    // Where nobody listens, or the answer is on its way, somebody may yet serve.
    const bool refuses =
        absl::IsUnavailable(reason) && !absl::StrContains(reason.message(), "Connection refused");
    refusals_to_talk = refuses ? refusals_to_talk + 1 : 0;
    if (refusals_to_talk >= kRefusalsBeforeGivingUp) {
      return PeerUnavailable(
          address_, absl::StrCat(WhyItRefuses(address_, plain_text), " (", reason.message(), ")"));
    }
    if (std::chrono::steady_clock::now() - begin > patience) {
      return PeerUnavailable(address_, absl::StrCat("does not answer (", reason.message(), ")"));
    }
  }
  return absl::OkStatus();
}

void GatewayClient::Prepare(grpc::ClientContext& context, double seconds) const {
  const std::string token = token_->text();
  if (!token.empty()) context.AddMetadata("authorization", "Bearer " + token);
  if (seconds > 0) {
    context.set_deadline(std::chrono::system_clock::now() +
                         std::chrono::milliseconds(static_cast<long>(seconds * 1000)));
    context.set_wait_for_ready(true);
  }
}

absl::Status GatewayClient::Call(const std::function<absl::Status(grpc::ClientContext&)>& call,
                                 double seconds) const {
  for (int tries = 1;; ++tries) {
    const std::string token = token_->text();
    grpc::ClientContext context;
    Prepare(context, seconds);
    const absl::Status status = call(context);
    if (tries == kTriesOfCalls) return status;
    if (absl::IsUnauthenticated(status) && token_->IsRenewed(token)) continue;
    if (!absl::IsUnavailable(status)) return status;
    std::this_thread::sleep_for(tries * kPauseBetweenCalls);
  }
}

absl::StatusOr<v1::Operation> GatewayClient::Follow(
    const std::string& operation, const std::function<void(const v1::Operation&)>& changed,
    const std::stop_token& stop) const {
  auto last_answer = std::chrono::steady_clock::now();
  v1::Operation latest;
  const Heard heard = [&](const v1::Operation& now) {
    last_answer = std::chrono::steady_clock::now();
    latest = now;
    changed(now);
  };
  bool has_stream = true;
  while (true) {
    const std::string token = token_->text();
    const absl::Status status = has_stream ? WatchOnce(*this, operation, heard, stop)
                                           : WaitOnce(*this, operation, heard, stop);
    if (HasEnded(latest)) return latest;
    if (stop.stop_requested()) return absl::CancelledError("the operation is no longer followed");
    if (!has_stream && status.ok()) continue;
    if (absl::IsUnauthenticated(status) && token_->IsRenewed(token)) continue;
    if (has_stream && DetailOf(status).reason == "TOO_MANY_STREAMS") {
      has_stream = false;
      continue;
    }
    // A service that restarts cuts the stream; its operation goes on.
    const bool may_come_back =
        status.ok() || absl::IsUnavailable(status) || absl::IsCancelled(status);
    if (!may_come_back || std::chrono::steady_clock::now() - last_answer > kPatienceForRestarts) {
      return status;
    }
    std::this_thread::sleep_for(kPauseBetweenTries);
    // Connecting goes on only while somebody waits for it.
    channel_->WaitForConnected(std::chrono::system_clock::now() + kConnectPatience);
  }
}

}  // namespace mortise::cli
