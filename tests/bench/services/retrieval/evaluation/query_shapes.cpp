#include "tests/bench/services/retrieval/evaluation/query_shapes.h"

namespace mortise::retrieval {

std::function<bool(int family)> FamiliesFor(const Study& study, const LabelledShape& shape,
                                            Strictness strictness) {
  return [&study, &shape, strictness](int number) {
    const EvaluationFamily& family = study.families()[static_cast<std::size_t>(number)];
    if (family.mesh.empty()) return true;
    return family.mesh != shape.name &&
           (strictness == Strictness::kShape || family.author != shape.author);
  };
}

}  // namespace mortise::retrieval
