// Whether a design at other parameters still holds together as it was drawn: no contact lost, no
// part in another, nothing resized that comes in one size. In every rest pose.
//
// Parts are looked at as their boxes, turned as the pose turns them, and, where the boxes of two
// meet and one of the parts has a shape, as their true surfaces: parts whose boxes overlap but
// whose solids only touch are in contact. Triangles may miss curved faces; what that explains is
// neither a gap nor a penetration.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/assembly/model/assembly.h"
#include "common/assembly/model/element.h"
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
  // Indices of the elements that the parts belong to; the same one of neighbours in a pattern, -1
  // where there is no second.
  int first_element = -1;
  int second_element = -1;
};

// "'leg 1' has lost 'top' by 0.002 m in 'lid hinge: open'".
std::string Describe(const ContactFault& fault);

class ContactCheck {
 public:
  // Notes what touches as drawn: boxes apart by no more than `tolerance`, m. The assembly must be
  // valid. O(poses · parts²).
  ContactCheck(Assembly assembly, std::vector<Element> elements, double tolerance = 1e-6);

  // INVALID_ARGUMENT, "q", for another number of parameters, one that is not finite or beyond
  // kFurthestFromOrigin, a size that is not positive, and where patterns so large would have far
  // more parts than the drawn design.
  absl::Status CheckParameters(const Eigen::VectorXd& q) const;

  // All faults at q, which has 6 numbers an element and 3 a joint:
  // - elements that touched are apart by more than the tolerance. If all parts of a pattern touched
  //   the other element, all it now has must do so;
  // - parts of elements that did not intersect, whether they touched or not, do so by more than
  //   `penetration`, m;
  // - neighbours in a pattern that touched are apart, or those that did not intersect do;
  // - a size is beyond what the item allows by more than the tolerance: differs from the drawn one,
  //   where the item fixes it.
  // What a rest pose moves together, or not at all, is told of once, as drawn. Empty if the design
  // is sound. Fails as CheckParameters. O(poses · parts²).
  absl::StatusOr<std::vector<ContactFault>> FaultsAt(const Eigen::VectorXd& q,
                                                     double penetration = 1e-4) const;

 private:
  struct Part {
    std::string name;
    OrientedBox box;
    mesh::BoxStretch stretch;
    const mesh::DrawnShape* shape = nullptr;            // none for boxes and prisms
    mutable std::optional<mesh::ProbedSurface> probed;  // made when it is first asked for
  };
  // Of each element, its parts at q in a pose.
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

  // How far two parts are apart, m; minus how deep they reach into each other. How deep is the dear
  // part of it for parts with shapes, and only asked for where it matters.
  double SeparationOf(const Part& a, const Part& b, bool how_deep) const;
  static const mesh::ProbedSurface& Probed(const Part& part);
  // Whether one map stretches both, in a pose by its index, from where they are drawn: nothing can
  // be wrong between them that is not as drawn.
  bool StandAsDrawn(std::size_t pose, std::size_t a, std::size_t b, const Parts& parts) const;
  // Unless both elements are boxes.
  void AddRegions(std::size_t a, std::size_t b, const Parts& drawn);
  // Whether each two parts stand to each other as drawn, in the pose that was drawn.
  bool StandAsDrawn(const Regions& regions, const Meeting& meeting, const std::vector<Part>& a,
                    const std::vector<Part>& b) const;
  static BoundingBox BoxAround(const Part& part);
  static Eigen::AlignedBox3d BoxAround(const std::vector<Part>& parts);
  // Pairs of elements that are not in every pose as they are in the drawn one: all in that, else
  // those of which one moves.
  std::vector<std::pair<std::size_t, std::size_t>> PairsIn(const Pose& pose) const;
  Parts PartsIn(const Pose& pose, const Eigen::VectorXd& q) const;
  Meeting MeetingOf(const std::vector<Part>& a, const std::vector<Part>& b) const;
  std::size_t PairIndex(std::size_t a, std::size_t b) const { return a * elements_.size() + b; }
  void CheckPair(const Meeting& meeting, const std::vector<Part>& a, const std::vector<Part>& b,
                 ContactFault fault, double penetration, std::vector<ContactFault>& faults) const;
  void CheckSizes(const Parts& parts, std::vector<ContactFault>& faults) const;
  // Of each direction of an element's pattern, the separation of neighbours at q, m; infinite where
  // there are none.
  std::array<double, 2> NeighbourGaps(std::size_t element, const Eigen::VectorXd& q) const;
  void CheckNeighbours(const Parts& parts, const Eigen::VectorXd& q, double penetration,
                       std::vector<ContactFault>& faults) const;

  Assembly assembly_;
  std::vector<Element> elements_;
  double tolerance_;
  std::vector<Pose> poses_;
  Eigen::VectorXd drawn_;
  std::vector<std::vector<OrientedBox>> boxes_;        // as drawn, by pose, of elements
  std::vector<std::vector<Meeting>> meetings_;         // by pose, then PairIndex(a, b) of a <= b
  std::vector<std::array<Neighbours, 2>> neighbours_;  // of each element's pattern
  // Of pairs of elements of which one has a shape and parts meet as drawn, in the drawn pose.
  std::map<std::pair<std::size_t, std::size_t>, Regions> regions_;
};

}  // namespace mortise::parametric
