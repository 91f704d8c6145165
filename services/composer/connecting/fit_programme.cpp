#include "services/composer/connecting/fit_programme.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/connections/connection.h"
#include "common/assembly/model/element.h"
#include "common/assembly/polyhedra/polyhedron.h"
#include "common/base/errors.h"
#include "services/composer/connecting/hold.h"

namespace mortise::composer {
namespace {

using parametric::BoundingBox;
using parametric::ConnectionPatch;
using parametric::ElementConnection;
using parametric::FeasibleSet;
using parametric::LinearForm;
using parametric::PatchKind;

// What a change of a connecting part counts beside the same of a principal one: next to nothing, as
// it is placed anew afterwards.
constexpr double kConnectingWeight = 0.01;
constexpr double kMinContact = 1e-3;  // m, that parts in contact share along each axis
constexpr double kNoChange = 1e-9;    // length of a row that says nothing of what is free
constexpr double kHeld = 1e-7;        // m; what such a row may miss

// coefficients · x + constant, m, in the programme's variables.
struct Affine {
  Eigen::VectorXd coefficients;
  double constant = 0;
};

Affine operator-(const Affine& a, const Affine& b) {
  return {a.coefficients - b.coefficients, a.constant - b.constant};
}
Affine Mean(const Affine& a, const Affine& b) {
  return {(a.coefficients + b.coefficients) / 2, (a.constant + b.constant) / 2};
}

class FitProgramme {
 public:
  FitProgramme(const BothSides& now, const FitSpaces& spaces,
               const std::vector<Candidate>& candidates, double hold)
      : now_(now),
        hold_(hold),
        component_set_(spaces.component),
        body_set_(spaces.body),
        body_standing_(body_set_.drawn() + now.body.assembly->Translations() * now.body.shift),
        component_columns_(component_set_.degrees_of_freedom()),
        columns_(component_columns_ + body_set_.degrees_of_freedom()) {
    for (const Candidate& candidate : candidates) {
      first_unknown_.push_back(columns_);
      const ElementConnection& connection = candidate.from->connection;
      columns_ += connection.end_unknown() - connection.first_unknown();
    }
    start_ = Eigen::VectorXd::Zero(columns_);
    start_.head(component_columns_) =
        ZOf(component_set_, spaces.component_scales, InSpace(now.component));
    start_.segment(component_columns_, body_set_.degrees_of_freedom()) =
        ZOf(body_set_, spaces.body_scales, now.body.q);
    KeepFeasible();
    for (std::size_t i = 0; i < candidates.size(); ++i) KeepConnection(candidates[i], i);
  }

  absl::StatusOr<FittedSides> Solve() {
    if (!impossible_.empty()) return Conflict(impossible_);
    MORTISE_ASSIGN_OR_RETURN(parametric::Projection nearest,
                             parametric::ProjectOnto(Rows(), start_));
    if (!nearest.point) {
      std::string names;
      for (const int row : nearest.inequalities) {
        absl::StrAppend(&names, names.empty() ? "" : "; ",
                        inequality_names_[static_cast<std::size_t>(row)]);
      }
      return Conflict(names);
    }
    Eigen::VectorXd point = *nearest.point;
    if (HoldSizes(point)) {
      MORTISE_ASSIGN_OR_RETURN(nearest, parametric::ProjectOnto(Rows(), start_));
      if (nearest.point) point = *nearest.point;
    }
    Design body = now_.body;
    body.q = BodyAt(point);
    return ChangesBetween(now_,
                          SidesOf(body, FromSpace(now_.component.assembly, ComponentAt(point))));
  }

 private:
  static absl::Status Conflict(const std::string& what) {
    return PreconditionFailed("CONNECTION_CONFLICT", absl::StrCat("cannot hold together: ", what));
  }

  // The coordinates of feasible parameters in a basis that is orthonormal by these scales.
  static Eigen::VectorXd ZOf(const FeasibleSet& set, const Eigen::VectorXd& scales,
                             const Eigen::VectorXd& q) {
    return set.basis().transpose() * (q - set.drawn()).cwiseQuotient(scales.cwiseAbs2());
  }
  Eigen::VectorXd ComponentAt(const Eigen::VectorXd& point) const {
    return component_set_.drawn() + component_set_.basis() * point.head(component_columns_);
  }
  Eigen::VectorXd BodyAt(const Eigen::VectorXd& point) const {
    return body_set_.drawn() +
           body_set_.basis() * point.segment(component_columns_, body_set_.degrees_of_freedom());
  }

