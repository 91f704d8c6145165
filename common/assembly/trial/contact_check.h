// Checks whether a design at other parameters still holds together as it was drawn, in every rest
// pose: no contact is lost, no part is in another, and nothing is resized that comes in one size.
//
// Parts are looked at as their boxes, turned as the pose turns them. Where the boxes of two meet
// and one of the parts has a shape, they are looked at as their true surfaces: parts whose boxes
// overlap but whose solids only touch are in contact. Triangles may miss curved faces; what that
// explains is neither a gap nor a penetration.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/assembly/model/assembly.h"
#include "common/assembly/model/element.h"
#include "common/assembly/model/linear_design.h"
#include "common/assembly/model/oriented_box.h"
#include "common/assembly/model/rest_pose.h"
#include "common/assembly/trial/meeting_region.h"
#include "common/mesh/repair/proximity.h"

namespace mortise::parametric {

struct ContactFault {
  enum class Kind { kLostContact, kPenetration, kChangedSize };
  Kind kind = Kind::kLostContact;
  std::string pose;    // empty as drawn; else "joint: pose"
  std::string first;   // part; of patterns the one at fault
  std::string second;  // part or pattern; empty for changed sizes
  double amount = 0;   // m: the gap, the depth, or by how much a size differs
  // The indices of the elements that the parts belong to. Neighbours in a pattern have the same
  // one; -1 if there is no second.
  int first_element = -1;
  int second_element = -1;
};

// Says a fault in words: "'leg 1' has lost 'top' by 0.002 m in 'lid hinge: open'".
std::string Describe(const ContactFault& fault);

class ContactCheck {
 public:
  // Notes what touches as drawn: boxes apart by no more than `tolerance`, m. The assembly must be
  // valid. O(poses · elements²).
  //
  // Of pairs of elements in the pose that was drawn, only those are looked at, by index and the
  // lower first, that `is_asked` says; all if it is empty.
  ContactCheck(Assembly assembly, std::vector<Element> elements, double tolerance = 1e-6,
               const std::function<bool(int, int)>& is_asked = {});

  // Checks that q can be looked at. INVALID_ARGUMENT, "q", for another number of parameters, for
  // one that is not finite or beyond kMaxFromOrigin, for a size that is not positive, and
  // where patterns so large would have far more parts than the drawn design.
  absl::Status CheckParameters(const Eigen::VectorXd& q) const;

  // Returns all faults at q, which has 6 numbers an element and 3 a joint:
  // - elements that touched are apart by more than the tolerance. If all parts of a pattern touched
  //   the other element, all that it now has must touch it;
  // - parts of elements that did not intersect, whether they touched or not, do so by more than
  //   `penetration`, m;
  // - neighbours in a pattern that touched are apart, or those that did not intersect do;
  // - a size is beyond what the item allows, or differs from the drawn one where the item fixes it,
  //   by more than the tolerance.
  // Faults between elements that a rest pose moves together, or not at all, are told of once, as
  // drawn. The list is empty if the design is sound. Fails as CheckParameters does. O(poses ·
  // parts log parts) where few boxes meet.
  absl::StatusOr<std::vector<ContactFault>> FaultsAt(const Eigen::VectorXd& q,
                                                     double penetration = 1e-4) const;

 private:
  struct Part {
    const PlacedPart* placed = nullptr;  // its name and stretch
    OrientedBox box;
    const mesh::DrawnShape* shape = nullptr;            // none for boxes and prisms
    mutable std::optional<mesh::ProbedSurface> probed;  // made when it is first asked for
  };
  // The parts of each element at q in a pose.
  using Parts = std::vector<std::vector<Part>>;
  // How two elements met as drawn.
  struct Meeting {
    bool any = false;            // some part of the first touched some of the second
    bool all_of_first = false;   // each part of the first touched some of the second
    bool all_of_second = false;  // and the other way round
    bool is_clear = true;        // no part of the one reached into one of the other
  };
  // How neighbours along a direction of a pattern met as drawn.
  struct Neighbours {
    bool touched = false;
    bool intersected = false;
  };

