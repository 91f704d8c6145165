// JSON schemas (2020-12, as OpenAPI 3.1 uses them) of protobuf messages in their JSON form.
#pragma once

#include <google/protobuf/descriptor.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "gateway/contract/contract.h"

namespace mortise::gateway {

using OrderedJson = nlohmann::ordered_json;

// Returns the comment of a message, field, method, enum or value in the proto file, as one
// paragraph; what stands after a field on its line counts too.
template <class DescriptorType>
std::string CommentOf(const DescriptorType& descriptor) {
  google::protobuf::SourceLocation location;
  if (!descriptor.GetSourceLocation(&location)) return {};
  std::string text = location.leading_comments + location.trailing_comments;
  std::string result;
  for (const char c : text) {
    const bool space = c == ' ' || c == '\n';
    if (space && (result.empty() || result.back() == ' ')) continue;
    result.push_back(space ? ' ' : c);
  }
  while (!result.empty() && result.back() == ' ') result.pop_back();
  return result;
}

// Collects the schemas of messages and of all they refer to.
class SchemaCollection {
 public:
  // {"$ref":"#/components/schemas/…"}, or the schema itself for well-known types.
  OrderedJson Refer(const google::protobuf::Descriptor& message);

  // Returns all schemas referred to so far, by full name.
  OrderedJson Take();

 private:
  OrderedJson MessageSchema(const google::protobuf::Descriptor& message);
  OrderedJson FieldSchema(const google::protobuf::FieldDescriptor& field);
  OrderedJson SingleSchema(const google::protobuf::FieldDescriptor& field);
  OrderedJson EnumReference(const google::protobuf::EnumDescriptor& type);

  std::map<std::string, OrderedJson> schemas_;
};

}  // namespace mortise::gateway
