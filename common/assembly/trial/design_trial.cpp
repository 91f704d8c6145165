#include "common/assembly/trial/design_trial.h"

#include <algorithm>
#include <future>
#include <random>
#include <utility>
#include <vector>

#include "common/assembly/model/rest_pose.h"
#include "common/assembly/trial/contact_check.h"
#include "common/base/errors.h"

namespace mortise::parametric {
namespace {

constexpr int kPartsLookedAt = 4000;
constexpr int kMinCorners = 24;
constexpr int kMaxCorners = 250;
constexpr int kFitsLookedAt = 250;  // true shapes take a hundred times as long as boxes
constexpr int kPartsWithFits = 800;
constexpr int kMinOfFits = 8;
constexpr int kMaxOfFits = 60;
constexpr std::size_t kAtATime = 2;  // designs that are looked at, each by a thread
constexpr std::uint64_t kSeed = 1;
constexpr double kRigid = 1e-9;  // rows of an orthonormal basis this short say that nothing moves

// Corners of the set, and points on the lines from each to the next, in turn.
absl::StatusOr<std::vector<Eigen::VectorXd>> TrialDesigns(const FeasibleSet& feasible_set,
                                                          int corners) {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<Eigen::VectorXd> at,
                           feasible_set.Corners(corners, kSeed));
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> uniform;
  std::vector<Eigen::VectorXd> designs;
  for (std::size_t i = 0; i + 1 < at.size(); ++i) {
    const double along = uniform(random);
    designs.push_back(at[i]);
    designs.push_back((1 - along) * at[i] + along * at[i + 1]);
  }
  return designs;
}

// As many corners as take little time: so much is looked at, once in each.
int CornersFor(int looked_at, std::size_t things, int fewest, int most) {
  const int share = looked_at / static_cast<int>(std::max<std::size_t>(things, 1));
  return std::clamp(share, fewest, most);
}

// Pairs of elements, lower first.
using Pairs = std::set<std::pair<int, int>>;

// Whether every design has both elements as they are drawn, but for where they stand together in a
// pose.
bool AreRigid(const Pose& pose, const Assembly& assembly, const std::vector<Element>& elements,
              const FeasibleSet& feasible_set, int a, int b) {
  const auto is_fixed = [&](const LinearForm& form) {
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(feasible_set.basis().cols());
    for (const LinearTerm& term : form.terms) {
      row += term.coefficient * feasible_set.basis().row(term.variable);
    }
    return row.norm() <= kRigid;
  };
  const auto is_in_pieces = [&](int element) {
    const auto& held = elements[static_cast<std::size_t>(element)].feature_anchors;
    return std::any_of(held.begin(), held.end(), [](const auto& along) { return !along.empty(); });
  };
  if (is_in_pieces(a) || is_in_pieces(b)) return false;
  const Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  return std::all_of(kAxes.begin(), kAxes.end(), [&](Axis axis) {
    const Eigen::Vector3d along = Eigen::Vector3d::Unit(static_cast<int>(axis));
    return is_fixed(LinearForm::Variable(SizeVariable(a, axis))) &&
           is_fixed(LinearForm::Variable(SizeVariable(b, axis))) &&
           is_fixed(PlaceIn(pose, assembly, elements, a, middle, along) -
                    PlaceIn(pose, assembly, elements, b, middle, along));
  });
}

// Those whose boxes meet in a pose of the drawn design, one of them with a shape, that are not
// rigid there.
Pairs FitsToTry(const Assembly& assembly, const std::vector<Element>& elements,
                const FeasibleSet& feasible_set, double tolerance) {
  const Eigen::VectorXd drawn = DrawnParameters(assembly, elements);
  const int count = static_cast<int>(elements.size());
  const auto at = [&](int element) -> const Element& {
    return elements[static_cast<std::size_t>(element)];
  };
  const auto has_shape = [&](int element) { return at(element).shape != nullptr; };
  Pairs pairs;
  for (const Pose& pose : PosesOf(assembly)) {
    std::vector<OrientedBox> boxes;
    for (int e = 0; e < count; ++e) boxes.push_back(BoxIn(pose, assembly, elements, e, drawn));
    const auto moves = [&](int element) { return MovesIn(pose, assembly, at(element)); };
    for (int a = 0; a < count; ++a) {
      for (int b = a + 1; b < count; ++b) {
        if (!has_shape(a) && !has_shape(b)) continue;
        if (pose.joint >= 0 && moves(a) == moves(b)) continue;
        const auto index_a = static_cast<std::size_t>(a), index_b = static_cast<std::size_t>(b);
        if (Separation(boxes[index_a], boxes[index_b]) > tolerance) continue;
        if (!AreRigid(pose, assembly, elements, feasible_set, a, b)) pairs.emplace(a, b);
      }
    }
  }
  return pairs;
}

// The elements with no shapes but those of the ones that are to be tried.
std::vector<Element> WithShapesOf(const Pairs& pairs, std::vector<Element> elements) {
  std::set<int> kept;
  for (const auto& [a, b] : pairs) kept.insert({a, b});
  for (std::size_t e = 0; e < elements.size(); ++e) {
    if (kept.count(static_cast<int>(e)) == 0) elements[e].shape = nullptr;
  }
  return elements;
}

using Faults = std::vector<ContactFault>;

// What is wrong with each of the designs from `first` on, as many as are looked at at a time; of
// those that cannot be looked at, as they have more parts than anybody may ask for, nothing.
std::vector<absl::StatusOr<Faults>> FaultsOf(const ContactCheck& check,
                                             const std::vector<Eigen::VectorXd>& designs,
                                             std::size_t first) {
  const auto look = [&check](const Eigen::VectorXd& q) -> absl::StatusOr<Faults> {
    if (!check.CheckParameters(q).ok()) return Faults();
    return check.FaultsAt(q);
  };
  std::vector<std::future<absl::StatusOr<Faults>>> others;
  for (std::size_t i = first + 1; i < std::min(first + kAtATime, designs.size()); ++i) {
    others.push_back(std::async(std::launch::async, look, std::cref(designs[i])));
  }
  std::vector<absl::StatusOr<Faults>> all = {look(designs[first])};
  for (auto& other : others) all.push_back(other.get());
  return all;
}

class Trial {
 public:
  Trial(const Assembly& assembly, const std::vector<Element>& elements, Pairs fits,
        const RepairPlan& known, double tolerance)
      : assembly_(assembly),
        elements_(elements),
        fits_(std::move(fits)),
        known_(known),
        tolerance_(tolerance),
        drawn_(DrawnParameters(assembly, elements)) {}

