#include "services/simulator/worker/mesh_case.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/mesh/length_unit.h"
#include "mortise/v1/item.pb.h"
#include "mortise/v1/simulator.pb.h"
#include "services/simulator/worker/mesh_case_checks.h"
#include "services/simulator/worker/mesh_load_checks.h"

namespace mortise::simulator {
namespace {

constexpr int kMaxMaterials = 100;  // and supports 200: so that results fit into a message
constexpr int kMaxSupports = 200;
constexpr int kMaxCases = 50;
constexpr int kMaxProbes = 100;
constexpr int kMaxPoints = 1000;
constexpr int kMaxModes = 100;
constexpr std::size_t kMaxCase = 200'000;  // bytes; workers may lease 16 in one message

absl::Status CheckPositive(double value, const std::string& field) {
  return value > 0 ? absl::OkStatus() : InvalidField(field, "must be positive");
}

absl::Status CheckNotNegative(double value, const std::string& field) {
  return value >= 0 ? absl::OkStatus() : InvalidField(field, "must not be negative");
}

// Three numbers, or none where they may be missing.
absl::Status CheckThree(const google::protobuf::RepeatedField<double>& values, bool may_be_missing,
                        const std::string& field) {
  if (values.size() == 3 || (values.empty() && may_be_missing)) return absl::OkStatus();
  return InvalidField(field, absl::StrCat("must have three numbers, not ", values.size()));
}

// `conducts`: whether conductivities are needed.
absl::Status CheckOrthotropic(const v1::OrthotropicValues& values, bool conducts,
                              const std::string& field) {
  const struct {
    const char* name;
    const google::protobuf::RepeatedField<double>& list;
    bool may_be_missing;
    bool is_positive;  // all must be
  } lists[] = {
      {"youngs_modulus", values.youngs_modulus(), false, true},
      {"poissons_ratio", values.poissons_ratio(), false, false},
      {"shear_modulus", values.shear_modulus(), false, true},
      {"thermal_expansion", values.thermal_expansion(), true, false},
      {"thermal_conductivity", values.thermal_conductivity(), !conducts, true},
  };
  // What is there but wrong is named before what is missing.
  for (const bool missing : {false, true}) {
    for (const auto& list : lists) {
      if (list.list.empty() != missing) continue;
      const std::string name = absl::StrCat(field, ".", list.name);
      MORTISE_RETURN_IF_ERROR(CheckThree(list.list, list.may_be_missing, name));
      for (int i = 0; i < list.list.size(); ++i) {
        const std::string element = absl::StrCat(name, "[", i, "]");
        if (list.is_positive) MORTISE_RETURN_IF_ERROR(CheckPositive(list.list[i], element));
      }
    }
  }
  return absl::OkStatus();
}

absl::Status CheckValues(const v1::MaterialValues& values, bool conducts,
                         const std::string& field) {
  if (values.has_orthotropic()) {
    MORTISE_RETURN_IF_ERROR(
        CheckOrthotropic(values.orthotropic(), conducts, field + ".orthotropic"));
  }
  MORTISE_RETURN_IF_ERROR(CheckPositive(values.density(), field + ".density"));
  MORTISE_RETURN_IF_ERROR(CheckNotNegative(values.strength(), field + ".strength"));
  MORTISE_RETURN_IF_ERROR(
      CheckNotNegative(values.thermal_conductivity(), field + ".thermal_conductivity"));
  MORTISE_RETURN_IF_ERROR(CheckNotNegative(values.youngs_modulus(), field + ".youngs_modulus"));
  if (values.has_orthotropic()) return absl::OkStatus();
  MORTISE_RETURN_IF_ERROR(CheckPositive(values.youngs_modulus(), field + ".youngs_modulus"));
  if (!(values.poissons_ratio() > -1 && values.poissons_ratio() <= 0.4999)) {
    return InvalidField(field + ".poissons_ratio",
                        "must lie above -1 and at most at 0.4999: at 0.5 a material is "
                        "incompressible, and elements of displacements lock");
  }
  if (!conducts) return absl::OkStatus();
  return CheckPositive(values.thermal_conductivity(), field + ".thermal_conductivity");
}

absl::Status CheckMaterialUse(const v1::MeshMaterial& use, bool conducts,
                              const std::string& field) {
  if (use.has_values()) {
    MORTISE_RETURN_IF_ERROR(CheckValues(use.values(), conducts, field + ".values"));
  } else if (!use.has_material()) {
    return InvalidField(field + ".values", "is missing, and so is `material`: give one of them");
  } else {
    MORTISE_RETURN_IF_ERROR(
        ParseResourceName(use.material(), "materials", field + ".material").status());
  }
  if (use.has_axes()) {
    const v1::Vector3& grain = use.axes().grain();
    if (grain.x() == 0 && grain.y() == 0 && grain.z() == 0) {
      return InvalidField(field + ".axes.grain", "must not be zero");
    }
    if (use.has_values() && !use.values().has_orthotropic()) {
      return InvalidField(field + ".axes", "is only for materials with `orthotropic`");
    }
  }
  return CheckGroups(use.groups(), true, field);
}

absl::Status CheckSupport(const v1::MeshSupport& support, const std::string& field) {
  MORTISE_RETURN_IF_ERROR(CheckGroups(support.groups(), false, field));
  switch (support.hold_case()) {
    case v1::MeshSupport::kFixed:
      if (!support.fixed()) return InvalidField(field + ".fixed", "must be true, or left out");
      return absl::OkStatus();
    case v1::MeshSupport::kSymmetric:
      if (!support.symmetric()) {
        return InvalidField(field + ".symmetric", "must be true, or left out");
      }
      return absl::OkStatus();
    case v1::MeshSupport::kDisplacement:
      if (support.displacement().has_x() || support.displacement().has_y() ||
          support.displacement().has_z()) {
        return absl::OkStatus();
      }
      return InvalidField(field + ".displacement", "must have x, y or z");
    default:
      return InvalidField(field + ".fixed",
                          "is missing: a support has one of fixed, displacement and symmetric");
  }
}

absl::Status CheckHeat(const v1::MeshHeat& heat, const std::string& field) {
  for (int i = 0; i < std::min(heat.convections_size(), kMaxConditions); ++i) {
    MORTISE_RETURN_IF_ERROR(CheckPositive(heat.convections(i).coefficient(),
                                          At(field, "convections", i) + ".coefficient"));
  }
  MORTISE_RETURN_IF_ERROR(CheckConditions(heat.temperatures(), field, "temperatures", "temperature",
                                          [](const auto& held) { return held.has_temperature(); }));
  MORTISE_RETURN_IF_ERROR(CheckConditions(heat.fluxes(), field, "fluxes", "flux",
                                          [](const auto& flux) { return flux.has_flux(); }));
  MORTISE_RETURN_IF_ERROR(CheckConditions(heat.convections(), field, "convections", "ambient",
                                          [](const auto& air) { return air.has_ambient(); }));
  return CheckConditions(
      heat.sources(), field, "sources", "power",
      [](const auto& source) { return source.has_power(); }, true);
}

// Names that are there, and only once.
class Names {
 public:
  absl::Status Add(const std::string& name, const std::string& owner) {
    const std::string field = owner + ".name";
    if (name.empty()) return InvalidField(field, "is missing");
    MORTISE_RETURN_IF_ERROR(CheckLabel(name, field));
    const auto [found, is_new] = owners_.emplace(name, owner);
    if (is_new) return absl::OkStatus();
    return InvalidField(field, absl::StrCat("'", name, "' is the name of ", found->second, " too"));
  }

