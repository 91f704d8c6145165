#include "common/assembly/codec/assembly_drawing.h"

#include <algorithm>

#include "absl/strings/str_cat.h"

namespace mortise::parametric {
namespace {

constexpr std::size_t kMaxName = 63;  // bytes

}  // namespace

void CheckAssemblyName(const std::string& field, const std::string& name,
                       std::vector<FieldViolation>& findings) {
  const bool printable = std::all_of(name.begin(), name.end(), [](char c) {
    return static_cast<unsigned char>(c) >= ' ' && c != 127;
  });
  if (name.empty() || name.size() > kMaxName || !printable) {
    findings.push_back(
        {field, absl::StrCat("must be 1 to ", kMaxName, " bytes of text in one line")});
  }
}

}  // namespace mortise::parametric
