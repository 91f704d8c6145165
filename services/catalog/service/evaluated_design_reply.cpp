#include "services/catalog/service/evaluated_design_reply.h"

#include <vector>

#include "common/assembly/parametric_assembly.h"
#include "common/base/errors.h"

namespace mortise::catalog {

absl::Status AddFaults(const templates::Template& function, const Eigen::VectorXd& q,
                       v1::EvaluatedDesign& design) {
  MORTISE_ASSIGN_OR_RETURN(const auto at, function.AssemblyAt(q));
  if (!at) return absl::OkStatus();
  MORTISE_ASSIGN_OR_RETURN(const std::vector<parametric::ContactFault> faults,
                           at->assembly->FaultsAt(at->q));
  for (const parametric::ContactFault& fault : faults) {
    design.add_faults(parametric::Describe(fault));
  }
  return absl::OkStatus();
}

void DropTriangles(v1::EvaluatedDesign& design) {
  for (v1::EvaluatedPart& part : *design.mutable_parts()) {
    if (!part.has_faceted()) continue;
    part.mutable_faceted()->clear_vertices();
    part.mutable_faceted()->clear_triangles();
    part.mutable_faceted()->clear_triangle_faces();
  }
}

}  // namespace mortise::catalog
