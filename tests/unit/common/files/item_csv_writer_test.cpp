// Items as tables: what is written is read as the same items.
#include "common/files/item_csv_writer.h"

#include <gmock/gmock.h>
#include <google/protobuf/util/message_differencer.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "common/base/errors.h"
#include "common/files/collection.h"
#include "common/files/design_file.h"

namespace mortise::parametric {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::filesystem::path ShippedFolder() {
  const char* folder = std::getenv("MORTISE_SOURCE_DIR");
  return std::filesystem::path(folder == nullptr ? "." : folder) / "collection";
}

v1::Item Screw() {
  v1::Item item;
  item.set_name("items/screw");
  item.set_kind(v1::SCREW);
  item.set_material("materials/steel");
  for (int axis = v1::X; axis <= v1::Z; ++axis) {
    v1::ItemDimension& dimension = *item.add_dimensions();
    dimension.set_axis(static_cast<v1::Axis>(axis));
    dimension.set_size(0.1 * axis + 1e-17);
  }
  item.mutable_price()->set_currency("EUR");
  item.mutable_price()->set_amount(0.1);
  item.set_price_basis(v1::PER_PIECE);
  item.set_price_date("2026-01-15");
  return item;
}

TEST(ItemCsvWriter, AllItemsThatShipAreReadAgain) {
  const auto shipped = ReadCollection(ShippedFolder());
  ASSERT_TRUE(shipped.ok()) << shipped.status();
  ASSERT_GE(shipped->items.size(), 400u);
  const auto table = ItemsAsCsv(shipped->items);
  ASSERT_TRUE(table.ok()) << table.status();
  const DesignFile read = ParseDesignCsv(*table);
  EXPECT_TRUE(read.findings.empty()) << read.findings[0].field << read.findings[0].message;
  ASSERT_EQ(read.items.size(), shipped->items.size());
  google::protobuf::util::MessageDifferencer differencer;
  std::string differences;
  differencer.ReportDifferencesToString(&differences);
  // The order of measures is that of columns.
  differencer.TreatAsSet(v1::Item::descriptor()->FindFieldByName("measures"));
  for (std::size_t i = 0; i < read.items.size(); ++i) {
    EXPECT_TRUE(differencer.Compare(shipped->items[i], read.items[i].message))
        << shipped->items[i].name() << ": " << differences;
  }
}

TEST(ItemCsvWriter, CellsHoldAnyText) {
  v1::Item item = Screw();
  item.set_title("3\" \"wood\" screw,\r\nlong; größer");
  item.add_external_ids("100-4711/A");
  item.add_external_ids("4711");
  (*item.mutable_labels())["site"] = "a=b";
  (*item.mutable_labels())["stocked"] = "";
  v1::SupplierLink& link = *item.add_more_suppliers();
  link.set_supplier("Other, Merchant");
  link.set_number("7");
  v1::StockSize& stock = *item.add_stock_sizes();
  stock.set_length(2.44);
  stock.set_width(1.22);
  stock.set_price(0);
  const auto table = ItemsAsCsv({item});
  ASSERT_TRUE(table.ok()) << table.status();
  const DesignFile read = ParseDesignCsv(*table);
  ASSERT_EQ(read.items.size(), 1u);
  EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals(item, read.items[0].message))
      << *table;
}

TEST(ItemCsvWriter, SpreadsheetsRunNoCell) {
  v1::Item item = Screw();
  item.set_title("=HYPERLINK(\"http://a.example\", \"screw\")");
  item.set_supplier("@SUM(A1:A9)");
  item.set_supplier_number("-22");
  item.set_standard("'=1");
  item.add_external_ids("+cmd|' /C calc'!A0");
  const auto table = ItemsAsCsv({item});
  ASSERT_TRUE(table.ok()) << table.status();
  EXPECT_THAT(*table, HasSubstr(",\"'=HYPERLINK("));
  EXPECT_THAT(*table, HasSubstr(",'@SUM(A1:A9),"));
  EXPECT_THAT(*table, HasSubstr(",-22,"));
  EXPECT_THAT(*table, HasSubstr(",''=1,"));
  EXPECT_THAT(*table, HasSubstr(",'+cmd|"));
  const DesignFile read = ParseDesignCsv(*table);
  ASSERT_EQ(read.items.size(), 1u);
  EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals(item, read.items[0].message))
      << *table;
}

TEST(ItemCsvWriter, WhatNoCellCanHoldIsNamed) {
  v1::Item with_label = Screw();
  (*with_label.mutable_labels())["note"] = "a; b";
  v1::Item with_id = Screw();
  with_id.add_external_ids("1;2");
  v1::Item with_supplier = Screw();
  with_supplier.add_more_suppliers()->set_supplier("A | B");
  for (const v1::Item& item : {with_label, with_id, with_supplier}) {
    const auto table = ItemsAsCsv({Screw(), item});
    EXPECT_EQ(DetailOf(table.status()).reason, "NOT_IN_CSV");
    EXPECT_EQ(DetailOf(table.status()).field, "items/screw");
  }
}

TEST(ItemCsvWriter, NoItemsAreAHeader) {
  const auto table = ItemsAsCsv({});
  ASSERT_TRUE(table.ok());
  EXPECT_THAT(*table, StartsWith("\xef\xbb\xbfname,title,kind,material,length,"));
  EXPECT_THAT(*table, HasSubstr("price_is_example\r\n"));
}

}  // namespace
}  // namespace mortise::parametric
