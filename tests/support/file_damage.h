// Files as they come out of broken transfers, disks and editors.
#pragma once

#include <random>
#include <string>

namespace mortise::testing {

enum class Damage {
  kCutOff,        // ends somewhere
  kLostBytes,     // up to 300 bytes are missing
  kZeroedBytes,   // up to 300 bytes are 0
  kChangedBytes,  // up to 4 bytes are others
  kFlippedBit,    // one bit is the other
  kLostLine,      // of text, or what lies between two bytes of its value
  kLostLines,     // up to 20 of them
  kDoubledLine,   // one is there twice
  kSwappedLines,  // two change places
};
inline constexpr int kDamages = 9;

const char* NameOf(Damage damage);

// The file after damage that `random` chooses; never as it was.
std::string Damaged(const std::string& file, Damage damage, std::mt19937& random);

}  // namespace mortise::testing
