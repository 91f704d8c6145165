// The shape of an analysed design and the fields on it, as evaluators give them beside metrics
// (fields/design_fields.h).
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/fields/design_fields.h"
#include "services/simulator/analysis/design_analysis.h"

namespace mortise::simulator {

// What must be solved to know a field.
enum class FieldSource { kLoads, kHeat, kModes, kAirflow };

// A field that designs can be asked for.
struct FieldDescription {
  std::string name;
  std::string unit;
  int components = 1;
  bool of_elements = false;  // else of nodes
  FieldSource source = FieldSource::kLoads;
  std::string description;
};

// Returns all of them: displacement, von_mises, stress, max_principal, reaction, temperature,
// heat_flux, mode_shape, air_pressure.
const std::vector<FieldDescription>& OfferedFields();

// What is wanted of a design.
struct FieldsDemand {
  bool tetrahedra = false;                // else the surface only
  std::vector<std::string> fields = {};   // names of OfferedFields, each once
  std::vector<std::string> regions = {};  // names; all if there are none
  int modes = 1;                          // how many natural modes that deform, for mode_shape
};

// Has `options` ask for all that the demand needs besides the metrics: the mesh, loads, heat, modes
// and the air around it.
void DemandFields(const FieldsDemand& demand, DesignAnalysisOptions& options);

// Returns the shape and fields of a design that was analysed as DemandFields says: of the mesh that
// it was solved on; of the surface as it was joined where there is no mesh. Fields come in the
// order asked for, each in every load case; shapes of modes as load cases "mode 1" and so on, those
// that move without deforming not counted. Without tetrahedra only the nodes of triangles are kept.
//
// Regions are called by the names of conditions that act on a face, then by those of faces, as
// FindFace finds them. Those that have other parts in front are all there: `triangle_front` tells.
//
// Control points and ways are those of the model, or else those of the outer surface where faces
// meet (mesh/face_edges.h); regions that are asked for have no part in it. Beyond 100,000 points
// there are none.
//
// INVALID_ARGUMENT naming "design_fields.regions[i]" for one that the design has not, or
// "design_fields.fields[i]" for fields of elements without tetrahedra.
absl::StatusOr<fields::DesignFields> CollectFields(const DesignModel& model,
                                                   const DesignAnalysis& analysis,
                                                   const FieldsDemand& demand);

}  // namespace mortise::simulator
