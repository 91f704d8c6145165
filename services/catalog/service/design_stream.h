// Designs as streams of chunks, in whatever format a request names.
#pragma once

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/rpc/stream_writer.h"
#include "mortise/v1/catalog.pb.h"
#include "services/catalog/exchange/assembly_export.h"

namespace mortise::catalog {

// What files of one format are called.
struct FileKind {
  const char* extension;   // ".step"
  const char* media_type;  // "model/step"
};

// INVALID_ARGUMENT, "format".
absl::StatusOr<FileKind> KindOf(v1::ExportDesignRequest::Format format);

// Returns which of the formats of triangles; the format must not be STEP.
MeshFormat MeshFormatOf(v1::ExportDesignRequest::Format format);

// The assembly as a file called by `id` and its extension. In STEP it is called by its title, or by
// the id if that is empty.
absl::Status StreamAssembly(const PosedAssembly& posed, v1::ExportDesignRequest::Format format,
                            const std::string& id, const std::string& title,
                            const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer);

}  // namespace mortise::catalog
