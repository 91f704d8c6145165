#include "gateway/http/items_handler.h"

#include <google/protobuf/descriptor.h>
#include <grpcpp/support/status.h>

#include <boost/asio/this_coro.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/violation_lists.h"
#include "common/files/design_file.h"
#include "common/files/item_csv_writer.h"
#include "common/rpc/status_mapping.h"
#include "gateway/contract/query_message.h"
#include "gateway/http/compression.h"
#include "gateway/http/connection_token_end.h"
#include "gateway/http/file_conditions.h"
#include "gateway/http/request_body.h"
#include "mortise/v1/catalog.pb.h"

namespace mortise::gateway {
namespace {

namespace asio = boost::asio;

constexpr char kListItems[] = "/mortise.v1.CatalogService/ListItems";
constexpr char kImportCatalog[] = "/mortise.v1.CatalogService/ImportCatalog";
constexpr int kPageOfItems = 1000;
constexpr std::size_t kMostItemBytes = 64 << 20;
constexpr int kItemsUnchanged = 304;
constexpr int kUnknownContentType = 415;
constexpr char kCsvType[] = "text/csv; charset=utf-8; header=present";

// Who may call a method.
absl::StatusOr<std::shared_ptr<const Caller>> CallerFor(const HttpContext& context,
                                                        const char* path,
                                                        const HttpRequest& request) {
  MORTISE_ASSIGN_OR_RETURN(auto caller, CallerOf(context, request));
  const MethodRoute* method = context.contract->Find(path);
  if (method == nullptr) return NotBuilt(path);
  MORTISE_RETURN_IF_ERROR(context.admission->Authorize(*method, *caller));
  return caller;
}

// The filters of a target's parameters. Pages are made here.
absl::StatusOr<v1::ListItemsRequest> ReadFilters(const HttpContext& context, const Target& target) {
  const auto& type = *context.contract->Find(kListItems)->descriptor->input_type();
  MORTISE_ASSIGN_OR_RETURN(const std::string json, JsonOfQuery(type, target.parameters));
  MORTISE_ASSIGN_OR_RETURN(const std::string bytes, context.transcoder->ToBinary(type, json));
  v1::ListItemsRequest filters;
  if (!filters.ParseFromString(bytes)) return InvalidField("request", "cannot be read");
  if (filters.page_size() != 0) {
    return InvalidField("page_size", "is not wanted: all items come in one table");
  }
  if (!filters.page_token().empty()) {
    return InvalidField("page_token", "is not wanted: all items come in one table");
  }
  filters.set_page_size(kPageOfItems);
  return filters;
}

// All items that meet the filters, page by page.
asio::awaitable<absl::StatusOr<std::vector<v1::Item>>> ReadItems(const HttpContext& context,
                                                                 const HttpRequest& request,
                                                                 v1::ListItemsRequest filters) {
  std::vector<v1::Item> items;
  std::size_t bytes = 0;
  do {
    const auto call =
        ClientCall::StartUnary(*context.stub, {kListItems, MetadataOf(request), std::nullopt},
                               filters.SerializeAsString());
    const std::optional<std::string> message = co_await call->Read();
    v1::ListItemsResponse page;
    if (!message) co_return rpc::FromGrpc(call->status());
    if (!page.ParseFromString(*message)) co_return absl::InternalError("a page cannot be read");
    bytes += message->size();
    if (bytes > kMostItemBytes) {
      co_return TooLarge("the items", absl::StrCat(kMostItemBytes, " bytes; filter them"));
    }
    for (v1::Item& item : *page.mutable_items()) items.push_back(std::move(item));
    filters.set_page_token(page.next_page_token());
  } while (!filters.page_token().empty());
  co_return items;
}

template <typename Message>
void PutPlace(const std::vector<parametric::Placed<Message>>& placed, const std::string& list,
              FieldViolation& violation) {
  const auto element = parametric::ElementOf(violation.field, list);
  if (!element || element->first >= placed.size()) return;
  const auto& read = placed[element->first];
  violation.field = absl::StrCat(parametric::PlaceOf(read.place, read.fields, element->second),
                                 element->second.empty() ? "" : ": ", element->second);
}

// A refusal by the catalog, with places in the table.
absl::Status InTable(const parametric::DesignFile& table, const absl::Status& status) {
  std::vector<FieldViolation> violations = AllViolationsOf(status);
  if (violations.empty()) return status;
  for (FieldViolation& violation : violations) {
    PutPlace(table.items, "items", violation);
    PutPlace(table.materials, "materials", violation);
  }
  return InvalidFields(violations);
}

absl::StatusOr<v1::ImportCatalogRequest> ReadTable(const parametric::DesignFile& table,
                                                   const HttpRequest& request) {
  std::vector<FieldViolation> findings = table.findings;
  if (table.unlisted > 0) {
    findings.push_back({"request", absl::StrCat("has ", table.unlisted, " more faults")});
  }
  if (!findings.empty()) return InvalidFields(findings);
  v1::ImportCatalogRequest import;
  const std::string_view key = HeaderOf(request, "idempotency-key");
  import.set_request_id(key.empty() ? NewIdentifier() : std::string(key));
  for (const auto& placed : table.items) *import.add_items() = placed.message;
  for (const auto& placed : table.materials) *import.add_materials() = placed.message;
  return import;
}

asio::awaitable<bool> Fail(HttpConnection& connection, const absl::Status& status,
                           bool keep_alive) {
  co_return co_await WriteError(connection, ToConnectError(status), {}, keep_alive) && keep_alive;
}

asio::awaitable<bool> RefuseTableType(HttpConnection& connection, bool keep_alive) {
  const HeaderList headers = {{"accept-post", "text/csv"}};
  const ConnectError error =
      ToConnectError(InvalidField("content-type", "items are imported as text/csv"));
  co_return co_await WriteErrorAs(kUnknownContentType, connection, error, headers, keep_alive) &&
      keep_alive;
}

asio::awaitable<bool> ImportTable(HttpConnection& connection, const HttpContext& context,
                                  const HttpRequest& request, const std::string& text) {
  const bool keep_alive = request.keep_alive();
  const parametric::DesignFile table = parametric::ParseDesignCsv(text);
  const auto import = ReadTable(table, request);
  if (!import.ok()) co_return co_await Fail(connection, import.status(), keep_alive);
  const auto call =
      ClientCall::StartUnary(*context.stub, {kImportCatalog, MetadataOf(request), std::nullopt},
                             import->SerializeAsString());
  const std::optional<std::string> message = co_await call->Read();
  if (!message) {
    const absl::Status refused = InTable(table, rpc::FromGrpc(call->status()));
    co_return co_await Fail(connection, refused, keep_alive);
  }
  auto json = context.transcoder->ToJson(
      *context.contract->Find(kImportCatalog)->descriptor->output_type(), *message);
  if (!json.ok()) co_return co_await Fail(connection, json.status(), keep_alive);
  const HeaderList headers = {{"content-type", "application/json"}};
  co_return co_await WriteCompressed(connection, request, 200, headers, *std::move(json),
                                     keep_alive) &&
      keep_alive;
}

}  // namespace

asio::awaitable<bool> HandleItems(HttpConnection& connection, const HttpContext& context,
                                  const Target& target, const HttpRequest& request) {
  const bool keep_alive = request.keep_alive();
  const auto caller = CallerFor(context, kListItems, request);
  if (!caller.ok()) co_return co_await Fail(connection, caller.status(), keep_alive);
  const auto filters = ReadFilters(context, target);
  if (!filters.ok()) co_return co_await Fail(connection, filters.status(), keep_alive);
  const auto place = context.answers->Take((*caller)->subject, 1);
  if (place == nullptr) {
    const absl::Status busy = TooManyAtATime("streams and waiting calls over HTTP");
    co_return co_await Fail(connection, busy, keep_alive);
  }
  const auto items = co_await ReadItems(context, request, *filters);
  if (!items.ok()) co_return co_await Fail(connection, items.status(), keep_alive);
  auto table = parametric::ItemsAsCsv(*items);
  if (!table.ok()) co_return co_await Fail(connection, table.status(), keep_alive);
  // Weak, as the same table is sent compressed and as it is.
  const std::string tag = absl::StrCat("\"", Sha256Hex(*table), "\"");
  HeaderList headers = {{"cache-control", "private, no-cache"}, {"etag", "W/" + tag}};
  if (NamesTag(HeaderOf(request, "if-none-match"), tag)) {
    co_return co_await connection.Write(kItemsUnchanged, headers, "", keep_alive) && keep_alive;
  }
  headers.emplace_back("content-type", kCsvType);
  headers.emplace_back("content-disposition", AttachmentNamed("items.csv"));
  headers.emplace_back("x-content-type-options", "nosniff");
  co_return co_await WriteCompressed(connection, request, 200, std::move(headers),
                                     *std::move(table), keep_alive) &&
      keep_alive;
}

asio::awaitable<bool> HandleItemsImport(HttpConnection& connection, const HttpContext& context,
                                        HttpRequest& request) {
  const bool keep_alive = request.keep_alive();
  const std::string_view type = HeaderOf(request, "content-type");
  if (type.substr(0, type.find(';')) != "text/csv") {
    co_return co_await RefuseTableType(connection, keep_alive);
  }
  const auto caller = CallerFor(context, kImportCatalog, request);
  if (!caller.ok()) co_return co_await Fail(connection, caller.status(), keep_alive);
  auto body = RequestBody::Expect(connection, context, request, (*caller)->subject);
  if (!body.ok()) co_return co_await Fail(connection, body.status(), keep_alive);
  const HttpReadResult read = co_await body->Read(connection, request);
  if (read != HttpReadResult::kRead) {
    co_await WriteBodyFailure(connection, read);
    co_return false;
  }
  const auto text = body->Take(request);
  if (!text.ok()) co_return co_await Fail(connection, text.status(), keep_alive);
  co_return co_await ImportTable(connection, context, request, *text);
}

}  // namespace mortise::gateway
