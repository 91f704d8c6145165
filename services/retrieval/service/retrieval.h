// What the methods of RetrievalService stand on.
#pragma once

#include "common/host/run_service.h"
#include "services/retrieval/service/loaded_indexes.h"
#include "services/retrieval/service/match_designs.h"
#include "services/retrieval/service/template_source.h"
#include "services/retrieval/service/uploaded_meshes.h"

namespace mortise::retrieval {

struct Retrieval {
  rpc::ServiceEnvironment& environment;
  TemplateSource& templates;
  LoadedIndexes& indexes;
  const UploadedMeshes& meshes;
  MatchFacts& facts;
};

}  // namespace mortise::retrieval
