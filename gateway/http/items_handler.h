// The catalogue's items as comma-separated values, for spreadsheets and PLM systems.
#pragma once

#include "gateway/contract/query.h"
#include "gateway/http/http_context.h"

namespace mortise::gateway {

inline constexpr char kItemsPath[] = "/items.csv";

// GET and HEAD: all items that meet the filters of ListItems, which are the target's parameters
// (query_message.h), in one table, with its digest as ETag. It takes the role of ListItems, and
// time and memory of a stream; RESOURCE_EXHAUSTED for more than 64 MiB of items.
boost::asio::awaitable<bool> HandleItems(HttpConnection& connection, const HttpContext& context,
                                         const Target& target, const HttpRequest& request);

// POST of such a table: imports its items, or materials if they have a density, as ImportCatalog
// does, all or none; answers with its answer. `Idempotency-Key` is its request id. Every fault is
// told by its place ("line 7, column 3 (price)").
boost::asio::awaitable<bool> HandleItemsImport(HttpConnection& connection,
                                               const HttpContext& context, HttpRequest& request);

}  // namespace mortise::gateway
