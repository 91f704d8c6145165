#include "gateway/contract/openapi.h"

#include "gateway/contract/openapi_schema.h"
#include "mortise/v1/access.pb.h"

namespace mortise::gateway {
namespace {

namespace pb = google::protobuf;

constexpr char kErrorSchema[] = R"({
  "type": "object",
  "description": "Why a call failed.",
  "properties": {
    "code": {"type": "string", "description": "The gRPC code in lower case, such as not_found."},
    "message": {"type": "string", "description": "What a person can do about it."},
    "reason": {"type": "string", "description": "Which failure it is, in capitals; stable across releases."},
    "fields": {"type": "array", "description": "What is wrong with the request.", "items": {"type": "object", "properties": {
      "field": {"type": "string", "description": "Path of the field, such as parameters[1].value."},
      "message": {"type": "string", "description": "What is wrong with it."}}}},
    "details": {"type": "array", "items": {"type": "object", "properties": {
      "type": {"type": "string", "description": "Message type, such as google.rpc.ErrorInfo."},
      "value": {"type": "string", "contentEncoding": "base64", "description": "The message."},
      "debug": {"description": "The same as JSON."}}}}
  },
  "required": ["code"]
})";

constexpr char kEventsPath[] = R"({
  "summary": "Follow events as server-sent events.",
  "description": "Each event has the id \"stream:number\" (of all streams followed, separated by commas), its type as event name and a mortise.v1.Event as data. Reconnect with Last-Event-ID to miss nothing.",
  "operationId": "followEvents",
  "tags": ["HTTP"],
  "parameters": [
    {"name": "streams", "in": "query", "schema": {"type": "string"}, "description": "Services, separated by commas; all if absent."},
    {"name": "types", "in": "query", "schema": {"type": "string"}, "description": "Prefixes of event types, separated by commas; all if absent."},
    {"name": "after", "in": "query", "schema": {"type": "integer", "format": "int64"}, "description": "Begin after this number in each stream: 0 from the first, -1 only new ones, the default."},
    {"name": "Last-Event-ID", "in": "header", "schema": {"type": "string"}, "description": "The id of the last event seen; counts more than `after`."}],
  "responses": {"200": {"description": "Events, until the client leaves.", "content": {"text/event-stream": {"schema": {"type": "string"}}}}}
})";

constexpr char kWatchPath[] = R"({
  "summary": "Watch an operation as server-sent events.",
  "description": "Each event is named \"operation\" and has a mortise.v1.Operation as data; the stream ends when the operation is done.",
  "operationId": "watchOperation",
  "tags": ["HTTP"],
  "parameters": [
    {"name": "service", "in": "path", "required": true, "schema": {"type": "string"}},
    {"name": "id", "in": "path", "required": true, "schema": {"type": "string"}}],
  "responses": {"200": {"description": "States of the operation.", "content": {"text/event-stream": {"schema": {"type": "string"}}}}}
})";

constexpr char kItemsPath[] = R"({
  "get": {
    "summary": "Items as comma-separated values.",
    "description": "All items that meet the filters, which are the fields of mortise.v1.ListItemsRequest but for its pages, in one table that spreadsheets read. Needs the role VIEWER.",
    "operationId": "readItems",
    "tags": ["HTTP"],
    "parameters": [
      {"name": "kind", "in": "query", "schema": {"type": "string"}, "description": "Only this kind, such as BOLT."},
      {"name": "material", "in": "query", "schema": {"type": "string"}, "description": "Only of this material."},
      {"name": "text", "in": "query", "schema": {"type": "string"}, "description": "Only those with each of these words."},
      {"name": "filter.externalId", "in": "query", "schema": {"type": "string"}, "description": "Only the one that another system knows by this."},
      {"name": "filter.creator", "in": "query", "schema": {"type": "string"}, "description": "Only those that this subject made."},
      {"name": "If-None-Match", "in": "header", "schema": {"type": "string"}}],
    "responses": {
      "200": {"description": "The table.", "content": {"text/csv": {"schema": {"type": "string"}}}},
      "304": {"description": "It is as it was."},
      "default": {"$ref": "#/components/responses/error"}},
    "x-mortise-role": "VIEWER"
  },
  "post": {
    "summary": "Imports items as comma-separated values.",
    "description": "Stores all rows or, with every fault named by its place, none. Needs the role DESIGNER.",
    "operationId": "importItems",
    "tags": ["HTTP"],
    "parameters": [
      {"name": "Idempotency-Key", "in": "header", "schema": {"type": "string"}, "description": "The request id of ImportCatalog; made if absent."}],
    "requestBody": {"required": true, "content": {"text/csv": {"schema": {"type": "string"}}}},
    "responses": {
      "200": {"description": "What became of each.", "content": {"application/json": {"schema": {"$ref": "#/components/schemas/mortise.v1.ImportCatalogResponse"}}}},
      "default": {"$ref": "#/components/responses/error"}},
    "x-mortise-role": "DESIGNER"
  }
})";

