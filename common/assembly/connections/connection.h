// Finds the connections of a design: which principal elements are held together, by which
// connecting elements, and what of that must stay when the principals change (thesis §3.6).
//
// A connection has parameters of its own, in metres, laid out as those of a design are: 6 an
// element (centre, size; the principals first), 3 a joint that moves some of its elements against
// others, then 6 a patch (centre and size of its region). The principals and the patches are given,
// the connecting elements and the joints' centres follow.
//
//   hard   what the design's own relationships say between connecting elements, and between these
//          and the principals: sizes, contact, order, symmetry, repetition, alignment; and that
//          what passes through a contact patch stays inside it. They hold exactly.
//   soft   how far each face of a connecting element lies from the edge of its patch, as drawn.
//          They hold in least squares: together they say where everything would be if the patch had
//          only moved, which is more than a patch of another size allows.
//
// What the drawing says of principals among themselves is not part of a connection: whoever places
// them sees to that.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/assembly/connections/connection_patch.h"
#include "common/assembly/model/assembly.h"
#include "common/assembly/model/element.h"
#include "common/assembly/polyhedra/linear_form.h"
#include "common/assembly/relations/relationship.h"

namespace mortise::parametric {

// A relationship that holds as nearly as the hard ones allow.
struct SoftRelationship {
  int patch = 0;    // index into ElementConnection::patches
  LinearForm form;  // of the connection's parameters, m; 0 as drawn
  double weight =
      1;  // of its square's root in the sum: 1 for the nearer edge, less for the further
  std::string description;  // for people: "'screw' y minimum 0.02 m from the edge of …"
};

// One connection. It refers to nothing outside itself, so it can be kept, and used for other
// principals.
struct ElementConnection {
  std::string name;  // "'side 1' with 'shelf'", by its principals
  int group = 0;     // the lowest that contains all principals

  // Indices into the design's elements and joints that the connection was made of.
  std::vector<int> principals;
  std::vector<int> connecting;
  std::vector<int> joints;

  Assembly assembly;                     // its parts, all groups, its joints
  std::vector<Element> elements;         // the principals, then the connecting ones; of `assembly`
  std::vector<ConnectionPatch> patches;  // as drawn
  std::vector<Relationship> hard;
  std::vector<SoftRelationship> soft;
  double tolerance = 0;  // m, within which things touch and align: the design's

  int principal_count() const { return static_cast<int>(principals.size()); }
  // Returns the index of the parameter that is the centre of a patch's region along an axis. The
  // parameters of patches come behind those of elements and joints.
  int PatchVariable(int patch, Axis axis) const {
    return static_cast<int>(6 * elements.size() + 3 * joints.size()) + 6 * patch +
           static_cast<int>(axis);
  }
  int parameter_count() const { return PatchVariable(static_cast<int>(patches.size()), Axis::kX); }
  // The parameters that follow from the others are [first_unknown(), end_unknown()).
  int first_unknown() const { return 6 * principal_count(); }
  int end_unknown() const { return static_cast<int>(6 * elements.size() + 3 * joints.size()); }
};

// Returns the lower and upper edge of a patch's region along an axis, as functions of the
// parameters.
LinearForm PatchEdge(const ElementConnection& connection, int patch, Axis axis, bool upper);

// Returns the connection's patch `patch` when its principals fill these boxes, m. It is of the
// drawn kind, but a kGap where principals that touched no longer do.
ConnectionPatch PatchAt(const ElementConnection& connection, int patch,
                        const std::vector<BoundingBox>& principals);

// Returns the parameters as drawn.
Eigen::VectorXd DrawnParameters(const ElementConnection& connection);

// Returns all connections of a design, ordered by their principals. They follow from the graph of
// what touches:
// - connecting elements that touch each other belong together, with all principals they touch;
//   those with the same principals are one connection;
// - two principals that touch over an area, without anything that connects them, are a connection
//   without connecting elements (glue, or just weight).
// Connecting elements that reach no principal are in no connection. `contacts`, `relationships` and
// `tolerance` (m) are those of the design. O(elements² + the sum of the squares of the connections'
// elements); dense QR of each connection's equalities.
std::vector<ElementConnection> FindConnections(const Assembly& assembly,
                                               const std::vector<Element>& elements,
                                               const Contacts& contacts,
                                               const std::vector<Relationship>& relationships,
                                               double tolerance);

}  // namespace mortise::parametric