  void Mend(const ContactFault& fault) {
    if (!KeepMeeting(fault) && !Fit(fault)) GiveUpPatterns(fault);
  }

  // Whether a fault of two elements as drawn, the lower first, could be helped: what nobody can
  // help need not be looked for.
  bool CanHelp(int a, int b) const {
    return At(a).pattern || At(b).pattern || fits_.count({a, b}) != 0;
  }

  // Whether some parts are to be fitted: what else is tried before they are is of no use.
  bool HasFitted() const { return !repair_plan_.known_conflicts.fitted.empty(); }

  bool HasRepairs() const {
    const KnownConflicts& known_conflicts = repair_plan_.known_conflicts;
    return !repair_plan_.lone.empty() || !known_conflicts.kept_apart.empty() ||
           !known_conflicts.kept_touching.empty() || !known_conflicts.fitted.empty();
  }

  RepairPlan TakeRepairPlan() { return std::move(repair_plan_); }

 private:
  const Element& At(int element) const { return elements_[static_cast<std::size_t>(element)]; }

  // In a rest pose, as they meet in it as drawn: apart, or touching.
  bool KeepMeeting(const ContactFault& fault) {
    if (fault.pose.empty()) return false;
    const bool is_lost = fault.kind == ContactFault::Kind::kLostContact;
    const std::vector<Pose> poses = PosesOf(assembly_);
    const auto pose = std::find_if(poses.begin(), poses.end(),
                                   [&](const Pose& one) { return one.name == fault.pose; });
    const double apart =
        Separation(BoxIn(*pose, assembly_, elements_, fault.first_element, drawn_),
                   BoxIn(*pose, assembly_, elements_, fault.second_element, drawn_));
    const PosedPair pair{fault.pose, At(fault.first_element).parts.front(),
                         At(fault.second_element).parts.front()};
    const auto kept = is_lost ? &KnownConflicts::kept_touching : &KnownConflicts::kept_apart;
    if (apart < -tolerance_ || (is_lost && apart > tolerance_)) return false;
    if ((known_.known_conflicts.*kept).count(pair) != 0) return false;
    (repair_plan_.known_conflicts.*kept).insert(pair);
    return true;
  }

