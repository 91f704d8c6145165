#include "services/simulator/analysis/analysis_notes.h"

#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/units.h"

namespace mortise::simulator {
namespace {

constexpr double kLeastModulus = kMegapascal, kMostModulus = 2e12;  // Pa
constexpr double kLeastDensity = 0.1, kMostDensity = 30'000;        // kg/m³

// A unit in which a number may have been meant.
struct OtherUnit {
  double factor = 1;  // SI units in one
  const char* name = "";
};

// Of those that people are used to, the commonest first.
constexpr std::array<OtherUnit, 2> kUnitsOfModulus{{{kGigapascal, "GPa"}, {kMegapascal, "MPa"}}};
constexpr std::array<OtherUnit, 3> kUnitsOfDensity{
    {{1e3, "g/cm³"}, {1e6, "g/mm³"}, {1e12, "t/mm³"}}};
// What ordinary materials have: a suggestion is to be likely, not just possible.
constexpr double kLeastUsualModulus = 1e8, kMostUsualModulus = 1.3e12;  // Pa
constexpr double kLeastUsualDensity = 100, kMostUsualDensity = 23'000;  // kg/m³

template <std::size_t N>
std::string Meant(double value, const std::array<OtherUnit, N>& units, double least, double most) {
  for (const OtherUnit& unit : units) {
    const double meant = value * unit.factor;
    if (meant >= least && meant <= most) {
      return absl::StrFormat("; were %.6g %s meant?", value, unit.name);
    }
  }
  return "; is the number in SI units?";
}

std::string NoteOnModulus(const std::string& name, const std::string& field, double value) {
  if (value >= kLeastModulus && value <= kMostModulus) return "";
  return absl::StrFormat(
      "material '%s': a %s of %.6g Pa is outside of what solids have, 1 MPa to 2 TPa%s", name,
      field, value, Meant(value, kUnitsOfModulus, kLeastUsualModulus, kMostUsualModulus));
}

std::string NoteOnDensity(const std::string& name, double value) {
  if (value == 0 || (value >= kLeastDensity && value <= kMostDensity)) return "";
  return absl::StrFormat(
      "material '%s': a density of %.6g kg/m³ is outside of what solids have, 0.1 to 30000%s", name,
      value, Meant(value, kUnitsOfDensity, kLeastUsualDensity, kMostUsualDensity));
}

void AddNotes(const Material& material, std::vector<std::string>& notes) {
  const auto add = [&notes](std::string note) {
    if (!note.empty()) notes.push_back(std::move(note));
  };
  if (material.orthotropy) {
    for (int k = 0; k < 3; ++k) {
      add(NoteOnModulus(material.name, absl::StrCat("youngs_modulus along direction ", k + 1),
                        material.orthotropy->youngs_modulus[k]));
    }
  } else {
    add(NoteOnModulus(material.name, "youngs_modulus", material.youngs_modulus));
  }
  add(NoteOnDensity(material.name, material.density));
}

std::string LengthText(double metres) {
  return metres < 1 ? absl::StrFormat("%.3g mm", metres / kMillimetre)
                    : absl::StrFormat("%.4g m", metres);
}

}  // namespace

std::vector<std::string> NotesOnMaterials(const std::vector<Material>& materials) {
  std::set<std::string> told;
  std::vector<std::string> notes;
  for (const Material& material : materials) {
    if (told.insert(material.name).second) AddNotes(material, notes);
  }
  return notes;
}

std::string NoteOnDisplacement(double largest, const Eigen::Matrix3Xd& nodes) {
  const double size = (nodes.rowwise().maxCoeff() - nodes.rowwise().minCoeff()).norm();
  if (!(largest > size)) return "";
  return absl::StrFormat(
      "the largest displacement, %s, exceeds the size of all that is there, %s: linear analysis "
      "means nothing at such displacements; look at the loads and at how stiff the materials are",
      LengthText(largest), LengthText(size));
}

std::string NoteOnBudget(const mesh::BudgetedMesh& mesh, const mesh::ElementBudget& budget) {
  if (mesh.is_beyond) {
    return absl::StrFormat(
        "the mesh has %d elements, more than the %.0f that it should have where nobody asks for a "
        "size: no coarser one could be made",
        mesh.mesh.tetrahedra.cols(), mesh::ElementsOf(budget));
  }
  if (mesh.chosen_size == 0) return "";
  return absl::StrFormat(
      "elements are up to %.3g mm wide, also where parts are thinner: %d of them, as well-shaped "
      "ones would be more than the budget of %.0f. An element_size (--element-size %.3gmm) gives "
      "those, however many they are; a relative_error (--relative-error 0.1) refines where it "
      "matters%s",
      mesh.chosen_size / kMillimetre, mesh.mesh.tetrahedra.cols(), mesh::ElementsOf(budget),
      // What is asked for is scaled as the default was.
      mesh.wanted_size / budget.size_scale / kMillimetre,
      mesh.mesh.IsQuadratic() ? ""
                              : ". Linear elements in one layer hardly bend: leave out `linear` "
                                "(--linear)");
}

}  // namespace mortise::simulator
