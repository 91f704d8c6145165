// Methods of AssemblyService about assemblies as they are drawn; assembly.proto says what each
// does.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/rpc/stream_reactors.h"
#include "common/store/store.h"
#include "mortise/v1/assembly.pb.h"
#include "services/catalog/service/catalog.h"

namespace mortise::catalog::methods {

absl::StatusOr<v1::Assembly> GetAssembly(Catalog& catalog, const rpc::Call& call,
                                         const v1::GetAssemblyRequest& asked);
absl::StatusOr<v1::ListAssembliesResponse> ListAssemblies(Catalog& catalog, const rpc::Call& call,
                                                          const v1::ListAssembliesRequest& asked);
absl::StatusOr<v1::DeleteAssemblyResponse> DeleteAssembly(const rpc::Call& call,
                                                          const v1::DeleteAssemblyRequest& asked,
                                                          store::Transaction& transaction);

// Parametrises an assembly, which takes a while, before the transaction of ImportAssembly.
absl::StatusOr<v1::AssemblyBundle> PrepareAssembly(Catalog& catalog, const rpc::Call& call,
                                                   const v1::ImportAssemblyRequest& asked);
absl::StatusOr<v1::Assembly> ImportAssembly(const rpc::Call& call,
                                            const v1::ImportAssemblyRequest& asked,
                                            v1::AssemblyBundle& bundle,
                                            store::Transaction& transaction);

// An assembly that is drawn in CAD and can be stored.
struct DrawnBundle {
  v1::AssemblyBundle bundle;
  std::vector<std::string> notes;  // for people
};
// The same of a drawing.
absl::StatusOr<DrawnBundle> PrepareAssemblyStep(Catalog& catalog, const rpc::Call& call,
                                                const v1::ImportAssemblyStepRequest& asked);
absl::StatusOr<v1::ImportAssemblyStepResponse> ImportAssemblyStep(
    const rpc::Call& call, const v1::ImportAssemblyStepRequest& asked, DrawnBundle& drawn,
    store::Transaction& transaction);

// The same of a mesh.
absl::StatusOr<DrawnBundle> PrepareAssemblyMesh(Catalog& catalog, const rpc::Call& call,
                                                const v1::ImportAssemblyMeshRequest& asked);
absl::StatusOr<v1::ImportAssemblyMeshResponse> ImportAssemblyMesh(
    const rpc::Call& call, const v1::ImportAssemblyMeshRequest& asked, DrawnBundle& drawn,
    store::Transaction& transaction);

absl::StatusOr<std::unique_ptr<rpc::UploadReader<v1::Chunk, v1::UploadDrawingResponse>>>
UploadDrawing(Catalog& catalog, const rpc::Call& call);

}  // namespace mortise::catalog::methods
