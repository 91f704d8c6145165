#include "common/design/structure.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/digest.h"

namespace mortise::parametric {

// Names may have any letters, so their lengths say where they end.
std::string KeyOf(const Structure& structure) {
  std::string text = "structure";
  for (const StructureCount& count : structure.counts) {
    absl::StrAppend(&text, "\n", count.name.size(), " ", count.name, " ",
                    absl::StrJoin(count.numbers, " "));
  }
  return Sha256Hex(text);
}

std::string Describe(const Structure& structure) {
  if (structure.counts.empty()) return "always the same";
  std::vector<std::string> texts;
  for (const StructureCount& count : structure.counts) {
    texts.push_back(absl::StrCat(count.name, ": ", absl::StrJoin(count.numbers, " × ")));
  }
  return absl::StrJoin(texts, ", ");
}

}  // namespace mortise::parametric
