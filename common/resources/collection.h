// A kind of resource whose messages lie in the store as they are: declared once, it gives the
// methods that every such resource has.
//
//   const resources::Collection<v1::Front> kFronts{.names = "fronts", .kind = "fronts"};
//
// What belongs to one kind alone (how it comes to be, who may remove it) stays with its service.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/violation_lists.h"
#include "common/resources/author.h"
#include "common/resources/record_page.h"
#include "common/resources/resource_filter.h"
#include "common/resources/resource_tags.h"
#include "common/store/store.h"

namespace mortise::resources {

// Runs `read`, which gives a StatusOr<Result>, on one state of the store.
template <typename Result, typename Function>
absl::StatusOr<Result> ReadFrom(store::Store& store, const Function& read) {
  absl::StatusOr<Result> result = absl::UnknownError("not read");
  MORTISE_RETURN_IF_ERROR(store.Read([&](store::ReadTransaction& transaction) {
    result = read(transaction);
    return result.status();
  }));
  return result;
}

// Returns a page as the response of a List method whose entries are `entries`.
template <typename Response, typename Message>
Response ToResponse(Page<Message> page,
                    google::protobuf::RepeatedPtrField<Message>* (Response::*entries)()) {
  Response response;
  for (Message& entry : page.entries) *(response.*entries)()->Add() = std::move(entry);
  response.set_next_page_token(page.next_page_token);
  return response;
}

// What is wrong with the page and the filter that a List request asks for: INVALID_ARGUMENT naming
// page_size, page_token and fields of the filter. Collection::List checks them itself; this is for
// methods that tell what is wrong with other fields together with it.
template <typename Request>
absl::Status CheckListRequest(const Request& request) {
  return CombineViolations(ReadPageQuery(request).status(), ResourceFilter::Of(request).status());
}

template <typename Message>
struct Collection {
  const char* names;  // the first part of their names: "fronts" of "fronts/0198c1x"
  const char* kind;   // of their records
  const char* event;  // what their events begin with: "front" of "front.updated"; null for none
  bool newest_first = true;  // how lists are ordered: else by name

  // Returns the resource of a name. NOT_FOUND; INVALID_ARGUMENT naming `field`; STORAGE_FAILED.
  absl::StatusOr<Message> Get(store::ReadTransaction& transaction, const std::string& name,
                              const std::string& field = "name") const {
    MORTISE_ASSIGN_OR_RETURN(const std::string id, ParseResourceName(name, names, field));
    const absl::StatusOr<store::Record> record = transaction.Get(kind, id);
    if (absl::IsNotFound(record.status())) return ResourceNotFound(name);
    MORTISE_RETURN_IF_ERROR(record.status());
    return ParseRecord<Message>(kind, *record);
  }

  absl::StatusOr<Message> Get(store::Store& store, const std::string& name,
                              const std::string& field = "name") const {
    return ReadFrom<Message>(
        store, [&](store::ReadTransaction& transaction) { return Get(transaction, name, field); });
  }

  // Returns the page that a List request asks for, of those that meet its `filter` and `takes`,
  // each as `shown` makes it. INVALID_ARGUMENT naming page_size, page_token and fields of the
  // filter.
  template <typename Request, typename Takes, typename Shown>
  absl::StatusOr<Page<Message>> List(store::Store& store, const Request& request,
                                     const Takes& takes, const Shown& shown) const {
    const absl::StatusOr<ResourceFilter> filter = ResourceFilter::Of(request);
    const absl::StatusOr<PageQuery> query = ReadPageQuery(request);
    MORTISE_RETURN_IF_ERROR(CombineViolations(query.status(), filter.status()));
    const auto entry_of =
        [&](const store::Record& record) -> absl::StatusOr<std::optional<Message>> {
      MORTISE_ASSIGN_OR_RETURN(Message message, ParseRecord<Message>(kind, record));
      if (!filter->Matches(message) || !takes(message)) return std::nullopt;
      return shown(std::move(message));
    };
    return ReadFrom<Page<Message>>(store, [&](store::ReadTransaction& transaction) {
      return ReadPage<Message>(transaction, {.kind = kind, .newest_first = newest_first}, *query,
                               entry_of);
    });
  }

  // The same, as they are stored.
  template <typename Request, typename Takes>
  absl::StatusOr<Page<Message>> List(store::Store& store, const Request& request,
                                     const Takes& takes) const {
    return List(store, request, takes, [](Message message) { return message; });
  }

  // Changes the external ids and labels of the resource that `changes` names, those of the mask or
  // both, and tells of it ("front.updated") where the kind has events. Returns it as it then is.
  // NOT_FOUND; INVALID_ARGUMENT with fields under `field`, the name of `changes` in its request, or
  // naming "update_mask".
  absl::StatusOr<Message> UpdateTags(store::Transaction& transaction, const Message& changes,
                                     const google::protobuf::FieldMask& mask,
                                     const std::string& field, const Author& author) const {
    const std::string name_field = absl::StrCat(field, ".name");
    MORTISE_RETURN_IF_ERROR(CombineViolations(
        CombineViolations(ParseResourceName(changes.name(), names, name_field).status(),
                          CheckTagMask(mask)),
        UnderField(field, ValidateTags(changes))));
    MORTISE_ASSIGN_OR_RETURN(Message present, Get(transaction, changes.name(), name_field));
    resources::UpdateTags(changes, mask, &present);
    MORTISE_ASSIGN_OR_RETURN(const std::string id,
                             ParseResourceName(present.name(), names, name_field));
    MORTISE_RETURN_IF_ERROR(transaction.Put(kind, id, present.SerializeAsString()).status());
    if (event == nullptr) return present;
    MORTISE_RETURN_IF_ERROR(transaction.AppendEvent({.type = absl::StrCat(event, ".updated"),
                                                     .subject = present.name(),
                                                     .payload = "{}",
                                                     .trace_id = author.trace_id}));
    return present;
  }
};

}  // namespace mortise::resources
