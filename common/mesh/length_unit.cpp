#include "common/mesh/length_unit.h"

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::mesh {

absl::StatusOr<double> MetresOf(const std::string& length_unit, const std::string& field) {
  constexpr struct {
    const char* name;
    double metres;
  } kUnits[] = {{"m", 1},     {"cm", 1e-2},    {"mm", 1e-3},
                {"um", 1e-6}, {"in", 25.4e-3}, {"ft", 304.8e-3}};
  for (const auto& unit : kUnits) {
    if (length_unit == unit.name) return unit.metres;
  }
  constexpr char kChoice[] = "give the unit of the mesh's coordinates: m, cm, mm, um, in or ft";
  if (length_unit.empty()) return InvalidField(field, absl::StrCat("is missing; ", kChoice));
  return InvalidField(field, absl::StrCat("is none that is known here; ", kChoice));
}

}  // namespace mortise::mesh
