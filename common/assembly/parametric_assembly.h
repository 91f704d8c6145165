// An assembly and what automatic parametrisation makes of it (thesis §3.4, §3.5), behind one door:
// its elements, contacts and relationships, and the designs that they allow.
//
//   MORTISE_ASSIGN_OR_RETURN(const auto shelf, ParametricAssembly::Create(assembly));
//   MORTISE_ASSIGN_OR_RETURN(const Adjustment wider,
//                            shelf.Adjust(shelf.drawn(), {{{"top", Axis::kX}, 1.2}},
//                                         DemandPolicy::kNearest));
//   const std::vector<PlacedPart> parts = shelf.PartsAt(wider.q);
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/assembly/connections/connection.h"
#include "common/assembly/connections/connection_placement.h"
#include "common/assembly/model/assembly.h"
#include "common/assembly/model/element.h"
#include "common/assembly/model/linear_design.h"
#include "common/assembly/relations/equality_solver.h"
#include "common/assembly/relations/feasible_set.h"
#include "common/assembly/relations/feature_anchors.h"
#include "common/assembly/relations/relationship.h"
#include "common/assembly/trial/contact_check.h"
#include "common/assembly/trial/drawn_contacts.h"
#include "common/assembly/trial/search_outcome.h"

namespace mortise::parametric {

enum class MeasureKind { kSize, kCenter, kMinimum, kMaximum };

// "size", "centre", "minimum" or "maximum".
const char* MeasureKindName(MeasureKind kind);

// A length of an element that a designer may ask for: how large it is, or where it lies.
struct Measure {
  std::string element;
  Axis axis = Axis::kX;
  MeasureKind kind = MeasureKind::kSize;
};

struct MeasureDemand {
  Measure measure;
  double value = 0;  // m
};

// What a measure may be, m, if nothing else is asked for.
struct MeasureRange {
  Measure measure;
  double drawn = 0;
  double minimum = 0;
  double maximum = 0;
};

// What to do with demands that cannot all be met.
enum class DemandPolicy {
  kNearest,  // come as near as the design allows, the first demands first
  kStrict,   // refuse, and say what cannot hold together
};

// What to do with elements that could move or grow without end.
enum class LoosePolicy {
  kRefuse,  // an expert's design must be held together
  kHold,    // let them keep their distance, as drawn, from the nearest that is held: pieces of a
            // design whose neighbours are gone lie as they lay (loose_elements.h)
};

// What the searches of a parametrisation need not find, and whom they tell how far they are.
struct SearchOptions {
  // What they came to for the same assembly before, by the same version of them; null if nobody
  // knows. Nothing refers to it afterwards.
  const SearchOutcome* outcome = nullptr;
  SearchProgress progress = [](const char*, std::int64_t, std::int64_t) {};
};

struct Adjustment {
  Eigen::VectorXd q;            // feasible
  std::vector<double> reached;  // m, of each demand
};

// Immutable; safe to share between threads.
class ParametricAssembly {
 public:
  // Parametrises a valid assembly. What touches is found on the surfaces of the parts' shapes, or
  // of their boxes where they have none; alignment, likeness and contact are judged with one
  // tolerance(), and curved faces besides with what their triangles may miss. The lowest element
  // is held on the floor, the first where it is drawn along x and y. Patterns end before parts that
  // they might lose (pattern_losses.h), and what designs that are tried show to be at fault is
  // mended (design_trial.h); each takes another round. FAILED_PRECONDITION as FeasibleSet::Create,
  // or by LoosePolicy::kRefuse FEASIBLE_SET_UNBOUNDED naming elements that could move or grow
  // without end. CANCELLED soon after `is_given_up`, which is asked before each round and each
  // design that is tried.
  //
  // What is made of `known`, assemblies that were parametrised before, such as the body of a model
  // and the component that comes to it, is not made anew where it is the same: systems of
  // equalities with the same coefficients (equality_solver.h). The result is what it would be
  // without them, to the bit. Nothing refers to them afterwards.
  //
  // So it is with what the searches came to before (SearchOptions): with it one round of solving is
  // all that is left to do.
  static absl::StatusOr<ParametricAssembly> Create(
      Assembly assembly, const std::function<bool()>& is_given_up = [] { return false; },
      const std::vector<const ParametricAssembly*>& known = {},
      LoosePolicy loose = LoosePolicy::kRefuse, const SearchOptions& search = {});