  // Holds the sizes that had better stay. Whether there are any.
  bool HoldSizes(const Eigen::VectorXd& point) {
    const std::size_t before = equalities_.size();
    const Eigen::VectorXd component = InSpace(now_.component);
    for (const int size : SizesToKeep(*now_.component.assembly, component, ComponentAt(point))) {
      Affine held = OfComponent(LinearForm::Variable(size));
      held.constant -= component[size];
      Add(held, true, "");
    }
    for (const int size : SizesToKeep(*now_.body.assembly, now_.body.q, BodyAt(point))) {
      Affine held = OfBody(LinearForm::Variable(size));
      held.constant -= now_.body.q[size];
      Add(held, true, "");
    }
    return equalities_.size() > before;
  }

  // In the set of one side, whose columns begin at `first`; `standing` are the parameters in space
  // at which its z is 0.
  Affine InSet(const LinearForm& form, const FeasibleSet& set, Eigen::Index first,
               const Eigen::VectorXd& standing) const {
    Affine affine{Eigen::VectorXd::Zero(columns_), form.At(standing)};
    for (const parametric::LinearTerm& term : form.terms) {
      affine.coefficients.segment(first, set.basis().cols()) +=
          term.coefficient * set.basis().row(term.variable).transpose();
    }
    return affine;
  }
  Affine OfComponent(const LinearForm& form) const {
    return InSet(form, component_set_, 0, component_set_.drawn());
  }
  Affine OfBody(const LinearForm& form) const {
    return InSet(form, body_set_, component_columns_, body_standing_);
  }

  Affine CenterOf(const BoundPrincipal& bound, std::size_t axis) const {
    const LinearForm& form = now_.PartOf(bound).center[axis];
    return bound.of_component ? OfComponent(form) : OfBody(form);
  }
  Affine SizeOf(const BoundPrincipal& bound, std::size_t axis) const {
    const LinearForm& form = now_.PartOf(bound).size[axis];
    return bound.of_component ? OfComponent(form) : OfBody(form);
  }
  Affine FaceOf(const BoundPrincipal& bound, std::size_t axis, bool upper) const {
    const Affine size = SizeOf(bound, axis);
    Affine face = CenterOf(bound, axis);
    face.coefficients += (upper ? 0.5 : -0.5) * size.coefficients;
    face.constant += (upper ? 0.5 : -0.5) * size.constant;
    return face;
  }
  double ValueNow(const Affine& affine) const {
    return affine.coefficients.dot(start_) + affine.constant;
  }

  void Add(const Affine& affine, bool equality, const std::string& name) {
    const double length = affine.coefficients.norm();
    if (length <= kNoChange) {
      const bool holds = equality ? std::abs(affine.constant) <= kHeld : affine.constant <= kHeld;
      if (!holds && impossible_.empty()) impossible_ = name;
      return;
    }
    (equality ? equalities_ : inequalities_)
        .push_back({affine.coefficients / length, affine.constant / length});
    if (!equality) inequality_names_.push_back(name);
  }

  void KeepFeasible() {
    for (const parametric::Relationship& kept : component_set_.inequalities()) {
      Add(OfComponent(kept.form), false, kept.description);
    }
    for (const parametric::Relationship& kept : body_set_.inequalities()) {
      // The design's own relationships say the same wherever it stands.
      Add(InSet(kept.form, body_set_, component_columns_, body_set_.drawn()), false,
          kept.description);
    }
  }

  // The lower and upper edges of a patch along each axis.
  struct Edges {
    std::array<Affine, 3> lower, upper;
  };

  Edges EdgesOf(const Candidate& candidate, const ConnectionPatch& drawn) {
    const ElementConnection& connection = candidate.from->connection;
    const BoundPrincipal& first = candidate.principals[static_cast<std::size_t>(drawn.first)];
    const BoundPrincipal& second = candidate.principals[static_cast<std::size_t>(drawn.second)];
    const auto normal = static_cast<std::size_t>(drawn.normal);
    const bool is_contact = drawn.kind == PatchKind::kContact;
    const bool is_flat = is_contact && drawn.region.size()[static_cast<Eigen::Index>(normal)] <=
                                           connection.tolerance;
    Edges edges;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (drawn.kind == PatchKind::kWhole) {
        edges.lower[axis] = FaceOf(first, axis, false);
        edges.upper[axis] = FaceOf(first, axis, true);
      } else if (is_flat && axis == normal) {
        Touch(connection, drawn, first, second, edges);
      } else {
        Share(connection, first, second, axis, is_contact, edges);
      }
    }
    return edges;
  }

