#include "cli/client/resource_access.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/field_mask.pb.h>

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "cli/client/generic_call.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"

namespace mortise::cli {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::EnumDescriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::MethodDescriptor;

constexpr int kMaxPage = 1000;

Resource NewMessage(const Descriptor& type) {
  return Resource(
      google::protobuf::MessageFactory::generated_factory()->GetPrototype(&type)->New());
}

const FieldDescriptor* FieldOf(const Message& message, const std::string& name) {
  return message.GetDescriptor()->FindFieldByName(name);
}

// Sets a field of text, if the message has it.
void SetText(const std::string& name, const std::string& text, Message& message) {
  const FieldDescriptor* const field = FieldOf(message, name);
  if (field != nullptr) message.GetReflection()->SetString(&message, field, text);
}

absl::StatusOr<Resource> Call(const GatewayClient& client, const MethodDescriptor& method,
                              const Message& request) {
  Resource response = NewMessage(*method.output_type());
  MORTISE_RETURN_IF_ERROR(CallMethod(client, method, request, *response));
  return response;
}

std::string Shown(const std::string& name) {
  return absl::StrReplaceAll(absl::AsciiStrToLower(name), {{"_", "-"}});
}

// The states that there are: "running, held, …"; the first stands for none.
std::string StateNames(const EnumDescriptor& states) {
  std::string names;
  for (int i = 1; i < states.value_count(); ++i) {
    absl::StrAppend(&names, i == 1 ? "" : ", ", Shown(states.value(i)->name()));
  }
  return names;
}

absl::Status AddStates(const ResourceKind& kind, const std::vector<std::string>& states,
                       Message& request) {
  if (states.empty()) return absl::OkStatus();
  const FieldDescriptor* const field = FieldOf(request, "states");
  if (field == nullptr) return InvalidField("states", absl::StrCat(kind.names, " have none"));
  for (const std::string& text : states) {
    const auto* const value = field->enum_type()->FindValueByName(
        absl::StrReplaceAll(absl::AsciiStrToUpper(text), {{"-", "_"}}));
    if (value == nullptr || value->number() == 0) {
      return InvalidField(
          "states", absl::StrCat("'", text, "' is none of ", StateNames(*field->enum_type())));
    }
    request.GetReflection()->AddEnum(&request, field, value);
  }
  return absl::OkStatus();
}

absl::StatusOr<Resource> ListRequest(const ResourceKind& kind, const ResourceQuery& query) {
  Resource request = NewMessage(*kind.list_request());
  const auto* const reflection = request->GetReflection();
  if (!query.subject.empty() && FieldOf(*request, "subject") == nullptr) {
    return InvalidField("subject", absl::StrCat(kind.names, " have none"));
  }
  SetText("subject", query.subject, *request);
  MORTISE_RETURN_IF_ERROR(AddStates(kind, query.states, *request));
  reflection->MutableMessage(request.get(), FieldOf(*request, "filter"))->CopyFrom(query.filter);
  // The results of operations may be megabytes each, and are resources of their own.
  if (const FieldDescriptor* const omit = FieldOf(*request, "omit_results")) {
    reflection->SetBool(request.get(), omit, true);
  }
  return request;
}

void SetTags(const Tags& tags, Message& resource) {
  const auto* const reflection = resource.GetReflection();
  const FieldDescriptor* const ids = FieldOf(resource, "external_ids");
  const FieldDescriptor* const labels = FieldOf(resource, "labels");
  reflection->ClearField(&resource, ids);
  for (const std::string& id : tags.external_ids) reflection->AddString(&resource, ids, id);
  reflection->ClearField(&resource, labels);
  for (const auto& [key, value] : tags.labels) {
    Message* const entry = reflection->AddMessage(&resource, labels);
    entry->GetReflection()->SetString(entry, entry->GetDescriptor()->map_key(), key);
    entry->GetReflection()->SetString(entry, entry->GetDescriptor()->map_value(), value);
  }
}

// The field of a request that holds a resource of this type.
const FieldDescriptor* FieldOfType(const Message& request, const Descriptor& type) {
  const Descriptor& fields = *request.GetDescriptor();
  for (int i = 0; i < fields.field_count(); ++i) {
    if (fields.field(i)->message_type() == &type) return fields.field(i);
  }
  return nullptr;
}

std::int64_t RevisionOf(const Message& resource) {
  const FieldDescriptor* const field = FieldOf(resource, "revision");
  return field == nullptr ? 0 : resource.GetReflection()->GetInt64(resource, field);
}

// Asks for two fields only, so only those travel, with what names the resource and its revision.
void FillUpdate(const Message& present, const Tags& tags, const FieldDescriptor& mask,
                Message& request, Message& changes) {
  SetText("name", TextOfField(present, "name"), changes);
  if (const FieldDescriptor* const revision = FieldOf(changes, "revision")) {
    changes.GetReflection()->SetInt64(&changes, revision, RevisionOf(present));
  }
  SetTags(tags, changes);
  google::protobuf::FieldMask paths;
  paths.add_paths("external_ids");
  paths.add_paths("labels");
  request.GetReflection()->MutableMessage(&request, &mask)->CopyFrom(paths);
}

void FillImport(const Message& present, const Tags& tags, Message& request, Message& content) {
  content.CopyFrom(present);
  SetTags(tags, content);
  const FieldDescriptor* const expected = FieldOf(request, "expected_revision");
  request.GetReflection()->SetInt64(&request, expected, RevisionOf(present));
}

}  // namespace

