#include "services/composer/model/controls.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/sub_tree.h"
#include "common/base/errors.h"
#include "services/composer/model/placed_forms.h"

namespace mortise::composer {
namespace {

using parametric::BoundingBox;
using parametric::Demand;
using parametric::Element;
using parametric::FeasibleSet;
using parametric::LinearForm;
using parametric::ParametricAssembly;

constexpr double kConstrained = 1e-9;  // of a form, the change along any direction of the set
constexpr double kNoRange = 1e-9;      // m
// m. Ends are approached to so much: exactly there rounding can have demands conflict.
constexpr double kInside = 1e-10;

// The lower and the upper end of a box along an axis, as functions of the parameters.
struct Ends {
  LinearForm lower, upper;
};

// A node of the model: its elements, and what bounds them.
class ControlledNode {
 public:
  explicit ControlledNode(const Design& design)
      : design_(design),
        scales_(ChangeScales(*design.assembly,
                             parametric::AssemblyDiagonal(design.assembly->assembly()))),
        free_(*design.assembly->FreeInSpace().Rescaled(scales_)),
        now_(InSpace(design)) {}

  absl::Status Choose(const std::string& node) {
    const parametric::Assembly& assembly = design_.assembly->assembly();
    absl::StatusOr<std::vector<std::string>> names = parametric::PartsOfNode(assembly, node);
    if (!names.ok()) {
      return WithDetail(names.status(), {DetailOf(names.status()).reason, "node"});
    }
    const std::set<std::string> wanted(names->begin(), names->end());
    const std::vector<Element>& elements = design_.assembly->elements();
    for (std::size_t e = 0; e < elements.size(); ++e) {
      const bool is_inside =
          std::any_of(elements[e].parts.begin(), elements[e].parts.end(), [&](int part) {
            return wanted.contains(assembly.parts[static_cast<std::size_t>(part)].name);
          });
      if (is_inside && !elements[e].connecting) elements_.push_back(static_cast<int>(e));
    }
    if (elements_.empty()) {
      return InvalidField("node", absl::StrCat("'", node, "' has no principal parts"));
    }
    HoldModel();
    return absl::OkStatus();
  }

  LinearForm FormOf(ControlKind kind, Axis axis) const {
    const Ends ends = EndsOf(elements_, axis);
    return kind == ControlKind::kSize ? ends.upper - ends.lower
                                      : parametric::Combine(0.5, ends.lower, 0.5, ends.upper);
  }

  double ValueOf(const LinearForm& form) const { return form.At(now_); }

  // Whether some direction of the set that leaves the model in its place changes the form.
  bool IsFree(const LinearForm& form) const {
    Eigen::VectorXd rest = RowOf(form);
    const double length = rest.norm();
    for (int pass = 0; pass < 2; ++pass) {
      for (const Eigen::VectorXd& kept : held_rows_) rest -= kept.dot(rest) * kept;
    }
    return rest.norm() > kConstrained * std::max(length, 1.0);
  }

  // The design in which the form is as large, or small, as it can be.
  absl::StatusOr<double> End(const LinearForm& form, double sign) const {
    MORTISE_ASSIGN_OR_RETURN(const Eigen::VectorXd furthest, free_.Furthest(sign * form, held_));
    return form.At(furthest);
  }

  // The nearest design in which the form has the value, which must be within its ends.
  absl::StatusOr<Design> Nearest(const LinearForm& form, double value) const {
    std::vector<Demand> demands = held_;
    demands.push_back({form, value, "the control's value"});
    MORTISE_ASSIGN_OR_RETURN(Eigen::VectorXd there, free_.Nearest(now_, demands));
    for (const int size : SizesToKeep(*design_.assembly, now_, there)) {
      demands.push_back({LinearForm::Variable(size), now_[size], ""});
    }
    absl::StatusOr<Eigen::VectorXd> kept = free_.Nearest(now_, demands);
    if (kept.ok()) there = *std::move(kept);
    return FromSpace(design_.assembly, there);
  }

