#include "common/assembly/parametric_assembly.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/model/bores.h"
#include "common/assembly/model/rest_pose.h"
#include "common/assembly/relations/loose_elements.h"
#include "common/assembly/relations/principal_patterns.h"
#include "common/assembly/trial/design_trial.h"
#include "common/assembly/trial/drawn_contacts.h"
#include "common/assembly/trial/near_misses.h"
#include "common/assembly/trial/pattern_losses.h"
#include "common/base/errors.h"
#include "common/base/names/offered_names.h"

namespace mortise::parametric {
namespace {

constexpr double kFixed = 1e-9;  // m; a range no wider is none
// m. What is reached stays this far inside of what can be while other demands are looked at:
// rounding must not turn the one into a conflict with the next.
constexpr double kInside = 1e-8;
constexpr double kPlaceScale = 3;  // of the design's diagonal
// Of the largest change of a size in proportion: those that change by less are to stay, if they
// can; if not all of them, those that change least.
constexpr double kLittle[] = {0.5, 0.2, 0.05};

std::string Describe(const MeasureDemand& demand) {
  return absl::StrCat("the ", AxisName(demand.measure.axis), " ",
                      MeasureKindName(demand.measure.kind), " of '", demand.measure.element,
                      "' is ", demand.value, " m");
}

// Holds the design where it stands: what is lowest stays on the floor, so that a shelf grows
// upwards.
std::vector<Relationship> StandingInPlace(const std::vector<Element>& elements) {
  const auto lowest = std::min_element(
      elements.begin(), elements.end(),
      [](const Element& a, const Element& b) { return a.box.minimum.z() < b.box.minimum.z(); });
  const int element = static_cast<int>(lowest - elements.begin());
  std::vector<Relationship> held = Anchor(elements, 0);
  Relationship& floor = held.back();  // along z
  floor.form = Combine(1, LinearForm::Variable(CenterVariable(element, Axis::kZ)), -0.5,
                       LinearForm::Variable(SizeVariable(element, Axis::kZ)));
  floor.form.constant = -lowest->box.minimum.z();
  floor.description = absl::StrCat("'", lowest->name, "' held where it stands");
  return held;
}

// The group above each; -1 for the root.
std::vector<int> ParentsOf(const Assembly& assembly) {
  std::vector<int> parents;
  for (const AssemblyGroup& group : assembly.groups) parents.push_back(group.parent);
  return parents;
}

EqualitySolver SolverOf(const std::vector<const ParametricAssembly*>& known) {
  std::vector<std::shared_ptr<const SolvedSystems>> systems;
  for (const ParametricAssembly* assembly : known) systems.push_back(assembly->solved_systems());
  return EqualitySolver(std::move(systems));
}

// By what a change of each parameter is measured, m: of a size, by the size as drawn; of a place,
// by several times the whole design, as places are to follow sizes and not sizes places.
Eigen::VectorXd ScalesOf(const std::vector<Element>& elements, const Eigen::VectorXd& drawn,
                         double diagonal) {
  Eigen::VectorXd scales = Eigen::VectorXd::Constant(drawn.size(), kPlaceScale * diagonal);
  for (std::size_t e = 0; e < elements.size(); ++e) {
    for (const Axis axis : kAxes) {
      const int size = SizeVariable(static_cast<int>(e), axis);
      scales[size] = drawn[size];
    }
  }
  return scales;
}

bool IsConflict(const absl::Status& status) {
  return DetailOf(status).reason == "DEMANDS_CONFLICT";
}

bool IsHeld(const FeasibleSet& feasible_set, int variable) {
  return feasible_set.basis().row(variable).norm() <= kFixed;
}

bool IsOpen(const Element& element, Axis axis) {
  const SizeLimits& limits = element.limits[static_cast<std::size_t>(axis)];
  return limits.minimum < limits.maximum;
}

// Where the shares that fits keep hold sizes that their items leave open, as two bores for one
// bought bracket do, lets go of all of them but the first, then of that; of none where that does
// not help once all that are held have let go. Whether there is something else to try now.
bool LoosenShares(const std::vector<Element>& elements, const FeasibleSet& feasible_set,
                  const FitCounts& fits, KnownConflicts& known_conflicts) {
  constexpr int kAll = std::numeric_limits<int>::max();
  bool is_looser = false;
  std::vector<int*> in_vain;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    for (const Axis axis : kAxes) {
      const std::pair<int, Axis> place(elements[e].parts.front(), axis);
      const auto count = fits.find(place);
      if (count == fits.end() || !IsOpen(elements[e], axis) ||
          !IsHeld(feasible_set, SizeVariable(static_cast<int>(e), axis))) {
        continue;
      }
      int& kept = known_conflicts.shares_kept.try_emplace(place, count->second).first->second;
      if (kept == kAll) continue;
      if (kept == 0) {
        in_vain.push_back(&kept);
      } else {
        kept = kept > 1 ? 1 : 0;
        is_looser = true;
      }
    }
  }
  if (is_looser) return true;
  for (int* const kept : in_vain) *kept = kAll;
  return !in_vain.empty();
}

}  // namespace