absl::StatusOr<ResourceList> ListResources(const GatewayClient& client, const ResourceKind& kind,
                                           const ResourceQuery& query) {
  MORTISE_ASSIGN_OR_RETURN(const Resource request, ListRequest(kind, query));
  const FieldDescriptor* const size = FieldOf(*request, "page_size");
  ResourceList list;
  std::string token;
  do {
    const int left = query.limit - static_cast<int>(list.resources.size());
    request->GetReflection()->SetInt32(request.get(), size, std::min(kMaxPage, left));
    SetText("page_token", token, *request);
    MORTISE_ASSIGN_OR_RETURN(const Resource page, Call(client, ListMethod(kind), *request));
    const FieldDescriptor& entries = EntriesField(kind);
    const int count = page->GetReflection()->FieldSize(*page, &entries);
    for (int i = 0; i < count; ++i) {
      const Message& entry = page->GetReflection()->GetRepeatedMessage(*page, &entries, i);
      list.resources.emplace_back(entry.New())->CopyFrom(entry);
    }
    token = TextOfField(*page, "next_page_token");
  } while (!token.empty() && static_cast<int>(list.resources.size()) < query.limit);
  list.has_more = !token.empty();
  return list;
}

absl::StatusOr<Resource> GetResource(const GatewayClient& client, const ResourceKind& kind,
                                     const std::string& name) {
  const MethodDescriptor& method = GetMethod(kind);
  const Resource request = NewMessage(*method.input_type());
  SetText("name", name, *request);
  return Call(client, method, *request);
}

Tags TagsOf(const Message& resource) {
  Tags tags;
  const auto* const reflection = resource.GetReflection();
  const FieldDescriptor* const ids = FieldOf(resource, "external_ids");
  for (int i = 0; i < reflection->FieldSize(resource, ids); ++i) {
    tags.external_ids.push_back(reflection->GetRepeatedString(resource, ids, i));
  }
  const FieldDescriptor* const labels = FieldOf(resource, "labels");
  for (int i = 0; i < reflection->FieldSize(resource, labels); ++i) {
    const Message& entry = reflection->GetRepeatedMessage(resource, labels, i);
    tags.labels[TextOfField(entry, "key")] = TextOfField(entry, "value");
  }
  return tags;
}

absl::StatusOr<Resource> ChangeTags(const GatewayClient& client, const ResourceKind& kind,
                                    const Message& present, const Tags& tags) {
  const MethodDescriptor* const method = ChangeMethod(kind);
  if (method == nullptr) {
    return InvalidField("name", absl::StrCat("the tags of ", kind.names, " do not change"));
  }
  const Resource request = NewMessage(*method->input_type());
  SetText("request_id", NewIdentifier(), *request);
  const FieldDescriptor* const field = FieldOfType(*request, *present.GetDescriptor());
  Message* const changed = request->GetReflection()->MutableMessage(request.get(), field);
  if (const FieldDescriptor* const mask = FieldOf(*request, "update_mask")) {
    FillUpdate(present, tags, *mask, *request, *changed);
  } else {
    FillImport(present, tags, *request, *changed);
  }
  FieldSources sources;  // for fields of the resource that the request has within another
  for (const char* const tag : {"external_ids", "labels"}) {
    sources.Add(absl::StrCat(field->name(), ".", tag), tag);
  }
  absl::StatusOr<Resource> done = Call(client, *method, *request);
  if (!done.ok()) return sources.Name(done.status());
  return done;
}

std::string TextOfField(const Message& message, std::string_view path) {
  const std::size_t dot = path.find('.');
  const FieldDescriptor* const field = FieldOf(message, std::string(path.substr(0, dot)));
  if (field == nullptr || field->is_repeated()) return "";
  const auto* const reflection = message.GetReflection();
  switch (field->cpp_type()) {
    case FieldDescriptor::CPPTYPE_STRING:
      return reflection->GetString(message, field);
    case FieldDescriptor::CPPTYPE_ENUM:
      return reflection->GetEnum(message, field)->name();
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return dot == std::string_view::npos || !reflection->HasField(message, field)
                 ? ""
                 : TextOfField(reflection->GetMessage(message, field), path.substr(dot + 1));
    default:
      return "";
  }
}

}  // namespace mortise::cli
