// Digests of messages, the same on every machine and in every process. Private to the codec files.
#pragma once

#include <google/protobuf/message.h>

#include <string>

#include "mortise/v1/catalog.pb.h"

namespace mortise::parametric {

// SHA-256 of the message, in lower-case hexadecimals.
std::string MessageDigest(const google::protobuf::Message& message);

// Without what only says which revision of an item or material this is, and since when.
void ClearRevisions(google::protobuf::RepeatedPtrField<v1::Item>& items,
                    google::protobuf::RepeatedPtrField<v1::Material>& materials);

}  // namespace mortise::parametric