OrderedJson Content(const MethodRoute& method, const OrderedJson& schema) {
  if (!method.client_streaming && !method.server_streaming) {
    return {{"application/json", {{"schema", schema}}}};
  }
  // Enveloped messages have no schema of their own; x-message tells what is inside.
  return {{"application/connect+json",
           {{"schema", {{"type", "string"}, {"contentMediaType", "application/connect+json"}}},
            {"x-message", schema}}}};
}

std::string RoleName(int role) {
  return role == 0 ? "NOBODY" : v1::Role_Name(static_cast<v1::Role>(role));
}

OrderedJson Operation(const MethodRoute& method, SchemaCollection& schemas) {
  const pb::MethodDescriptor& descriptor = *method.descriptor;
  const std::string comment = CommentOf(descriptor);
  OrderedJson operation;
  operation["operationId"] = descriptor.service()->full_name() + "." + descriptor.name();
  operation["tags"] = {descriptor.service()->full_name()};
  operation["summary"] = comment.substr(0, comment.find(". "));
  operation["description"] = comment + (comment.empty() ? "" : " ") + "Needs the role " +
                             RoleName(method.role) +
                             (method.mutates ? "; leaves an audit record." : ".");
  operation["parameters"] = {{{"$ref", "#/components/parameters/connectProtocolVersion"}},
                             {{"$ref", "#/components/parameters/connectTimeout"}},
                             {{"$ref", "#/components/parameters/requestId"}}};
  operation["requestBody"] = {
      {"required", true}, {"content", Content(method, schemas.Refer(*descriptor.input_type()))}};
  operation["responses"] = {
      {"200",
       {{"description", method.server_streaming ? "Messages, each in an envelope." : "The answer."},
        {"content", Content(method, schemas.Refer(*descriptor.output_type()))}}},
      {"default", {{"$ref", "#/components/responses/error"}}}};
  operation["x-mortise-role"] = RoleName(method.role);
  operation["x-mortise-mutates"] = method.mutates;
  if (method.client_streaming) operation["x-mortise-client-streaming"] = true;
  if (method.server_streaming) operation["x-mortise-server-streaming"] = true;
  return operation;
}

OrderedJson QueryParameter(const std::string& name, const std::string& type,
                           const std::string& description) {
  return {
      {"name", name}, {"in", "query"}, {"schema", {{"type", type}}}, {"description", description}};
}

// The fields of a request as parameters of a URL: those that are one value by name, and all else by
// its path, or in the whole.
OrderedJson QueryParameters(const pb::Descriptor& request) {
  OrderedJson parameters = OrderedJson::array();
  for (int i = 0; i < request.field_count(); ++i) {
    const pb::FieldDescriptor& field = *request.field(i);
    if (field.is_repeated() || field.cpp_type() == pb::FieldDescriptor::CPPTYPE_MESSAGE) continue;
    const bool truth = field.cpp_type() == pb::FieldDescriptor::CPPTYPE_BOOL;
    parameters.push_back(
        QueryParameter(field.json_name(), truth ? "boolean" : "string", CommentOf(field)));
  }
  parameters.push_back(QueryParameter("message", "string",
                                      "Instead of all others, the whole request as JSON. Without "
                                      "it, parts of lists and messages are "
                                      "parameters by their path, such as parameters[0].name."));
  for (const char* header : {"Range", "If-Range", "If-None-Match"}) {
    parameters.push_back({{"name", header}, {"in", "header"}, {"schema", {{"type", "string"}}}});
  }
  return parameters;
}

OrderedJson AnyBytes(const char* description) {
  return {
      {"description", description},
      {"content",
       {{"application/octet-stream", {{"schema", {{"type", "string"}, {"format", "binary"}}}}}}}};
}

// The same method by GET.
OrderedJson FileOperation(const MethodRoute& method, const OrderedJson& call) {
  OrderedJson operation = call;
  operation["operationId"] = "get." + call["operationId"].get<std::string>();
  operation["parameters"] = QueryParameters(*method.descriptor->input_type());
  operation.erase("requestBody");
  operation.erase("x-mortise-server-streaming");
  operation["responses"] = {
      {"200", AnyBytes("The file, named, typed and with its SHA-256 as ETag.")},
      {"206", AnyBytes("A range of it.")},
      {"304", {{"description", "It is the one that If-None-Match names."}}},
      {"416", {{"$ref", "#/components/responses/error"}}},
      {"default", {{"$ref", "#/components/responses/error"}}}};
  return operation;
}

