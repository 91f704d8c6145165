// Finds the hard and soft relationships of a connection whose elements and patches are known.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/assembly/connections/connection.h"
#include "common/assembly/relations/relationship.h"

namespace mortise::parametric {

// Fills `hard` and `soft`. `contacts` are of the connection's elements; `joint_ties` say where its
// joints' centres lie, in its parameters.
//
// - Relationships are found as in a whole design, among the connection's elements only. Those of
//   principals alone are left out. All hold in the design, since what aligns here aligns there.
// - Where faces lie against each other, each such pair is held. Any other alignment is held once:
//   with the patch if the element is level with both of its principals (so that it follows what
//   they share when they differ), else with the shortest principal along that axis, else with
//   another connecting element. The same holds for what a symmetry is about.
// - Alignments that others imply are left out (exactly, by Gram–Schmidt); what is left has at most
//   one value for any principals.
void RelateConnection(const Contacts& contacts, const std::vector<Relationship>& joint_ties,
                      ElementConnection& connection);

// Returns which rows are no linear combination of the rows before them. A row of zeros always is
// one. O(rows² · columns).
std::vector<bool> IndependentRows(const Eigen::MatrixXd& rows);

}  // namespace mortise::parametric
