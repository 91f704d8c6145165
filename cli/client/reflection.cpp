#include "cli/client/reflection.h"

#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/unknown_field_set.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <cctype>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/strip.h"
#include "cli/client/generic_call.h"
#include "common/base/errors.h"
#include "common/base/names/offered_names.h"

namespace mortise::cli {
namespace {

using google::protobuf::FileDescriptorProto;
using google::protobuf::UnknownFieldSet;

constexpr char kReflectionMethod[] =
    "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo";

// Field numbers of the reflection protocol (grpc.reflection.v1alpha).
constexpr int kRequestFileByName = 3;
constexpr int kRequestFileContainingSymbol = 4;
constexpr int kRequestListServices = 7;
constexpr int kResponseFileDescriptors = 4;
constexpr int kResponseServices = 6;
constexpr int kResponseError = 7;
constexpr int kErrorMessage = 2;

const std::string* Bytes(const UnknownFieldSet& fields, int number, int occurrence = 0) {
  for (int i = 0; i < fields.field_count(); ++i) {
    const auto& field = fields.field(i);
    if (field.number() != number) continue;
    if (field.type() != google::protobuf::UnknownField::TYPE_LENGTH_DELIMITED) continue;
    if (occurrence-- == 0) return &field.length_delimited();
  }
  return nullptr;
}

}  // namespace

class Reflection::Database : public google::protobuf::DescriptorDatabase {
 public:
  explicit Database(const GatewayClient& client) : client_(client) {}

  // One question and its answer, the fields of the response.
  absl::StatusOr<std::unique_ptr<UnknownFieldSet>> Ask(int field, const std::string& value) {
    UnknownFieldSet request;
    request.AddLengthDelimited(field, value);
    std::string bytes;
    request.SerializeToString(&bytes);
    std::string answer;
    MORTISE_RETURN_IF_ERROR(
        CallGeneric(client_, kReflectionMethod, bytes, 30, [&](const std::string& response) {
          answer = response;
          return true;
        }));
    auto response = std::make_unique<UnknownFieldSet>();
    if (!response->ParseFromString(answer)) {
      return absl::DataLossError("reflection: malformed answer");
    }
    if (const std::string* error = Bytes(*response, kResponseError)) {
      UnknownFieldSet details;
      details.ParseFromString(*error);
      const std::string* message = Bytes(details, kErrorMessage);
      return absl::NotFoundError(message == nullptr ? value : *message);
    }
    return response;
  }

  bool FindFileByName(const std::string& name, FileDescriptorProto* output) override {
    if (cache_.FindFileByName(name, output)) return true;
    return Fetch(kRequestFileByName, name) && cache_.FindFileByName(name, output);
  }
  bool FindFileContainingSymbol(const std::string& symbol, FileDescriptorProto* output) override {
    if (cache_.FindFileContainingSymbol(symbol, output)) return true;
    return Fetch(kRequestFileContainingSymbol, symbol) &&
           cache_.FindFileContainingSymbol(symbol, output);
  }
  bool FindFileContainingExtension(const std::string&, int, FileDescriptorProto*) override {
    return false;
  }

 private:
  bool Fetch(int field, const std::string& value) {
    const auto response = Ask(field, value);
    if (!response.ok()) return false;
    const std::string* files = Bytes(**response, kResponseFileDescriptors);
    UnknownFieldSet list;
    if (files == nullptr || !list.ParseFromString(*files)) return false;
    for (int i = 0; const std::string* bytes = Bytes(list, 1, i); ++i) {
      FileDescriptorProto file;
      FileDescriptorProto known;
      if (!file.ParseFromString(*bytes)) return false;
      if (!cache_.FindFileByName(file.name(), &known)) cache_.Add(file);
    }
    return true;
  }

  const GatewayClient& client_;
  google::protobuf::SimpleDescriptorDatabase cache_;
};

Reflection::Reflection(const GatewayClient& client)
    : database_(std::make_unique<Database>(client)),
      pool_(std::make_unique<google::protobuf::DescriptorPool>(database_.get())) {}

Reflection::~Reflection() = default;

absl::StatusOr<std::vector<std::string>> Reflection::ListServices() {
  MORTISE_ASSIGN_OR_RETURN(const auto response, database_->Ask(kRequestListServices, "*"));
  std::vector<std::string> names;
  UnknownFieldSet list;
  const std::string* services = Bytes(*response, kResponseServices);
  if (services != nullptr) list.ParseFromString(*services);
  for (int i = 0; const std::string* bytes = Bytes(list, 1, i); ++i) {
    UnknownFieldSet service;
    service.ParseFromString(*bytes);
    if (const std::string* name = Bytes(service, 1)) names.push_back(*name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

namespace {

std::string WordBehindDot(const std::string& name) {
  return name.substr(name.find_last_of("./") + 1);
}

// Says that there is no such method: which one may be meant, or which the service has, or which
// services there are.
absl::Status NoSuchMethod(const std::string& name, const std::vector<std::string>& services,
                          const std::vector<std::string>& methods) {
  std::string offered;
  for (const std::string& method : methods) {
    if (NearestName(WordBehindDot(name), {WordBehindDot(method)})) {
      offered = absl::StrCat("did you mean '", method, "'? ");
      break;
    }
  }
  return WithDetail(absl::NotFoundError(absl::StrCat(
                        "there is no method '", name, "'; ", offered,
                        methods.empty() ? absl::StrCat("services: ", absl::StrJoin(services, ", "))
                                        : absl::StrCat("methods: ", absl::StrJoin(methods, ", ")))),
                    {"RESOURCE_NOT_FOUND", name});
}

}  // namespace

absl::StatusOr<const google::protobuf::MethodDescriptor*> Reflection::FindMethod(
    const std::string& name) {
  const std::size_t split = name.find_last_of("./");
  if (split == std::string::npos) {
    return InvalidField("method", absl::StrCat("'", name, "' is not of the form SERVICE.METHOD"));
  }
  const std::string wanted_service = absl::AsciiStrToLower(name.substr(0, split));
  const std::string wanted_method = name.substr(split + 1);
  MORTISE_ASSIGN_OR_RETURN(const std::vector<std::string> services, ListServices());
  std::vector<std::string> candidates;
  for (const std::string& service : services) {
    const std::string full = absl::AsciiStrToLower(service);
    const std::string short_name = full.substr(full.rfind('.') + 1);
    const bool matches = full == wanted_service || short_name == wanted_service ||
                         absl::StripSuffix(short_name, "service") == wanted_service;
    if (!matches) continue;
    const google::protobuf::ServiceDescriptor* descriptor = pool_->FindServiceByName(service);
    if (descriptor == nullptr) continue;
    if (const auto* method = descriptor->FindMethodByName(wanted_method)) return method;
    for (int i = 0; i < descriptor->method_count(); ++i) {
      candidates.push_back(absl::StrCat(service, "/", descriptor->method(i)->name()));
    }
  }
  return NoSuchMethod(name, services, candidates);
}

}  // namespace mortise::cli
