// What the methods of ParetoService stand on.
#pragma once

namespace mortise::operations {
class Operations;
}
namespace mortise::rpc {
class Peers;
}
namespace mortise::store {
class Store;
}

namespace mortise::pareto {

class FrontCache;

// All of it outlives the calls.
struct Pareto {
  store::Store* store;
  operations::Operations* operations;
  rpc::Peers* peers;     // of which "simulator" evaluates
  FrontCache* explored;  // the fronts that points were picked of last
};

}  // namespace mortise::pareto
