#include "services/simulator/worker/mesh_load_checks.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "mortise/v1/simulator.pb.h"
#include "services/simulator/worker/mesh_case_checks.h"

namespace mortise::simulator {
namespace {

constexpr int kMaxPointForces = 100;

// An empty vector is a load whose numbers somebody forgot.
absl::Status CheckLoad(const v1::LoadVector& load, const std::string& field) {
  if (load.has_x() || load.has_y() || load.has_z()) return absl::OkStatus();
  return InvalidField(field, "needs at least one of x, y, z");
}

bool IsZero(const v1::LoadVector& load) { return load.x() == 0 && load.y() == 0 && load.z() == 0; }

// Loads on groups; `vector` gives a load's own.
template <typename Loads, typename Vector>
absl::Status CheckVectors(const Loads& loads, const std::string& field, const char* list,
                          const char* name, const Vector& vector) {
  for (int i = 0; i < loads.size(); ++i) {
    MORTISE_RETURN_IF_ERROR(
        CheckLoad(vector(loads[i]), absl::StrCat(At(field, list, i), ".", name)));
  }
  return absl::OkStatus();
}

absl::Status CheckGroupLoads(const v1::MeshLoadCase& loads, const std::string& field) {
  const auto has_force = [](const auto& load) { return load.has_force(); };
  const auto force = [](const auto& load) { return load.force(); };
  MORTISE_RETURN_IF_ERROR(CheckConditions(loads.forces(), field, "forces", "force", has_force));
  MORTISE_RETURN_IF_ERROR(CheckVectors(loads.forces(), field, "forces", "force", force));
  MORTISE_RETURN_IF_ERROR(CheckConditions(loads.pressures(), field, "pressures", "pressure",
                                          [](const auto& load) { return load.has_pressure(); }));
  MORTISE_RETURN_IF_ERROR(CheckConditions(loads.tractions(), field, "tractions", "traction",
                                          [](const auto& load) { return load.has_traction(); }));
  MORTISE_RETURN_IF_ERROR(CheckVectors(loads.tractions(), field, "tractions", "traction",
                                       [](const auto& load) { return load.traction(); }));
  MORTISE_RETURN_IF_ERROR(
      CheckConditions(loads.nodal_forces(), field, "nodal_forces", "force", has_force));
  return CheckVectors(loads.nodal_forces(), field, "nodal_forces", "force", force);
}

absl::Status CheckPointForces(const v1::MeshLoadCase& loads, const std::string& field) {
  MORTISE_RETURN_IF_ERROR(
      CheckCount(loads.point_forces_size(), kMaxPointForces, field + ".point_forces"));
  for (int i = 0; i < loads.point_forces_size(); ++i) {
    const v1::PointForce& load = loads.point_forces(i);
    const std::string place = At(field, "point_forces", i);
    MORTISE_RETURN_IF_ERROR(CheckGiven(load.has_position(), place + ".position"));
    MORTISE_RETURN_IF_ERROR(CheckGiven(load.has_force(), place + ".force"));
    MORTISE_RETURN_IF_ERROR(CheckLoad(load.force(), place + ".force"));
  }
  return absl::OkStatus();
}

absl::Status CheckBodyLoads(const v1::MeshLoadCase& loads, const std::string& field) {
  if (loads.has_gravity()) {
    MORTISE_RETURN_IF_ERROR(CheckLoad(loads.gravity(), field + ".gravity"));
  }
  if (loads.has_body_force()) {
    MORTISE_RETURN_IF_ERROR(CheckLoad(loads.body_force(), field + ".body_force"));
  }
  if (!loads.has_rotation()) return absl::OkStatus();
  const std::string velocity = field + ".rotation.angular_velocity";
  MORTISE_RETURN_IF_ERROR(CheckGiven(loads.rotation().has_angular_velocity(), velocity));
  return CheckLoad(loads.rotation().angular_velocity(), velocity);
}

// Whether a load case has a load that is not 0.
bool IsLoaded(const v1::MeshLoadCase& loads) {
  const auto any = [](const auto& list, const auto& is_zero) {
    return !std::all_of(list.begin(), list.end(), is_zero);
  };
  const auto no_force = [](const auto& load) { return IsZero(load.force()); };
  return !IsZero(loads.gravity()) || !IsZero(loads.body_force()) ||
         !IsZero(loads.rotation().angular_velocity()) || any(loads.forces(), no_force) ||
         any(loads.point_forces(), no_force) || any(loads.nodal_forces(), no_force) ||
         any(loads.pressures(), [](const auto& load) { return load.pressure() == 0; }) ||
         any(loads.tractions(), [](const auto& load) { return IsZero(load.traction()); });
}

absl::Status CheckLoaded(const v1::MeshLoadCase& loads, const v1::MeshCase& of,
                         const std::string& field) {
  if (MovesSupports(of) || IsLoaded(loads)) return absl::OkStatus();
  return PreconditionFailed(
      "NO_LOADS",
      absl::StrCat("nothing loads ", field,
                   ": give it forces, pressures, tractions, point_forces, nodal_forces, gravity, "
                   "body_force or rotation that are not 0, or thermal_stress; without one, every "
                   "displacement and stress is 0"),
      field);
}

}  // namespace

bool MovesSupports(const v1::MeshCase& of) {
  return std::any_of(of.supports().begin(), of.supports().end(), [](const auto& support) {
    const v1::PrescribedDisplacement& by = support.displacement();
    return by.x() != 0 || by.y() != 0 || by.z() != 0;
  });
}

absl::Status CheckLoadCase(const v1::MeshLoadCase& loads, const v1::MeshCase& of,
                           const std::string& field) {
  MORTISE_RETURN_IF_ERROR(CheckGroupLoads(loads, field));
  MORTISE_RETURN_IF_ERROR(CheckPointForces(loads, field));
  MORTISE_RETURN_IF_ERROR(CheckBodyLoads(loads, field));
  if (!loads.thermal_stress()) return CheckLoaded(loads, of, field);
  if (!of.has_heat()) {
    return InvalidField(field + ".thermal_stress", "needs the case's `heat`");
  }
  if (!of.heat().has_reference_temperature()) {
    return InvalidField(field + ".thermal_stress", "needs the heat's `reference_temperature`");
  }
  return absl::OkStatus();
}

}  // namespace mortise::simulator
