#include "common/design/structure.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/digest.h"

namespace mortise::parametric {

namespace {

// Names may have any letters, so their lengths say where they end.
void AppendName(const std::string& name, std::string& text) {
  absl::StrAppend(&text, name.size(), " ", name, " ");
}

void AppendNames(const char* what, const std::vector<std::string>& names, std::string& text) {
  for (const std::string& name : names) {
    absl::StrAppend(&text, "\n", what, " ");
    AppendName(name, text);
  }
}

}  // namespace

// What a structure has none of is not in the text, so that keys of structures of counts alone are
// those that they always were.
std::string KeyOf(const Structure& structure) {
  std::string text = "structure";
  for (const StructureCount& count : structure.counts) {
    absl::StrAppend(&text, "\n", count.name.size(), " ", count.name, " ",
                    absl::StrJoin(count.numbers, " "));
  }
  for (const StructureChoice& choice : structure.choices) {
    absl::StrAppend(&text, "\nchoice ");
    AppendName(choice.parameter, text);
    AppendName(choice.value, text);
  }
  AppendNames("part", structure.absent_parts, text);
  AppendNames("condition", structure.absent_conditions, text);
  AppendNames("feature", structure.absent_features, text);
  for (const StructureItem& item : structure.items) {
    absl::StrAppend(&text, "\nitem ");
    AppendName(item.part, text);
    AppendName(item.item, text);
  }
  return Sha256Hex(text);
}

std::string Describe(const Structure& structure) {
  std::vector<std::string> texts;
  for (const StructureChoice& choice : structure.choices) {
    texts.push_back(absl::StrCat(choice.parameter, " = ", choice.value));
  }
  for (const auto* absent :
       {&structure.absent_parts, &structure.absent_features, &structure.absent_conditions}) {
    for (const std::string& name : *absent) texts.push_back(absl::StrCat("without ", name));
  }
  for (const StructureCount& count : structure.counts) {
    texts.push_back(absl::StrCat(count.name, ": ", absl::StrJoin(count.numbers, " × ")));
  }
  for (const StructureItem& item : structure.items) {
    texts.push_back(absl::StrCat(item.part, " of ", item.item));
  }
  return texts.empty() ? "always the same" : absl::StrJoin(texts, ", ");
}

}  // namespace mortise::parametric