const char* MeasureKindName(MeasureKind kind) {
  switch (kind) {
    case MeasureKind::kSize:
      return "size";
    case MeasureKind::kCenter:
      return "centre";
    case MeasureKind::kMinimum:
      return "minimum";
    case MeasureKind::kMaximum:
      return "maximum";
  }
  return "";
}

absl::StatusOr<ParametricAssembly> ParametricAssembly::Create(
    Assembly assembly, const std::function<bool()>& is_given_up,
    const std::vector<const ParametricAssembly*>& known, LoosePolicy loose,
    const SearchOptions& search) {
  ParametricAssembly made;
  made.assembly_ = std::move(assembly);
  made.tolerance_ = ToleranceOf(made.assembly_);
  EqualitySolver solver = SolverOf(known);
  const bool is_known =
      search.outcome != nullptr && NamesPartsOf(*search.outcome, made.assembly_.parts.size());
  if (is_known) made.outcome_ = *search.outcome;
  // What does not hold any more is searched anew.
  if (!is_known || !made.TakeSoundFeasibleSet(loose, solver).ok()) {
    made.outcome_ = {};
    MORTISE_RETURN_IF_ERROR(made.FindSoundFeasibleSet(is_given_up, loose, solver, search.progress));
  }
  made.solved_systems_ = solver.solved();
  made.placement_.emplace(*made.feasible_set_, made.elements_,
                          FindConnections(made.assembly_, made.elements_, made.contacts_,
                                          made.relationships_, made.tolerance_));
  MORTISE_ASSIGN_OR_RETURN(made.in_proportion_,
                           made.feasible_set_->Rescaled(ScalesOf(
                               made.elements_, made.drawn(), AssemblyDiagonal(made.assembly_))));
  return made;
}

const ContactCheck& ParametricAssembly::contact_check() const {
  std::call_once(contact_check_->is_made,
                 [this] { contact_check_->check.emplace(assembly_, elements_, tolerance_); });
  return *contact_check_->check;
}

absl::Status ParametricAssembly::TakeSoundFeasibleSet(LoosePolicy loose, EqualitySolver& solver) {
  ShapeFeatures known;
  return FindFeasibleSet(outcome_.touching, known,
                         {outcome_.pattern_losses, outcome_.repair_plan.lone},
                         outcome_.repair_plan.known_conflicts, loose, solver)
      .status();
}

absl::Status ParametricAssembly::FindSoundFeasibleSet(const std::function<bool()>& is_given_up,
                                                      LoosePolicy loose, EqualitySolver& solver,
                                                      const SearchProgress& progress) {
  auto& [touching, pattern_losses, repair_plan] = outcome_;
  const auto parts = static_cast<std::int64_t>(assembly_.parts.size());
  progress("looking for contacts", 0, parts);
  MORTISE_ASSIGN_OR_RETURN(
      touching, FindTouchingParts(assembly_, tolerance_, [&](std::size_t done) {
        progress("looking for contacts", static_cast<std::int64_t>(done), parts);
        return !is_given_up();
      }));
  ShapeFeatures known;
  repair_plan.lone = RowsInBoresOfOne(assembly_, MakeElements(assembly_, tolerance_, {}, known),
                                      tolerance_, known);
  const auto has_more = [](auto& all, const auto& found) {
    const std::size_t before = all.size();
    all.insert(found.begin(), found.end());
    return all.size() > before;
  };
  while (true) {
    if (is_given_up()) return absl::CancelledError("nobody waits for the designs any more");
    progress("solving relationships", 0, 0);
    MORTISE_ASSIGN_OR_RETURN(const FitCounts fits,
                             FindFeasibleSet(touching, known, {pattern_losses, repair_plan.lone},
                                             repair_plan.known_conflicts, loose, solver));
    if (LoosenShares(elements_, *feasible_set_, fits, repair_plan.known_conflicts)) continue;
    MORTISE_ASSIGN_OR_RETURN(const PatternLosses lost,
                             FindPatternLosses(assembly_, elements_, *feasible_set_, tolerance_));
    if (has_more(pattern_losses, lost)) continue;
    MORTISE_ASSIGN_OR_RETURN(
        const RepairPlan found,
        TryDesigns(assembly_, elements_, *feasible_set_, repair_plan, tolerance_, is_given_up,
                   [&](std::size_t done, std::size_t total) {
                     progress("trying designs", static_cast<std::int64_t>(done),
                              static_cast<std::int64_t>(total));
                   }));
    KnownConflicts& known_conflicts = repair_plan.known_conflicts;
    bool is_sound = !has_more(repair_plan.lone, found.lone);
    is_sound &= !has_more(known_conflicts.kept_apart, found.known_conflicts.kept_apart);
    is_sound &= !has_more(known_conflicts.kept_touching, found.known_conflicts.kept_touching);
    is_sound &= !has_more(known_conflicts.fitted, found.known_conflicts.fitted);
    if (is_sound) return absl::OkStatus();
  }
}