  const Assembly& assembly() const { return assembly_; }
  double tolerance() const { return tolerance_; }  // m: a millionth of the design's diagonal
  const std::vector<Element>& elements() const { return elements_; }
  const Contacts& contacts() const { return contacts_; }

  // Returns what the searches came to, for those who keep it for the same assembly.
  const SearchOutcome& search_outcome() const { return outcome_; }

  const std::vector<Relationship>& relationships() const { return relationships_; }
  const FeasibleSet& feasible_set() const { return *feasible_set_; }

  // Returns the forms, by axis, that are 0 m where the design stands as drawn: the lowest element
  // on its floor, the first in its place along x and y. The feasible set holds them.
  const std::array<LinearForm, 3>& standing() const { return standing_; }

  // Returns the directions in which all of the design moves along x, y and z: |q| × 3.
  Eigen::MatrixXd Translations() const;

  // Returns the feasible set of the design when nothing holds it in its place. O(degrees of
  // freedom² · parameters).
  FeasibleSet FreeInSpace() const { return feasible_set_->FreedAlong(Translations()); }

  // Returns what places the connecting elements once the principals stand.
  const ConnectionPlacement& placement() const { return *placement_; }

  // Returns what holds the principal elements together: see FindConnections.
  const std::vector<ElementConnection>& connections() const { return placement_->connections(); }

  // Returns the parameters as the expert drew the design.
  const Eigen::VectorXd& drawn() const { return feasible_set_->drawn(); }

  // Returns the systems of equalities that were solved, for those who parametrise what contains the
  // same.
  const std::shared_ptr<const SolvedSystems>& solved_systems() const { return solved_systems_; }

  // Returns the degrees of freedom of a group's subtree by itself, its place in space included.
  absl::StatusOr<int> DegreesOfFreedom(int group) const;

  // Returns the feasible parameters nearest to `from` that meet the demands, with the connecting
  // elements where their connections want them for these principals (ConnectionPlacement). Changes
  // of sizes count in proportion to the sizes as drawn, changes of places hardly: a thickness stays
  // rather than a length, and a top follows its legs. Of the sizes that would change little beside
  // others, as many as can stay exactly. INVALID_ARGUMENT, "from" or "demands[i].measure.element";
  // FAILED_PRECONDITION, DEMANDS_CONFLICT, if they must all be met and cannot be: it names the
  // demands and relationships that cannot hold together.
  absl::StatusOr<Adjustment> Adjust(const Eigen::VectorXd& from,
                                    const std::vector<MeasureDemand>& demands,
                                    DemandPolicy policy) const;

  // Returns the design nearest to the drawn one that meets all demands, with distances as Adjust
  // has them; continuous in the values demanded, as F(q) of a template must be, so that sizes that
  // Adjust would keep may change a little. Fails as Adjust.
  absl::StatusOr<Adjustment> Meet(const std::vector<MeasureDemand>& demands) const;

  // Returns what a measure may be if nothing else is asked for. INVALID_ARGUMENT,
  // "measure.element", for an element there is not.
  absl::StatusOr<MeasureRange> RangeOf(const Measure& measure) const;

  // Returns which values the measures may have together, m: what Meet can meet.
  // INVALID_ARGUMENT, "measures[i].element", for an element there is not, and "measures[i]" for a
  // measure that cannot change.
  absl::StatusOr<PolyhedronShadow> ValuesOf(const std::vector<Measure>& measures) const;

  // Returns the sizes of principal elements that can be changed, with their ranges, element by
  // element.
  absl::StatusOr<std::vector<MeasureRange>> AdjustableSizes() const;

  // Returns the sizes of principal elements that their items leave open and the design holds all
  // the same: those of a board that is let in, rounded, into a frame of fixed sizes.
  std::vector<Measure> HeldSizes() const;