  // The faces that lie against each other are one plane.
  void Touch(const ElementConnection& connection, const ConnectionPatch& drawn,
             const BoundPrincipal& first, const BoundPrincipal& second, Edges& edges) {
    const auto axis = static_cast<std::size_t>(drawn.normal);
    const auto at = static_cast<Eigen::Index>(axis);
    const bool is_before =
        connection.elements[static_cast<std::size_t>(drawn.first)].box.center()[at] <
        connection.elements[static_cast<std::size_t>(drawn.second)].box.center()[at];
    const Affine face = FaceOf(first, axis, is_before);
    Add(face - FaceOf(second, axis, !is_before), true,
        absl::StrCat(connection.name, " lie against each other"));
    edges.lower[axis] = edges.upper[axis] = face;
  }

  // Along other axes a patch reaches over what its principals share; where they share nothing, over
  // the gap.
  void Share(const ElementConnection& connection, const BoundPrincipal& first,
             const BoundPrincipal& second, std::size_t axis, bool is_contact, Edges& edges) {
    std::array<Affine, 2> lower = {FaceOf(first, axis, false), FaceOf(second, axis, false)};
    std::array<Affine, 2> upper = {FaceOf(first, axis, true), FaceOf(second, axis, true)};
    if (ValueNow(lower[0]) < ValueNow(lower[1])) std::swap(lower[0], lower[1]);
    if (ValueNow(upper[0]) > ValueNow(upper[1])) std::swap(upper[0], upper[1]);
    const std::string name = absl::StrCat(connection.name, " meet as they do now");
    Add(lower[1] - lower[0], false, name);
    Add(upper[0] - upper[1], false, name);
    const bool share = ValueNow(lower[0]) < ValueNow(upper[0]);
    if (is_contact) {
      Affine apart = lower[0] - upper[0];
      apart.constant += kMinContact;
      Add(apart, false, absl::StrCat(connection.name, " touch"));
    }
    edges.lower[axis] = is_contact || share ? lower[0] : upper[0];
    edges.upper[axis] = is_contact || share ? upper[0] : lower[0];
  }

  void KeepConnection(const Candidate& candidate, std::size_t index) {
    const ElementConnection& connection = candidate.from->connection;
    std::vector<Edges> edges;
    for (const ConnectionPatch& patch : connection.patches) {
      edges.push_back(EdgesOf(candidate, patch));
    }
    const Eigen::VectorXd drawn = parametric::DrawnParameters(connection);
    std::vector<Affine> parameters(static_cast<std::size_t>(connection.parameter_count()));
    for (std::size_t i = 0; i < candidate.principals.size(); ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        parameters[6 * i + axis] = CenterOf(candidate.principals[i], axis);
        parameters[6 * i + 3 + axis] = SizeOf(candidate.principals[i], axis);
      }
    }
    for (std::size_t patch = 0; patch < edges.size(); ++patch) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto variable = static_cast<std::size_t>(
            connection.PatchVariable(static_cast<int>(patch), static_cast<Axis>(axis)));
        parameters[variable] = Mean(edges[patch].lower[axis], edges[patch].upper[axis]);
        parameters[variable + 3] = edges[patch].upper[axis] - edges[patch].lower[axis];
      }
    }
    PlaceUnknowns(connection, drawn, index, parameters);
    for (const parametric::Relationship& hard : connection.hard) {
      Affine value{Eigen::VectorXd::Zero(columns_), hard.form.constant};
      for (const parametric::LinearTerm& term : hard.form.terms) {
        const Affine& parameter = parameters[static_cast<std::size_t>(term.variable)];
        value.coefficients += term.coefficient * parameter.coefficients;
        value.constant += term.coefficient * parameter.constant;
      }
      Add(value, hard.equality, hard.description);
    }
    for (const Hold& hold : HoldsOf(connection)) KeepHold(connection, hold, parameters);
  }

  void KeepHold(const ElementConnection& connection, const Hold& hold,
                const std::vector<Affine>& parameters) {
    const auto face = [&](int element, bool upper) {
      const auto center = static_cast<std::size_t>(parametric::CenterVariable(element, hold.axis));
      Affine at = parameters[center];
      at.coefficients += (upper ? 0.5 : -0.5) * parameters[center + 3].coefficients;
      at.constant += (upper ? 0.5 : -0.5) * parameters[center + 3].constant;
      return at;
    };
    // What lies ahead of the end that holds, minus that end: minus the depth.
    Affine missing = hold.from_below ? face(hold.principal, false) - face(hold.connecting, true)
                                     : face(hold.connecting, false) - face(hold.principal, true);
    missing.constant += hold_ * hold.depth;
    Add(missing, false,
        absl::StrCat("'", connection.elements[static_cast<std::size_t>(hold.connecting)].name,
                     "' reaches into '",
                     connection.elements[static_cast<std::size_t>(hold.principal)].name, "'"));
  }

  // The connecting parts begin where their patch has moved.
  void PlaceUnknowns(const ElementConnection& connection, const Eigen::VectorXd& drawn,
                     std::size_t index, std::vector<Affine>& parameters) const {
    Eigen::Vector3d moved = Eigen::Vector3d::Zero();
    for (int axis = 0; axis < 3 && !connection.patches.empty(); ++axis) {
      const int variable = connection.PatchVariable(0, static_cast<Axis>(axis));
      moved[axis] = ValueNow(parameters[static_cast<std::size_t>(variable)]) - drawn[variable];
    }
    const int of_elements = 6 * static_cast<int>(connection.elements.size());
    for (int v = connection.first_unknown(); v < connection.end_unknown(); ++v) {
      const bool is_place = v >= of_elements || v % 6 < 3;
      const int axis = v >= of_elements ? (v - of_elements) % 3 : v % 3;
      Affine& unknown = parameters[static_cast<std::size_t>(v)];
      unknown.coefficients = Eigen::VectorXd::Zero(columns_);
      unknown.coefficients[first_unknown_[index] + v - connection.first_unknown()] =
          1 / kConnectingWeight;
      unknown.constant = drawn[v] + (is_place ? moved[axis] : 0);
    }
  }

  parametric::Polyhedron Rows() const {
    parametric::Polyhedron rows;
    rows.inequalities.resize(static_cast<Eigen::Index>(inequalities_.size()), columns_);
    rows.bounds.resize(rows.inequalities.rows());
    for (Eigen::Index i = 0; i < rows.inequalities.rows(); ++i) {
      const Affine& row = inequalities_[static_cast<std::size_t>(i)];
      rows.inequalities.row(i) = row.coefficients.transpose();
      rows.bounds[i] = -row.constant;
    }
    rows.equalities.resize(static_cast<Eigen::Index>(equalities_.size()), columns_);
    rows.values.resize(rows.equalities.rows());
    for (Eigen::Index i = 0; i < rows.equalities.rows(); ++i) {
      const Affine& row = equalities_[static_cast<std::size_t>(i)];
      rows.equalities.row(i) = row.coefficients.transpose();
      rows.values[i] = -row.constant;
    }
    return rows;
  }

  const BothSides& now_;
  const double hold_;
  const FeasibleSet& component_set_;
  const FeasibleSet& body_set_;
  const Eigen::VectorXd body_standing_;  // the body as drawn, where it is in space
  const Eigen::Index component_columns_;
  Eigen::Index columns_;
  std::vector<Eigen::Index> first_unknown_;
  Eigen::VectorXd start_;
  std::vector<Affine> equalities_, inequalities_;
  std::vector<std::string> inequality_names_;
  std::string impossible_;
};

}  // namespace