absl::StatusOr<FitCounts> ParametricAssembly::FindFeasibleSet(
    const TouchingParts& touching, ShapeFeatures& known, const PatternExclusions& exclusions,
    const KnownConflicts& known_conflicts, LoosePolicy loose, EqualitySolver& solver) {
  elements_ = MakeElements(assembly_, tolerance_, exclusions, known);
  contacts_ = ContactsOf(touching, assembly_, elements_);
  FollowPrincipalPatterns(elements_, contacts_, tolerance_);
  const FeatureAnchors held =
      AnchorFeatures(assembly_, elements_, contacts_, tolerance_, known_conflicts, known);
  relationships_ = FindRelationships(assembly_, elements_, contacts_, tolerance_, known_conflicts);
  for (const std::vector<Relationship>& more :
       {held.relationships, KeepRound(assembly_, elements_, tolerance_, known)}) {
    relationships_.insert(relationships_.end(), more.begin(), more.end());
  }
  std::vector<Relationship> anchored = relationships_;
  std::size_t axis = 0;
  for (Relationship& still : StandingInPlace(elements_)) {
    standing_[axis++] = still.form;
    still.group = kAboveRoot;
    anchored.push_back(std::move(still));
  }
  MORTISE_RETURN_IF_ERROR(Solve(std::move(anchored), loose, solver));
  return held.fits;
}

absl::Status ParametricAssembly::Solve(std::vector<Relationship> anchored, LoosePolicy loose,
                                       EqualitySolver& solver) {
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(feasible_set_,
                             FeasibleSet::Create(anchored, DrawnParameters(assembly_, elements_),
                                                 VariablesWithin(assembly_, elements_, 0),
                                                 ParentsOf(assembly_), &solver));
    if (loose == LoosePolicy::kRefuse) {
      return CheckBounded(assembly_, elements_, *feasible_set_,
                          [this](const std::vector<int>& free) {
                            return TellOfNearMisses(assembly_, elements_, tolerance_, free);
                          });
    }
    MORTISE_ASSIGN_OR_RETURN(const auto free, feasible_set_->UnboundedDirection());
    if (!free) return absl::OkStatus();
    relationships_.push_back(HoldWhatMoves(assembly_, elements_, *free));
    anchored.push_back(relationships_.back());
  }
}

absl::StatusOr<int> ParametricAssembly::DegreesOfFreedom(int group) const {
  EqualitySolver solver({solved_systems_});
  MORTISE_ASSIGN_OR_RETURN(
      const FeasibleSet within,
      FeasibleSet::Create(RelationshipsWithin(assembly_, relationships_, group), drawn(),
                          VariablesWithin(assembly_, elements_, group), ParentsOf(assembly_),
                          &solver));
  return within.degrees_of_freedom();
}

Eigen::MatrixXd ParametricAssembly::Translations() const {
  Eigen::MatrixXd directions = Eigen::MatrixXd::Zero(drawn().size(), 3);
  const auto move = [&](int variable) {
    directions.middleRows<3>(variable) = Eigen::Matrix3d::Identity();
  };
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    move(CenterVariable(static_cast<int>(e), Axis::kX));
  }
  for (std::size_t j = 0; j < assembly_.joints.size(); ++j) {
    move(JointVariable(elements_.size(), static_cast<int>(j), Axis::kX));
  }
  return directions;
}

