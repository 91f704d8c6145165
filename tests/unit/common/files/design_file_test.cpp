// Items as CSV and designs as JSON: what is read, and where each fault is.
#include "common/files/design_file.h"

#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>
#include <google/protobuf/util/message_differencer.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "common/base/files.h"
#include "common/base/identifiers.h"
#include "common/files/template_codec.h"
#include "tests/unit/common/files/table.h"

namespace mortise::parametric {
namespace {

using google::protobuf::util::MessageDifferencer;
using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr char kHeader[] =
    "name,title,kind,material,length_mm,width_mm,thickness_mm,price,currency,price_date\n";

auto At(const std::string& field, const std::string& message) {
  return testing::AllOf(Field(&FieldViolation::field, field),
                        Field(&FieldViolation::message, HasSubstr(message)));
}

std::string Listed(const std::vector<FieldViolation>& findings) {
  std::string text;
  for (const FieldViolation& finding : findings) {
    text += finding.field + ": " + finding.message + "\n";
  }
  return text;
}

TEST(ItemsCsv, FillsEveryField) {
  const DesignFile file = ParseDesignCsv(
      "name,title,kind,material,length_mm,length.process,length.minimum_mm,length.maximum_mm,"
      "width,width.nominal,width.name,thickness_mm,stock_sizes_mm,measure.edge_radius_mm,"
      "measure.edge_radius.minimum_mm,measure.edge_radius.maximum_mm,grain_axis,radial_axis,"
      "standard,designation,price,currency,price_basis,price_date,price_is_example,supplier,"
      "supplier_url,supplier_number,more_suppliers\n"
      "items/a,\"Board, \"\"planed\"\"\",BOARD,materials/oak,2440,CHOP_SAW,40,2440,0.089,0.1016,"
      "breadth,38.5,2440@6.4; 3050,3,2.5,3.5,X,Y,PS 20,2 x 4,6.4,EUR,PER_VOLUME,2026-01-15,true,"
      "Somebody,https://somebody.example/7,7,Other|https://other.example|9; Third\n");
  ASSERT_THAT(file.findings, IsEmpty()) << Listed(file.findings);
  ASSERT_THAT(file.items, SizeIs(1));
  v1::Item expected;
  ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(R"({
    "name": "items/a", "title": "Board, \"planed\"", "kind": "BOARD", "material": "materials/oak",
    "dimensions": [
      {"axis": "X", "size": 2.44, "process": "CHOP_SAW", "minimum": 0.04, "maximum": 2.44},
      {"axis": "Y", "size": 0.089, "nominal": 0.1016, "name": "breadth"},
      {"axis": "Z", "size": 0.0385}],
    "price": {"currency": "EUR", "amount": 6.4}, "price_basis": "PER_VOLUME",
    "price_date": "2026-01-15", "price_is_example": true, "supplier": "Somebody",
    "supplier_url": "https://somebody.example/7", "supplier_number": "7",
    "more_suppliers": [{"supplier": "Other", "url": "https://other.example", "number": "9"},
                       {"supplier": "Third"}],
    "standard": "PS 20", "designation": "2 x 4", "grain_axis": "X", "radial_axis": "Y",
    "measures": [{"name": "edge_radius", "size": 0.003, "minimum": 0.0025, "maximum": 0.0035}],
    "stock_sizes": [{"length": 2.44, "price": 6.4}, {"length": 3.05}]})",
                                                          &expected)
                  .ok());
  EXPECT_TRUE(MessageDifferencer::Equals(file.items[0].message, expected))
      << file.items[0].message.DebugString();
}

TEST(ItemsCsv, NamesLineAndColumnOfEveryFault) {
  const DesignFile file = ParseDesignCsv(
      std::string(kHeader) +
      "items/a,A,BOLD,materials/steel,40,8,8,0.1,EUR,2026-01-15\n"
      "items/b,\"B\nof two lines\",BOLT,materials/steel,\"40,5\",8,8,nan,EUR,2026-01-15\n");
  EXPECT_THAT(file.findings, SizeIs(3)) << Listed(file.findings);
  EXPECT_THAT(file.findings, Contains(At("line 2, column 3 (kind)", "'BOLD' is none of BOARD")));
  EXPECT_THAT(file.findings,
              Contains(At("line 4, column 5 (length_mm)", "'40,5' is no number, such as 12.5")));
  EXPECT_THAT(file.findings, Contains(At("line 4, column 8 (price)", "'nan' is no number")));
}

