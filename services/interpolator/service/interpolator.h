// What the methods of InterpolatorService stand on.
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

namespace mortise::interpolator {

class LoadedMaps;
class LoadedShapes;

// All of it outlives the calls.
struct Interpolator {
  store::Store* store;
  operations::Operations* operations;
  rpc::Peers* peers;     // of which "simulator" evaluates
  LoadedMaps* loaded;    // those that were asked last
  LoadedShapes* shapes;  // likewise, of all maps
};

inline constexpr char kEvaluatorPeer[] = "simulator";

}  // namespace mortise::interpolator
