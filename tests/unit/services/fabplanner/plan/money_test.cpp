#include "services/fabplanner/plan/money.h"

#include <gtest/gtest.h>

namespace mortise::fabplanner {
namespace {

double Rounded(double amount, const std::string& currency) {
  return RoundAsMoney({currency, amount}).amount;
}

TEST(MoneyTest, HalfOfTheSmallestAmountGoesToTheEvenOne) {
  EXPECT_EQ(Rounded(0.125, "EUR"), 0.12);
  EXPECT_EQ(Rounded(0.135, "EUR"), 0.14);
  EXPECT_EQ(Rounded(0.1251, "EUR"), 0.13);
  EXPECT_EQ(Rounded(0.1349, "EUR"), 0.13);
  // No binary number is either of these; people mean the decimals that they wrote.
  EXPECT_EQ(Rounded(1.015, "EUR"), 1.02);
  EXPECT_EQ(Rounded(1.005, "EUR"), 1.0);
  EXPECT_EQ(Rounded(2.675, "EUR"), 2.68);
  EXPECT_EQ(Rounded(123456789.125, "EUR"), 123456789.12);
}

TEST(MoneyTest, CurrenciesHaveTheirOwnDecimals) {
  EXPECT_EQ(Rounded(1234.5, "JPY"), 1234);
  EXPECT_EQ(Rounded(1235.5, "JPY"), 1236);
  EXPECT_EQ(Rounded(1.2345, "KWD"), 1.234);
  EXPECT_EQ(Rounded(1.23455, "CLF"), 1.2346);
  EXPECT_EQ(AmountText({"EUR", 9.5}), "9.50");
  EXPECT_EQ(AmountText({"JPY", 950}), "950");
  EXPECT_EQ(AmountText({"KWD", 9.5}), "9.500");
}

TEST(MoneyTest, WhatIsSharedAddsUp) {
  EXPECT_EQ(SharedUnits(100, {1, 1, 1}), (std::vector<double>{34, 33, 33}));
  EXPECT_EQ(SharedUnits(10, {0.3, 0.45, 0.25}), (std::vector<double>{3, 5, 2}));
  EXPECT_EQ(SharedUnits(0, {1, 2}), (std::vector<double>{0, 0}));
  EXPECT_EQ(SharedUnits(2850, {3}), (std::vector<double>{2850}));
  EXPECT_EQ(SharedUnits(1, {0, 1, 0}), (std::vector<double>{0, 1, 0}));
}

TEST(MoneyTest, WithoutACurrencyThereIsNoPrice) {
  EXPECT_EQ(RoundAsMoney({"", 5}).currency, "");
  EXPECT_EQ(RoundAsMoney({"", 5}).amount, 0);
  EXPECT_EQ(AmountText({"", 5}), "");
}

}  // namespace
}  // namespace mortise::fabplanner
