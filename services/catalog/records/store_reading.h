// What both services of the catalog do with its store: one read, one page of a List method.
#pragma once

#include <google/protobuf/repeated_ptr_field.h>

#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/base/errors.h"
#include "common/store/store.h"
#include "services/catalog/records/catalog_records.h"

namespace mortise::catalog {

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

// The page that `list` finds, as the response whose entries are `entries`.
template <typename Response, typename Message, typename List>
absl::StatusOr<Response> ListFrom(
    store::Store& store, google::protobuf::RepeatedPtrField<Message>* (Response::*entries)(),
    const List& list) {
  MORTISE_ASSIGN_OR_RETURN(Page<Message> page, ReadFrom<Page<Message>>(store, list));
  Response response;
  for (Message& entry : page.entries) *(response.*entries)()->Add() = std::move(entry);
  response.set_next_page_token(page.next_page_token);
  return response;
}

}  // namespace mortise::catalog
