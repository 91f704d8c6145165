// Finds what joints leave free, whose equations have few entries.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace mortise::simulator {

// Says how vectors move what joints connect. Rows are about 1 long, those of misfits after they are
// multiplied by their tolerance.
struct JointRows {
  Eigen::SparseMatrix<double> misfits;  // what joints do not let happen, per what is forgiven of it
  Eigen::SparseMatrix<double> slips;    // what they do let happen
};

struct NullSpace {
  int dimension = 0;      // where there are more than `most`, soft vectors are counted with them
  Eigen::MatrixXd basis;  // columns × dimension, orthonormal; at most `most` of them
};

// Returns the greatest space of vectors whose misfits are smaller than their slips. It is not
// enough that misfits are small against the vectors: where a thousand bodies are but slightly soft
// one after the other, the last one moves a million times as far. So vectors with small misfits are
// found first, from the rows' Gram matrix, by its eigenvalues or where it is large by counting the
// signs of its shifted pivots (Sylvester's law of inertia) and inverse iteration. In the space that
// these span, the sum of the squares of misfits is then held against that of slips: coordinates
// that are rounded leave misfits that are in proportion to the slips of the same joint. Anything
// counts that has misfits below a 1e13th of the vectors, or slips more than twice its misfits;
// nothing does whose misfits are the larger.
NullSpace FindNullSpace(const JointRows& rows, int most);

}  // namespace mortise::simulator
