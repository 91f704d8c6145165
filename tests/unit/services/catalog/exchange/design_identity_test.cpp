#include "services/catalog/exchange/design_identity.h"

#include <gtest/gtest.h>

#include "mortise/v1/template.pb.h"

namespace mortise::catalog {
namespace {

DesignIdentity TableIdentity() {
  v1::Template table;
  table.set_revision(3);
  table.add_external_ids("100-4711/A");
  table.add_external_ids("second");
  table.mutable_create_time()->set_seconds(1'700'000'000);
  google::protobuf::RepeatedPtrField<v1::Item> items;
  v1::Item& screw = *items.Add();
  screw.set_name("items/screw");
  screw.set_revision(5);
  screw.add_external_ids("S-1");
  return IdentityOf(table, items);
}

TEST(DesignIdentity, TheWholeHasTheFirstExternalIdAndTheTimeOfItsRevision) {
  const DesignIdentity identity = TableIdentity();
  EXPECT_EQ(identity.whole.id, "100-4711/A");
  EXPECT_EQ(identity.whole.revision, "3");
  EXPECT_EQ(identity.time_stamp, "2023-11-14T22:13:20");
  EXPECT_EQ(StepTime({}), "");
}

TEST(DesignIdentity, WhatIsBoughtHasThatOfItsItem) {
  parametric::EvaluatedPart part;
  part.item = "items/screw";
  part.material = "materials/steel";
  const cad::StepIdentity bought = ProductIdentity(part, TableIdentity());
  EXPECT_EQ(bought.id, "S-1");
  EXPECT_EQ(bought.revision, "5");
  EXPECT_EQ(bought.description, "items/screw, revision 5, materials/steel");
  part.process = parametric::Process::kChopSaw;
  const cad::StepIdentity cut = ProductIdentity(part, TableIdentity());
  EXPECT_EQ(cut.id, "");
  EXPECT_EQ(cut.revision, "3");
  EXPECT_EQ(cut.description, bought.description);
  part.item.clear();
  EXPECT_EQ(ProductIdentity(part, TableIdentity()).description, "materials/steel");
}

TEST(DesignIdentity, ProductsHaveNoIdInCommon) {
  std::vector<cad::StepProduct> products(4);
  products[0].identity = {.id = "S-1", .description = "items/screw"};
  products[1].identity = {.id = "H-2", .description = "items/hinge"};
  products[2].identity = {.id = "S-1"};
  ShareNoIds(products);
  EXPECT_EQ(products[0].identity.id, "");
  EXPECT_EQ(products[0].identity.description, "S-1, items/screw");
  EXPECT_EQ(products[1].identity.id, "H-2");
  EXPECT_EQ(products[1].identity.description, "items/hinge");
  EXPECT_EQ(products[2].identity.description, "S-1");
  EXPECT_EQ(products[3].identity.description, "");
}

}  // namespace
}  // namespace mortise::catalog