  // Returns `count` designs spread evenly over the feasible set, as FeasibleSet::Sample does.
  absl::StatusOr<std::vector<Eigen::VectorXd>> Sample(int count, std::uint64_t seed) const {
    return feasible_set_->Sample(count, seed);
  }

  // Says whether the design can be looked at there, feasible or not, as
  // ContactCheck::CheckParameters does.
  absl::Status CheckParameters(const Eigen::VectorXd& q) const {
    return contact_check().CheckParameters(q);
  }

  // Returns all parts at q, in the pose the design is drawn in. CheckParameters must be OK.
  std::vector<PlacedPart> PartsAt(const Eigen::VectorXd& q) const {
    return PlaceParts(assembly_, elements_, q);
  }

  // Returns what the part looks like, divided where it is stretched in pieces
  // (PlacedPart::stretch); null if the part looks as its item's kind says.
  const std::shared_ptr<const mesh::DrawnShape>& ShapeOf(const PlacedPart& part) const {
    return elements_[static_cast<std::size_t>(part.element)].shape;
  }

  // Returns what is wrong with the design at q, in every rest pose: see ContactCheck.
  absl::StatusOr<std::vector<ContactFault>> FaultsAt(const Eigen::VectorXd& q) const {
    return contact_check().FaultsAt(q);
  }

 private:
  ParametricAssembly() = default;
  // Makes the feasible set anew until no pattern might lose what it touches, and none of the
  // designs that are tried has a fault that could be helped.
  absl::Status FindSoundFeasibleSet(const std::function<bool()>& is_given_up, LoosePolicy loose,
                                    EqualitySolver& solver, const SearchProgress& progress);
  // Makes the feasible set that the searches have come to, of which outcome_ is known.
  absl::Status TakeSoundFeasibleSet(LoosePolicy loose, EqualitySolver& solver);
  // Makes everything up to the feasible set, and returns how many things fit into each element.
  absl::StatusOr<FitCounts> FindFeasibleSet(const TouchingParts& touching, ShapeFeatures& known,
                                            const PatternExclusions& exclusions,
                                            const KnownConflicts& known_conflicts,
                                            LoosePolicy loose, EqualitySolver& solver);
  // Solves the relationships and the anchors; what is held besides comes to the relationships.
  absl::Status Solve(std::vector<Relationship> anchored, LoosePolicy loose, EqualitySolver& solver);
  absl::StatusOr<LinearForm> FormOf(const Measure& measure, const std::string& field) const;
  absl::StatusOr<std::vector<Demand>> FormsOf(const std::vector<MeasureDemand>& demands) const;
  absl::StatusOr<Eigen::VectorXd> NearestKeepingSizes(const Eigen::VectorXd& from,
                                                      const std::vector<Demand>& demands) const;
  absl::StatusOr<Adjustment> ComeNear(const Eigen::VectorXd& from,
                                      const std::vector<Demand>& demands) const;
  absl::StatusOr<Adjustment> PlaceConnecting(const Eigen::VectorXd& q,
                                             const std::vector<Demand>& demands) const;
  // Made when somebody first looks at a design: who only asks what can be changed needs none.
  const ContactCheck& contact_check() const;

  struct CheckOnDemand {
    std::once_flag is_made;
    std::optional<ContactCheck> check;
  };

  Assembly assembly_;
  double tolerance_ = 0;
  SearchOutcome outcome_;
  std::vector<Element> elements_;
  Contacts contacts_;
  std::vector<Relationship> relationships_;
  std::array<LinearForm, 3> standing_;
  std::shared_ptr<const SolvedSystems> solved_systems_;
  std::optional<FeasibleSet> feasible_set_;
  std::optional<FeasibleSet> in_proportion_;  // the same, sizes measured by themselves
  std::optional<ConnectionPlacement> placement_;
  std::shared_ptr<CheckOnDemand> contact_check_ = std::make_shared<CheckOnDemand>();
};

}  // namespace mortise::parametric
