// What the methods of CatalogService and AssemblyService stand on. They are in the files
// <resource>_methods.h, as plain functions.
#pragma once

#include <cstddef>

#include "services/catalog/records/parametrization_cache.h"
#include "services/catalog/records/template_cache.h"
#include "services/catalog/service/drawing_source.h"

namespace mortise::store {
class BlobFolder;
class Store;
}  // namespace mortise::store

namespace mortise::catalog {

// Thread safe.
class Catalog {
 public:
  // `store_with_records` and `uploads`, where drawings are kept that are uploaded, outlive it.
  Catalog(store::Store* store_with_records, store::BlobFolder* uploads)
      : store(store_with_records), blobs(uploads), drawings(store_with_records, uploads) {}

  store::Store* const store;
  store::BlobFolder* const blobs;
  ParametrizationCache parametrized{std::size_t{256} << 20, store};             // 256 MiB
  TemplateCache compiled{std::size_t{256} << 20, parametrized.ForTemplates()};  // 256 MiB
  DrawingSource drawings;
};

}  // namespace mortise::catalog
