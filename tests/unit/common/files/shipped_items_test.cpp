// The items that ship: as many as promised, all valid, and of the dimensions that are published.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "common/design/template_validation.h"
#include "tests/unit/common/files/table.h"

namespace mortise::parametric {
namespace {

using ::testing::IsEmpty;

class ShippedItems : public testing::Test {
 protected:
  void SetUp() override {
    for (const auto& message : collection_.materials) {
      const auto material = FromProto(message);
      ASSERT_TRUE(material.ok()) << material.status();
      materials_.push_back(*material);
    }
    for (const auto& message : collection_.items) {
      const auto item = FromProto(message);
      ASSERT_TRUE(item.ok()) << message.name() << ": " << item.status();
      items_.push_back(*item);
    }
  }

  const Item& Get(const std::string& id) const {
    const Item* item = FindItem(items_, "items/" + id);
    EXPECT_NE(item, nullptr) << id;
    static const Item none;
    return item == nullptr ? none : *item;
  }

  // A dimension of the box, m.
  double Size(const std::string& id, Axis axis) const {
    return Get(id).dimensions[static_cast<std::size_t>(axis)].size;
  }

  double Measure(const std::string& id, const std::string& name) const {
    for (const ItemMeasure& measure : Get(id).measures) {
      if (measure.name == name) return measure.size;
    }
    ADD_FAILURE() << id << " has no " << name;
    return 0;
  }

