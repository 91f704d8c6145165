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
#include "mortise/v1/events.pb.h"
#include "mortise/v1/fabplanner.grpc.pb.h"
#include "mortise/v1/gateway.pb.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "mortise/v1/pareto.grpc.pb.h"
#include "mortise/v1/retrieval.pb.h"
#include "mortise/v1/simulator.grpc.pb.h"

namespace mortise::e2e {
namespace {

using google::protobuf::FileDescriptor;
using google::protobuf::Message;

// A tetrahedron, in millimetres, as a text in protobuf text.
constexpr char kTetrahedron[] =
    "solid t\\n"
    "facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0 9 0 vertex 9 0 0 endloop endfacet\\n"
    "facet normal 0 0 0 outer loop vertex 0 0 0 vertex 9 0 0 vertex 0 0 9 endloop endfacet\\n"
    "facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0 0 9 vertex 0 9 0 endloop endfacet\\n"
    "facet normal 0 0 0 outer loop vertex 9 0 0 vertex 0 9 0 vertex 0 0 9 endloop endfacet\\n"
    "endsolid t\\n";

constexpr char kMesh[] =
    "*NODE\n1, 0, 0, 0\n2, 9, 0, 0\n3, 0, 9, 0\n4, 0, 0, 9\n*ELEMENT, TYPE=C3D4, ELSET=body\n"
    "1, 1, 2, 3, 4\n*SURFACE, NAME=base\n1, S1\n*NSET, NSET=tip\n4\n";

struct Example {
  const char* method;
  const char* request;  // text format; {plan} and so on stand for names
  Outcome outcome = Outcome::kOk;
};

constexpr Example kExamples[] = {
    {"CatalogService/ImportCatalog",
     "request_id: 'bad-42' "
     "materials { name: 'materials/elm' title: 'Elm' density: 560 youngs_modulus: 9e9 "
     "poissons_ratio: 0.3 strength: 5e7 } "
     "items { {item} name: 'items/imported-board' } "
     "templates { {template} }",
     Outcome::kChanges},
    {"CatalogService/GetMaterial", "name: 'materials/spruce'"},
    {"CatalogService/ListMaterials", "page_size: 10"},
    {"CatalogService/CreateMaterial",
     "request_id: 'bad-1' material { name: 'materials/ash' title: 'Ash' density: 700 "
     "youngs_modulus: 1.2e10 poissons_ratio: 0.3 strength: 9e7 }",
     Outcome::kChanges},
    {"CatalogService/UpdateMaterial",
     "request_id: 'bad-21' material { name: 'materials/spruce' title: 'Spruce' density: 450 "
     "youngs_modulus: 1.2e10 poissons_ratio: 0.3 strength: 3e7 revision: 1 }",
     Outcome::kChanges},
    {"CatalogService/DeleteMaterial", "request_id: 'bad-22' name: 'materials/spruce' revision: 1",
     Outcome::kChanges},
    {"CatalogService/GetItem", "name: 'items/board-38x89'"},
    {"CatalogService/ListItems", "page_size: 10 kind: BOARD"},
    {"CatalogService/CreateItem", "request_id: 'bad-2' item { {item} name: 'items/new-board' }",
     Outcome::kChanges},
    {"CatalogService/UpdateItem",
     "request_id: 'bad-3' item { {item} name: 'items/board-38x89' revision: 1 }",
     Outcome::kChanges},
    {"CatalogService/DeleteItem", "request_id: 'bad-4' name: 'items/board-38x89' revision: 1",
     Outcome::kChanges},
    {"CatalogService/ImportShape", "request_id: 'bad-18' file: '{tetrahedron}' format: STL",
     Outcome::kChanges},
    {"CatalogService/GetShape", "name: '{shape}'"},
    {"CatalogService/DownloadShape", "name: '{shape}'"},
    {"CatalogService/GetTemplate", "name: 'templates/table' revision: 1"},
    {"CatalogService/ListTemplates", "page_size: 10"},
    {"CatalogService/ImportTemplate",
     "request_id: 'bad-5' expected_revision: 1 template { {template} }", Outcome::kChanges},
    {"CatalogService/DeleteTemplate", "request_id: 'bad-43' name: 'templates/table' revision: 1",
     Outcome::kChanges},
    {"CatalogService/GetTemplateBundle", "name: 'templates/table'"},
    {"CatalogService/EvaluateTemplate",
     "name: 'templates/table' parameters { name: 'length' value: 1.5 }"},
    {"CatalogService/ExportDesign",
     "name: 'templates/table' parameters { name: 'length' value: 1.5 } format: GLB"},
    {"AssemblyService/GetAssembly", "name: 'assemblies/planter' revision: 1"},
    {"AssemblyService/ListAssemblies", "page_size: 10"},
    {"AssemblyService/ImportAssembly",
     "request_id: 'bad-16' expected_revision: 1 assembly { {assembly} }", Outcome::kChanges},
    {"AssemblyService/ImportAssemblyStep",
     "request_id: 'bad-17' step: '{step}' annotations { name: 'assemblies/drawn' "
     "parts { parts: 'screw left 1.1' item: 'items/screw-4x40' role: CONNECTING } }",
     Outcome::kChanges},
    {"AssemblyService/ImportAssemblyMesh",
     "request_id: 'bad-51' file: '{tetrahedron}' file_name: 't.stl' length_unit: 'mm' up: Z "
     "most_parts: 10 annotations { name: 'assemblies/meshed' tolerance: 0.0001 }",
     Outcome::kChanges},
    {"AssemblyService/DeleteAssembly",
     "request_id: 'bad-44' name: 'assemblies/planter' revision: 1", Outcome::kChanges},
    {"AssemblyService/UploadDrawing", "data: 'abc' total_size: 4", Outcome::kRefused},
    {"AssemblyService/ParametrizeAssembly", "name: 'assemblies/planter' revision: 1"},
    {"AssemblyService/AdjustAssembly",
     "name: 'assemblies/planter' q: [{q}] "
     "demands { measure { {measure} } value: {size} }"},
    {"AssemblyService/EvaluateAssembly", "name: 'assemblies/planter' points { q: [{q}] }"},
    {"AssemblyService/SampleAssembly", "name: 'assemblies/planter' count: 2 seed: 7"},
    {"AssemblyService/ExportAssembly", "name: 'assemblies/planter' q: [{q}] format: GLB"},
    {"EvaluatorService/DescribeDesignSpace", "subject: 'templates/table'"},
    {"EvaluatorService/EvaluateBatch",
     "subject: 'templates/table' points { parameters: [{point}] } metrics: 'mass' metrics: "
     "'slender' "
     "mesh { element_size: 0.3 linear: true } metric_definitions { points { name: 'p' x: 'length' "
     "} "
     "expressions { name: 'slender' unit: '1' expression: \"distance('p', 'top/cap') / '2 m'\" } } "
     "airflow { wind { x: -10 } temperature: 300 pressure: 1e5 cells: 2000 } gradients: true "
     "difference_step: 0.01",
     Outcome::kChanges},
    {"EvaluatorService/CreateEvaluator",
     "request_id: 'bad-40' evaluator { name: 'evaluators/bad' title: 'Bad' version: '1' space { "
     "parameters { name: 'x' unit: 'm' minimum: 0 maximum: 2 default_value: 1 step: 0.5 } "
     "metrics { name: 'y' unit: 'kg' description: 'Mass.' offers_gradient: true } } }",
     Outcome::kChanges},
    {"EvaluatorService/GetEvaluator", "name: 'evaluators/none'", Outcome::kRefused},
    {"EvaluatorService/ListEvaluators", "page_size: 10"},
    {"EvaluatorService/DeleteEvaluator", "request_id: 'bad-41' name: 'evaluators/none'",
     Outcome::kRefused},
    {"EvaluatorService/UpdateEvaluator",
     "request_id: 'bad-45' evaluator { name: 'evaluators/none' external_ids: '100-4711/A' } "
     "update_mask { paths: 'external_ids' }",
     Outcome::kRefused},
    {"SimulatorService/AnalyzeDesign",
     "request_id: 'bad-6' template: 'templates/table' parameters { name: 'length' value: 1.5 } "
     "mesh { element_size: 0.3 linear: true } "
     "airflow { wind { x: -10 } temperature: 300 pressure: 1e5 cells: 2000 } solver: ITERATIVE",
     Outcome::kChanges},
    {"SimulatorService/AnalyzeMesh",
     "request_id: 'bad-19' mesh_file: '{mesh}' case { title: 'Block' length_unit: 'mm' modes: 1 "
     "materials { groups: 'body' values { density: 450 youngs_modulus: 1e10 poissons_ratio: 0.3 "
     "strength: 3e7 thermal_expansion: 5e-6 thermal_conductivity: 0.13 } } "
     "supports { groups: 'base' fixed: true } "
     "load_cases { name: 'all' forces { groups: 'base' force { z: 1 } } "
     "pressures { groups: 'base' pressure: 10 } tractions { groups: 'base' traction { z: 1 } } "
     "point_forces { position { x: 1 } force { z: 1 } } "
     "nodal_forces { groups: 'tip' force { z: 1 } } gravity { z: -9.8 } body_force { z: 1 } "
     "rotation { angular_velocity { z: 1 } } thermal_stress: true } "
     "combinations { name: 'twice' terms { load_case: 'all' factor: 2 } } "
     "heat { temperatures { groups: 'base' temperature: 20 } fluxes { groups: 'base' flux: 1 } "
     "convections { groups: 'base' coefficient: 5 ambient: 20 } "
     "sources { groups: 'body' power: 1 } reference_temperature: 20 } "
     "probes { name: 'there' points { x: 1 } groups: 'tip' } solver: DIRECT }",
     Outcome::kChanges},
    {"SimulatorService/GetAnalysis", "name: '{analysis}'"},
    {"SimulatorService/ListAnalyses", "page_size: 10"},
    {"SimulatorService/UpdateAnalysis",
     "request_id: 'bad-46' analysis { name: 'analyses/none' labels { key: 'a' value: 'b' } }",
     Outcome::kRefused},
    {"SimulatorService/DownloadArtifact", "name: '{analysis}' file_name: 'stress.png'"},
    {"SimulatorService/LeaseTasks", "evaluator: 'evaluators/none' worker: 'nobody' limit: 1",
     Outcome::kRefused},
    {"SimulatorService/RenewLeases",
     "worker: 'nobody' lease_seconds: 10 "
     "tasks { name: 'tasks/none' attempt: 1 progress { stage: 'mesh' done: 1 total: 5 } }"},
    {"SimulatorService/ReportTask",
     "task { name: 'tasks/none' attempt: 1 } result { metrics { name: 'mass' unit: 'kg' value: 1 } "
     "}",
     Outcome::kRefused},
    {"SimulatorService/UploadBlob", "data: 'abc' total_size: 4", Outcome::kRefused},
    {"SimulatorService/DownloadBlob", "sha256: '{mesh}'"},
    {"SimulatorService/GetQueueStatus", "evaluator: 'simulator'"},
    {"SimulatorService/ListTasks", "page_size: 10 state: DONE"},
    {"ParetoService/DiscoverFront",
     "request_id: 'bad-7' specification { {discovery} } external_ids: '100-4711/A' "
     "labels { key: 'customer' value: 'acme' }",
     Outcome::kChanges},
    {"ParetoService/GetFront", "name: '{front}'"},
    {"ParetoService/ListFronts", "page_size: 10"},
    {"ParetoService/UpdateFront",
     "request_id: 'bad-47' front { name: 'fronts/none' labels { key: 'a' value: 'b' } }",
     Outcome::kRefused},
    {"ParetoService/PickPoint",
     "name: '{front}' metric { name: 'mass' unit: 'kg' value: 20 } improve: 'mass' steps: 2"},
    {"ParetoService/RestrictFront",
     "name: '{front}' limits { name: 'mass' minimum: 1 maximum: 30 } limits { name: 'height' "
     "minimum: 0.1 }"},
    {"ParetoService/ExportFront", "name: '{front}' format: CSV"},
    {"FabPlannerService/CreatePlan",
     "request_id: 'bad-8' template: 'templates/table' template_revision: 1 quantity: 1 "
     "parameters { name: 'length' value: 1.5 } "
     "rules { kerf: 0.003 board_trim: 0.01 sheet_trim: 0.01 sheet_spacing: 0.01 }",
     Outcome::kChanges},
    {"FabPlannerService/GetPlan", "name: '{plan}'"},
    {"FabPlannerService/ListPlans", "page_size: 10"},
    {"FabPlannerService/DownloadArtifact", "name: '{plan}' file_name: 'cut-list.csv'"},
    {"FabPlannerService/ReleaseWorkOrder", "request_id: 'bad-9' plan: '{plan}'", Outcome::kChanges},
    {"FabPlannerService/GetWorkOrder", "name: '{order}'"},
    {"FabPlannerService/ListWorkOrders", "page_size: 10"},
    {"FabPlannerService/HoldWorkOrder", "request_id: 'bad-10' name: '{order}'", Outcome::kChanges},
    {"FabPlannerService/ResumeWorkOrder", "request_id: 'bad-11' name: '{order}'",
     Outcome::kChanges},
    {"FabPlannerService/AttachBridge",
     "hello { bridge: 'bad-bridge' next_report_number: 1 "
     "machines { name: 'saw' kind: CHOP_SAW_WITH_FEEDER state: 'IDLE' } }",
     Outcome::kChanges},
    {"FabPlannerService/ListBridges", ""},
    {"FabPlannerService/UpdatePlan",
     "request_id: 'bad-23' plan { name: '{plan}' external_ids: '100-4711/A' } "
     "update_mask { paths: 'external_ids' }",
     Outcome::kChanges},
    {"FabPlannerService/UpdateWorkOrder",
     "request_id: 'bad-24' work_order { name: '{order}' external_ids: '100-4711/A' } "
     "update_mask { paths: 'external_ids' }",
     Outcome::kChanges},
    {"RetrievalService/SearchShapes",
     "mesh { file: '{tetrahedron}' file_name: 't.stl' length_unit: 'mm' up: Z } "
     "shape_descriptor: VOXEL limit: 3 templates: 'templates/table' categories: 'table' "
     "design_filter { min_size { x: 0.1 y: 0.1 z: 0.1 } max_size { x: 3 y: 3 z: 3 } "
     "materials: 'materials/pine' max_price { currency: 'EUR' amount: 200 } "
     "items { item: 'items/board' quantity: 4 } }",
     Outcome::kRefused},
    {"RetrievalService/UploadMesh", "data: 'abc' total_size: 4", Outcome::kRefused},
    {"RetrievalService/BuildIndex", "request_id: 'bad-50' templates: 'templates/table'",
     Outcome::kChanges},
    {"RetrievalService/GetIndex", "name: 'indexes/voxel'", Outcome::kRefused},
    {"RetrievalService/ListIndexFamilies", "name: 'indexes/voxel' page_size: 10",
     Outcome::kRefused},
    {"RetrievalService/ListIndexes", "page_size: 10"},
    {"RetrievalService/LeaseCover",
     "worker: 'nobody' cover_version: 'none' lease_seconds: 10 wait_seconds: 1", Outcome::kRefused},
    {"RetrievalService/RenewCover",
     "task: 'tasks/0000000000000000000000000000000000000000000000000000000000000000' attempt: 1 "
     "lease_seconds: 10"},
    {"RetrievalService/ReportCover",
     "task: 'tasks/0000000000000000000000000000000000000000000000000000000000000000' attempt: 1 "
     "cover { shape_descriptor: D2 digest: 'none' fault: 'none' evaluations: 1 } last: true "
     "lease_seconds: 10",
     Outcome::kRefused},
    {"RetrievalService/UploadCover", "data: 'abc' total_size: 4", Outcome::kRefused},
    {"OperationService/GetOperation", "name: '{operation}'"},
    {"OperationService/ListOperations",
     "page_size: 10 service: 'fabplanner' kind: 'fabplanner.plan' subject: 'templates/table' "
     "omit_results: true"},
    {"OperationService/CancelOperation", "request_id: 'bad-12' name: '{operation}'",
     Outcome::kChanges},
    {"OperationService/WaitOperation", "name: '{operation}' timeout_seconds: 1"},
    {"OperationService/WatchOperation", "name: '{operation}'"},
    {"EventService/ListStreams", ""},
    {"EventService/ReadEvents", "stream: 'catalog' limit: 10"},
    {"EventService/FollowEvents", "streams: 'catalog' after_number: 1", Outcome::kChanges},
    {"AuditService/ListAuditRecords", "page_size: 10 service: 'catalog'"},
    {"GatewayService/GetHouse", ""},
    {"WebhookService/CreateWebhook",
     "request_id: 'bad-13' url: 'https://192.0.2.1/hook' streams: 'catalog'", Outcome::kChanges},
    {"WebhookService/GetWebhook", "name: 'webhooks/none'", Outcome::kRefused},
    {"WebhookService/ListWebhooks", "page_size: 10"},
    {"WebhookService/DeleteWebhook", "request_id: 'bad-14' name: 'webhooks/none'",
     Outcome::kRefused},
    {"WebhookService/ReplayWebhook",
     "request_id: 'bad-15' name: 'webhooks/none' stream: 'catalog' after_number: 1",
     Outcome::kRefused},
    {"WebhookService/ListDeadLetters", "name: 'webhooks/none'", Outcome::kRefused},
    {"WebhookService/UpdateWebhook",
     "request_id: 'bad-25' webhook { name: 'webhooks/none' external_ids: '100-4711/A' } "
     "update_mask { paths: 'external_ids' }",
     Outcome::kRefused},
};

constexpr char kDiscovery[] =
    "subject: 'templates/table' objectives { metric: 'mass' } "
    "objectives { metric: 'max_displacement' } "
    "bounds { parameter: 'length' minimum: 1.2 maximum: 1.5 } evaluations: 10 seed: 1 "
    "mesh { element_size: 0.3 linear: true } "
    "metric_definitions { expressions { name: 'slender' unit: '1' expression: 'length / width' } } "
    "airflow { wind { x: -10 } temperature: 300 pressure: 1e5 cells: 2000 } "
    "constraints { metric: 'slender' minimum: 1 maximum: 10 }";

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

// What stands for the names in the examples.
std::map<std::string, std::string> MakeResources(const std::shared_ptr<grpc::Channel>& channel) {
  v1::CatalogService::Stub catalog(channel);
  v1::SimulatorService::Stub simulator(channel);
  v1::ParetoService::Stub pareto(channel);
  v1::FabPlannerService::Stub planner(channel);
  v1::OperationService::Stub operations(channel);
  std::map<std::string, std::string> names;

  const auto discovering =
      Call(pareto, &v1::ParetoService::Stub::DiscoverFront,
           Parse<v1::DiscoverFrontRequest>(std::string("request_id: 'good-1' specification {") +
                                           kDiscovery + "}"));
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
  AwaitQuiet(simulator, operations, releasing.name());

  names["{template}"] = Call(catalog, &v1::CatalogService::Stub::GetTemplate,
                             Parse<v1::GetTemplateRequest>("name: 'templates/table'"))
                            .ShortDebugString();
  auto item = Call(catalog, &v1::CatalogService::Stub::GetItem,
                   Parse<v1::GetItemRequest>("name: 'items/board-38x89'"));
  item.clear_name();
  item.clear_revision();
  names["{item}"] = item.ShortDebugString();
  names["{discovery}"] = kDiscovery;
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
          v1::CreatePlanRequest::descriptor()->file(),
          v1::SearchShapesRequest::descriptor()->file(),
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
