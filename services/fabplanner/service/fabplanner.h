// What the methods of FabPlannerService stand on. All of it outlives them.
#pragma once

namespace mortise::operations {
class Operations;
}
namespace mortise::rpc {
class Dispatcher;
}
namespace mortise::store {
class BlobFolder;
class Store;
}  // namespace mortise::store

namespace mortise::fabplanner {

class PlanOperation;
class ShopFloor;

struct FabPlanner {
  store::Store* store;
  operations::Operations* operations;
  rpc::Dispatcher* dispatcher;
  store::BlobFolder* blobs;       // files of plans
  const PlanOperation* planning;  // what CreatePlan starts
  ShopFloor* floor;               // what ReleaseWorkOrder starts
  int most_orders;                // work orders under way at a time
};

}  // namespace mortise::fabplanner
