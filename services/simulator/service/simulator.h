// What the methods of SimulatorService stand on.
#pragma once

namespace mortise::operations {
class Operations;
}
namespace mortise::rpc {
class FileQuota;
}
namespace mortise::store {
class BlobFolder;
}

namespace mortise::simulator {

class SimulatorCore;

// All of it outlives the calls.
struct Simulator {
  SimulatorCore* core;       // the store, the queue and who waits for it, the catalog
  store::BlobFolder* blobs;  // files of meshes, analyses and designs
  rpc::FileQuota* quota;     // of these
  operations::Operations* operations;
};

}  // namespace mortise::simulator
