// Methods of AssemblyService about what automatic parametrisation makes of assemblies;
// assembly.proto says what each does.
#pragma once

#include <memory>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/rpc/stream_writer.h"
#include "mortise/v1/assembly.pb.h"
#include "services/catalog/service/catalog.h"

namespace mortise::catalog::methods {

using AdjustedWriter = std::shared_ptr<rpc::StreamWriter<v1::AdjustedAssembly>>;

absl::StatusOr<v1::Parametrization> ParametrizeAssembly(
    Catalog& catalog, const rpc::Call& call, const v1::ParametrizeAssemblyRequest& asked);
absl::StatusOr<v1::AdjustedAssembly> AdjustAssembly(Catalog& catalog, const rpc::Call& call,
                                                    const v1::AdjustAssemblyRequest& asked);
absl::Status EvaluateAssembly(Catalog& catalog, const rpc::Call& call,
                              const v1::EvaluateAssemblyRequest& asked,
                              const AdjustedWriter& writer);
absl::Status SampleAssembly(Catalog& catalog, const rpc::Call& call,
                            const v1::SampleAssemblyRequest& asked, const AdjustedWriter& writer);
absl::Status ExportAssembly(Catalog& catalog, const rpc::Call& call,
                            const v1::ExportAssemblyRequest& asked,
                            const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer);

// All that is wrong with a request, without evaluating anything.
absl::Status ExplainAdjustAssembly(Catalog& catalog, const rpc::Call& call,
                                   const v1::AdjustAssemblyRequest& asked);
absl::Status ExplainEvaluateAssembly(Catalog& catalog, const rpc::Call& call,
                                     const v1::EvaluateAssemblyRequest& asked);
absl::Status ExplainExportAssembly(Catalog& catalog, const rpc::Call& call,
                                   const v1::ExportAssemblyRequest& asked);

}  // namespace mortise::catalog::methods
