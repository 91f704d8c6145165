// Many materials, items and templates at once, all or none. Each may use what comes with it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/resources/author.h"
#include "common/store/store.h"
#include "common/templates/template_codec.h"
#include "mortise/v1/catalog.pb.h"

namespace mortise::catalog {

// Returns the templates of a request as they will be stored, after everything in it has been
// checked against each other and the store. INVALID_ARGUMENT with all that is wrong, fields as the
// request has them ("items[3].price.amount"); templates are not judged by materials and items that
// are at fault themselves. Changes nothing. Takes up to seconds a template; CANCELLED as soon as
// `is_given_up`, which is asked before each design of a template that is tried.
absl::StatusOr<std::vector<v1::TemplateBundle>> PrepareImport(
    store::Store& store, const v1::ImportCatalogRequest& request,
    const std::function<bool()>& is_given_up, const templates::Parametrize& parametrize);

// Stores a request with its templates as PrepareImport has made them. What others changed
// meanwhile is replaced like everything else; what they removed is INVALID_ARGUMENT as above where
// something of the request needs it. What is there keeps its external ids where the request has
// none of it, and so its labels. Template revisions keep the items that were there when they were
// prepared.
absl::StatusOr<v1::ImportCatalogResponse> ImportCatalog(
    store::Transaction& transaction, const v1::ImportCatalogRequest& request,
    const std::vector<v1::TemplateBundle>& templates, const resources::Author& author);

}  // namespace mortise::catalog