TEST(ItemsCsv, KnowsWhereEachFieldStands) {
  const DesignFile file = ParseDesignCsv(std::string(kHeader) +
                                         "items/a,A,BOLT,materials/steel,40,8,-8,0.1,EUR,soon\n");
  ASSERT_THAT(file.findings, IsEmpty()) << Listed(file.findings);
  const Placed<v1::Item>& placed = file.items.at(0);
  const auto item = FromProto(placed.message);
  ASSERT_TRUE(item.ok()) << item.status();
  std::vector<std::string> places;
  for (const FieldViolation& finding : ValidateItem(*item, {})) {
    places.push_back(PlaceOf(placed.place, placed.fields, finding.field));
  }
  EXPECT_THAT(places, testing::UnorderedElementsAre("line 2, column 4 (material)",
                                                    "line 2, column 7 (thickness_mm)",
                                                    "line 2, column 10 (price_date)"));
  EXPECT_EQ(PlaceOf(placed.place, placed.fields, "supplier_url"), "line 2");
}

TEST(ItemsCsv, RefusesHeadersThatItDoesNotUnderstand) {
  const auto findings = [](const std::string& header) { return ParseDesignCsv(header).findings; };
  EXPECT_THAT(findings("name,colour,kind,material,length,width,thickness,price,currency,"
                       "price_date,width_mm,title_mm,measure.Bore,length.size.minimum\n"),
              testing::ElementsAre(At("line 1, column 2", "no column 'colour'"),
                                   At("line 1, column 11", "'width' is there twice"),
                                   At("line 1, column 12", "no column 'title_mm'"),
                                   At("line 1, column 13", "no column 'measure.Bore'"),
                                   At("line 1, column 14", "no column 'length.size.minimum'")));
  EXPECT_THAT(findings("name,kind,length,width,thickness,currency,price_date\n"),
              testing::ElementsAre(At("line 1", "'material' is missing"),
                                   At("line 1", "'price' is missing")));
  EXPECT_THAT(findings(""), testing::ElementsAre(At("line 1", "is missing")));
}

// The header of a table that spreadsheets of other languages write is no single column.
TEST(ItemsCsv, SaysWhatSeparatesCellsButCommas) {
  const auto fault = [](const std::string& text) {
    const DesignFile file = ParseDesignCsv(text);
    EXPECT_THAT(file.findings, SizeIs(1)) << Listed(file.findings);
    EXPECT_THAT(file.items, IsEmpty());
    return Listed(file.findings);
  };
  EXPECT_THAT(fault("\xEF\xBB\xBFname;kind;price\r\nitems/a;NUT;2,95\r\n"),
              HasSubstr("line 1: separates cells by semicolons"));
  EXPECT_THAT(fault("name\tkind\tprice\nitems/a\tNUT\t2.95\n"),
              HasSubstr("line 1: separates cells by tabs"));
  EXPECT_THAT(fault("sep=;\r\nname;kind;price\r\n"),
              HasSubstr("line 1: separates cells by semicolons"));
  EXPECT_THAT(fault("sep=\t\nname\tkind\n"), HasSubstr("line 1: separates cells by tabs"));
  EXPECT_THAT(fault("name|kind\n"), HasSubstr("vertical bars"));
}

TEST(ItemsCsv, AHeaderAloneIsTold) {
  EXPECT_THAT(ParseDesignCsv(kHeader).findings,
              testing::ElementsAre(At("line 1", "names the columns, but no row follows")));
  EXPECT_THAT(ParseDesignCsv(kHeader + std::string(",,,\n")).findings,
              testing::ElementsAre(At("line 1", "names the columns, but no row follows")));
}

TEST(ItemsCsv, CountsWhatItDoesNotList) {
  std::string text = kHeader;
  for (int i = 0; i < 120; ++i) {
    text += "items/a,A,NUT,materials/steel,y,1,1,x,EUR,2026-01-15\n";
  }
  const DesignFile file = ParseDesignCsv(text);
  EXPECT_THAT(file.findings, SizeIs(100));
  EXPECT_EQ(file.unlisted, 140u);
}

