// What the methods of RetrievalService stand on.
#pragma once

#include "common/host/run_service.h"
#include "services/retrieval/catalog/template_source.h"
#include "services/retrieval/service/loaded_indexes.h"
#include "services/retrieval/service/match_designs.h"
#include "services/retrieval/service/uploaded_meshes.h"

namespace mortise::store {
class BlobFolder;
}

namespace mortise::retrieval {

class CoverQueue;

struct Retrieval {
  rpc::ServiceEnvironment& environment;
  TemplateSource& templates;
  LoadedIndexes& indexes;
  const UploadedMeshes& meshes;
  MatchFacts& facts;
  CoverQueue& covers;
  store::BlobFolder* blobs;
};

}  // namespace mortise::retrieval
