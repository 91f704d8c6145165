// Items and materials: named dimensions, measures, stock, suppliers; elasticity that is possible.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "common/design/template_validation.h"

namespace mortise::parametric {
namespace {

using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

auto At(const std::string& field, const std::string& message = "") {
  return testing::AllOf(Field(&FieldViolation::field, field),
                        Field(&FieldViolation::message, HasSubstr(message)));
}

Material Spruce() {
  Material spruce;
  spruce.name = "materials/spruce";
  spruce.density = 420;
  spruce.youngs_modulus = 11e9;
  spruce.poissons_ratio = 0.37;
  spruce.strength = 24e6;
  spruce.orthotropic = {11e9, 0.86e9, 0.47e9, 0.70e9, 0.67e9, 0.033e9, 0.372, 0.467, 0.435};
  return spruce;
}

// Of the same elasticity in all directions.
Material Isotropic(double poissons_ratio) {
  Material material = Spruce();
  const double e = 200e9, g = e / (2 * (1 + poissons_ratio)), nu = poissons_ratio;
  material.orthotropic = {e, e, e, g, g, g, nu, nu, nu};
  return material;
}

Item Board() {
  Item board;
  board.name = "items/board";
  board.kind = ItemKind::kBoard;
  board.material = "materials/spruce";
  board.dimensions = {{{2.44, Process::kChopSaw, 0.04, 2.44},
                       {0.089, Process::kRipSaw, 0.02, 0.089, "", 0.1016},
                       {0.038, Process::kNone, 0, 0, "", 0.0508}}};
  board.price = {"EUR", 6.4};
  board.price_date = "2026-01-15";
  board.measures = {{"edge_radius", 0.003, 0.002, 0.004}};
  board.stock_sizes = {{2.44, 0, 6.4}, {3.05, 0, 8}};
  board.more_suppliers = {{"Sawmill", "https://sawmill.example", ""}};
  board.grain_axis = Axis::kX;
  board.radial_axis = Axis::kZ;
  return board;
}

std::vector<FieldViolation> Spoilt(const std::function<void(Item&)>& spoil) {
  Item item = Board();
  spoil(item);
  return ValidateItem(item, {Spruce()});
}

std::vector<FieldViolation> SpoiltElasticity(
    const std::function<void(OrthotropicElasticity&)>& spoil) {
  Material material = Spruce();
  spoil(*material.orthotropic);
  return ValidateMaterial(material);
}

TEST(ItemValidation, TakesAWholeItem) {
  EXPECT_THAT(ValidateItem(Board(), {Spruce()}), IsEmpty());
  EXPECT_THAT(Spoilt([](Item& item) {
                item.measures.clear();
                item.stock_sizes.clear();
                item.more_suppliers.clear();
                item.grain_axis.reset();
                item.radial_axis.reset();
              }),
              IsEmpty());
}

TEST(ItemValidation, ChecksDimensions) {
  EXPECT_THAT(Spoilt([](Item& item) { item.dimensions[1].nominal = -0.1; }),
              ElementsAre(At("dimensions[Y].nominal")));
  EXPECT_THAT(Spoilt([](Item& item) { item.dimensions[1].nominal = 101.6; }),
              ElementsAre(At("dimensions[Y].nominal", "metres")));
  EXPECT_THAT(Spoilt([](Item& item) { item.dimensions[2].name = "Thick"; }),
              ElementsAre(At("dimensions[Z].name")));
  EXPECT_THAT(Spoilt([](Item& item) { item.dimensions[2].name = "width"; }),
              ElementsAre(At("dimensions[Z].size", "both are 'width'")));
  EXPECT_THAT(Spoilt([](Item& item) { item.dimensions[1].process = Process::kNone; }),
              ElementsAre(At("dimensions[Y].process")));
  EXPECT_THAT(Spoilt([](Item& item) { item.kind = ItemKind::kThreadedRod; }),
              ElementsAre(At("dimensions[Z].size", "round")));
  // One diameter, said twice.
  EXPECT_THAT(Spoilt([](Item& item) {
                item.kind = ItemKind::kThreadedRod;
                item.dimensions[1] = {0.008, Process::kNone, 0, 0, "thread_diameter"};
                item.dimensions[2] = item.dimensions[1];
              }),
              IsEmpty());
}

TEST(ItemValidation, ChecksMeasures) {
  EXPECT_THAT(Spoilt([](Item& item) { item.measures[0].size = 0; }),
              ElementsAre(At("measures[0].size")));
  EXPECT_THAT(Spoilt([](Item& item) { item.measures[0].minimum = 0.01; }),
              ElementsAre(At("measures[0].minimum", "more than the size")));
  EXPECT_THAT(Spoilt([](Item& item) { item.measures[0].maximum = 0.001; }),
              ElementsAre(At("measures[0].maximum", "less than the size")));
  EXPECT_THAT(Spoilt([](Item& item) { item.measures[0].name = "edge-radius"; }),
              ElementsAre(At("measures[0].name")));
  EXPECT_THAT(Spoilt([](Item& item) { item.measures.push_back(item.measures[0]); }),
              ElementsAre(At("measures[1].name", "already")));
  EXPECT_THAT(Spoilt([](Item& item) { item.measures[0].name = "width"; }),
              ElementsAre(At("measures[0].name", "already")));
  EXPECT_THAT(Spoilt([](Item& item) { item.measures.resize(33); }),
              ElementsAre(At("measures", "33 entries")));
  // What is given wrongly is named before what is not given.
  EXPECT_THAT(
      Spoilt([](Item& item) {
        item.measures = {{"", 0, 0, -1}};
      }),
      ElementsAre(At("measures[0].maximum"), At("measures[0].size"), At("measures[0].name")));
}

TEST(ItemValidation, ChecksStockAndSuppliers) {
  EXPECT_THAT(Spoilt([](Item& item) { item.stock_sizes[1].price = -1; }),
              ElementsAre(At("stock_sizes[1].price")));
  EXPECT_THAT(Spoilt([](Item& item) { item.stock_sizes[1].length = 0; }),
              ElementsAre(At("stock_sizes[1].length")));
  EXPECT_THAT(Spoilt([](Item& item) { item.stock_sizes[1].width = 1; }),
              ElementsAre(At("stock_sizes[1].width", "only sheets")));
  EXPECT_THAT(Spoilt([](Item& item) { item.stock_sizes.erase(item.stock_sizes.begin()); }),
              ElementsAre(At("stock_sizes", "do not contain")));
  EXPECT_THAT(Spoilt([](Item& item) {
                item.stock_sizes.resize(65, {2.44, 0, 0});
              }),
              ElementsAre(At("stock_sizes", "65 entries")));
  EXPECT_THAT(Spoilt([](Item& item) {
                item.kind = ItemKind::kSheet;
                item.stock_sizes = {{2.44, 0.089, 0}, {2.44, 0, 0}};
              }),
              ElementsAre(At("stock_sizes[1].width", "is missing")));
  EXPECT_THAT(Spoilt([](Item& item) { item.more_suppliers[0].url = "javascript:alert(1)"; }),
              ElementsAre(At("more_suppliers[0].url")));
  EXPECT_THAT(Spoilt([](Item& item) { item.more_suppliers[0].supplier = ""; }),
              ElementsAre(At("more_suppliers[0].supplier")));
  EXPECT_THAT(Spoilt([](Item& item) { item.more_suppliers.resize(17); }),
              ElementsAre(At("more_suppliers", "17 entries")));
  EXPECT_THAT(Spoilt([](Item& item) { item.designation = std::string(1001, 'x'); }),
              ElementsAre(At("designation")));
  EXPECT_THAT(Spoilt([](Item& item) { item.title = std::string(201, 'x'); }),
              ElementsAre(At("title", "200 characters")));
  EXPECT_THAT(Spoilt([](Item& item) {
                for (int i = 0; i < 200; ++i) item.title += "ß";
              }),
              IsEmpty())
      << "characters, not bytes";
  for (const char* no_day :
       {"2026-02-30", "2026-02-29", "2026-04-31", "2026-13-01", "2026-00-10"}) {
    EXPECT_THAT(Spoilt([&](Item& item) { item.price_date = no_day; }),
                ElementsAre(At("price_date")))
        << no_day;
  }
  EXPECT_THAT(Spoilt([](Item& item) { item.price_date = "2028-02-29"; }), IsEmpty());
}

TEST(ItemValidation, GrainLiesAlongTwoAxes) {
  EXPECT_THAT(Spoilt([](Item& item) { item.radial_axis = Axis::kX; }),
              ElementsAre(At("radial_axis")));
  EXPECT_THAT(Spoilt([](Item& item) {
                item.radial_axis.reset();
                item.grain_axis = Axis::kZ;
              }),
              ElementsAre(At("grain_axis")));
  EXPECT_THAT(Spoilt([](Item& item) {
                item.radial_axis = Axis::kX;
                item.grain_axis = Axis::kZ;
              }),
              IsEmpty());
}

TEST(MaterialValidation, TakesWoodAndWhatHasNoGrain) {
  EXPECT_THAT(ValidateMaterial(Spruce()), IsEmpty());
  for (const double nu : {-0.9, -0.3, 0.0, 0.3, 0.49, 0.4999}) {
    EXPECT_THAT(ValidateMaterial(Isotropic(nu)), IsEmpty()) << nu;
  }
}

// An isotropic compliance is positive definite for -1 < ν < 1/2 alone.
TEST(MaterialValidation, RefusesElasticityThatWouldSetEnergyFree) {
  for (const double nu : {0.5, 0.6, 0.99}) {
    EXPECT_THAT(ValidateMaterial(Isotropic(nu)), ElementsAre(At("orthotropic", "definite"))) << nu;
  }
  EXPECT_THAT(SpoiltElasticity([](auto& e) { e.poissons_ratio_lr = 3.7; }),
              ElementsAre(At("orthotropic.poissons_ratio_lr", "youngs_modulus_l")));
  EXPECT_THAT(SpoiltElasticity([](auto& e) { e.poissons_ratio_lt = 5; }),
              ElementsAre(At("orthotropic.poissons_ratio_lt")));
  EXPECT_THAT(SpoiltElasticity([](auto& e) { e.poissons_ratio_rt = 1.4; }),
              ElementsAre(At("orthotropic.poissons_ratio_rt")));
}

TEST(MaterialValidation, NamesEachConstant) {
  EXPECT_THAT(SpoiltElasticity([](auto& e) {
                e.youngs_modulus_t = 0;
                e.shear_modulus_rt = -1;
                e.poissons_ratio_rt = NAN;
                e.poissons_ratio_lt = -1.5;
              }),
              ElementsAre(At("orthotropic.shear_modulus_rt"), At("orthotropic.poissons_ratio_lt"),
                          At("orthotropic.poissons_ratio_rt"),
                          At("orthotropic.youngs_modulus_t", "missing")));
}

}  // namespace
}  // namespace mortise::parametric
