// External ids and labels of materials and items, in each form of files.
#include "common/files/csv_tags.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/files/design_file.h"

namespace mortise::parametric {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

constexpr char kItemHeader[] =
    "name,title,kind,material,length_mm,width_mm,thickness_mm,price,currency,price_date";
constexpr char kItemRow[] = "items/a,A,NUT,materials/steel,1,1,1,1,EUR,2026-01-15";
constexpr char kMaterialHeader[] = "name,title,density,youngs_modulus,poissons_ratio,strength";
constexpr char kMaterialRow[] = "materials/oak,Oak,700,1.1e10,0.3,4e7";

TEST(CsvTags, AreOfItems) {
  const DesignFile file =
      ParseDesignCsv(std::string(kItemHeader) + ",external_ids,labels\n" + kItemRow +
                     ",100-4711/A; 4711,site=Hamburg; stocked ;formula=a=b\n" + kItemRow + ",,\n");
  ASSERT_THAT(file.findings, IsEmpty());
  ASSERT_THAT(file.items, SizeIs(2));
  const v1::Item& item = file.items[0].message;
  EXPECT_THAT(item.external_ids(), ElementsAre("100-4711/A", "4711"));
  EXPECT_THAT(item.labels(), UnorderedElementsAre(Pair("site", "Hamburg"), Pair("stocked", ""),
                                                  Pair("formula", "a=b")));
  EXPECT_EQ(file.items[0].fields.at("labels"), "line 2, column 12 (labels)");
  EXPECT_EQ(PlaceOf(file.items[0].place, file.items[0].fields, "external_ids[1]"),
            "line 2, column 11 (external_ids)");
  EXPECT_THAT(file.items[1].message.external_ids(), IsEmpty()) << "an empty cell says nothing";
  EXPECT_THAT(file.items[1].message.labels(), IsEmpty());
}

TEST(CsvTags, AreOfMaterials) {
  const DesignFile file =
      ParseDesignCsv(std::string(kMaterialHeader) + ",labels,external_ids\n" + kMaterialRow +
                     ",region=Spessart,W-17;W-18\n" + kMaterialRow + ",,\n");
  ASSERT_THAT(file.findings, IsEmpty());
  ASSERT_THAT(file.materials, SizeIs(2));
  const v1::Material& material = file.materials[0].message;
  EXPECT_THAT(material.external_ids(), ElementsAre("W-17", "W-18"));
  EXPECT_THAT(material.labels(), UnorderedElementsAre(Pair("region", "Spessart")));
  EXPECT_THAT(file.materials[1].message.external_ids(), IsEmpty());
  EXPECT_THAT(file.materials[1].message.labels(), IsEmpty());
}

TEST(CsvTags, ALabelIsThereOnce) {
  for (const std::string& text :
       {std::string(kItemHeader) + ",labels\n" + kItemRow + ",a=1;b=2;a=3\n",
        std::string(kMaterialHeader) + ",labels\n" + kMaterialRow + ",a=1;b=2;a=3\n"}) {
    const DesignFile file = ParseDesignCsv(text);
    ASSERT_THAT(file.findings, SizeIs(1)) << text;
    EXPECT_THAT(file.findings[0].field, HasSubstr("(labels)"));
    EXPECT_THAT(file.findings[0].message, HasSubstr("'a' is there twice"));
  }
}

TEST(CsvTags, WhatTheServiceSaysIsNoColumn) {
  for (const char* column : {"creator", "create_time"}) {
    const DesignFile items =
        ParseDesignCsv(std::string(kItemHeader) + "," + column + "\n" + kItemRow + ",x\n");
    ASSERT_THAT(items.findings, SizeIs(1)) << column;
    EXPECT_THAT(items.findings[0].message, HasSubstr(column));
    const DesignFile materials =
        ParseDesignCsv(std::string(kMaterialHeader) + "," + column + "\n" + kMaterialRow + ",x\n");
    ASSERT_THAT(materials.findings, SizeIs(1)) << column;
    EXPECT_THAT(materials.findings[0].message, HasSubstr(column));
  }
}

TEST(JsonTags, AreOfAllThatIsImported) {
  const DesignFile file = ParseDesignJson(R"({
    "materials": [{"name": "materials/oak", "externalIds": ["W-17"], "labels": {"a": "1"}}],
    "items": [{"name": "items/a", "external_ids": ["100-4711/A"], "labels": {"b": "", "c": "d"}}],
    "templates": [{"name": "templates/t", "external_ids": ["T;1"], "labels": {"e": "f"}}]})");
  ASSERT_THAT(file.findings, IsEmpty());
  ASSERT_THAT(file.materials, SizeIs(1));
  EXPECT_THAT(file.materials[0].message.external_ids(), ElementsAre("W-17"));
  ASSERT_THAT(file.items, SizeIs(1));
  EXPECT_THAT(file.items[0].message.external_ids(), ElementsAre("100-4711/A"));
  EXPECT_THAT(file.items[0].message.labels(), UnorderedElementsAre(Pair("b", ""), Pair("c", "d")));
  ASSERT_THAT(file.templates, SizeIs(1));
  EXPECT_THAT(file.templates[0].message.external_ids(), ElementsAre("T;1"));
  EXPECT_THAT(file.templates[0].message.labels(), UnorderedElementsAre(Pair("e", "f")));
}

TEST(JsonTags, NameTheFieldAtFault) {
  const DesignFile file = ParseDesignJson(
      R"({"items": [{"name": "items/a", "external_ids": ["1", 2], "labels": {"b": ["c"]}}]})");
  std::vector<std::string> messages;
  for (const FieldViolation& finding : file.findings) messages.push_back(finding.message);
  EXPECT_THAT(messages, UnorderedElementsAre(HasSubstr("items[0].external_ids[1]"),
                                             HasSubstr("items[0].labels")));
}

}  // namespace
}  // namespace mortise::parametric
