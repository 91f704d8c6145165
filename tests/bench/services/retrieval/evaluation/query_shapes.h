// Which families a labelled shape may be answered with.
#pragma once

#include <functional>

#include "tests/bench/services/retrieval/evaluation/study.h"

namespace mortise::retrieval {

enum class Strictness {
  kShape,   // not with the family that was made of it
  kAuthor,  // nor with those made of any shape of its author, which are alike for other reasons
};

std::function<bool(int family)> FamiliesFor(const Study& study, const LabelledShape& shape,
                                            Strictness strictness);

}  // namespace mortise::retrieval
