#include "tests/e2e/good_requests.h"

#include <google/protobuf/text_format.h>
#include <grpcpp/client_context.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <thread>

#include "absl/strings/escaping.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "mortise/v1/assembly.grpc.pb.h"
#include "mortise/v1/audit.pb.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "mortise/v1/composer.grpc.pb.h"
#include "mortise/v1/events.pb.h"
#include "mortise/v1/fabplanner.grpc.pb.h"
#include "mortise/v1/gateway.pb.h"
#include "mortise/v1/interpolator.grpc.pb.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "mortise/v1/pareto.grpc.pb.h"
#include "mortise/v1/retrieval.pb.h"
#include "mortise/v1/simulator.grpc.pb.h"
#include "tests/e2e/request_examples.h"

namespace mortise::e2e {
namespace {

using google::protobuf::FileDescriptor;
using google::protobuf::Message;

[[noreturn]] void Fail(const std::string& what) {
  std::fprintf(stderr, "the requests cannot be made: %s\n", what.c_str());
  std::abort();
}

template <class Request>
Request Parse(const std::string& text) {
  Request request;
  if (!google::protobuf::TextFormat::ParseFromString(text, &request)) Fail(text);
  return request;
}

template <class Stub, class Request, class Response>
Response Call(Stub& stub,
              grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
              const Request& request) {
  grpc::ClientContext context;
  Response response;
  const grpc::Status status = (stub.*method)(&context, request, &response);
  if (!status.ok()) Fail(status.error_message());
  return response;
}

// The message inside an operation's result, once it has succeeded.
template <class Result>
Result ResultOf(v1::OperationService::Stub& operations, const v1::Operation& started) {
  v1::WaitOperationRequest wait;
  wait.set_name(started.name());
  const auto done = Call(operations, &v1::OperationService::Stub::WaitOperation, wait);
  Result result;
  if (!done.result().UnpackTo(&result)) Fail(done.ShortDebugString());
  return result;
}

// Until nothing more happens by itself: no evaluation is left over from the discovery, and the work
// order has reported that it waits for machines.
void AwaitQuiet(v1::SimulatorService::Stub& simulator, v1::OperationService::Stub& operations,
                const std::string& work_order_operation) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  v1::GetOperationRequest get;
  get.set_name(work_order_operation);
  while (std::chrono::steady_clock::now() < deadline) {
    const auto queue =
        Call(simulator, &v1::SimulatorService::Stub::GetQueueStatus, v1::GetQueueStatusRequest());
    const auto order = Call(operations, &v1::OperationService::Stub::GetOperation, get);
    if (queue.queued() + queue.leased() == 0 && order.progress().total() > 0) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  Fail("the house does not come to rest");
}

// An assembly as a STEP file, escaped.
std::string StepOf(v1::AssemblyService::Stub& assemblies, const std::string& name) {
  v1::ExportAssemblyRequest request;
  request.set_name(name);
  request.set_format(v1::ExportDesignRequest::STEP);
  grpc::ClientContext context;
  const auto reader = assemblies.ExportAssembly(&context, request);
  std::string bytes;
  v1::Chunk chunk;
  while (reader->Read(&chunk)) bytes += chunk.data();
  const grpc::Status status = reader->Finish();
  if (!status.ok()) Fail(status.error_message());
  return absl::CEscape(bytes);
}

// What stands for an assembly, its parameters as drawn, and a size that can be asked for.
void NameAssembly(const std::shared_ptr<grpc::Channel>& channel,
                  std::map<std::string, std::string>& names) {
  v1::AssemblyService::Stub assemblies(channel);
  names["{assembly}"] = Call(assemblies, &v1::AssemblyService::Stub::GetAssembly,
                             Parse<v1::GetAssemblyRequest>("name: 'assemblies/planter'"))
                            .ShortDebugString();
  const auto described = Call(assemblies, &v1::AssemblyService::Stub::ParametrizeAssembly,
                              Parse<v1::ParametrizeAssemblyRequest>("name: 'assemblies/planter'"));
  names["{q}"] = absl::StrJoin(described.q(), ", ", [](std::string* out, double number) {
    absl::StrAppendFormat(out, "%.17g", number);
  });
  if (described.sizes().empty()) Fail("the assembly has no size that can be changed");
  names["{measure}"] = described.sizes(0).measure().ShortDebugString();
  names["{size}"] = absl::StrFormat("%.17g", described.sizes(0).drawn());
  names["{step}"] = StepOf(assemblies, "assemblies/bookshelf");
}

// Uploads a mesh of one tetrahedron.
std::string UploadMesh(v1::SimulatorService::Stub& simulator) {
  grpc::ClientContext context;
  v1::UploadBlobResponse response;
  const auto writer = simulator.UploadBlob(&context, &response);
  v1::Chunk chunk;
  chunk.set_data(kMesh);
  chunk.set_total_size(static_cast<int64_t>(chunk.data().size()));
  writer->Write(chunk);
  writer->WritesDone();
  if (!writer->Finish().ok()) Fail("the mesh was not taken");
  return response.sha256();
}

// Composes a model of two planters, of which one is not connected, at revision 3.
std::string MakeModel(const std::shared_ptr<grpc::Channel>& channel) {
  v1::ComposerService::Stub composer(channel);
  Call(composer, &v1::ComposerService::Stub::CreateModel,
       Parse<v1::CreateModelRequest>("request_id: 'good-6' model_id: 'composed'"));
  Call(composer, &v1::ComposerService::Stub::AddComponent,
       Parse<v1::AddComponentRequest>("request_id: 'good-7' name: 'models/composed' revision: 1 "
                                      "template: 'templates/planter'"));
  return Call(composer, &v1::ComposerService::Stub::AddComponent,
              Parse<v1::AddComponentRequest>(
                  "request_id: 'good-8' name: 'models/composed' revision: 2 "
                  "template: 'templates/planter' component_id: 'loose' position { x: 1.5 }"))
      .name();
}

// What stands for the names in the examples.
std::map<std::string, std::string> MakeResources(const std::shared_ptr<grpc::Channel>& channel) {
  v1::CatalogService::Stub catalog(channel);
  v1::SimulatorService::Stub simulator(channel);
  v1::ParetoService::Stub pareto(channel);
  v1::FabPlannerService::Stub planner(channel);
  v1::InterpolatorService::Stub interpolator(channel);
  v1::OperationService::Stub operations(channel);
  std::map<std::string, std::string> names;

  const auto discovering =
      Call(pareto, &v1::ParetoService::Stub::DiscoverFront,
           Parse<v1::DiscoverFrontRequest>(std::string("request_id: 'good-1' specification {") +
                                           kDiscovery + "}"));
  const auto mapping =
      Call(interpolator, &v1::InterpolatorService::Stub::BuildMap,
           Parse<v1::BuildMapRequest>(std::string("request_id: 'good-9' specification {") +
                                      kMapSpecification + "}"));
  const auto analysing =
      Call(simulator, &v1::SimulatorService::Stub::AnalyzeDesign,
           Parse<v1::AnalyzeDesignRequest>("request_id: 'good-2' template: 'templates/table' "
                                           "mesh { element_size: 0.3 linear: true }"));
  const auto planning =
      Call(planner, &v1::FabPlannerService::Stub::CreatePlan,
           Parse<v1::CreatePlanRequest>("request_id: 'good-3' template: 'templates/table'"));
  names["{operation}"] = planning.name();
  names["{plan}"] = ResultOf<v1::Plan>(operations, planning).name();
  const auto releasing = Call(
      planner, &v1::FabPlannerService::Stub::ReleaseWorkOrder,
      Parse<v1::ReleaseWorkOrderRequest>("request_id: 'good-4' plan: '" + names["{plan}"] + "'"));
  names["{order}"] = releasing.subject();
  const auto analysis = ResultOf<v1::Analysis>(operations, analysing);
  names["{analysis}"] = analysis.name();
  for (const v1::ParameterValue& value : analysis.parameters()) {
    names["{point}"] += (names["{point}"].empty() ? "" : ", ") + std::to_string(value.value());
  }
  names["{front}"] = ResultOf<v1::Front>(operations, discovering).name();
  names["{map}"] = ResultOf<v1::DesignMap>(operations, mapping).name();
  AwaitQuiet(simulator, operations, releasing.name());
  names["{model}"] = MakeModel(channel);

  names["{template}"] = Call(catalog, &v1::CatalogService::Stub::GetTemplate,
                             Parse<v1::GetTemplateRequest>("name: 'templates/table'"))
                            .ShortDebugString();
  auto item = Call(catalog, &v1::CatalogService::Stub::GetItem,
                   Parse<v1::GetItemRequest>("name: 'items/board-38x89'"));
  item.clear_name();
  item.clear_revision();
  names["{item}"] = item.ShortDebugString();
  names["{discovery}"] = kDiscovery;
  names["{mapping}"] = kMapSpecification;
  names["{tetrahedron}"] = kTetrahedron;
  names["{shape}"] =
      Call(catalog, &v1::CatalogService::Stub::ImportShape,
           Parse<v1::ImportShapeRequest>(std::string("request_id: 'good-5' format: STL file: '") +
                                         kTetrahedron + "'"))
          .name();
  names["{mesh}"] = UploadMesh(simulator);
  NameAssembly(channel, names);
  return names;
}

// The files of the protos, which this also makes sure are part of the program.
std::vector<const FileDescriptor*> Files() {
  return {v1::GetItemRequest::descriptor()->file(),
          v1::GetAssemblyRequest::descriptor()->file(),
          v1::EvaluateBatchRequest::descriptor()->file(),
          v1::AnalyzeDesignRequest::descriptor()->file(),
          v1::DiscoverFrontRequest::descriptor()->file(),
          v1::BuildMapRequest::descriptor()->file(),
          v1::CreatePlanRequest::descriptor()->file(),
          v1::SearchShapesRequest::descriptor()->file(),
          v1::CreateModelRequest::descriptor()->file(),
          v1::GetOperationRequest::descriptor()->file(),
          v1::ReadEventsRequest::descriptor()->file(),
          v1::ListAuditRecordsRequest::descriptor()->file(),
          v1::CreateWebhookRequest::descriptor()->file()};
}

std::unique_ptr<Message> MakeMessage(const google::protobuf::Descriptor* type,
                                     const std::string& text) {
  std::unique_ptr<Message> message(
      google::protobuf::MessageFactory::generated_factory()->GetPrototype(type)->New());
  if (!google::protobuf::TextFormat::ParseFromString(text, message.get())) Fail(text);
  return message;
}

}  // namespace

std::vector<GoodRequest> MakeGoodRequests(const std::shared_ptr<grpc::Channel>& channel) {
  const std::map<std::string, std::string> names = MakeResources(channel);
  std::map<std::string, const Example*> examples;
  for (const Example& example : kExamples) {
    examples[std::string("mortise.v1.") + example.method] = &example;
  }
  std::vector<GoodRequest> requests;
  for (const FileDescriptor* file : Files()) {
    for (int i = 0; i < file->service_count(); ++i) {
      const auto* service = file->service(i);
      for (int j = 0; j < service->method_count(); ++j) {
        GoodRequest request;
        request.descriptor = service->method(j);
        request.method = service->full_name() + "/" + service->method(j)->name();
        const auto example = examples.find(request.method);
        if (example == examples.end()) continue;
        request.outcome = example->second->outcome;
        request.message = MakeMessage(request.descriptor->input_type(),
                                      absl::StrReplaceAll(example->second->request, names));
        requests.push_back(std::move(request));
      }
    }
  }
  return requests;
}

}  // namespace mortise::e2e
