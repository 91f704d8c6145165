#include "common/mesh/distinct_names.h"

#include <cstddef>
#include <map>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/digest.h"

namespace mortise::mesh {
namespace {

constexpr std::size_t kLongest = 200;  // bytes, of a list of neighbours
constexpr std::size_t kDigest = 16;    // digits

std::map<std::string, int> CountsOf(const std::vector<std::string>& names) {
  std::map<std::string, int> counts;
  for (const std::string& name : names) ++counts[name];
  return counts;
}

// Returns the neighbours' names that only they have, sorted.
std::string ListOf(const std::vector<int>& beside, const std::vector<std::string>& names,
                   const std::map<std::string, int>& counts) {
  std::set<std::string> known;
  for (const int neighbour : beside) {
    const std::string& name = names[static_cast<std::size_t>(neighbour)];
    if (counts.at(name) == 1) known.insert(name);
  }
  std::string list = absl::StrJoin(known, ", ");
  if (list.size() > kLongest) list = "#" + Sha256Hex(list).substr(0, kDigest);
  return list;
}

}  // namespace

std::vector<std::string> DistinctNames(std::vector<std::string> names,
                                       const std::vector<std::vector<int>>& beside) {
  const std::vector<std::string> given = names;
  // Each turn but the last gives a name of its own to one more at least.
  for (std::size_t turn = 0; turn < given.size(); ++turn) {
    const std::map<std::string, int> counts = CountsOf(names);
    std::vector<std::string> next = names;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (counts.at(names[i]) == 1) continue;
      const std::string list = ListOf(beside[i], names, counts);
      if (!list.empty()) next[i] = absl::StrCat(given[i], " beside (", list, ")");
    }
    const std::map<std::string, int> told = CountsOf(next);
    bool has_new = false;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (counts.at(names[i]) == 1 || told.at(next[i]) > 1) continue;
      names[i] = next[i];
      has_new = true;
    }
    if (!has_new) break;
  }
  return names;
}

}  // namespace mortise::mesh
