// Digests of messages, the same on every machine and in every process.
#pragma once

#include <google/protobuf/message.h>

#include <string>

#include "mortise/v1/catalog.pb.h"

namespace mortise::parametric {

// Returns the SHA-256 of the message, in lower-case hexadecimals.
std::string MessageDigest(const google::protobuf::Message& message);

// Takes away what is no content of items and materials: which revision this is, since when, who
// created it, and by which external ids and labels it is found.
void ClearRevisions(google::protobuf::RepeatedPtrField<v1::Item>& items,
                    google::protobuf::RepeatedPtrField<v1::Material>& materials);

}  // namespace mortise::parametric
