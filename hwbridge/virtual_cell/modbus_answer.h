// What a machine of the virtual cell answers to a Modbus request.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hwbridge/virtual_cell/machine.h"

namespace mortise::hwbridge {

// Carries out the request and returns the data unit of the answer. Functions 2, 3, 4, 6 and 16;
// what is wrong is answered by exception, in the order of the standard: 1 for any other function, 3
// for a count outside its range or a request that is longer or shorter than it says, 2 for
// registers that the map does not have or that lie on both sides of a gap, then what the machine
// says. `request` is not empty.
std::vector<std::uint8_t> AnswerTo(std::span<const std::uint8_t> request, Machine& machine);

// The answer that is nothing but an exception.
std::vector<std::uint8_t> ExceptionAnswer(std::uint8_t function, ModbusException exception);

}  // namespace mortise::hwbridge
