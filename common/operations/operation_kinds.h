// The kinds of operations that a house has, each "<service>.<what>": the services register their
// own, and lists of operations are asked for by them.
#pragma once

namespace mortise::operations {

inline constexpr char kPlanOperation[] = "fabplanner.plan";
inline constexpr char kWorkOrderOperation[] = "fabplanner.workOrder";
inline constexpr char kMapOperation[] = "interpolator.map";
inline constexpr char kVerificationOperation[] = "interpolator.verification";
inline constexpr char kDiscoveryOperation[] = "pareto.discovery";
inline constexpr char kIndexOperation[] = "retrieval.index";
inline constexpr char kAnalysisOperation[] = "simulator.analysis";

inline constexpr const char* kOperationKinds[] = {
    kPlanOperation,      kWorkOrderOperation, kMapOperation,     kVerificationOperation,
    kDiscoveryOperation, kIndexOperation,     kAnalysisOperation};

}  // namespace mortise::operations
