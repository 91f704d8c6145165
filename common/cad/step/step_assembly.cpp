// Paths, placements and names in the tree of a STEP file.
#include "common/cad/step/step_assembly.h"

#include <algorithm>
#include <map>
#include <set>

#include "absl/strings/str_cat.h"

namespace mortise::cad {
namespace {

constexpr std::size_t kMaxName = 63;  // bytes, as elsewhere in the house

// The longest beginning of UTF-8 text that fits and does not end within a character.
std::string Beginning(const std::string& text, std::size_t limit) {
  if (text.size() <= limit) return text;
  std::size_t end = limit;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  return text.substr(0, end);
}

// In one line, without blanks at the ends.
std::string Cleaned(const std::string& name, const std::string& nameless) {
  std::string clean = name;
  for (char& c : clean) {
    if (static_cast<unsigned char>(c) < ' ' || c == 127) c = ' ';
  }
  const std::size_t begin = clean.find_first_not_of(' ');
  if (begin == std::string::npos) return nameless;
  clean = Beginning(clean.substr(begin), kMaxName);
  return clean.substr(0, clean.find_last_not_of(' ') + 1);
}

}  // namespace

std::string PathOf(const StepAssembly& assembly, int group, const std::string& name) {
  std::string path = name;
  for (; group > 0; group = assembly.groups[static_cast<std::size_t>(group)].parent) {
    path = absl::StrCat(assembly.groups[static_cast<std::size_t>(group)].name, "/", path);
  }
  return path;
}

Eigen::Isometry3d PlacementOf(const StepAssembly& assembly, int group) {
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
  for (; group >= 0; group = assembly.groups[static_cast<std::size_t>(group)].parent) {
    placement = assembly.groups[static_cast<std::size_t>(group)].placement * placement;
  }
  return placement;
}

std::vector<std::string> DistinctNames(const std::vector<std::string>& names,
                                       const std::string& nameless) {
  std::vector<std::string> distinct;
  std::map<std::string, int> occurrences;
  for (const std::string& name : names) {
    distinct.push_back(Cleaned(name, nameless));
    ++occurrences[distinct.back()];
  }
  std::set<std::string> used;
  for (const auto& [name, count] : occurrences) {
    if (count == 1) used.insert(name);
  }
  std::map<std::string, int> numbers;
  for (std::string& name : distinct) {
    if (occurrences[name] == 1) continue;
    int& number = numbers[name];
    std::string numbered;
    do {
      const std::string suffix = absl::StrCat(" ", ++number);
      numbered = Beginning(name, kMaxName - suffix.size()) + suffix;
    } while (!used.insert(numbered).second);
    name = std::move(numbered);
  }
  return distinct;
}

}  // namespace mortise::cad
