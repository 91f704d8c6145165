// A request for every method of the house that is right, as text; good_requests.h makes messages of
// them.
#pragma once

#include "tests/e2e/good_requests.h"

namespace mortise::e2e {

// A tetrahedron, in millimetres, as a text in protobuf text.
inline constexpr char kTetrahedron[] =
    "solid t\\n"
    "facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0 9 0 vertex 9 0 0 endloop endfacet\\n"
    "facet normal 0 0 0 outer loop vertex 0 0 0 vertex 9 0 0 vertex 0 0 9 endloop endfacet\\n"
    "facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0 0 9 vertex 0 9 0 endloop endfacet\\n"
    "facet normal 0 0 0 outer loop vertex 9 0 0 vertex 0 9 0 vertex 0 0 9 endloop endfacet\\n"
    "endsolid t\\n";

inline constexpr char kMesh[] =
    "*NODE\n1, 0, 0, 0\n2, 9, 0, 0\n3, 0, 9, 0\n4, 0, 0, 9\n*ELEMENT, TYPE=C3D4, ELSET=body\n"
    "1, 1, 2, 3, 4\n*SURFACE, NAME=base\n1, S1\n*NSET, NSET=tip\n4\n";

struct Example {
  const char* method;
  const char* request;  // text format; {plan} and so on stand for names
  Outcome outcome = Outcome::kOk;
};

inline constexpr Example kExamples[] = {
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
    {"CatalogService/PlaceTemplate",
     "request_id: 'bad-91' name: 'templates/deck' revision: 1 height_fields { name: 'ground' "
     "title: 'Bank' datum: 300 grid { x: -1 y: -1 x_spacing: 2.5 y_spacing: 5 columns: 3 "
     "heights: [300, 300.1, 300.2, 300.1, 300, 299.9] } }",
     Outcome::kChanges},
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
     "airflow { wind { x: -10 } temperature: 300 pressure: 1e5 cells: 2000 } "
     "design_fields { geometry: TETRAHEDRA fields: 'von_mises' regions: 'top/cap' position_step: "
     "1e-6 "
     "modes: 1 } gradients: true "
     "difference_step: 0.01",
     Outcome::kChanges},
    {"EvaluatorService/CreateEvaluator",
     "request_id: 'bad-40' evaluator { name: 'evaluators/bad' title: 'Bad' version: '1' space { "
     "parameters { name: 'x' unit: 'm' minimum: 0 maximum: 2 default_value: 1 step: 0.5 } "
     "metrics { name: 'y' unit: 'kg' description: 'Mass.' offers_gradient: true } "
     "geometry: TETRAHEDRA "
     "fields { name: 'f' unit: 'Pa' components: 1 description: 'Stress.' } } }",
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
     "airflow { wind { x: -10 } temperature: 300 pressure: 1e5 cells: 2000 } solver: ITERATIVE "
     "setup { boundary_conditions { name: 'held' kind: FIXED face: 'apron_front/y_min' } }",
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
    {"InterpolatorService/BuildMap", "request_id: 'bad-52' specification { {mapping} }",
     Outcome::kChanges},
    {"InterpolatorService/GetMap", "name: '{map}'"},
    {"InterpolatorService/ListMaps", "page_size: 10"},
    {"InterpolatorService/EvaluateMap",
     "name: '{map}' points: [1.3, 1.45] metrics: 'mass' gradients: true"},
    {"InterpolatorService/EvaluateMapShape",
     "name: '{map}' point: 1.3 fields: 'von_mises' metrics: 'mass' geometry: SURFACE",
     Outcome::kRefused},
    {"InterpolatorService/FollowMapShape", "begin { name: '{map}' metrics: 'mass' }",
     Outcome::kRefused},
    {"InterpolatorService/ExportMap", "name: '{map}' structure: 0 metrics: 'mass'"},
    {"InterpolatorService/OptimizeMap",
     "name: '{map}' objective: 'mass' starts: 2 seed: 1 limits { metric: 'mass' minimum: 0 "
     "maximum: 1e6 } "
     "fixed { name: 'length' value: 1.3 }"},
    {"InterpolatorService/VerifyMap", "request_id: 'bad-53' name: '{map}' points: 1.3",
     Outcome::kChanges},
    {"InterpolatorService/UpdateMap",
     "request_id: 'bad-54' map { name: 'maps/none' labels { key: 'a' value: 'b' } }",
     Outcome::kRefused},
    {"InterpolatorService/DeleteMap", "request_id: 'bad-55' name: 'maps/none'", Outcome::kRefused},
    {"ParetoService/DiscoverFront",
     "request_id: 'bad-7' specification { {discovery} } external_ids: '100-4711/A' "
     "labels { key: 'customer' value: 'acme' }",
     Outcome::kChanges},
    {"ParetoService/GetFront", "name: '{front}'"},
    {"ParetoService/ListFronts", "page_size: 10 states: BUDGET states: CONVERGED"},
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
     "rules { kerf: 0.003 board_trim: 0.01 sheet_trim: 0.01 sheet_spacing: 0.01 mitre_limit: 0.8 "
     "bevel_limit: 0.7 compound_cuts: true jigsaw_radius: 0.01 }",
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
    {"RetrievalService/DeleteIndex", "request_id: 'bad-90' name: 'indexes/voxel'",
     Outcome::kRefused},
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
    {"ComposerService/CreateModel",
     "request_id: 'bad-60' model_id: 'bad-model' title: 'Bad' external_ids: '100-4711/A' "
     "labels { key: 'customer' value: 'acme' }",
     Outcome::kChanges},
    {"ComposerService/GetModel", "name: '{model}'"},
    {"ComposerService/ListModels", "page_size: 10"},
    {"ComposerService/UpdateModel",
     "request_id: 'bad-61' model { name: '{model}' external_ids: '100-4711/A' } "
     "update_mask { paths: 'external_ids' }",
     Outcome::kChanges},
    {"ComposerService/DeleteModel", "request_id: 'bad-62' name: '{model}' revision: 3",
     Outcome::kChanges},
    {"ComposerService/ForkModel",
     "request_id: 'bad-63' name: '{model}' model_id: 'bad-fork' title: 'Fork'", Outcome::kChanges},
    {"ComposerService/AddComponent",
     "request_id: 'bad-64' name: '{model}' revision: 3 component_id: 'third' "
     "template: 'templates/planter' template_revision: 1 position { x: 2 } "
     "demands { measure { {measure} } value: {size} } turns: Z turns: Z",
     Outcome::kChanges},
    {"ComposerService/SnapComponent",
     "request_id: 'bad-65' name: '{model}' revision: 3 component: 'loose'", Outcome::kChanges},
    {"ComposerService/ConnectComponent",
     "request_id: 'bad-66' name: '{model}' revision: 3 component: 'none'", Outcome::kRefused},
    {"ComposerService/MoveComponent",
     "request_id: 'bad-67' name: '{model}' revision: 3 component: 'loose' position { x: 2 }",
     Outcome::kChanges},
    {"ComposerService/GetNodeControls", "name: '{model}'"},
    {"ComposerService/DragControl",
     "request_id: 'bad-68' name: '{model}' revision: 3 control: 'width' value: 1",
     Outcome::kChanges},
    {"ComposerService/RemoveNode",
     "request_id: 'bad-69' name: '{model}' revision: 3 component: 'loose'", Outcome::kChanges},
    {"ComposerService/UndoModel", "request_id: 'bad-70' name: '{model}' revision: 3",
     Outcome::kChanges},
    {"ComposerService/RedoModel", "request_id: 'bad-71' name: '{model}' revision: 3",
     Outcome::kRefused},
    {"ComposerService/SaveModel",
     "request_id: 'bad-72' name: '{model}' revision: 3 template_id: 'bad-saved' title: 'Saved'",
     Outcome::kRefused},
    {"ComposerService/DrawModel", "name: '{model}' width: 64 height: 48"},
    {"ComposerService/CheckModel", "name: '{model}'"},
    {"ComposerService/GetModelBill", "name: '{model}'"},
    {"ComposerService/SuggestComponents", "name: '{model}' count: 2"},
    {"ComposerService/PreviewDrag",
     "name: '{model}' revision: 3 control: 'width' value: 1.2 since_value: 1.1"},
    {"ComposerService/ListModelSteps", "name: '{model}' after_revision: 1 page_size: 10"},
    {"ComposerService/DragNode", "begin { name: '{model}' revision: 3 control: 'width' }"},
    {"ComposerService/TurnComponent",
     "request_id: 'bad-turn' name: '{model}' revision: 3 component: 'loose' turns: Z",
     Outcome::kChanges},
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
    {"WebhookService/TestWebhook", "name: 'webhooks/none'", Outcome::kRefused},
    {"WebhookService/RotateWebhookSecret",
     "request_id: 'bad-60' name: 'webhooks/none' overlap { seconds: 60 }", Outcome::kRefused},
    {"WebhookService/UpdateWebhook",
     "request_id: 'bad-25' webhook { name: 'webhooks/none' external_ids: '100-4711/A' } "
     "update_mask { paths: 'external_ids' }",
     Outcome::kRefused},
};

// Its mass is known without a mesh.
inline constexpr char kMapSpecification[] =
    "subject: 'templates/table' metrics { name: 'mass' noise_floor: 0.001 } "
    "metrics { name: 'slender' } "
    "metric_definitions { expressions { name: 'slender' unit: '1' expression: 'length / width' } } "
    "variations { parameter: 'length' minimum: 1.2 maximum: 1.5 } "
    "fixed { name: 'width' value: 0.8 } basis: LINEAR evaluations: 10 tolerance: 0.01 "
    "seconds: 60 seed: 1 mesh { element_size: 0.3 linear: true } "
    "airflow { wind { x: -10 } temperature: 300 pressure: 1e5 cells: 2000 } most_structures: 2";

inline constexpr char kDiscovery[] =
    "subject: 'templates/table' objectives { metric: 'mass' } "
    "objectives { metric: 'max_displacement' } "
    "bounds { parameter: 'length' minimum: 1.2 maximum: 1.5 } evaluations: 10 seed: 1 "
    "mesh { element_size: 0.3 linear: true } "
    "metric_definitions { expressions { name: 'slender' unit: '1' expression: 'length / width' } } "
    "airflow { wind { x: -10 } temperature: 300 pressure: 1e5 cells: 2000 } "
    "constraints { metric: 'slender' minimum: 1 maximum: 10 }";

}  // namespace mortise::e2e