FittedSides ChangesBetween(const BothSides& before, BothSides after) {
  FittedSides changed;
  const auto compare = [&](const std::vector<PrincipalPart>& old,
                           const std::vector<PrincipalPart>& made) {
    for (std::size_t i = 0; i < std::min(old.size(), made.size()); ++i) {
      if (old[i].name != made[i].name) continue;
      const Eigen::Vector3d centers = made[i].box.center() - old[i].box.center();
      const Eigen::Vector3d sizes = made[i].box.size() - old[i].box.size();
      changed.moved_by =
          std::max({changed.moved_by, centers.cwiseAbs().maxCoeff(), sizes.cwiseAbs().maxCoeff()});
      changed.resized_by = std::max(changed.resized_by,
                                    sizes.cwiseQuotient(old[i].box.size()).cwiseAbs().maxCoeff());
    }
  };
  compare(before.body_parts, after.body_parts);
  compare(before.component_parts, after.component_parts);
  changed.sides = std::move(after);
  return changed;
}

FitSpaces FitSpacesOf(const BothSides& sides) {
  const parametric::ParametricAssembly& component = *sides.component.assembly;
  const parametric::ParametricAssembly& body = *sides.body.assembly;
  const double diagonal = parametric::AssemblyDiagonal(body.assembly());
  Eigen::VectorXd component_scales = ChangeScales(component, diagonal);
  Eigen::VectorXd body_scales = ChangeScales(body, diagonal);
  FeasibleSet component_set = *component.FreeInSpace().Rescaled(component_scales);
  FeasibleSet body_set = *body.feasible_set().Rescaled(body_scales);
  return {std::move(component_scales), std::move(body_scales), std::move(component_set),
          std::move(body_set)};
}

absl::StatusOr<FittedSides> FitSides(const BothSides& now, const FitSpaces& spaces,
                                     const std::vector<Candidate>& candidates, double hold) {
  return FitProgramme(now, spaces, candidates, hold).Solve();
}

}  // namespace mortise::composer
