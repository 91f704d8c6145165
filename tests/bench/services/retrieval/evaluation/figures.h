// The figures and tables of thesis §4.7, each as a function that writes it.
#pragma once

#include "absl/status/status.h"
#include "tests/bench/services/retrieval/evaluation/result_folder.h"
#include "tests/bench/services/retrieval/evaluation/study.h"

namespace mortise::retrieval {

// Table 4.1: how many families of which category there are.
absl::Status WriteCollection(Study& study, ResultFolder& results);

// Figure 4-7: rejection against adaptive sampling on a paraboloid.
absl::Status WriteSamplingSchemes(Study& study, ResultFolder& results);

// Figure 4-8: fitting and coverage errors against δ.
absl::Status WriteAccuracy(Study& study, ResultFolder& results);

// Figure 4-9: what covers of points, tangents and both cost.
absl::Status WriteCosts(Study& study, ResultFolder& results);

// Figure 4-10: random designs, found by mean shapes and by manifolds.
absl::Status WriteRandomDesigns(Study& study, ResultFolder& results);

// Figure 4-11: covers against random points of the parameters.
absl::Status WriteNaiveSampling(Study& study, ResultFolder& results);

// Figures 4-12 and 4-14: pictures of what is found for labelled shapes.
absl::Status WriteFoundByDelta(Study& study, ResultFolder& results);
absl::Status WriteFoundByMeanShapes(Study& study, ResultFolder& results);

// Figure 4-13 and Table 4.2: precision and recall of labelled shapes, and how far apart categories
// are.
absl::Status WritePrecision(Study& study, ResultFolder& results);
absl::Status WriteCategoryDistances(Study& study, ResultFolder& results);

// Labelled shapes among each other, leaving one out: nearest neighbour and first tier.
absl::Status WriteLabelledShapes(Study& study, ResultFolder& results);

}  // namespace mortise::retrieval
