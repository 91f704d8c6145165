// The public contract as data: every proto file of the house, with its comments, built into the
// program. Routing, transcoding, reflection and the OpenAPI document are all made from it, so they
// cannot disagree.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace google::protobuf {
class DescriptorPool;
class DynamicMessageFactory;
class FileDescriptor;
class MethodDescriptor;
class ServiceDescriptor;
class FieldDescriptor;
}  // namespace google::protobuf

namespace mortise::gateway {

// Where a call goes.
enum class Destination {
  kService,      // to the service `MethodRoute::service`
  kByOperation,  // to the service named in an operation's name: "operations/pareto/0198c1"
  kByStream,     // to the service whose stream `routing_field` names
};

// How long calls of a method stay open, and what they must not stand in the way of.
enum class CallKind {
  kCall,    // one answer, when the work is done
  kWait,    // one answer, when something has happened
  kStream,  // many messages, for as long as either side likes
  kUrgent,  // one answer, whatever the load
};

// One method of the house.
struct MethodRoute {
  std::string path;       // "/mortise.v1.CatalogService/GetItem"
  std::string full_name;  // "mortise.v1.CatalogService/GetItem"
  const google::protobuf::MethodDescriptor* descriptor = nullptr;
  Destination destination = Destination::kService;
  std::string service;  // "catalog"; "gateway" for what it hosts itself; empty unless kService
  const google::protobuf::FieldDescriptor* routing_field = nullptr;  // of the request
  int role = 0;          // least mortise.v1.Role a caller needs; 0: nobody may call
  bool mutates = false;  // changes something
  CallKind kind = CallKind::kCall;
  bool client_streaming = false;
  bool server_streaming = false;
  std::size_t index = 0;  // its place in Contract::methods()
};

// Whether a method gives one file: a stream of mortise.v1.Chunk, of one request that changes
// nothing.
bool GivesFile(const MethodRoute& method);

// Whether a method takes one file: a stream of mortise.v1.Chunk, answered once.
bool TakesFile(const MethodRoute& method);

class Contract {
 public:
  // Reads the descriptors that were built in. They are part of the program, so this cannot fail.
  static std::unique_ptr<const Contract> Load();

  ~Contract();
  Contract(const Contract&) = delete;
  Contract& operator=(const Contract&) = delete;

  const google::protobuf::DescriptorPool& pool() const { return *pool_; }

  // Files of the house itself (mortise/…), without their imports.
  const std::vector<const google::protobuf::FileDescriptor*>& files() const { return files_; }

  // By path, in the order of the files.
  const std::vector<MethodRoute>& methods() const { return methods_; }

  // Returns the method of an HTTP/2 path such as "/mortise.v1.CatalogService/GetItem"; null if
  // unknown.
  const MethodRoute* Find(std::string_view path) const;

  // Whether `bytes` are a message of the type that the method takes. Slow: they are decoded.
  bool IsRequest(const MethodRoute& method, const std::string& bytes) const;

  // Names of the services behind the gateway that own methods: "catalog", "composer", …
  const std::vector<std::string>& services() const { return services_; }

 private:
  Contract();

  void AddService(const google::protobuf::ServiceDescriptor& service, const std::string& owner);

  std::unique_ptr<google::protobuf::DescriptorPool> pool_;
  std::unique_ptr<google::protobuf::DynamicMessageFactory> messages_;  // of pool_; thread safe
  std::vector<const google::protobuf::FileDescriptor*> files_;
  std::vector<MethodRoute> methods_;
  std::unordered_map<std::string_view, std::size_t> by_path_;
  std::vector<std::string> services_;
};

// Returns the serialised FileDescriptorSet that is built in: imports first, comments included.
std::string_view ContractBytes();

// Returns the service an operation belongs to: "pareto" of "operations/pareto/0198c1"; empty if the
// name is not of that form.
std::string_view ServiceOfOperation(std::string_view name);

}  // namespace mortise::gateway
