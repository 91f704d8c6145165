#include "gateway/admission/open_calls.h"

#include <openssl/rand.h>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::gateway {
namespace {

const char* Plural(CallKind kind) {
  switch (kind) {
    case CallKind::kStream:
      return "streams";
    case CallKind::kWait:
      return "waiting calls";
    default:
      return "calls";
  }
}

absl::Status TooMany(CallKind kind, const std::string& of, int limit) {
  const bool streams = kind == CallKind::kStream;
  return WithDetail(absl::ResourceExhaustedError(absl::StrCat(
                        of, " has ", limit, " ", Plural(kind),
                        " open, as many as are allowed; end some, or try again later")),
                    {streams ? "TOO_MANY_STREAMS" : "TOO_MANY_CALLS", of});
}

std::string RandomText() {
  unsigned char bytes[16] = {};
  RAND_bytes(bytes, sizeof(bytes));
  return absl::BytesToHexString(
      absl::string_view(reinterpret_cast<const char*>(bytes), sizeof(bytes)));
}

}  // namespace

OpenCalls::OpenCalls(OpenCallLimits limits) : limits_(limits), pass_(RandomText()) {}

const OpenCallLimits::Limit& OpenCallLimits::Of(CallKind kind) const {
  switch (kind) {
    case CallKind::kWait:
      return waits;
    case CallKind::kStream:
      return streams;
    case CallKind::kUrgent:
      return urgent;
    default:
      return calls;
  }
}

OpenCalls::Place::~Place() {
  calls_.Uncount({Whose::kSubject, kind_, subject_});
  if (!service_.empty()) calls_.Uncount({Whose::kService, kind_, service_});
}

absl::Status OpenCalls::Place::EnterService(const std::string& service) {
  MORTISE_RETURN_IF_ERROR(calls_.Count({Whose::kService, kind_, service}));
  service_ = service;
  return absl::OkStatus();
}

absl::StatusOr<std::unique_ptr<OpenCalls::Place>> OpenCalls::Enter(CallKind kind,
                                                                   const std::string& subject) {
  MORTISE_RETURN_IF_ERROR(Count({Whose::kSubject, kind, subject}));
  return std::make_unique<Place>(*this, kind, subject);
}

absl::Status OpenCalls::Count(Key key) {
  const auto& [whose, kind, name] = key;
  const OpenCallLimits::Limit& limit = limits_.Of(kind);
  const bool subject = whose == Whose::kSubject;
  const int most = subject ? limit.of_subject : limit.of_service;
  std::lock_guard lock(mutex_);
  const auto found = open_.find(key);
  if (found != open_.end() && found->second >= most) {
    return TooMany(kind, subject ? name : absl::StrCat("the ", name, " service"), most);
  }
  ++open_[std::move(key)];
  return absl::OkStatus();
}

void OpenCalls::Uncount(const Key& key) {
  std::lock_guard lock(mutex_);
  const auto found = open_.find(key);
  if (--found->second == 0) open_.erase(found);
}

}  // namespace mortise::gateway
