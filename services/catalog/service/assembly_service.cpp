// The methods of AssemblyService, one a line. What answers them is in assembly_methods.cpp and
// parametrization_methods.cpp.
#include "services/catalog/service/assembly_service.h"

#include <utility>

#include "common/rpc/method_overrides.h"
#include "mortise/v1/assembly.grpc.pb.h"
#include "services/catalog/service/assembly_methods.h"
#include "services/catalog/service/parametrization_methods.h"

namespace mortise::catalog {
namespace {

using rpc::BadNumbers;
using rpc::With;

class AssemblyAdapter final : public v1::AssemblyService::CallbackService {
  using Contract = v1::AssemblyService::CallbackService;

 public:
  AssemblyAdapter(rpc::Dispatcher* dispatcher, std::shared_ptr<Catalog> catalog)
      : catalog_(std::move(catalog)), endpoint_(dispatcher, "mortise.v1.AssemblyService") {}

  MORTISE_QUERY(GetAssembly, With(*catalog_, methods::GetAssembly))
  MORTISE_QUERY(ListAssemblies, With(*catalog_, methods::ListAssemblies))
  MORTISE_PREPARED_MUTATION(ImportAssembly, With(*catalog_, methods::PrepareAssembly),
                            methods::ImportAssembly, BadNumbers::kToldWithAllElse)
  MORTISE_PREPARED_MUTATION(ImportAssemblyStep, With(*catalog_, methods::PrepareAssemblyStep),
                            methods::ImportAssemblyStep, BadNumbers::kToldWithAllElse)
  MORTISE_PREPARED_MUTATION(ImportAssemblyMesh, With(*catalog_, methods::PrepareAssemblyMesh),
                            methods::ImportAssemblyMesh, BadNumbers::kToldWithAllElse)
  MORTISE_MUTATION(DeleteAssembly, methods::DeleteAssembly)
  MORTISE_UPLOAD(UploadDrawing, With(*catalog_, methods::UploadDrawing))

  MORTISE_QUERY(ParametrizeAssembly, With(*catalog_, methods::ParametrizeAssembly))
  MORTISE_QUERY(AdjustAssembly, With(*catalog_, methods::AdjustAssembly),
                With(*catalog_, methods::ExplainAdjustAssembly))
  MORTISE_SERVER_STREAM(EvaluateAssembly, With(*catalog_, methods::EvaluateAssembly), {},
                        With(*catalog_, methods::ExplainEvaluateAssembly))
  MORTISE_SERVER_STREAM(SampleAssembly, With(*catalog_, methods::SampleAssembly))
  MORTISE_SERVER_STREAM(ExportAssembly, With(*catalog_, methods::ExportAssembly), {},
                        With(*catalog_, methods::ExplainExportAssembly))

 private:
  const std::shared_ptr<Catalog> catalog_;
  rpc::Endpoint endpoint_;
};

}  // namespace

std::shared_ptr<grpc::Service> MakeAssemblyService(const rpc::ServiceEnvironment& environment,
                                                   std::shared_ptr<Catalog> catalog) {
  return std::make_shared<AssemblyAdapter>(environment.dispatcher, std::move(catalog));
}

}  // namespace mortise::catalog
