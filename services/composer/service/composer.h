// What the methods of ComposerService stand on. All of it outlives them.
#pragma once

#include <memory>
#include <string>

#include "services/composer/service/collection_connections.h"
#include "services/composer/service/drag_cache.h"
#include "services/composer/service/model_drawings.h"
#include "services/composer/service/origin_source.h"

namespace mortise::composer {

struct Composer {
  store::Store* store;
  ModelDrawings& drawings;
  OriginSource& origins;
  CollectionConnections& collection;
  DragCache& drags;
  const std::shared_ptr<grpc::Channel>& catalog;
  std::string service;  // the process, as audit records name it
};

}  // namespace mortise::composer
