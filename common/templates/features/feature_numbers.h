// The numbers of a list of features: which there are, what each must be, and their values at given
// parameters.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "absl/status/statusor.h"
#include "common/design/template_validation.h"
#include "common/expressions/expression.h"
#include "common/templates/features/cad_template.h"

namespace mortise::cad {

// The most instances of one pattern, and the most copies that all patterns of a template make
// together: the kernel combines them in a few seconds, which grow with the square of the number.
inline constexpr int kMaxInstances = 200;

// The need that a number must meet to be used.
enum class Need {
  kAny,         // finite
  kPosition,    // m, at most 1 km from the origin
  kLength,      // m, 1 µm to 1 km
  kCount,       // a whole number from 1 to 1000
  kSides,       // a whole number from 3 to 64
  kTurn,        // rad, more than 0 to a full turn
  kDraftAngle,  // rad, more than 0, less than 1.2
  kConeAngle,   // rad, 0.1 to 3
  kPositive,    // more than 0
};

// A number of a feature.
struct NumberUse {
  std::string field;  // "extrude.to", within the feature
  const Formula* formula;
  Need need = Need::kAny;
  bool optional = false;  // may be empty
};

// Returns all numbers of a feature. They point into it.
std::vector<NumberUse> NumbersOf(const Feature& feature);

// The values at given parameters, by the text of the expression.
class Numbers {
 public:
  double operator()(const Formula& formula) const;  // 0 if empty; else it must be known
  Eigen::Vector2d operator()(const Formula2& formula) const;
  Eigen::Vector3d operator()(const Formula3& formula) const;

  bool Knows(const Formula& formula) const { return formula.empty() || values_.contains(formula); }

  // Whether the feature of this index is made, or acts. Of one that is not nothing else is known.
  bool IsPresent(std::size_t feature) const { return present_[feature]; }

 private:
  friend class FeatureNumbers;
  std::unordered_map<std::string, double> values_;
  std::vector<bool> present_;  // of each feature
};

// Every expression of a template, parsed once. Can be evaluated from any number of threads.
class FeatureNumbers {
 public:
  // Parses the expressions; what is wrong, with its place, is added to `findings`.
  FeatureNumbers(const CadTemplate& definition, std::vector<FieldViolation>& findings);

  // Returns the numbers at `q`, one entry a parameter in the template's order, which need not be
  // within their ranges. Whatever cannot be evaluated or is not what it must be is added to
  // `findings`, but for features that are not present. Parameters that are not finite, and
  // definitions that could not be parsed or evaluated, are unknown: so is what uses them, of which
  // nothing is told; features of which the presence is unknown count as absent.
  Numbers Evaluate(const Eigen::Ref<const Eigen::VectorXd>& q,
                   std::vector<FieldViolation>& findings) const;

 private:
  // An expression, and which of the parameters and definitions it names.
  struct Parsed {
    parametric::Expression expression;
    std::vector<Eigen::Index> names;
  };
  using Names = std::vector<parametric::ExpressionName>;
  static absl::StatusOr<Parsed> Parse(const std::string& text, const Names& names);

  struct Use {
    std::size_t feature;  // index; that after the last for the reference temperature
    std::string field;    // "features[2].extrude.to"
    std::string text;
    Need need;
    std::string condition;  // whose it is; empty for the shape's
  };
  void AddPresent(const CadTemplate& definition, const Names& names,
                  std::vector<FieldViolation>& findings);
  void AddReferenceTemperature(const CadTemplate& definition, const Names& names,
                               std::vector<FieldViolation>& findings);
  std::vector<bool> PresentAt(const Eigen::VectorXd& values,
                              std::vector<FieldViolation>& findings) const;

  std::vector<std::optional<Parsed>> definitions_;  // none for those that cannot be parsed
  std::vector<Use> uses_;
  std::vector<std::optional<Parsed>> present_;  // of each feature; none of those that always are
  std::unordered_map<std::string, Parsed> expressions_;  // by text
  Eigen::Index parameter_count_ = 0;
};

}  // namespace mortise::cad
