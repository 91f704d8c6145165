// The operation behind CreatePlan: evaluates the design at the catalog, plans it, draws its files
// and stores the plan.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/operations/operations.h"
#include "mortise/v1/catalog.pb.h"
#include "mortise/v1/fabplanner.pb.h"
#include "services/fabplanner/documents/plan_files.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::rpc {
class IdentitySigner;
class Peers;
struct Origin;
}  // namespace mortise::rpc
namespace mortise::store {
class BlobFolder;
}

namespace mortise::fabplanner {

// Whether a request names a template and a revision that there may be. INVALID_ARGUMENT otherwise.
absl::Status CheckTemplate(const v1::CreatePlanRequest& request);

// Tells what can be said against a request before the catalog is asked. INVALID_ARGUMENT naming
// every field at fault.
absl::Status CheckRequest(const v1::CreatePlanRequest& request);

// Runs it. The plan's id is the operation's, so that a run repeated after a crash makes the same
// plan. Fails as MakePlan and the catalog do.
class PlanOperation {
 public:
  // All outlive it; `signer` may be null.
  PlanOperation(rpc::Peers* peers, const rpc::IdentitySigner* signer, store::BlobFolder* blobs)
      : peers_(peers), signer_(signer), blobs_(blobs) {}

  // Asks the catalog for the design: NOT_FOUND, INVALID_ARGUMENT or OUT_OF_RANGE as it answers. OK
  // if it cannot be asked now; Run will.
  absl::Status CheckDesign(const v1::CreatePlanRequest& request, const rpc::Origin& origin) const;

  // Returns the packed v1::Plan.
  absl::StatusOr<std::string> Run(operations::OperationContext& context) const;

 private:
  struct Inputs {
    v1::EvaluatedDesign design;
    v1::TemplateBundle bundle;
  };
  // Returns the bytes of a file that the catalog exports.
  absl::StatusOr<std::string> Export(const v1::ExportDesignRequest& request,
                                     operations::OperationContext& context) const;
  absl::StatusOr<Inputs> FetchInputs(const v1::CreatePlanRequest& request,
                                     operations::OperationContext& context) const;
  // Looks for the parameters nearest to the design's by which machines make what they cannot make
  // of it; the catalog evaluates other designs for that. Does nothing where they make all.
  absl::Status FindNearestParameters(const Inputs& inputs, const Items& items,
                                     FabricationPlan* plan,
                                     operations::OperationContext& context) const;
  // Returns the design as a STEP file; empty for what has no exact surfaces, such as a mesh in a
  // cage.
  absl::StatusOr<std::string> FetchStep(const v1::EvaluatedDesign& design,
                                        operations::OperationContext& context) const;
  // Fetches the step for a plan with drawings, which afterwards names the file among them. Where
  // the catalog cannot make it, it is empty, and the plan says so; fails if that may pass.
  absl::StatusOr<std::string> AttachStep(const v1::EvaluatedDesign& design, FabricationPlan* plan,
                                         operations::OperationContext& context) const;
  // Stores the files, and names them in the plan.
  absl::Status KeepFiles(const std::vector<PlanFile>& files, v1::Plan* plan) const;

  rpc::Peers* peers_;
  const rpc::IdentitySigner* signer_;
  store::BlobFolder* blobs_;
};

}  // namespace mortise::fabplanner
