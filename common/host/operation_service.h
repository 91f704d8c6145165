// OperationService of one service process: its own operations, over common/operations.
#pragma once

#include <memory>

namespace grpc {
class Service;
}
namespace mortise::operations {
class Operations;
}

namespace mortise::rpc {

class Dispatcher;

// `operations` and `dispatcher` must outlive it.
std::shared_ptr<grpc::Service> MakeOperationService(Dispatcher* dispatcher,
                                                    operations::Operations* operations);

}  // namespace mortise::rpc
