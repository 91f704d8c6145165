// Numbers of messages for people that compare them: those that differ read differently.
#pragma once

#include <string>
#include <vector>

namespace mortise {

// Lengths that one message compares, m, as millimetres without needless zeros: to a tenth, or with
// as many digits as it takes for those that differ by a nanometre or more to read differently.
// 2.4200001 beside 2.42 becomes "2420.0001" beside "2420".
std::vector<std::string> ComparedMillimetres(const std::vector<double>& metres);

// Numbers that one message compares, in six digits or as many as it takes for those that differ to
// read differently: 2.42000001 beside 2.42.
std::vector<std::string> ComparedNumbers(const std::vector<double>& numbers);

}  // namespace mortise