  bool Fit(const ContactFault& fault) {
    const std::pair<int, int> pair = std::minmax(fault.first_element, fault.second_element);
    if (fits_.count(pair) == 0 || At(pair.first).pattern || At(pair.second).pattern) return false;
    const PosedPair parts{fault.pose, At(pair.first).parts.front(), At(pair.second).parts.front()};
    if (known_.known_conflicts.fitted.count(parts) != 0) return false;
    repair_plan_.known_conflicts.fitted.insert(parts);
    return true;
  }

  void GiveUpPatterns(const ContactFault& fault) {
    std::vector<int> patterns;
    for (const int element : {fault.first_element, fault.second_element}) {
      if (element >= 0 && At(element).pattern) patterns.push_back(element);
    }
    const bool fastens = std::any_of(patterns.begin(), patterns.end(),
                                     [&](int element) { return At(element).connecting; });
    for (const int element : patterns) {
      if (fastens && !At(element).connecting) continue;
      repair_plan_.lone.insert(At(element).parts.begin(), At(element).parts.end());
    }
  }

  const Assembly& assembly_;
  const std::vector<Element>& elements_;
  const Pairs fits_;
  const RepairPlan& known_;
  const double tolerance_;
  const Eigen::VectorXd drawn_;
  RepairPlan repair_plan_;
};

}  // namespace

absl::StatusOr<RepairPlan> TryDesigns(const Assembly& assembly,
                                      const std::vector<Element>& elements,
                                      const FeasibleSet& feasible_set, const RepairPlan& known,
                                      double tolerance, const std::function<bool()>& is_given_up,
                                      const std::function<void(std::size_t, std::size_t)>& tried) {
  const bool has_patterns =
      std::any_of(elements.begin(), elements.end(),
                  [](const Element& element) { return element.pattern.has_value(); });
  const Pairs fits = FitsToTry(assembly, elements, feasible_set, tolerance);
  Trial trial(assembly, elements, fits, known, tolerance);
  const auto look_at = [&](const Pairs& with_shapes, int corners) -> absl::Status {
    const ContactCheck check(assembly, WithShapesOf(with_shapes, elements), tolerance,
                             [&](int a, int b) { return trial.CanHelp(a, b); });
    MORTISE_ASSIGN_OR_RETURN(const std::vector<Eigen::VectorXd> designs,
                             TrialDesigns(feasible_set, corners));
    for (std::size_t i = 0; i < designs.size(); i += kAtATime) {
      if (is_given_up()) return absl::CancelledError("nobody waits for the designs any more");
      for (const absl::StatusOr<Faults>& faults : FaultsOf(check, designs, i)) {
        MORTISE_RETURN_IF_ERROR(faults.status());
        for (const ContactFault& fault : *faults) trial.Mend(fault);
        if (trial.HasFitted()) return absl::OkStatus();
      }
      tried(std::min(i + kAtATime, designs.size()), designs.size());
    }
    return absl::OkStatus();
  };
  if (has_patterns || PosesOf(assembly).size() > 1) {
    MORTISE_RETURN_IF_ERROR(
        look_at({}, CornersFor(kPartsLookedAt, assembly.parts.size(), kMinCorners, kMaxCorners)));
  }
  // With what is known now the set will be another, and fits may be sound in that.
  if (!fits.empty() && !trial.HasRepairs()) {
    MORTISE_RETURN_IF_ERROR(look_at(
        fits, std::min(CornersFor(kFitsLookedAt, fits.size(), kMinOfFits, kMaxOfFits),
                       CornersFor(kPartsWithFits, assembly.parts.size(), kMinOfFits, kMaxOfFits))));
  }
  return trial.TakeRepairPlan();
}

}  // namespace mortise::parametric
