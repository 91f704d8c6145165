// CAD templates that can be evaluated: F(q) of a list of features is a solid with named faces, and
// the supports and loads on them (thesis §6.1).
//
//   std::vector<FieldViolation> findings = ValidateCadTemplate(definition);
//   MORTISE_ASSIGN_OR_RETURN(FeatureModel model, FeatureModel::Create(definition));
//   MORTISE_ASSIGN_OR_RETURN(RegeneratedModel wrench, model.Regenerate(model.Defaults()));
//   wrench.solid.Volume();
//   FacesOf(wrench, "jaw.opening");     // indices into wrench.solid.face_names()
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "common/cad/solid.h"
#include "common/design/face_condition.h"
#include "common/design/structure.h"
#include "common/design/template_validation.h"
#include "common/templates/features/cad_template.h"
#include "common/templates/features/feature_numbers.h"
#include "common/templates/features/feature_reference.h"

namespace mortise::cad {

struct RegeneratedModel {
  Solid solid;  // valid by the kernel's check; face_names are the first of `origins`
  std::vector<std::vector<FaceName>> origins;         // of each face: all names that lead to it
  std::vector<parametric::FaceCondition> conditions;  // in the order of the features
  std::optional<double> reference_temperature;        // K; no thermal stress without it
};

// Returns the indices of the faces that a reference as in feature_reference.h means.
// INVALID_ARGUMENT if it cannot be read; none if no face is of that name. "[0]" and "[*]" of a
// pattern do not include the feature that it repeats: ask for that by its own name.
absl::StatusOr<std::vector<int>> FacesOf(const RegeneratedModel& model, std::string_view reference);

// Returns everything that can be seen to be wrong without making a solid, at once: names, ranges,
// references to features that do not exist, come later or cannot be meant, roles that a feature
// does not have, and numbers that are not what they must be at the defaults, at every corner of the
// parameter box (the ends of single parameters where there are more than 6) and at random points,
// always the same.
std::vector<FieldViolation> ValidateCadTemplate(const CadTemplate& definition);

// A list of features, checked. Immutable; may be used from any number of threads.
class FeatureModel {
 public:
  // Makes a model. INVALID_ARGUMENT naming all that ValidateCadTemplate finds.
  static absl::StatusOr<FeatureModel> Create(CadTemplate definition);

  const CadTemplate& definition() const { return state_->definition; }
  Eigen::VectorXd Defaults() const;

  // Returns the solid at `q`, one entry a parameter in the template's order. INVALID_ARGUMENT
  // naming each parameter out of its range ("parameters[1]"); each number that is not what it must
  // be ("features[3].fillet.radius"); or the first feature that cannot be made, with its reference
  // ("features[3].fillet.edges[0]") and why. The last is also the answer if the kernel fails or its
  // check finds the solid invalid.
  absl::StatusOr<RegeneratedModel> Regenerate(const Eigen::Ref<const Eigen::VectorXd>& q) const;

  // Returns how many instances each pattern has at `q`, the feature that it repeats among them, and
  // how many corners each polygon of a sketch ("sketch.profile"), feature by feature. Takes
  // microseconds, as no solid is made: INVALID_ARGUMENT naming parameters and numbers only.
  absl::StatusOr<parametric::Structure> StructureAt(
      const Eigen::Ref<const Eigen::VectorXd>& q) const;

 private:
  absl::StatusOr<Numbers> NumbersAt(const Eigen::Ref<const Eigen::VectorXd>& q) const;

  struct State {
    CadTemplate definition;
    FeatureNumbers numbers;
  };
  explicit FeatureModel(std::shared_ptr<const State> state) : state_(std::move(state)) {}

  std::shared_ptr<const State> state_;
};

}  // namespace mortise::cad