 private:
  // What bounds elements along an axis, as they are now; of several the first.
  Ends EndsOf(const std::vector<int>& elements, Axis axis) const {
    const int a = static_cast<int>(axis);
    int lowest = elements.front(), highest = elements.front();
    for (const int element : elements) {
      const BoundingBox box = ElementBox(design_, element);
      if (box.minimum[a] < ElementBox(design_, lowest).minimum[a]) lowest = element;
      if (box.maximum[a] > ElementBox(design_, highest).maximum[a]) highest = element;
    }
    const auto face = [&](int element, double side) {
      return parametric::Combine(1, LinearForm::Variable(parametric::CenterVariable(element, axis)),
                                 side,
                                 LinearForm::Variable(parametric::SizeVariable(element, axis)));
    };
    return {face(lowest, -0.5), face(highest, 0.5)};
  }

  // The model stands on its floor, and the middle of its box stays along x and y.
  void HoldModel() {
    std::vector<int> all;
    const std::vector<Element>& elements = design_.assembly->elements();
    for (std::size_t e = 0; e < elements.size(); ++e) all.push_back(static_cast<int>(e));
    for (const Axis axis : {Axis::kX, Axis::kY}) {
      const Ends ends = EndsOf(all, axis);
      Hold(parametric::Combine(0.5, ends.lower, 0.5, ends.upper));
    }
    Hold(EndsOf(all, Axis::kZ).lower);
  }

  void Hold(const LinearForm& form) {
    held_.push_back({form, form.At(now_), "the model stays where it stands"});
    Eigen::VectorXd row = RowOf(form);
    for (int pass = 0; pass < 2; ++pass) {
      for (const Eigen::VectorXd& kept : held_rows_) row -= kept.dot(row) * kept;
    }
    held_rows_.push_back(row.normalized());
  }

  Eigen::VectorXd RowOf(const LinearForm& form) const {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(free_.degrees_of_freedom());
    for (const parametric::LinearTerm& term : form.terms) {
      row += term.coefficient * free_.basis().row(term.variable).transpose();
    }
    return row;
  }

  const Design& design_;
  const Eigen::VectorXd scales_;
  const FeasibleSet free_;
  const Eigen::VectorXd now_;  // in space
  std::vector<int> elements_;
  std::vector<Demand> held_;
  std::vector<Eigen::VectorXd> held_rows_;  // orthonormal
};

}  // namespace

absl::StatusOr<std::vector<Control>> ControlsOf(const Design& design, const std::string& node) {
  ControlledNode controlled(design);
  MORTISE_RETURN_IF_ERROR(controlled.Choose(node));
  std::vector<Control> controls;
  for (const ControlKind kind : {ControlKind::kCenter, ControlKind::kSize}) {
    for (const Axis axis : parametric::kAxes) {
      const LinearForm form = controlled.FormOf(kind, axis);
      if (!controlled.IsFree(form)) continue;
      Control control{kind, axis, controlled.ValueOf(form), 0, 0};
      MORTISE_ASSIGN_OR_RETURN(control.minimum, controlled.End(form, -1));
      MORTISE_ASSIGN_OR_RETURN(control.maximum, controlled.End(form, 1));
      if (control.maximum - control.minimum > kNoRange) controls.push_back(control);
    }
  }
  return controls;
}

absl::StatusOr<Design> Drag(const Design& design, const std::string& node, ControlKind kind,
                            Axis axis, double value) {
  if (!std::isfinite(value)) return InvalidField("value", "must be finite");
  ControlledNode controlled(design);
  MORTISE_RETURN_IF_ERROR(controlled.Choose(node));
  const LinearForm form = controlled.FormOf(kind, axis);
  const std::string name = absl::StrCat("the ", kind == ControlKind::kSize ? "size" : "centre",
                                        " of '", node, "' along ", AxisName(axis));
  if (!controlled.IsFree(form)) {
    return InvalidField("control", absl::StrCat(name, " is determined by the design"));
  }
  const double sign = value < controlled.ValueOf(form) ? -1 : 1;
  absl::StatusOr<Design> there = controlled.Nearest(form, value);
  if (DetailOf(there.status()).reason == "DEMANDS_CONFLICT") {
    MORTISE_ASSIGN_OR_RETURN(const double end, controlled.End(form, sign));
    there = controlled.Nearest(form, end - sign * kInside);
  }
  MORTISE_RETURN_IF_ERROR(there.status());
  return Settled(*std::move(there));
}

}  // namespace mortise::composer
