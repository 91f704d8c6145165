// Tells people of the fields of messages: what they are called, and what they take.
#pragma once

#include <google/protobuf/descriptor.h>

#include <string>

namespace mortise {

// Returns "X, Y, Z": all values but the first, which stands for what is not said.
std::string ValueNames(const google::protobuf::EnumDescriptor& type);

// Returns "cad, cage": the fields of which a message has one at most.
std::string ChoiceNames(const google::protobuf::OneofDescriptor& choice);

// Returns what to offer where `type` has no field of this name, as NamesOffered does.
std::string FieldsOffered(const std::string& name, const google::protobuf::Descriptor& type);

// Whether JSON writes messages of this type in a way of their own, as texts or numbers
// (google.protobuf.Timestamp).
bool HasSpecialJson(const google::protobuf::Descriptor& type);

// How a message is written, where that makes a difference.
enum class Notation { kJson, kTextFormat };

// Returns what a field takes, for faults of what is written: "must be a number", "must be one of X,
// Y, Z".
std::string WantedValue(const google::protobuf::FieldDescriptor& field,
                        Notation notation = Notation::kJson);

}  // namespace mortise
