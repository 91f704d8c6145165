#include "tests/support/file_damage.h"

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

namespace mortise::testing {
namespace {

constexpr std::size_t kMaxBlock = 300;
constexpr std::size_t kMaxLines = 20;

std::size_t Below(std::size_t limit, std::mt19937& random) { return random() % limit; }

std::vector<std::string> LinesOf(const std::string& file) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < file.size();) {
    const std::size_t end = std::min(file.find('\n', begin), file.size() - 1) + 1;
    lines.push_back(file.substr(begin, end - begin));
    begin = end;
  }
  return lines;
}

std::string JoinLines(const std::vector<std::string>& lines) {
  std::string file;
  for (const std::string& line : lines) file += line;
  return file;
}

std::string WithDamagedLines(const std::string& file, Damage damage, std::mt19937& random) {
  std::vector<std::string> lines = LinesOf(file);
  const std::size_t first = Below(lines.size(), random), other = Below(lines.size(), random);
  const auto at = [&](std::size_t line) {
    return lines.begin() + static_cast<std::ptrdiff_t>(line);
  };
  if (damage == Damage::kSwappedLines) {
    std::swap(lines[first], lines[other]);
  } else if (damage == Damage::kDoubledLine) {
    const std::string line = lines[first];
    lines.insert(at(first), line);
  } else {
    const std::size_t count = damage == Damage::kLostLine ? 1 : 1 + Below(kMaxLines, random);
    lines.erase(at(first), at(std::min(first + count, lines.size())));
  }
  return JoinLines(lines);
}

std::string WithDamagedBytes(std::string file, Damage damage, std::mt19937& random) {
  const std::size_t at = Below(file.size(), random);
  const std::size_t length = 1 + Below(std::min(kMaxBlock, file.size() - at), random);
  switch (damage) {
    case Damage::kCutOff:
      file.resize(at);
      break;
    case Damage::kLostBytes:
      file.erase(at, length);
      break;
    case Damage::kZeroedBytes:
      std::fill_n(file.begin() + static_cast<std::ptrdiff_t>(at), length, '\0');
      break;
    case Damage::kChangedBytes:
      for (std::size_t i = 0; i < 1 + length % 4; ++i) {
        file[Below(file.size(), random)] = static_cast<char>(random());
      }
      break;
    default:
      file[at] = static_cast<char>(file[at] ^ (1 << Below(8, random)));
  }
  return file;
}

}  // namespace

const char* NameOf(Damage damage) {
  static constexpr const char* kNames[kDamages] = {
      "cut off",   "bytes lost", "bytes zeroed", "bytes changed", "bit flipped",
      "line lost", "lines lost", "line doubled", "lines swapped"};
  return kNames[static_cast<int>(damage)];
}

std::string Damaged(const std::string& file, Damage damage, std::mt19937& random) {
  // Of one line none can be swapped.
  const std::vector<std::string> lines = LinesOf(file);
  const bool is_one =
      std::adjacent_find(lines.begin(), lines.end(), std::not_equal_to<>()) == lines.end();
  if (is_one && damage == Damage::kSwappedLines) damage = Damage::kChangedBytes;
  std::string damaged = file;
  while (damaged == file) {
    damaged = damage < Damage::kLostLine ? WithDamagedBytes(file, damage, random)
                                         : WithDamagedLines(file, damage, random);
  }
  return damaged;
}

}  // namespace mortise::testing