  const Collection collection_ = ShippedCollection();
  std::vector<Material> materials_;
  std::vector<Item> items_;
};

TEST_F(ShippedItems, AreAllValidAndThereOnce) {
  EXPECT_GE(items_.size(), 150u);
  std::set<std::string> names;
  for (const Material& material : materials_) {
    EXPECT_TRUE(names.insert(material.name).second) << material.name;
    EXPECT_THAT(ValidateMaterial(material), IsEmpty()) << material.name;
  }
  for (const Item& item : items_) {
    EXPECT_TRUE(names.insert(item.name).second) << item.name;
    const auto findings = ValidateItem(item, materials_);
    EXPECT_THAT(findings, IsEmpty())
        << item.name << ": " << findings[0].field << " " << findings[0].message;
    EXPECT_FALSE(item.title.empty()) << item.name;
  }
}

TEST_F(ShippedItems, AreOfEveryKind) {
  std::map<ItemKind, int> counts;
  for (const Item& item : items_) ++counts[item.kind];
  for (int kind = 1; kind <= static_cast<int>(ItemKind::kTube); ++kind) {
    EXPECT_GE(counts[static_cast<ItemKind>(kind)], 5) << v1::ItemKind_Name(kind);
  }
}

TEST_F(ShippedItems, HavePricesThatAreDatedExamplesOfNobody) {
  for (const Item& item : items_) {
    EXPECT_TRUE(item.price_is_example) << item.name;
    EXPECT_EQ(item.price_date, "2026-01-15") << item.name;
    EXPECT_THAT(item.supplier_url, testing::HasSubstr(".example/")) << item.name;
  }
}

TEST_F(ShippedItems, WoodHasAGrain) {
  for (const Item& item : items_) {
    if (item.kind != ItemKind::kBoard && item.kind != ItemKind::kDowel) continue;
    EXPECT_TRUE(FindMaterial(materials_, item.material)->orthotropic.has_value()) << item.name;
  }
}

// ISO 4032: width across flats and largest height.
TEST_F(ShippedItems, NutsAreThoseOfIso4032) {
  struct Published {
    const char* id;
    double across_flats, height;  // m
  };
  for (const Published& nut : {Published{"hex-nut-m5", 8e-3, 4.7e-3},
                               {"hex-nut-m8", 13e-3, 6.8e-3},
                               {"hex-nut-m10", 16e-3, 8.4e-3},
                               {"hex-nut-m20", 30e-3, 18e-3}}) {
    EXPECT_EQ(Get(nut.id).standard, "ISO 4032");
    EXPECT_DOUBLE_EQ(Size(nut.id, Axis::kX), nut.across_flats) << nut.id;
    EXPECT_DOUBLE_EQ(Size(nut.id, Axis::kZ), nut.height) << nut.id;
  }
  EXPECT_EQ(Get("hex-nut-m8").dimensions[0].name, "width_across_flats");
  EXPECT_DOUBLE_EQ(Measure("hex-nut-m8", "thread_pitch"), 1.25e-3);
}

// ISO 7089: hole, outside diameter, largest thickness.
TEST_F(ShippedItems, WashersAreThoseOfIso7089) {
  EXPECT_DOUBLE_EQ(Measure("washer-m8", "hole_diameter"), 8.4e-3);
  EXPECT_DOUBLE_EQ(Size("washer-m8", Axis::kX), 16e-3);
  EXPECT_DOUBLE_EQ(Size("washer-m8", Axis::kZ), 1.8e-3);
}

// ISO 4014: width across flats and height of the head.
TEST_F(ShippedItems, BoltsAreThoseOfIso4014) {
  EXPECT_DOUBLE_EQ(Size("hex-bolt-m8x40", Axis::kX), 40e-3);
  EXPECT_DOUBLE_EQ(Size("hex-bolt-m8x40", Axis::kY), 8e-3);
  EXPECT_DOUBLE_EQ(Measure("hex-bolt-m8x40", "width_across_flats"), 13e-3);
  EXPECT_DOUBLE_EQ(Measure("hex-bolt-m8x40", "head_height"), 5.3e-3);
  EXPECT_EQ(Get("hex-bolt-m8x40").designation, "ISO 4014 - M8 x 40 - 8.8");
}

// ISO 4762: largest head diameter of knurled heads, socket.
TEST_F(ShippedItems, SocketScrewsAreThoseOfIso4762) {
  EXPECT_DOUBLE_EQ(Measure("socket-screw-m6x20", "head_diameter"), 10.22e-3);
  EXPECT_DOUBLE_EQ(Measure("socket-screw-m6x20", "socket_width"), 5e-3);
}

// ISO 15: bore, outside diameter, width.
TEST_F(ShippedItems, BearingsAreThoseOfIso15) {
  struct Published {
    const char* id;
    double bore, outside, width;  // m
  };
  for (const Published& bearing : {Published{"bearing-608", 8e-3, 22e-3, 7e-3},
                                   {"bearing-623", 3e-3, 10e-3, 4e-3},
                                   {"bearing-6204", 20e-3, 47e-3, 14e-3}}) {
    EXPECT_DOUBLE_EQ(Measure(bearing.id, "bore_diameter"), bearing.bore) << bearing.id;
    EXPECT_DOUBLE_EQ(Size(bearing.id, Axis::kX), bearing.outside) << bearing.id;
    EXPECT_DOUBLE_EQ(Size(bearing.id, Axis::kZ), bearing.width) << bearing.id;
  }
}

// American Softwood Lumber Standard PS 20, dry: a two-by-four is 38 × 89 mm.
TEST_F(ShippedItems, LumberHasNominalAndDressedSizes) {
  EXPECT_DOUBLE_EQ(Size("board-38x89", Axis::kY), 89e-3);
  EXPECT_DOUBLE_EQ(Size("board-38x89", Axis::kZ), 38e-3);
  EXPECT_DOUBLE_EQ(Get("board-38x89").dimensions[1].nominal, 4 * 25.4e-3);
  EXPECT_DOUBLE_EQ(Get("board-38x89").dimensions[2].nominal, 2 * 25.4e-3);
  EXPECT_DOUBLE_EQ(Get("board-38x286").dimensions[1].nominal, 12 * 25.4e-3);
  EXPECT_GE(Get("board-38x89").stock_sizes.size(), 2u);
}

// ASME B36.10M: NPS 1, schedule 40: 33.4 × 3.38 mm.
TEST_F(ShippedItems, PipesAreThoseOfAsmeB36) {
  EXPECT_NEAR(Size("pipe-nps-1", Axis::kY), 33.4e-3, 1e-5);
  EXPECT_NEAR(Measure("pipe-nps-1", "wall_thickness"), 3.38e-3, 1e-5);
}

}  // namespace
}  // namespace mortise::parametric
