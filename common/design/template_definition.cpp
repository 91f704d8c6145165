// Look-ups among the plain structs of templates and designs.
#include "common/design/template_definition.h"

#include <algorithm>
#include <charconv>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/design/evaluated_design.h"

namespace mortise::parametric {
namespace {

template <typename Named>
const Named* FindByName(const std::vector<Named>& entries, const std::string& name) {
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [&name](const Named& entry) { return entry.name == name; });
  return found == entries.end() ? nullptr : &*found;
}

}  // namespace

const char* AxisName(Axis axis) {
  switch (axis) {
    case Axis::kX:
      return "x";
    case Axis::kY:
      return "y";
    case Axis::kZ:
      break;
  }
  return "z";
}

std::string CopyName(std::string_view part, std::span<const int> numbers) {
  std::string name(part);
  if (!numbers.empty()) absl::StrAppend(&name, " ", absl::StrJoin(numbers, "."));
  return name;
}

std::optional<CopyReference> ReadCopyName(std::string_view name) {
  const std::size_t blank = name.find(' ');
  CopyReference reference{std::string(name.substr(0, blank)), {}};
  if (blank == std::string_view::npos) return reference;
  const char* at = name.data() + blank;
  const char* const end = name.data() + name.size();
  while (at != end) {
    int number = 0;
    const bool separates = *at == (reference.numbers.empty() ? ' ' : '.');
    const auto [rest, error] = std::from_chars(at + 1, end, number);
    // Written as CopyName does, without signs and zeros before the number.
    const bool is_number = error == std::errc() && number >= 1 && number <= 1000;
    if (!separates || !is_number || at[1] == '0') return {};
    reference.numbers.push_back(number);
    at = rest;
  }
  return reference;
}

const Item* FindItem(const std::vector<Item>& items, const std::string& name) {
  return FindByName(items, name);
}

const Material* FindMaterial(const std::vector<Material>& materials, const std::string& name) {
  return FindByName(materials, name);
}

int FindPart(const EvaluatedDesign& design, const std::string& name) {
  const EvaluatedPart* part = FindByName(design.parts, name);
  return part == nullptr ? -1 : static_cast<int>(part - design.parts.data());
}

Eigen::Vector3d FromPrismAxes(Axis axis, double u, double v, double along) {
  switch (axis) {
    case Axis::kX:
      return {along, u, v};
    case Axis::kY:
      return {v, along, u};
    case Axis::kZ:
      break;
  }
  return {u, v, along};
}

}  // namespace mortise::parametric
