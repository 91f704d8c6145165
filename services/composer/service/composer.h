// What the methods of ComposerService stand on. All of it outlives them.
#pragma once

#include <memory>
#include <string>

#include "services/composer/catalog/collection_connections.h"
#include "services/composer/catalog/origin_source.h"
#include "services/composer/records/model_drawings.h"
#include "services/composer/service/drag_cache.h"

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