  // Where parts of two elements meet as drawn, by index among the parts of each.
  struct Regions {
    std::size_t count_a = 0, count_b = 0;  // parts as drawn
    std::map<std::pair<std::size_t, std::size_t>, MeetingRegion> of;
  };

  // What is to be known of how two parts stand to each other; the less, the sooner it is told.
  struct Question {
    double furthest = 0;    // m; solids in each other's boxes that are further apart are just that
    double shallowest = 0;  // m; parts that reach no deeper into each other just touch
  };
  // Returns how far two parts are apart, m, or minus how deep they reach into each other. What the
  // triangles may miss is neither.
  double SeparationOf(const Part& a, const Part& b, const Question& question) const;
  // Returns how far a part is from the nearest of others, m.
  double GapOf(const Part& part, const std::vector<Part>& others) const;
  static const mesh::ProbedSurface& Probed(const Part& part);
  // Whether one map stretches both elements, in a pose by its index, from where they are drawn.
  // Nothing can then be wrong between them that is not wrong as drawn.
  bool StandAsDrawn(std::size_t pose, std::size_t a, std::size_t b, const Parts& parts) const;
  bool IsAsked(std::size_t a, std::size_t b) const {
    return !is_asked_ || is_asked_(static_cast<int>(a), static_cast<int>(b));
  }
  // Notes where the parts of two elements meet as drawn, unless both elements are boxes.
  void AddRegions(std::size_t a, std::size_t b, const Parts& drawn);
  // Whether each two parts stand to each other as drawn, in the pose that was drawn.
  bool StandAsDrawn(const Regions& regions, const Meeting& meeting, const std::vector<Part>& a,
                    const std::vector<Part>& b) const;
  static BoundingBox BoxAround(const Part& part);
  static Eigen::AlignedBox3d BoxAround(const std::vector<Part>& parts);
  using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;
  // Returns the pairs of elements to look at in a pose, by its index, whose boxes meet, in order:
  // of all in the drawn one, in others of those of which one element moves and the other does not.
  Pairs PairsThatMeet(std::size_t pose, const std::vector<Eigen::AlignedBox3d>& boxes) const;
  // Notes how elements meet as drawn in a pose.
  void AddMeetings(std::size_t pose, const std::vector<PlacedPart>& drawn);
  // The parts refer to those placed at q.
  Parts PartsIn(const Pose& pose, const Eigen::VectorXd& q,
                const std::vector<PlacedPart>& placed) const;
  Meeting MeetingOf(const std::vector<Part>& a, const std::vector<Part>& b) const;
  std::size_t PairIndex(std::size_t a, std::size_t b) const { return a * elements_.size() + b; }
  void CheckPair(const Meeting& meeting, const std::vector<Part>& a, const std::vector<Part>& b,
                 ContactFault fault, double penetration, std::vector<ContactFault>& faults) const;
  void CheckSizes(const Parts& parts, std::vector<ContactFault>& faults) const;
  // Returns the separation of neighbours at q along each direction of an element's pattern, m;
  // infinite where there are none.
  std::array<double, 2> NeighbourGaps(std::size_t element, const Eigen::VectorXd& q) const;
  void CheckNeighbours(const Parts& parts, const Eigen::VectorXd& q, double penetration,
                       std::vector<ContactFault>& faults) const;

  Assembly assembly_;
  std::vector<Element> elements_;
  double tolerance_;
  std::function<bool(int, int)> is_asked_;
  std::vector<Pose> poses_;
  Eigen::VectorXd drawn_;
  std::vector<std::vector<bool>> moved_;               // by pose, whether it moves an element
  std::vector<std::vector<OrientedBox>> boxes_;        // as drawn, by pose, of elements
  std::vector<std::vector<Meeting>> meetings_;         // by pose, then PairIndex(a, b) of a <= b
  std::vector<Pairs> touching_;                        // by pose, pairs with Meeting::any, in order
  std::vector<std::array<Neighbours, 2>> neighbours_;  // of each element's pattern
  // The regions of pairs of elements of which one has a shape and whose parts meet as drawn, in the
  // drawn pose.
  std::map<std::pair<std::size_t, std::size_t>, Regions> regions_;
};

}  // namespace mortise::parametric
