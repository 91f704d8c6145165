// AuditService of one service process: the records its mutations left in its store.
#pragma once

#include <memory>
#include <string>

namespace grpc {
class Service;
}
namespace mortise::store {
class Store;
}

namespace mortise::rpc {

class Dispatcher;

// `dispatcher` and `store` must outlive it.
std::shared_ptr<grpc::Service> MakeAuditService(Dispatcher* dispatcher, store::Store* store,
                                                const std::string& service);

}  // namespace mortise::rpc
