// Methods of CatalogService about designs, F(q) of templates; catalog.proto says what each does.
#pragma once

#include <memory>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/rpc/stream_writer.h"
#include "mortise/v1/catalog.pb.h"
#include "services/catalog/service/catalog.h"

namespace mortise::catalog::methods {

absl::StatusOr<v1::EvaluatedDesign> EvaluateTemplate(Catalog& catalog, const rpc::Call& call,
                                                     const v1::EvaluateTemplateRequest& asked);
absl::Status ExportDesign(Catalog& catalog, const rpc::Call& call,
                          const v1::ExportDesignRequest& asked,
                          const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer);

// All that is wrong with a request, without evaluating anything.
absl::Status ExplainEvaluateTemplate(Catalog& catalog, const rpc::Call& call,
                                     const v1::EvaluateTemplateRequest& asked);
absl::Status ExplainExportDesign(Catalog& catalog, const rpc::Call& call,
                                 const v1::ExportDesignRequest& asked);

}  // namespace mortise::catalog::methods
