// Names of a message's type as people are told them. Target mortise_message_faults.
#pragma once

#include <google/protobuf/descriptor.h>

#include <string>

namespace mortise {

// "X, Y, Z": all values but the first, which stands for what is not said.
std::string ValueNames(const google::protobuf::EnumDescriptor& type);

// "cad, cage": the fields of which a message has one at most.
std::string ChoiceNames(const google::protobuf::OneofDescriptor& choice);

}  // namespace mortise