// The same method by PUT.
OrderedJson UploadOperation(const MethodRoute& method, const OrderedJson& call,
                            SchemaCollection& schemas) {
  OrderedJson operation = call;
  operation["operationId"] = "put." + call["operationId"].get<std::string>();
  operation["parameters"] = {{{"name", "Content-Digest"},
                              {"in", "header"},
                              {"description", "sha-256=:BASE64: has what comes checked."},
                              {"schema", {{"type", "string"}}}}};
  operation.erase("x-mortise-client-streaming");
  operation["requestBody"] = AnyBytes("The file as it is, with its length.");
  operation["requestBody"]["required"] = true;
  const OrderedJson answer = schemas.Refer(*method.descriptor->output_type());
  operation["responses"] = {
      {"200",
       {{"description", "The answer."}, {"content", {{"application/json", {{"schema", answer}}}}}}},
      {"default", {{"$ref", "#/components/responses/error"}}}};
  return operation;
}

OrderedJson PlainPath(const char* id, const char* summary, const char* media_type) {
  return {{"get",
           {{"operationId", id},
            {"summary", summary},
            {"tags", {"HTTP"}},
            {"security", OrderedJson::array()},
            {"responses",
             {{"200",
               {{"description", summary},
                {"content", {{media_type, {{"schema", {{"type", "string"}}}}}}}}}}}}}};
}

OrderedJson Header(const char* name, const char* description, OrderedJson schema) {
  return {{"name", name}, {"in", "header"}, {"description", description}, {"schema", schema}};
}

OrderedJson Components(SchemaCollection& schemas) {
  OrderedJson components;
  components["schemas"] = schemas.Take();
  components["schemas"]["connect.error"] = OrderedJson::parse(kErrorSchema);
  components["responses"]["error"] = {
      {"description", "The call failed; the status follows from the code."},
      {"content",
       {{"application/json", {{"schema", {{"$ref", "#/components/schemas/connect.error"}}}}}}}};
  components["parameters"] = {
      {"connectProtocolVersion", Header("Connect-Protocol-Version", "The version of the protocol.",
                                        {{"type", "string"}, {"const", "1"}})},
      {"connectTimeout", Header("Connect-Timeout-Ms", "After how many milliseconds to give up.",
                                {{"type", "integer"}, {"minimum", 0}})},
      {"requestId", Header("X-Request-Id", "An id for this call in logs; made if absent.",
                           {{"type", "string"}, {"maxLength", 128}})}};
  components["securitySchemes"]["bearer"] = {
      {"type", "http"}, {"scheme", "bearer"}, {"bearerFormat", "JWT"}};
  return components;
}

}  // namespace

std::string OpenApiDocument(const Contract& contract, std::string_view version) {
  SchemaCollection schemas;
  OrderedJson document;
  document["openapi"] = "3.1.0";
  document["info"] = {
      {"title", "Mortise"},
      {"version", version},
      {"description",
       "Computational design for manufacturing. Every method is a POST of JSON in the Connect "
       "protocol; methods that give a file answer GET, those that take one PUT. The same methods "
       "are "
       "served as gRPC on the other port."}};
  document["servers"] = {{{"url", "/"}}};
  document["security"] = {{{"bearer", OrderedJson::array()}}};
  document["tags"] = OrderedJson::array();
  const pb::ServiceDescriptor* tagged = nullptr;
  OrderedJson& paths = document["paths"];
  for (const MethodRoute& method : contract.methods()) {
    const pb::ServiceDescriptor* service = method.descriptor->service();
    if (service != tagged) {
      document["tags"].push_back(
          {{"name", service->full_name()}, {"description", CommentOf(*service)}});
      tagged = service;
    }
    OrderedJson& path = paths[method.path];
    path["post"] = Operation(method, schemas);
    if (GivesFile(method)) path["get"] = FileOperation(method, path["post"]);
    if (TakesFile(method)) path["put"] = UploadOperation(method, path["post"], schemas);
  }
  document["tags"].push_back({{"name", "HTTP"}, {"description", "What exists only over HTTP."}});
  paths["/events"]["get"] = OrderedJson::parse(kEventsPath);
  paths["/operations/{service}/{id}/watch"]["get"] = OrderedJson::parse(kWatchPath);
  paths["/items.csv"] = OrderedJson::parse(kItemsPath);
  paths["/healthz"] = PlainPath("health", "Whether the gateway serves.", "text/plain");
  paths["/version"] = PlainPath("version", "The gateway's version.", "application/json");
  paths["/metrics"] = PlainPath("metrics", "Metrics for Prometheus.", "text/plain");
  document["components"] = Components(schemas);
  return document.dump(1, ' ', false, OrderedJson::error_handler_t::replace);
}

}  // namespace mortise::gateway
