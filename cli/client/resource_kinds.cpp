#include "cli/client/resource_kinds.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "mortise/v1/assembly.pb.h"
#include "mortise/v1/catalog.pb.h"
#include "mortise/v1/composer.pb.h"
#include "mortise/v1/evaluator.pb.h"
#include "mortise/v1/fabplanner.pb.h"
#include "mortise/v1/gateway.pb.h"
#include "mortise/v1/interpolator.pb.h"
#include "mortise/v1/operations.pb.h"
#include "mortise/v1/pareto.pb.h"
#include "mortise/v1/simulator.pb.h"

namespace mortise::cli {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::FileDescriptor;
using google::protobuf::MethodDescriptor;
using google::protobuf::ServiceDescriptor;

// The methods of a kind stand in the service that lists it, and are named after its message or, as
// those of DesignMap, after the last word of that.
const MethodDescriptor* MethodCalled(const ResourceKind& kind, const std::string& verb) {
  const std::string& resource = EntriesField(kind).message_type()->name();
  const ServiceDescriptor& service = *ListMethod(kind).service();
  const MethodDescriptor* const method = service.FindMethodByName(verb + resource);
  if (method != nullptr) return method;
  std::size_t last = resource.size();
  while (last > 0 && !absl::ascii_isupper(static_cast<unsigned char>(resource[last]))) --last;
  return service.FindMethodByName(verb + resource.substr(last));
}

// "work-orders" and "workOrders" are one word.
std::string Spelling(std::string_view word) {
  std::string letters;
  for (const char c : word) {
    if (c != '-') letters += absl::ascii_tolower(static_cast<unsigned char>(c));
  }
  return letters;
}

}  // namespace

const std::vector<ResourceKind>& ResourceKinds() {
  static const std::vector<ResourceKind> kKinds = {
      {"materials", &v1::ListMaterialsRequest::descriptor, "title"},
      {"items", &v1::ListItemsRequest::descriptor, "title"},
      {"assemblies", &v1::ListAssembliesRequest::descriptor, "title"},
      {"templates", &v1::ListTemplatesRequest::descriptor, "title"},
      {"evaluators", &v1::ListEvaluatorsRequest::descriptor, "title"},
      {"analyses", &v1::ListAnalysesRequest::descriptor, "template"},
      {"maps", &v1::ListMapsRequest::descriptor, "specification.subject", "shapes.geometry"},
      {"fronts", &v1::ListFrontsRequest::descriptor, "specification.subject"},
      {"plans", &v1::ListPlansRequest::descriptor, "template"},
      {"workOrders", &v1::ListWorkOrdersRequest::descriptor, "plan"},
      {"models", &v1::ListModelsRequest::descriptor, "title"},
      {"webhooks", &v1::ListWebhooksRequest::descriptor, "url"},
      {"operations", &v1::ListOperationsRequest::descriptor, "subject"},
  };
  return kKinds;
}

std::string ResourceKindNames() {
  return absl::StrJoin(ResourceKinds(), ", ",
                       [](std::string* out, const ResourceKind& kind) { out->append(kind.names); });
}

const ResourceKind* FindKind(std::string_view word) {
  const auto& kinds = ResourceKinds();
  const auto found = std::find_if(kinds.begin(), kinds.end(), [&](const ResourceKind& kind) {
    return Spelling(kind.names) == Spelling(word);
  });
  return found == kinds.end() ? nullptr : &*found;
}

absl::StatusOr<const ResourceKind*> KindOfName(const std::string& name) {
  const std::size_t slash = name.find('/');
  const ResourceKind* const kind =
      slash == std::string::npos ? nullptr : FindKind(std::string_view(name).substr(0, slash));
  if (kind != nullptr && slash + 1 < name.size()) return kind;
  return InvalidField("name", absl::StrCat("'", name,
                                           "' is no name such as items/board-38x89: it "
                                           "begins with one of ",
                                           ResourceKindNames()));
}

const MethodDescriptor& ListMethod(const ResourceKind& kind) {
  const Descriptor* const request = kind.list_request();
  const FileDescriptor& file = *request->file();
  const MethodDescriptor* method = nullptr;
  for (int i = 0; i < file.service_count() && method == nullptr; ++i) {
    const ServiceDescriptor& service = *file.service(i);
    for (int k = 0; k < service.method_count(); ++k) {
      if (service.method(k)->input_type() == request) method = service.method(k);
    }
  }
  return *method;  // each kind has one, as a test checks
}

const FieldDescriptor& EntriesField(const ResourceKind& kind) {
  const Descriptor& response = *ListMethod(kind).output_type();
  int i = 0;
  while (!response.field(i)->is_repeated()) ++i;
  return *response.field(i);
}

const MethodDescriptor& GetMethod(const ResourceKind& kind) { return *MethodCalled(kind, "Get"); }

const MethodDescriptor* ChangeMethod(const ResourceKind& kind) {
  const MethodDescriptor* const update = MethodCalled(kind, "Update");
  return update != nullptr ? update : MethodCalled(kind, "Import");
}

}  // namespace mortise::cli
