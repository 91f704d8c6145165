#include "gateway/contract/contract.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/dynamic_message.h>

#include <algorithm>
#include <cstdlib>

#include "mortise/v1/access.pb.h"

namespace mortise::gateway {
namespace {

constexpr char kPieceOfFile[] = "mortise.v1.Chunk";

namespace pb = google::protobuf;

// The service that answers the methods of a file is the one the file is named after, with these
// exceptions.
std::string OwnerOfFile(const std::string& file) {
  const auto slash = file.rfind('/') + 1;
  std::string stem = file.substr(slash, file.rfind('.') - slash);
  if (stem == "assembly") return "catalog";
  if (stem == "evaluator") return "simulator";
  if (stem == "operations" || stem == "events" || stem == "audit") return "gateway";
  return stem;
}

// Methods that every service has, and that the gateway passes on by what the request names.
void RouteByContent(MethodRoute& route) {
  const pb::Descriptor& request = *route.descriptor->input_type();
  const std::string& service = route.descriptor->service()->full_name();
  if (service == "mortise.v1.OperationService") {
    route.routing_field = request.FindFieldByName("name");
    if (route.routing_field != nullptr) route.destination = Destination::kByOperation;
  } else if (service == "mortise.v1.EventService") {
    route.routing_field = request.FindFieldByName("stream");
    if (route.routing_field != nullptr) route.destination = Destination::kByStream;
  }
  if (route.routing_field != nullptr) route.service.clear();
}

CallKind KindOf(const pb::MethodDescriptor& method, const v1::Access& access) {
  if (access.urgent()) return CallKind::kUrgent;
  if (method.client_streaming() || method.server_streaming()) return CallKind::kStream;
  return access.waits() ? CallKind::kWait : CallKind::kCall;
}

}  // namespace

bool GivesFile(const MethodRoute& method) {
  return method.server_streaming && !method.client_streaming && !method.mutates &&
         method.descriptor->output_type()->full_name() == kPieceOfFile;
}

bool TakesFile(const MethodRoute& method) {
  return method.client_streaming && !method.server_streaming &&
         method.descriptor->input_type()->full_name() == kPieceOfFile;
}

Contract::Contract()
    : pool_(std::make_unique<pb::DescriptorPool>()),
      messages_(std::make_unique<pb::DynamicMessageFactory>(pool_.get())) {}
Contract::~Contract() = default;

std::unique_ptr<const Contract> Contract::Load() {
  pb::FileDescriptorSet set;
  const std::string_view bytes = ContractBytes();
  if (!set.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) std::abort();

  std::unique_ptr<Contract> contract(new Contract);
  for (const pb::FileDescriptorProto& file : set.file()) {
    const pb::FileDescriptor* built = contract->pool_->BuildFile(file);
    if (built == nullptr) std::abort();
    if (!built->package().starts_with("mortise.")) continue;
    contract->files_.push_back(built);
    for (int i = 0; i < built->service_count(); ++i) {
      contract->AddService(*built->service(i), OwnerOfFile(file.name()));
    }
  }
  for (const MethodRoute& route : contract->methods_) {
    contract->by_path_.emplace(route.path, route.index);
    if (route.service.empty() || route.service == "gateway") continue;
    auto& services = contract->services_;
    if (std::find(services.begin(), services.end(), route.service) == services.end()) {
      services.push_back(route.service);
    }
  }
  std::sort(contract->services_.begin(), contract->services_.end());
  return contract;
}

void Contract::AddService(const pb::ServiceDescriptor& service, const std::string& owner) {
  for (int i = 0; i < service.method_count(); ++i) {
    const pb::MethodDescriptor& method = *service.method(i);
    MethodRoute route;
    route.full_name = service.full_name() + "/" + method.name();
    route.path = "/" + route.full_name;
    route.descriptor = &method;
    route.service = owner;
    const v1::Access& access = method.options().GetExtension(v1::access);
    route.role = access.role();
    route.mutates = access.mutates();
    route.kind = KindOf(method, access);
    route.client_streaming = method.client_streaming();
    route.server_streaming = method.server_streaming();
    route.index = methods_.size();
    RouteByContent(route);
    methods_.push_back(std::move(route));
  }
}

const MethodRoute* Contract::Find(std::string_view path) const {
  const auto found = by_path_.find(path);
  return found == by_path_.end() ? nullptr : &methods_[found->second];
}

bool Contract::IsRequest(const MethodRoute& method, const std::string& bytes) const {
  const std::unique_ptr<pb::Message> message(
      messages_->GetPrototype(method.descriptor->input_type())->New());
  return message->ParseFromString(bytes);
}

std::string_view ServiceOfOperation(std::string_view name) {
  constexpr std::string_view kPrefix = "operations/";
  if (!name.starts_with(kPrefix)) return {};
  name.remove_prefix(kPrefix.size());
  const auto slash = name.find('/');
  if (slash == 0 || slash == std::string_view::npos || slash + 1 == name.size()) return {};
  return name.substr(0, slash);
}

}  // namespace mortise::gateway