 private:
  std::map<std::string, std::string> owners_;
};

// Prescribed displacements are in every load case, and a sum of cases must have them once.
absl::Status CheckFactors(const v1::LoadCombination& combination, const v1::MeshCase& of,
                          const std::string& field) {
  double sum = 0;
  for (int i = 0; i < combination.terms_size(); ++i) {
    MORTISE_RETURN_IF_ERROR(
        CheckGiven(combination.terms(i).has_factor(), At(field, "terms", i) + ".factor"));
    sum += combination.terms(i).factor();
  }
  if (std::abs(sum - 1) <= 1e-9 || !MovesSupports(of)) return absl::OkStatus();
  return InvalidField(field + ".terms",
                      absl::StrCat("has factors that add up to ", sum,
                                   "; supports are moved in every load case, so that only sums of "
                                   "factors 1 move them as prescribed"));
}

absl::Status CheckCombination(const v1::LoadCombination& combination, const v1::MeshCase& of,
                              const std::string& field) {
  MORTISE_RETURN_IF_ERROR(CheckCount(combination.terms_size(), kMaxCases, field + ".terms"));
  if (combination.terms().empty()) return InvalidField(field + ".terms", "must not be empty");
  for (int i = 0; i < combination.terms_size(); ++i) {
    const std::string& name = combination.terms(i).load_case();
    if (std::any_of(of.load_cases().begin(), of.load_cases().end(),
                    [&](const v1::MeshLoadCase& loads) { return loads.name() == name; })) {
      continue;
    }
    const std::string names =
        absl::StrJoin(of.load_cases(), ", ", [](std::string* out, const v1::MeshLoadCase& loads) {
          absl::StrAppend(out, "'", loads.name(), "'");
        });
    return InvalidField(At(field, "terms", i) + ".load_case",
                        absl::StrCat("there is no load case '", name.substr(0, kMaxLabelLength),
                                     "'; there are ", names.empty() ? "none" : names));
  }
  return CheckFactors(combination, of, field);
}

absl::Status CheckProbe(const v1::MeshProbe& probe, const std::string& field) {
  MORTISE_RETURN_IF_ERROR(CheckCount(probe.points_size(), kMaxPoints, field + ".points"));
  MORTISE_RETURN_IF_ERROR(CheckGroups(probe.groups(), true, field));
  if (!probe.points().empty() || !probe.groups().empty()) return absl::OkStatus();
  return InvalidField(field + ".points", "is missing, and so is `groups`");
}

// Far beyond all that can be measured, and squares of it are still numbers.
constexpr double kMaxNumber = 1e30;

// INVALID_ARGUMENT naming the first number below `field` that is larger.
absl::Status CheckMagnitudes(const google::protobuf::Message& message, const std::string& field) {
  using google::protobuf::FieldDescriptor;
  const google::protobuf::Reflection& reflection = *message.GetReflection();
  std::vector<const FieldDescriptor*> present;
  reflection.ListFields(message, &present);
  for (const FieldDescriptor* at : present) {
    const int count = at->is_repeated() ? reflection.FieldSize(message, at) : 1;
    for (int i = 0; i < count; ++i) {
      const std::string path =
          absl::StrCat(field, ".", at->name(), at->is_repeated() ? absl::StrCat("[", i, "]") : "");
      if (at->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
        MORTISE_RETURN_IF_ERROR(CheckMagnitudes(at->is_repeated()
                                                    ? reflection.GetRepeatedMessage(message, at, i)
                                                    : reflection.GetMessage(message, at),
                                                path));
      } else if (at->cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE) {
        const double value = at->is_repeated() ? reflection.GetRepeatedDouble(message, at, i)
                                               : reflection.GetDouble(message, at);
        if (std::abs(value) > kMaxNumber) {
          return InvalidField(path, absl::StrCat("is beyond ", kMaxNumber));
        }
      }
    }
  }
  return absl::OkStatus();
}

absl::Status CheckCounts(const v1::MeshCase& of, const std::string& field) {
  MORTISE_RETURN_IF_ERROR(CheckCount(of.materials_size(), kMaxMaterials, field + ".materials"));
  MORTISE_RETURN_IF_ERROR(CheckCount(of.supports_size(), kMaxSupports, field + ".supports"));
  MORTISE_RETURN_IF_ERROR(CheckCount(of.load_cases_size(), kMaxCases, field + ".load_cases"));
  MORTISE_RETURN_IF_ERROR(CheckCount(of.combinations_size(), kMaxCases, field + ".combinations"));
  MORTISE_RETURN_IF_ERROR(CheckCount(of.probes_size(), kMaxProbes, field + ".probes"));
  if (of.modes() < 0 || of.modes() > kMaxModes) {
    return InvalidField(field + ".modes", absl::StrCat("must be within 0 to ", kMaxModes));
  }
  if (of.materials().empty()) return InvalidField(field + ".materials", "must not be empty");
  if (of.load_cases().empty() && !of.has_heat() && of.modes() == 0) {
    return InvalidField(field + ".load_cases",
                        "is missing, and so are `heat` and `modes`: nothing is asked for");
  }
  return CheckLabel(of.title(), field + ".title");
}

}  // namespace

absl::Status CheckMeshCase(const v1::MeshCase& mesh_case, const std::string& field) {
  if (mesh_case.ByteSizeLong() > kMaxCase) {
    return TooLarge(field, absl::StrCat(kMaxCase, " bytes"));
  }
  MORTISE_RETURN_IF_ERROR(mesh::MetresOf(mesh_case.length_unit(), field + ".length_unit").status());
  MORTISE_RETURN_IF_ERROR(CheckMagnitudes(mesh_case, field));
  MORTISE_RETURN_IF_ERROR(CheckCounts(mesh_case, field));
  for (int i = 0; i < mesh_case.materials_size(); ++i) {
    MORTISE_RETURN_IF_ERROR(
        CheckMaterialUse(mesh_case.materials(i), mesh_case.has_heat(), At(field, "materials", i)));
  }
  for (int i = 0; i < mesh_case.supports_size(); ++i) {
    MORTISE_RETURN_IF_ERROR(CheckSupport(mesh_case.supports(i), At(field, "supports", i)));
  }
  if (mesh_case.has_heat()) {
    MORTISE_RETURN_IF_ERROR(CheckHeat(mesh_case.heat(), field + ".heat"));
  }
  Names names;
  for (int i = 0; i < mesh_case.load_cases_size(); ++i) {
    const std::string place = At(field, "load_cases", i);
    MORTISE_RETURN_IF_ERROR(CheckLoadCase(mesh_case.load_cases(i), mesh_case, place));
    MORTISE_RETURN_IF_ERROR(names.Add(mesh_case.load_cases(i).name(), place));
  }
  for (int i = 0; i < mesh_case.combinations_size(); ++i) {
    const std::string place = At(field, "combinations", i);
    MORTISE_RETURN_IF_ERROR(CheckCombination(mesh_case.combinations(i), mesh_case, place));
    MORTISE_RETURN_IF_ERROR(names.Add(mesh_case.combinations(i).name(), place));
  }
  Names probes;
  for (int i = 0; i < mesh_case.probes_size(); ++i) {
    const std::string place = At(field, "probes", i);
    MORTISE_RETURN_IF_ERROR(CheckProbe(mesh_case.probes(i), place));
    MORTISE_RETURN_IF_ERROR(probes.Add(mesh_case.probes(i).name(), place));
  }
  return absl::OkStatus();
}

void UseCatalogMaterial(const v1::Material& material, v1::MeshMaterial& use) {
  v1::MaterialValues& values = *use.mutable_values();  // takes the place of the name
  values.Clear();
  values.set_density(material.density());
  values.set_youngs_modulus(material.youngs_modulus());
  values.set_poissons_ratio(material.poissons_ratio());
  values.set_strength(material.strength());
  values.set_thermal_expansion(material.thermal_expansion());
  values.set_thermal_conductivity(material.thermal_conductivity());
  // Without axes nobody knows where the grain runs: the isotropic values hold.
  if (!material.has_orthotropic() || !use.has_axes()) return;
  const v1::OrthotropicElasticity& wood = material.orthotropic();
  v1::OrthotropicValues& three = *values.mutable_orthotropic();
  for (const double value :
       {wood.youngs_modulus_l(), wood.youngs_modulus_r(), wood.youngs_modulus_t()}) {
    three.add_youngs_modulus(value);
  }
  for (const double value :
       {wood.poissons_ratio_lr(), wood.poissons_ratio_rt(), wood.poissons_ratio_lt()}) {
    three.add_poissons_ratio(value);
  }
  for (const double value :
       {wood.shear_modulus_lr(), wood.shear_modulus_rt(), wood.shear_modulus_lt()}) {
    three.add_shear_modulus(value);
  }
  for (int k = 0; k < 3; ++k) {
    three.add_thermal_expansion(material.thermal_expansion());
    if (material.thermal_conductivity() > 0) {
      three.add_thermal_conductivity(material.thermal_conductivity());
    }
  }
}

}  // namespace mortise::simulator
