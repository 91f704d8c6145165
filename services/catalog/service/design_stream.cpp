#include "services/catalog/service/design_stream.h"

#include <utility>

#include "common/base/errors.h"
#include "common/host/chunk_stream.h"

namespace mortise::catalog {

absl::StatusOr<FileKind> KindOf(v1::ExportDesignRequest::Format format) {
  switch (format) {
    case v1::ExportDesignRequest::STEP:
      return FileKind{".step", "model/step"};
    case v1::ExportDesignRequest::GLB:
      return FileKind{".glb", "model/gltf-binary"};
    case v1::ExportDesignRequest::OBJ:
      return FileKind{".obj", "model/obj"};
    case v1::ExportDesignRequest::STL:
      return FileKind{".stl", "model/stl"};
    default:
      return InvalidField("format", "must be STEP, GLB, OBJ or STL");
  }
}

MeshFormat MeshFormatOf(v1::ExportDesignRequest::Format format) {
  return format == v1::ExportDesignRequest::OBJ   ? MeshFormat::kObj
         : format == v1::ExportDesignRequest::STL ? MeshFormat::kStl
                                                  : MeshFormat::kGlb;
}

absl::Status StreamAssembly(const PosedAssembly& posed, v1::ExportDesignRequest::Format format,
                            const std::string& id, const std::string& title,
                            const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer) {
  MORTISE_ASSIGN_OR_RETURN(const FileKind kind, KindOf(format));
  MORTISE_ASSIGN_OR_RETURN(std::string bytes,
                           format == v1::ExportDesignRequest::STEP
                               ? ExportAssemblyStep(posed, title.empty() ? id : title)
                               : ExportAssemblyMesh(posed, MeshFormatOf(format), id));
  rpc::StreamBytes(std::move(bytes), {id + kind.extension, kind.media_type}, writer);
  return absl::OkStatus();
}

}  // namespace mortise::catalog
