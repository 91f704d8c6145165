// What callers attach to a resource to find it by: external ids, the numbers that other systems
// know it by, and labels. types.proto says what they may hold. They are no content of the resource:
// what was computed of it stays valid when they change.
//
// `Message` is that of any resource, or of a request that makes one: it has `external_ids` and
// `labels`.
#pragma once

#include <google/protobuf/field_mask.pb.h>
#include <google/protobuf/map.h>
#include <google/protobuf/repeated_ptr_field.h>

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "common/base/field_violations.h"

namespace mortise::resources {

using ExternalIds = google::protobuf::RepeatedPtrField<std::string>;
using Labels = google::protobuf::Map<std::string, std::string>;

inline constexpr int kMaxExternalIds = 20;
inline constexpr int kMaxExternalIdBytes = 200;
inline constexpr int kMaxLabels = 64;
inline constexpr int kMaxLabelKeyBytes = 63;
inline constexpr int kMaxLabelValueBytes = 200;

// Returns what is wrong with them: fields "external_ids", "external_ids[2]" and "labels".
std::vector<FieldViolation> CheckTags(const ExternalIds& external_ids, const Labels& labels);

template <typename Message>
std::vector<FieldViolation> CheckTags(const Message& message) {
  return CheckTags(message.external_ids(), message.labels());
}

// The same as a status: INVALID_ARGUMENT naming the fields, or OK.
absl::Status ValidateTags(const ExternalIds& external_ids, const Labels& labels);

template <typename Message>
absl::Status ValidateTags(const Message& message) {
  return ValidateTags(message.external_ids(), message.labels());
}

// Whether both have the same ones; the order of external ids counts.
bool HaveSameTags(const ExternalIds& external_ids, const Labels& labels,
                  const ExternalIds& other_external_ids, const Labels& other_labels);

template <typename Message>
bool HaveSameTags(const Message& one, const Message& other) {
  return HaveSameTags(one.external_ids(), one.labels(), other.external_ids(), other.labels());
}

// Gives `to` the tags of `from` in place of its own.
template <typename From, typename To>
void CopyTags(const From& from, To* to) {
  *to->mutable_external_ids() = from.external_ids();
  *to->mutable_labels() = from.labels();
}

// Fails with INVALID_ARGUMENT, "update_mask", for each path but "external_ids" and "labels".
absl::Status CheckTagMask(const google::protobuf::FieldMask& mask);

// Gives `present` those tags of `changes` that a checked mask names; both where it names none.
template <typename Message>
void UpdateTags(const Message& changes, const google::protobuf::FieldMask& mask, Message* present) {
  if (mask.paths().empty()) return CopyTags(changes, present);
  for (const std::string& path : mask.paths()) {
    if (path == "external_ids") *present->mutable_external_ids() = changes.external_ids();
    if (path == "labels") *present->mutable_labels() = changes.labels();
  }
}

// Takes away the tags and the creator, which are no content.
template <typename Message>
void ClearTags(Message* message) {
  message->clear_external_ids();
  message->clear_labels();
  message->clear_creator();
}

}  // namespace mortise::resources
