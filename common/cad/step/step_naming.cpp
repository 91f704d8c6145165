#include "common/cad/step/step_naming.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"

namespace mortise::cad {
namespace {

// "'a', 'b' and 3 more".
std::string Some(const std::vector<std::string>& names) {
  constexpr std::size_t kShown = 5;
  std::string text;
  for (std::size_t i = 0; i < std::min(kShown, names.size()); ++i) {
    absl::StrAppend(&text, i == 0 ? "'" : ", '", names[i], "'");
  }
  if (names.size() > kShown) absl::StrAppend(&text, " and ", names.size() - kShown, " more");
  return text;
}

}  // namespace

void NameAll(StepAssembly& assembly) {
  std::vector<std::string> names;
  for (const StepPart& part : assembly.parts) names.push_back(part.drawn_name);
  for (const StepLeaf& leaf : assembly.leaves) names.push_back(leaf.drawn_name);
  const std::vector<std::string> distinct = DistinctNames(names, "part");
  std::map<std::string, std::vector<std::string>> renamed;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::size_t leaf = i - std::min(i, assembly.parts.size());
    (i < assembly.parts.size() ? assembly.parts[i].name : assembly.leaves[leaf].name) = distinct[i];
    if (distinct[i] != names[i]) renamed[names[i]].push_back(distinct[i]);
  }
  names.clear();
  for (const StepGroup& group : assembly.groups) names.push_back(group.name);
  names.erase(names.begin());
  const std::vector<std::string> groups = DistinctNames(names, "group");
  for (std::size_t i = 0; i < groups.size(); ++i) {
    assembly.groups[i + 1].name = groups[i];
    if (groups[i] != names[i]) renamed[names[i]].push_back(groups[i]);
  }
  for (const auto& [name, now] : renamed) {
    assembly.notes.push_back(now.size() == 1 ? absl::StrCat("'", name, "' is called '", now[0], "'")
                                             : absl::StrCat("'", name, "' occurs ", now.size(),
                                                            " times; they are called '", now[0],
                                                            "' to '", now.back(), "'"));
  }
}

void TellOfDistortions(StepAssembly& assembly) {
  for (std::size_t i = 0; i < assembly.products.size(); ++i) {
    const StepProduct& product = assembly.products[i];
    if (product.scale == 1 && !product.is_mirrored) continue;
    std::vector<std::string> names;
    for (const StepPart& part : assembly.parts) {
      if (part.product == static_cast<int>(i)) names.push_back(part.name);
    }
    std::string note = Some(names);
    if (product.is_mirrored) {
      absl::StrAppend(&note, names.size() == 1 ? " is a mirror image" : " are mirror images",
                      " of '", product.name, "', which cannot be made from it by turning");
    }
    if (product.scale != 1) {
      absl::StrAppend(&note,
                      product.is_mirrored ? ","
                      : names.size() == 1 ? " is '"
                                          : " are '",
                      product.is_mirrored ? "" : absl::StrCat(product.name, "'"), " at ",
                      product.scale, " times its size");
    }
    assembly.notes.push_back(std::move(note));
  }
}

}  // namespace mortise::cad
