// Things for tests of ImportCatalog.
#pragma once

#include <cstddef>
#include <string>

#include "absl/strings/str_cat.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/support/status_assertions.h"

namespace mortise::catalog {

inline v1::Material Wood(const std::string& id) {
  v1::Material material;
  material.set_name("materials/" + id);
  material.set_title(id);
  material.set_density(690);
  material.set_youngs_modulus(12.5e9);
  material.set_poissons_ratio(0.36);
  material.set_strength(40e6);
  return material;
}

inline v1::Item Peg(const std::string& id, const std::string& material) {
  v1::Item item;
  item.set_name("items/" + id);
  item.set_title("Peg, 8 x 35 mm");
  item.set_kind(v1::DOWEL);
  item.set_material(material);
  item.set_price_basis(v1::PER_PIECE);
  item.mutable_price()->set_currency("EUR");
  item.mutable_price()->set_amount(0.07);
  item.set_price_date("2026-01-15");
  for (const auto& [axis, size] : {std::pair(v1::X, 0.035), {v1::Y, 0.008}, {v1::Z, 0.008}}) {
    v1::ItemDimension& dimension = *item.add_dimensions();
    dimension.set_axis(axis);
    dimension.set_size(size);
  }
  return item;
}

// A wood and so many pegs of it.
inline v1::ImportCatalogRequest ManyPegs(int count) {
  v1::ImportCatalogRequest request;
  request.set_request_id("many-pegs");
  *request.add_materials() = Wood("ash");
  for (int i = 0; i < count; ++i) {
    *request.add_items() = Peg(absl::StrCat("peg-", i), "materials/ash");
  }
  return request;
}

inline std::size_t CountItems(v1::CatalogService::Stub& stub) {
  v1::ListItemsRequest request;
  request.set_page_size(1000);
  std::size_t count = 0;
  do {
    const auto page = testing::Call(stub, &v1::CatalogService::Stub::ListItems, request);
    EXPECT_OK(page);
    if (!page.ok()) break;
    count += static_cast<std::size_t>(page->items_size());
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty());
  return count;
}

}  // namespace mortise::catalog