TEST(ItemsCsv, ReadsWhatItCanOfRowsAndOfHeadersAtFault) {
  const DesignFile file =
      ParseDesignCsv(std::string("colour,") + kHeader +
                     "red,items/a,A,BOLD,materials/steel,40,8,eight,0.1,EUR,2026-01-15\n"
                     "red,items/short,B\n"
                     "red,items/\"c\",C,BOLT,materials/steel,40,8,8,0.1,EUR,2026-01-15\n"
                     "red,items/d,D,BOLT,materials/steel,40,8,8,0.1,EURO,2026-01-15\n");
  EXPECT_THAT(file.findings,
              testing::UnorderedElementsAre(At("line 1, column 1", "no column 'colour'"),
                                            At("line 2, column 4 (kind)", "BOLD"),
                                            At("line 2, column 8 (thickness_mm)", "eight"),
                                            At("line 3, column 1", "has 3 cells"),
                                            At("line 4, column 2", "quote")))
      << Listed(file.findings);
  ASSERT_THAT(file.items, SizeIs(2));
  EXPECT_THAT(file.items[0].unread, testing::ElementsAre("dimensions[Z].size", "kind"));
  EXPECT_TRUE(std::isnan(file.items[0].message.dimensions(2).size()));
  EXPECT_EQ(file.items[0].message.price().currency(), "EUR");
  EXPECT_THAT(file.items[1].unread, IsEmpty());
  EXPECT_EQ(file.items[1].message.name(), "items/d");
  EXPECT_THAT(file.unread_names, testing::ElementsAre("items/short"));
  const DesignFile without = ParseDesignCsv(
      "name,kind,material,length,thickness,price,price_date\n"
      "items/a,BOLT,materials/steel,0.04,0.008,0.1,2026-01-15\n");
  ASSERT_THAT(without.items, SizeIs(1));
  EXPECT_THAT(without.items[0].unread,
              testing::ElementsAre("dimensions[Y].size", "price.currency"));
}

TEST(ItemsCsv, TakesMillimetresAsTheNearestNumber) {
  for (const char* text : {"6.8", "0.1", "13.27", "68e-1", "1e1"}) {
    const DesignFile file = ParseDesignCsv(std::string(kHeader) + "items/a,A,NUT,materials/steel," +
                                           text + ",13,6.8,0.1,EUR,2026-01-15\n");
    ASSERT_THAT(file.findings, IsEmpty()) << Listed(file.findings);
    EXPECT_DOUBLE_EQ(file.items[0].message.dimensions(0).size(), std::stod(text) / 1000);
    EXPECT_EQ(file.items[0].message.dimensions(1).size(), 0.013);
    EXPECT_EQ(file.items[0].message.dimensions(2).size(), 0.0068);
  }
}

TEST(MaterialsCsv, FillsEveryField) {
  const DesignFile file = ParseDesignCsv(
      "name,title,density,youngs_modulus,poissons_ratio,strength,thermal_conductivity,"
      "thermal_expansion,orthotropic.youngs_modulus_l,orthotropic.poissons_ratio_rt\n"
      "materials/a,Ash,690,12.5e9,0.36,40e6,0.17,5e-6,12.5e9,0.68\n"
      "materials/b,Iron,7870,211e9,0.29,50e6,80,,,\n");
  ASSERT_THAT(file.findings, IsEmpty()) << Listed(file.findings);
  EXPECT_THAT(file.items, IsEmpty());
  ASSERT_THAT(file.materials, SizeIs(2));
  v1::Material expected;
  ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(R"({
    "name": "materials/a", "title": "Ash", "density": 690, "youngs_modulus": 12.5e9,
    "poissons_ratio": 0.36, "strength": 40e6, "thermal_conductivity": 0.17,
    "thermal_expansion": 5e-6,
    "orthotropic": {"youngs_modulus_l": 12.5e9, "poissons_ratio_rt": 0.68}})",
                                                          &expected)
                  .ok());
  EXPECT_TRUE(MessageDifferencer::Equals(file.materials[0].message, expected))
      << file.materials[0].message.DebugString();
  EXPECT_FALSE(file.materials[1].message.has_orthotropic());
  // What is missing has its column all the same.
  const auto ash = FromProto(file.materials[0].message);
  ASSERT_TRUE(ash.ok());
  const Placed<v1::Material>& placed = file.materials[0];
  const std::vector<FieldViolation> findings = ValidateMaterial(*ash);
  ASSERT_FALSE(findings.empty());
  EXPECT_EQ(PlaceOf(placed.place, placed.fields, findings[0].field), "line 2");
  EXPECT_EQ(PlaceOf(placed.place, placed.fields, "orthotropic.youngs_modulus_l"),
            "line 2, column 9 (orthotropic.youngs_modulus_l)");
}

