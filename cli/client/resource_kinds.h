// Every kind of resource, for commands that work on any of them: a line a kind. What methods it has
// is read from the contract: which lists it, gets one, and changes its tags.
#pragma once

#include <google/protobuf/descriptor.h>

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace mortise::cli {

struct ResourceKind {
  const char* names;  // the first part of their names: "workOrders" of "workOrders/0198c1"

  // Returns the type of the request of their List method.
  const google::protobuf::Descriptor* (*list_request)();

  // The field that tells people which one it is, within others where it has dots: "title".
  const char* about;

  // The field that tells which geometry it has, likewise; empty of kinds without.
  const char* geometry = "";
};

// Returns all of them, in the order in which a design passes through them.
const std::vector<ResourceKind>& ResourceKinds();

// "fronts", "analyses" … as a text, for messages and help.
std::string ResourceKindNames();

// Returns the kind that a person calls "workOrders" or "work-orders"; null if there is none.
const ResourceKind* FindKind(std::string_view word);

// Returns the kind of a resource's name: that of "items/board-38x89". INVALID_ARGUMENT, "name".
absl::StatusOr<const ResourceKind*> KindOfName(const std::string& name);

// ListItems.
const google::protobuf::MethodDescriptor& ListMethod(const ResourceKind& kind);

// Returns the repeated field of the entries in the response of ListItems.
const google::protobuf::FieldDescriptor& EntriesField(const ResourceKind& kind);

// GetItem.
const google::protobuf::MethodDescriptor& GetMethod(const ResourceKind& kind);

// UpdateItem; ImportTemplate of what is only changed as a whole; null of what nobody changes.
const google::protobuf::MethodDescriptor* ChangeMethod(const ResourceKind& kind);

}  // namespace mortise::cli
