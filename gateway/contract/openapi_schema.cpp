#include "gateway/contract/openapi_schema.h"

#include <map>
#include <optional>

namespace mortise::gateway {
namespace {

namespace pb = google::protobuf;

// Types whose JSON form is not that of their fields.
std::optional<OrderedJson> WellKnownSchema(const std::string& name) {
  static const std::map<std::string, const char*> kSchemas = {
      {"google.protobuf.Timestamp", R"({"type":"string","format":"date-time"})"},
      {"google.protobuf.Duration", R"({"type":"string","pattern":"^-?[0-9]+(\\.[0-9]+)?s$"})"},
      {"google.protobuf.FieldMask",
       R"({"type":"string","description":"camelCase paths, separated by commas"})"},
      {"google.protobuf.Any",
       R"({"type":"object","properties":{"@type":{"type":"string"}},"required":["@type"],)"
       R"("additionalProperties":true})"},
      {"google.protobuf.Struct", R"({"type":"object","additionalProperties":true})"},
      {"google.protobuf.Value", R"({})"},
      {"google.protobuf.Empty", R"({"type":"object"})"}};
  const auto found = kSchemas.find(name);
  if (found == kSchemas.end()) return std::nullopt;
  return OrderedJson::parse(found->second);
}

OrderedJson Reference(const std::string& name) {
  return {{"$ref", "#/components/schemas/" + name}};
}

}  // namespace

OrderedJson SchemaCollection::Refer(const pb::Descriptor& message) {
  if (auto known = WellKnownSchema(message.full_name())) return *known;
  // Entered before it is built, because messages may contain themselves.
  if (schemas_.emplace(message.full_name(), OrderedJson()).second) {
    OrderedJson schema = MessageSchema(message);
    schemas_[message.full_name()] = std::move(schema);
  }
  return Reference(message.full_name());
}

OrderedJson SchemaCollection::Take() {
  OrderedJson all = OrderedJson::object();
  for (auto& [name, schema] : schemas_) all[name] = std::move(schema);
  schemas_.clear();
  return all;
}

OrderedJson SchemaCollection::MessageSchema(const pb::Descriptor& message) {
  OrderedJson schema = {{"type", "object"}};
  if (const std::string comment = CommentOf(message); !comment.empty()) {
    schema["description"] = comment;
  }
  OrderedJson properties = OrderedJson::object();
  for (int i = 0; i < message.field_count(); ++i) {
    properties[message.field(i)->json_name()] = FieldSchema(*message.field(i));
  }
  schema["properties"] = std::move(properties);
  schema["additionalProperties"] = false;
  return schema;
}

OrderedJson SchemaCollection::FieldSchema(const pb::FieldDescriptor& field) {
  OrderedJson schema;
  if (field.is_map()) {
    schema = {{"type", "object"},
              {"additionalProperties", SingleSchema(*field.message_type()->map_value())}};
  } else if (field.is_repeated()) {
    schema = {{"type", "array"}, {"items", SingleSchema(field)}};
  } else {
    schema = SingleSchema(field);
  }
  std::string comment = CommentOf(field);
  if (const pb::OneofDescriptor* oneof = field.real_containing_oneof()) {
    comment += (comment.empty() ? "" : " ") + std::string("(At most one field of \"") +
               oneof->name() + "\" is set.)";
  }
  if (!comment.empty()) schema["description"] = comment;
  return schema;
}

OrderedJson SchemaCollection::SingleSchema(const pb::FieldDescriptor& field) {
  switch (field.cpp_type()) {
    case pb::FieldDescriptor::CPPTYPE_INT32:
      return {{"type", "integer"}, {"format", "int32"}};
    case pb::FieldDescriptor::CPPTYPE_UINT32:
      return {{"type", "integer"}, {"format", "uint32"}, {"minimum", 0}};
    case pb::FieldDescriptor::CPPTYPE_INT64:
      return {{"type", "string"}, {"format", "int64"}};
    case pb::FieldDescriptor::CPPTYPE_UINT64:
      return {{"type", "string"}, {"format", "uint64"}};
    case pb::FieldDescriptor::CPPTYPE_DOUBLE:
      return {{"type", "number"}, {"format", "double"}};
    case pb::FieldDescriptor::CPPTYPE_FLOAT:
      return {{"type", "number"}, {"format", "float"}};
    case pb::FieldDescriptor::CPPTYPE_BOOL:
      return {{"type", "boolean"}};
    case pb::FieldDescriptor::CPPTYPE_ENUM:
      return EnumReference(*field.enum_type());
    case pb::FieldDescriptor::CPPTYPE_STRING:
      if (field.type() == pb::FieldDescriptor::TYPE_BYTES) {
        return {{"type", "string"}, {"contentEncoding", "base64"}};
      }
      return {{"type", "string"}};
    case pb::FieldDescriptor::CPPTYPE_MESSAGE:
      return Refer(*field.message_type());
  }
  return OrderedJson::object();
}

OrderedJson SchemaCollection::EnumReference(const pb::EnumDescriptor& type) {
  if (schemas_.count(type.full_name()) == 0) {
    OrderedJson schema = {{"type", "string"}};
    std::string comment = CommentOf(type);
    OrderedJson values = OrderedJson::array();
    for (int i = 0; i < type.value_count(); ++i) {
      const pb::EnumValueDescriptor& value = *type.value(i);
      values.push_back(value.name());
      comment += (comment.empty() ? "" : " ") + value.name() + ": " + CommentOf(value);
    }
    schema["description"] = comment;
    schema["enum"] = std::move(values);
    schemas_[type.full_name()] = std::move(schema);
  }
  return Reference(type.full_name());
}

}  // namespace mortise::gateway
