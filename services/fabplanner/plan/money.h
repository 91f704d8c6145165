// Rounds prices as money: to the smallest amount that there is of a currency.
#pragma once

#include <string>
#include <vector>

#include "services/fabplanner/plan/design.h"

namespace mortise::fabplanner {

// Returns how many decimals the amounts of a currency have (ISO 4217): 2 of "EUR", none of "JPY", 3
// of "KWD"; 2 of what is not known.
int MinorDigits(const std::string& currency);

// Returns how many of the currency's smallest amounts that is, half of one to the even number:
// 12 for 0.125 EUR. What misses a half only as decimals do that are no binary numbers, such
// as 1.015, counts as a half.
double MinorUnits(const Money& money);

// Returns so many of the currency's smallest amounts.
Money FromMinorUnits(double units, const std::string& currency);

// Returns the amount as money has it. Without a currency there is no price, and it stays so.
Money RoundAsMoney(const Money& money);

// Shares that many of the smallest amounts by weight, whole ones each: what remains goes to the
// largest remainders, first come, so that they add up. `weights`: >= 0, at least one of them over
// 0.
std::vector<double> SharedUnits(double units, const std::vector<double>& weights);

// Returns "12.50" or "12" with the decimals of its currency; empty without a currency.
std::string AmountText(const Money& money);

}  // namespace mortise::fabplanner
