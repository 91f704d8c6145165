#include "gateway/forwarding/reflection.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "gateway/admission/call_time.h"
#include "gateway/contract/contract.h"
#include "gateway/forwarding/wire.h"
#include "reflection_wire.pb.h"

namespace mortise::gateway {
namespace {

namespace pb = google::protobuf;

// A file and everything it imports, each once; the file first, as the protocol suggests.
void AddFile(const pb::FileDescriptor& file, std::set<std::string>& added,
             wire::FileDescriptorResponse& response) {
  if (!added.insert(file.name()).second) return;
  pb::FileDescriptorProto proto;
  file.CopyTo(&proto);
  response.add_file_descriptor_proto(proto.SerializeAsString());
  for (int i = 0; i < file.dependency_count(); ++i) AddFile(*file.dependency(i), added, response);
}

void Describe(const pb::FileDescriptor* file, const std::string& what,
              wire::ReflectionResponse& response) {
  if (file == nullptr) {
    response.mutable_error_response()->set_error_code(grpc::StatusCode::NOT_FOUND);
    response.mutable_error_response()->set_error_message("there is no '" + what + "'");
    return;
  }
  std::set<std::string> added;
  AddFile(*file, added, *response.mutable_file_descriptor_response());
}

const pb::FileDescriptor* FileOfSymbol(const Contract& contract, const std::string& symbol) {
  const pb::FileDescriptor* file = contract.pool().FindFileContainingSymbol(symbol);
  if (file != nullptr) return file;
  // Not ours: health and reflection themselves.
  return pb::DescriptorPool::generated_pool()->FindFileContainingSymbol(symbol);
}

void ListServices(const Contract& contract, wire::ListServiceResponse& response) {
  std::set<std::string> names = {"grpc.health.v1.Health",
                                 "grpc.reflection.v1alpha.ServerReflection"};
  for (const MethodRoute& method : contract.methods()) {
    names.insert(method.descriptor->service()->full_name());
  }
  for (const std::string& name : names) response.add_service()->set_name(name);
}

void FindExtension(const Contract& contract, const wire::ExtensionRequest& request,
                   wire::ReflectionResponse& response) {
  const pb::Descriptor* type = contract.pool().FindMessageTypeByName(request.containing_type());
  const pb::FieldDescriptor* extension =
      type == nullptr ? nullptr
                      : contract.pool().FindExtensionByNumber(type, request.extension_number());
  Describe(extension == nullptr ? nullptr : extension->file(), request.containing_type(), response);
}

void ListExtensions(const Contract& contract, const std::string& name,
                    wire::ReflectionResponse& response) {
  const pb::Descriptor* type = contract.pool().FindMessageTypeByName(name);
  if (type == nullptr) return Describe(nullptr, name, response);
  std::vector<const pb::FieldDescriptor*> extensions;
  contract.pool().FindAllExtensions(type, &extensions);
  auto& answer = *response.mutable_all_extension_numbers_response();
  answer.set_base_type_name(name);
  for (const pb::FieldDescriptor* extension : extensions) {
    answer.add_extension_number(extension->number());
  }
}

wire::ReflectionResponse Answer(const Contract& contract, const wire::ReflectionRequest& request) {
  wire::ReflectionResponse response;
  response.set_valid_host(request.host());
  *response.mutable_original_request() = request;
  switch (request.message_request_case()) {
    case wire::ReflectionRequest::kFileByFilename:
      Describe(contract.pool().FindFileByName(request.file_by_filename()),
               request.file_by_filename(), response);
      break;
    case wire::ReflectionRequest::kFileContainingSymbol:
      Describe(FileOfSymbol(contract, request.file_containing_symbol()),
               request.file_containing_symbol(), response);
      break;
    case wire::ReflectionRequest::kFileContainingExtension:
      FindExtension(contract, request.file_containing_extension(), response);
      break;
    case wire::ReflectionRequest::kAllExtensionNumbersOfType:
      ListExtensions(contract, request.all_extension_numbers_of_type(), response);
      break;
    case wire::ReflectionRequest::kListServices:
      ListServices(contract, *response.mutable_list_services_response());
      break;
    case wire::ReflectionRequest::MESSAGE_REQUEST_NOT_SET:
      response.mutable_error_response()->set_error_code(grpc::StatusCode::INVALID_ARGUMENT);
      response.mutable_error_response()->set_error_message("the request asks for nothing");
      break;
  }
  return response;
}

class ReflectionStream final : public grpc::ServerGenericBidiReactor {
 public:
  ReflectionStream(const Contract& contract, grpc::CallbackServerContext& call,
                   std::unique_ptr<OpenCalls::Place> place, std::chrono::milliseconds time)
      : contract_(contract), place_(std::move(place)), time_(call, time) {
    StartRead(&message_);
  }

  void OnReadDone(bool ok) override {
    if (!ok) return Finish(grpc::Status::OK);
    wire::ReflectionRequest request;
    if (!request.ParseFromString(ToString(message_))) {
      return Finish({grpc::StatusCode::INVALID_ARGUMENT, "not a reflection request"});
    }
    message_ = ToByteBuffer(Answer(contract_, request).SerializeAsString());
    StartWrite(&message_);
  }

  void OnWriteDone(bool ok) override {
    if (!ok) return Finish(grpc::Status::CANCELLED);
    StartRead(&message_);
  }

  void OnDone() override { delete this; }

 private:
  const Contract& contract_;
  const std::unique_ptr<OpenCalls::Place> place_;
  grpc::ByteBuffer message_;
  const CallTime time_;
};

}  // namespace

bool IsReflection(std::string_view path) {
  return path == "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo" ||
         path == "/grpc.reflection.v1.ServerReflection/ServerReflectionInfo";
}

grpc::ServerGenericBidiReactor* MakeReflection(const Contract& contract,
                                               grpc::CallbackServerContext& call,
                                               std::unique_ptr<OpenCalls::Place> place,
                                               std::chrono::milliseconds time) {
  return new ReflectionStream(contract, call, std::move(place), time);
}

}  // namespace mortise::gateway