TEST(MaterialsCsv, NamesThePlaceOfEveryFault) {
  const auto findings = [](const std::string& text) { return ParseDesignCsv(text).findings; };
  EXPECT_THAT(findings("name,density,revision,orthotropic,orthotropic.strength,density\n"),
              testing::ElementsAre(At("line 1, column 3", "no column 'revision'"),
                                   At("line 1, column 4", "no column 'orthotropic'"),
                                   At("line 1, column 5", "no column 'orthotropic.strength'"),
                                   At("line 1, column 6", "'density' is there twice"),
                                   At("line 1", "'youngs_modulus' is missing"),
                                   At("line 1", "'poissons_ratio' is missing"),
                                   At("line 1", "'strength' is missing")));
  EXPECT_THAT(findings("name,density,youngs_modulus,poissons_ratio,strength\n"
                       "materials/a,heavy,1e9,0.3,inf\n"),
              testing::ElementsAre(At("line 2, column 2 (density)", "'heavy' is no number"),
                                   At("line 2, column 5 (strength)", "'inf' is no number")));
}

TEST(DesignJson, ReadsWhatTheShippedCollectionSays) {
  const Collection collection = ShippedCollection();
  std::string items, materials;
  const auto add = [](const google::protobuf::Message& message, std::string& list) {
    std::string text;
    ASSERT_TRUE(google::protobuf::util::MessageToJsonString(message, &text).ok());
    list += (list.empty() ? "" : ",\n") + text;
  };
  for (const auto& item : collection.items) add(item, items);
  for (const auto& material : collection.materials) add(material, materials);
  const DesignFile file =
      ParseDesignJson("{\"materials\": [" + materials + "], \"items\": [" + items + "]}");
  ASSERT_THAT(file.findings, IsEmpty()) << Listed(file.findings);
  ASSERT_EQ(file.items.size(), collection.items.size());
  ASSERT_EQ(file.materials.size(), collection.materials.size());
  for (std::size_t i = 0; i < file.items.size(); ++i) {
    EXPECT_TRUE(MessageDifferencer::Equals(file.items[i].message, collection.items[i]));
  }
  // A list alone is one of items.
  EXPECT_EQ(ParseDesignJson("[" + items + "]").items.size(), collection.items.size());
}

TEST(DesignJson, NamesThePlaceOfEveryFault) {
  const DesignFile file = ParseDesignJson(R"({
  "items": [
    {"name": "items/a", "title": "with \"]}\" in it"},
    {"name": "items/b", "title": 3, "priceDate": "2026-01-15",
     "kind": "BOLD", "dimensions": [{"axis": "X", "size": "wide"}, 7, {"axis": "Z", "size": 2}]},
    7,
    {"nmae": "items/c", "title": "one", "title": "other"}
  ],
  "materials": {},
  "colours": [1, 2]
})");
  ASSERT_THAT(file.items, SizeIs(3));
  EXPECT_THAT(file.findings, SizeIs(9)) << Listed(file.findings);
  EXPECT_THAT(file.findings, Contains(At("line 4", "items[1].title: 3 must be a text")));
  EXPECT_THAT(file.findings,
              Contains(At("line 4", "items[1].kind: \"BOLD\" must be one of BOARD, ")));
  EXPECT_THAT(file.findings, Contains(At("line 4", "items[1].dimensions[0].size: \"wide\"")));
  EXPECT_THAT(file.findings, Contains(At("line 4", "items[1].dimensions[1]: must be an object")));
  // What can be read of the item is there.
  const Placed<v1::Item>& placed = file.items[1];
  EXPECT_EQ(placed.message.price_date(), "2026-01-15");
  EXPECT_TRUE(std::isnan(placed.message.dimensions(0).size()));
  EXPECT_EQ(placed.message.dimensions(2).size(), 2);
  EXPECT_THAT(placed.unread,
              testing::ElementsAre("dimensions[0].size", "dimensions[1]", "kind", "title"));
  EXPECT_THAT(file.findings, Contains(At("line 6", "items[2] must be an object")));
  EXPECT_THAT(file.findings, Contains(At("line 7", "nmae")));
  EXPECT_THAT(file.findings, Contains(At("line 7", "items[3].title: is there twice")));
  EXPECT_THAT(file.findings, Contains(At("line 9", "materials must be a list")));
  EXPECT_THAT(file.findings, Contains(At("line 10", "'colours' is none of")));
}

