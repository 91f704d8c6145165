// Tags of the catalog's records: external ids and labels, which are a resource's own and no content
// of it.
#pragma once

#include "common/resources/resource_tags.h"

namespace mortise::catalog {

// Gives a message that takes the place of `present` those of its external ids and labels of which
// the message says nothing: who imports many things does not know what others wrote on them.
template <typename Message>
void KeepTags(const Message& present, Message* message) {
  if (message->external_ids().empty()) *message->mutable_external_ids() = present.external_ids();
  if (message->labels().empty()) *message->mutable_labels() = present.labels();
}

}  // namespace mortise::catalog