absl::StatusOr<LinearForm> ParametricAssembly::FormOf(const Measure& measure,
                                                      const std::string& field) const {
  const auto found = std::find_if(elements_.begin(), elements_.end(), [&](const Element& element) {
    return element.name == measure.element;
  });
  if (found == elements_.end()) {
    return InvalidField(absl::StrCat(field, ".element"),
                        absl::StrCat("there is no element '", measure.element, "'",
                                     NamesOffered(measure.element, elements_, &Element::name)));
  }
  const int element = static_cast<int>(found - elements_.begin());
  const LinearForm center = LinearForm::Variable(CenterVariable(element, measure.axis));
  const LinearForm size = LinearForm::Variable(SizeVariable(element, measure.axis));
  switch (measure.kind) {
    case MeasureKind::kSize:
      return size;
    case MeasureKind::kCenter:
      return center;
    case MeasureKind::kMinimum:
      return Combine(1, center, -0.5, size);
    case MeasureKind::kMaximum:
      return Combine(1, center, 0.5, size);
  }
  return absl::InternalError("a kind of measure that is none");
}

absl::StatusOr<std::vector<Demand>> ParametricAssembly::FormsOf(
    const std::vector<MeasureDemand>& demands) const {
  std::vector<Demand> forms;
  for (std::size_t i = 0; i < demands.size(); ++i) {
    const std::string field = absl::StrCat("demands[", i, "]");
    if (!(std::abs(demands[i].value) <= kMaxFromOrigin)) {
      return InvalidField(absl::StrCat(field, ".value"),
                          absl::StrCat("must be within ", kMaxFromOrigin, " m"));
    }
    MORTISE_ASSIGN_OR_RETURN(const LinearForm form,
                             FormOf(demands[i].measure, absl::StrCat(field, ".measure")));
    forms.push_back({form, demands[i].value, Describe(demands[i])});
  }
  return forms;
}

absl::StatusOr<Adjustment> ParametricAssembly::Adjust(const Eigen::VectorXd& from,
                                                      const std::vector<MeasureDemand>& demands,
                                                      DemandPolicy policy) const {
  if (from.size() != drawn().size() || !from.allFinite()) {
    return InvalidField("from", absl::StrCat("must be ", drawn().size(), " finite numbers"));
  }
  MORTISE_ASSIGN_OR_RETURN(const std::vector<Demand> forms, FormsOf(demands));
  absl::StatusOr<Eigen::VectorXd> exact = NearestKeepingSizes(from, forms);
  if (!exact.ok() && policy == DemandPolicy::kNearest && IsConflict(exact.status())) {
    return ComeNear(from, forms);
  }
  MORTISE_RETURN_IF_ERROR(exact.status());
  return PlaceConnecting(*exact, forms);
}

absl::StatusOr<Adjustment> ParametricAssembly::Meet(
    const std::vector<MeasureDemand>& demands) const {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<Demand> forms, FormsOf(demands));
  MORTISE_ASSIGN_OR_RETURN(const Eigen::VectorXd q, in_proportion_->Nearest(drawn(), forms));
  return PlaceConnecting(q, forms);
}

absl::StatusOr<Eigen::VectorXd> ParametricAssembly::NearestKeepingSizes(
    const Eigen::VectorXd& from, const std::vector<Demand>& demands) const {
  MORTISE_ASSIGN_OR_RETURN(Eigen::VectorXd q, in_proportion_->Nearest(from, demands));
  std::vector<std::pair<int, double>> changes;  // of sizes, in proportion
  double largest = 0;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    for (const Axis axis : kAxes) {
      const int size = SizeVariable(static_cast<int>(e), axis);
      changes.emplace_back(size, std::abs(q[size] - from[size]) / drawn()[size]);
      largest = std::max(largest, changes.back().second);
    }
  }
  for (const double little : kLittle) {
    std::vector<Demand> held = demands;
    for (const auto& [size, change] : changes) {
      if (change <= kFixed || change >= little * largest) continue;
      held.push_back({LinearForm::Variable(size), from[size], ""});
    }
    absl::StatusOr<Eigen::VectorXd> kept = in_proportion_->Nearest(from, held);
    if (kept.ok() || !IsConflict(kept.status())) return kept;
  }
  return q;
}