TEST(DesignJson, RefusesWhatIsNoJson) {
  const auto fault = [](std::string_view text) {
    const DesignFile file = ParseDesignJson(text);
    EXPECT_THAT(file.findings, SizeIs(1)) << text;
    return file.findings.empty() ? "" : file.findings[0].field + file.findings[0].message;
  };
  EXPECT_THAT(fault("{\n  \"items\": [,]\n}"), HasSubstr("line 2, column 13"));
  EXPECT_THAT(fault(""), HasSubstr("line 1, column 1"));
  EXPECT_THAT(fault("{\"items\": []} 3"), HasSubstr("line 1, column"));
  EXPECT_THAT(fault("3"), HasSubstr("must be an object"));
  EXPECT_THAT(fault("{\"items\": [], \"items\": []}"), HasSubstr("'items' is twice"));
  EXPECT_THAT(fault(std::string(100'000, '[')), HasSubstr("nested deeper"));
  EXPECT_THAT(fault("{\"items\": [\"caf\xE9\"]}"), HasSubstr("line 1, column"));
}

TEST(MaterialsCsv, SayWhetherThereIsAGrain) {
  const DesignFile file = ParseDesignCsv(
      "name,density,youngs_modulus,poissons_ratio,strength,grain\n"
      "materials/a,690,12.5e9,0.36,40e6,true\nmaterials/b,7870,211e9,0.29,50e6,false\n"
      "materials/c,900,3e9,0.3,40e6,\nmaterials/d,900,3e9,0.3,40e6,no\n");
  EXPECT_THAT(file.findings,
              testing::ElementsAre(At("line 5, column 6 (grain)", "must be true or false")));
  ASSERT_THAT(file.materials, SizeIs(4));
  EXPECT_TRUE(FromProto(file.materials[0].message)->HasGrain());
  EXPECT_FALSE(FromProto(file.materials[1].message)->HasGrain());
  // One that does not say is cut as if there were one, and stays one that does not say.
  EXPECT_TRUE(FromProto(file.materials[2].message)->HasGrain());
  EXPECT_FALSE(ToProto(*FromProto(file.materials[2].message)).has_grain());
  EXPECT_TRUE(ToProto(*FromProto(file.materials[1].message)).has_grain());
}

TEST(ItemsCsv, PricesAreDecimalAndMayBeLeftOutOfSizes) {
  const std::string header =
      "name,kind,material,length,width,thickness,price,currency,price_date,stock_sizes\n";
  const auto findings = [&](const std::string& price, const std::string& sizes) {
    return ParseDesignCsv(header + "items/a,BOARD,materials/b,3,0.1,0.02," + price +
                          ",EUR,2026-01-15," + sizes + "\n")
        .findings;
  };
  EXPECT_THAT(findings("0x10", ""),
              testing::ElementsAre(At("line 2, column 7 (price)", "no number")));
  EXPECT_THAT(findings("1", "3@0x10"),
              testing::ElementsAre(At("line 2, column 10 (stock_sizes)", "no number")));
  // Neither is 0 by 10.
  EXPECT_THAT(findings("1", "3@1;0x10@5"),
              testing::ElementsAre(
                  At("line 2, column 10 (stock_sizes)", "'0x10@5' is no size in decimal numbers")));
  const DesignFile file = ParseDesignCsv(header + "items/a,BOARD,materials/b,3,0.1,0.02,5,EUR," +
                                         "2026-01-15,3@5;2;1@0\n");
  ASSERT_THAT(file.findings, IsEmpty()) << Listed(file.findings);
  const Item item = *FromProto(file.items[0].message);
  EXPECT_EQ(item.stock_sizes[0].price.value_or(-1), 5);
  EXPECT_FALSE(item.stock_sizes[1].price.has_value());
  EXPECT_EQ(item.stock_sizes[2].price.value_or(-1), 0);
  EXPECT_FALSE(ToProto(item).stock_sizes(1).has_price());
  EXPECT_TRUE(ToProto(item).stock_sizes(2).has_price());
}

TEST(DesignFileOf, MayBeginWithAByteOrderMark) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("mortise-marked-file-" + NewIdentifier());
  const auto read = [&folder](const std::string& name, const std::string& text) {
    EXPECT_TRUE(WriteFile(folder / name, text).ok());
    return ReadDesignFile(folder / name);
  };
  const std::string mark = "\xEF\xBB\xBF";
  EXPECT_THAT(read("a.json", mark + "[{\"name\": \"items/a\"}]").items, SizeIs(1));
  EXPECT_THAT(read("a.textproto", mark + "items { name: \"items/a\" }").items, SizeIs(1));
  EXPECT_THAT(
      read("a.csv", mark + kHeader + "items/a,A,NUT,materials/steel,1,1,1,1,EUR,2026-01-15\n")
          .items,
      SizeIs(1));
  EXPECT_THAT(read("b.json", mark + "[{\"nmae\": 1}]").findings, SizeIs(1));
  for (const char* const name : {"w.json", "w.textproto", "w.csv"}) {
    const std::vector<FieldViolation> findings =
        read(name, std::string("i\0t\0e\0m\0", 8)).findings;
    ASSERT_THAT(findings, SizeIs(1)) << name;
    EXPECT_THAT(findings[0].message, HasSubstr("UTF-16, not UTF-8; save it as UTF-8")) << name;
  }
  // Neither form takes hexadecimal for a number.
  EXPECT_THAT(read("h.json", R"([{"name": "items/a", "price": {"amount": "0x10"}}])").findings,
              testing::ElementsAre(At("line 1", "price.amount")));
  EXPECT_THAT(read("h.textproto", "items { price { amount: 0x10 } }").findings, SizeIs(1));
  std::filesystem::remove_all(folder);
}

TEST(DesignFileOf, GoesByTheExtension) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("mortise-design-file-" + NewIdentifier());
  const auto read = [&folder](const std::string& name, const std::string& text) {
    EXPECT_TRUE(WriteFile(folder / name, text).ok());
    return ReadDesignFile(folder / name);
  };
  EXPECT_THAT(
      read("a.csv", std::string(kHeader) + "items/a,A,NUT,materials/steel,1,1,1,1,EUR,2026-01-15\n")
          .items,
      SizeIs(1));
  EXPECT_THAT(
      read("B.CSV", std::string(kHeader) + "items/a,A,NUT,materials/steel,1,1,1,1,EUR,2026-01-15\n")
          .items,
      SizeIs(1));
  EXPECT_THAT(read("a.json", "[{\"name\": \"items/a\"}]").items, SizeIs(1));
  EXPECT_THAT(read("b.Json", "[{\"name\": \"items/a\"}]").items, SizeIs(1));
  EXPECT_THAT(read("a.textproto", "items { name: \"items/a\" }").items, SizeIs(1));
  EXPECT_THAT(
      read("b.textproto", "# proto-message: mortise.v1.Template\nname: \"templates/b\"").templates,
      SizeIs(1));
  EXPECT_THAT(
      read("c.textproto", "\nitems { nmae: 1 }\nitmes {}").findings,
      testing::ElementsAre(At("line 2, column 9", "'nmae'"), At("line 3, column 1", "'itmes'")));
  EXPECT_THAT(ReadDesignFile(folder / "absent.csv").findings, SizeIs(1));
  EXPECT_THAT(ReadDesignFile(folder).findings,
              testing::ElementsAre(At("", "is a folder, not a file")));
  EXPECT_THAT(read("big.csv", std::string((4 << 20) + 1, 'x')).findings,
              testing::ElementsAre(At("", "4")));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace mortise::parametric