absl::StatusOr<Adjustment> ParametricAssembly::ComeNear(const Eigen::VectorXd& from,
                                                        const std::vector<Demand>& demands) const {
  std::vector<Demand> held, ends;
  MORTISE_ASSIGN_OR_RETURN(Eigen::VectorXd q, feasible_set_->Nearest(from));
  for (const Demand& demand : demands) {
    held.push_back(demand);
    ends.push_back(demand);
    absl::StatusOr<Eigen::VectorXd> met = feasible_set_->Nearest(from, held);
    if (met.ok()) {
      q = *std::move(met);
      continue;
    }
    if (!IsConflict(met.status())) return met.status();
    held.pop_back();
    // The values a form can take are an interval, and the one asked for lies outside.
    const double present = demand.form.At(q);
    const double sign = demand.value > present ? 1 : -1;
    MORTISE_ASSIGN_OR_RETURN(const Eigen::VectorXd furthest,
                             feasible_set_->Furthest(sign * demand.form, held));
    const double end = demand.form.At(furthest);
    const bool is_ahead = sign * (end - present) > kInside;
    ends.back().value = is_ahead ? end : present;
    held.push_back(demand);
    held.back().value = is_ahead ? end - sign * kInside : present;
    MORTISE_ASSIGN_OR_RETURN(q, feasible_set_->Nearest(from, held));
  }
  absl::StatusOr<Eigen::VectorXd> nearest = NearestKeepingSizes(from, ends);
  if (!nearest.ok() && IsConflict(nearest.status())) nearest = NearestKeepingSizes(from, held);
  MORTISE_RETURN_IF_ERROR(nearest.status());
  return PlaceConnecting(*nearest, demands);
}

absl::StatusOr<Adjustment> ParametricAssembly::PlaceConnecting(
    const Eigen::VectorXd& q, const std::vector<Demand>& demands) const {
  std::vector<LinearForm> held;
  for (const Demand& demand : demands) held.push_back(demand.form);
  MORTISE_ASSIGN_OR_RETURN(Eigen::VectorXd placed, placement_->Place(q, held));
  Adjustment adjustment{std::move(placed), {}};
  for (const Demand& demand : demands) adjustment.reached.push_back(demand.form.At(adjustment.q));
  return adjustment;
}

absl::StatusOr<MeasureRange> ParametricAssembly::RangeOf(const Measure& measure) const {
  MORTISE_ASSIGN_OR_RETURN(const LinearForm form, FormOf(measure, "measure"));
  MORTISE_ASSIGN_OR_RETURN(const std::vector<Range> ranges, feasible_set_->RangesOf({form}));
  return MeasureRange{measure, form.At(drawn()), ranges[0].minimum, ranges[0].maximum};
}

absl::StatusOr<PolyhedronShadow> ParametricAssembly::ValuesOf(
    const std::vector<Measure>& measures) const {
  std::vector<LinearForm> forms;
  for (std::size_t i = 0; i < measures.size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(forms.emplace_back(),
                             FormOf(measures[i], absl::StrCat("measures[", i, "]")));
  }
  return feasible_set_->ValuesOf(forms);
}

absl::StatusOr<std::vector<MeasureRange>> ParametricAssembly::AdjustableSizes() const {
  std::vector<MeasureRange> sizes;
  std::vector<LinearForm> forms;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    if (elements_[e].connecting) continue;
    for (const Axis axis : kAxes) {
      const int variable = SizeVariable(static_cast<int>(e), axis);
      if (IsHeld(*feasible_set_, variable)) continue;
      forms.push_back(LinearForm::Variable(variable));
      sizes.push_back({{elements_[e].name, axis}, drawn()[variable], 0, 0});
    }
  }
  MORTISE_ASSIGN_OR_RETURN(const std::vector<Range> ranges, feasible_set_->RangesOf(forms));
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    sizes[i].minimum = ranges[i].minimum;
    sizes[i].maximum = ranges[i].maximum;
  }
  sizes.erase(std::remove_if(
                  sizes.begin(), sizes.end(),
                  [](const MeasureRange& size) { return size.maximum - size.minimum <= kFixed; }),
              sizes.end());
  return sizes;
}

std::vector<Measure> ParametricAssembly::HeldSizes() const {
  std::vector<Measure> held;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const Element& element = elements_[e];
    if (element.connecting) continue;
    for (const Axis axis : kAxes) {
      const bool is_held = IsHeld(*feasible_set_, SizeVariable(static_cast<int>(e), axis));
      if (is_held && IsOpen(element, axis)) held.push_back({element.name, axis});
    }
  }
  return held;
}

}  // namespace mortise::parametric
