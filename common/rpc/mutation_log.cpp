#include "common/rpc/mutation_log.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/message.h>
#include <google/protobuf/util/time_util.h>

#include <algorithm>

#include "absl/strings/cord.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/store/store.h"
#include "mortise/v1/audit.pb.h"

namespace mortise::rpc {
namespace {

using google::protobuf::Message;

constexpr char kAnswers[] = "rpc.answers";  // request's digest, then the serialised response
constexpr char kAudit[] = "rpc.audit";      // mortise.v1.AuditRecord
constexpr char kAgain[] = "mortise/prepare-again";  // payload of a failure that asks for it
constexpr std::size_t kDigestLength = 64;
constexpr std::size_t kMaxRequestIdLength = 128;

// The value of a singular string field; empty if there is no such field.
std::string StringField(const Message& message, const char* name) {
  const auto* field = message.GetDescriptor()->FindFieldByName(name);
  if (field == nullptr || field->is_repeated() ||
      field->type() != google::protobuf::FieldDescriptor::TYPE_STRING) {
    return "";
  }
  return message.GetReflection()->GetString(message, field);
}

// The same bytes for equal messages (maps in a fixed order), unlike SerializeAsString.
std::string SerializeDeterministically(const Message& message) {
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream stream(&bytes);
    google::protobuf::io::CodedOutputStream output(&stream);
    output.SetSerializationDeterministic(true);
    message.SerializeToCodedStream(&output);
  }
  return bytes;
}

// Sorts by time.
std::string AuditKey(absl::Time time) {
  return absl::StrFormat("%016x-%s", absl::ToUnixMicros(time), NewIdentifier());
}

}  // namespace

absl::Status PrepareAgain(absl::Status failure) {
  failure.SetPayload(kAgain, absl::Cord("1"));
  return failure;
}

bool TakesPreparingAgain(absl::Status& failure) { return failure.ErasePayload(kAgain); }

absl::StatusOr<MutationKey> MakeMutationKey(const Call& call, const Message& request) {
  MutationKey key;
  key.request_id = StringField(request, "request_id");
  if (key.request_id.empty()) {
    return InvalidField("request_id",
                        "must be set: a unique text chosen by the caller, repeated "
                        "when the call is repeated");
  }
  if (key.request_id.size() > kMaxRequestIdLength ||
      !std::all_of(key.request_id.begin(), key.request_id.end(),
                   [](char c) { return c > ' ' && c < 127; })) {
    return InvalidField("request_id", "must be at most 128 printable ASCII characters");
  }
  key.request_sha256 = Sha256Hex(SerializeDeterministically(request));
  key.record_key =
      Sha256Hex(absl::StrCat(call.method(), "\n", call.identity().subject, "\n", key.request_id));
  return key;
}

absl::StatusOr<bool> FindAnswer(store::ReadTransaction& transaction, const MutationKey& key,
                                Message* response) {
  absl::StatusOr<store::Record> record = transaction.Get(kAnswers, key.record_key);
  if (absl::IsNotFound(record.status())) return false;
  if (!record.ok()) return record.status();
  if (record->payload.compare(0, kDigestLength, key.request_sha256) != 0) {
    return InvalidField("request_id", "was used before for a different request");
  }
  if (record->payload.size() < kDigestLength ||
      !response->ParseFromArray(record->payload.data() + kDigestLength,
                                static_cast<int>(record->payload.size() - kDigestLength))) {
    return absl::DataLossError("the stored answer to this request is damaged");
  }
  return true;
}

absl::Status RecordMutation(store::Transaction& transaction, std::string_view service,
                            const Call& call, const MutationKey& key, const Message& request,
                            const Message& response) {
  MORTISE_RETURN_IF_ERROR(
      transaction.Put(kAnswers, key.record_key, key.request_sha256 + response.SerializeAsString())
          .status());
  v1::AuditRecord record;
  record.set_service(std::string(service));
  record.set_method(call.method());
  record.set_subject(call.identity().subject);
  record.set_request_id(key.request_id);
  record.set_trace_id(call.identity().trace_id);
  *record.mutable_time() = google::protobuf::util::TimeUtil::MicrosecondsToTimestamp(
      absl::ToUnixMicros(transaction.Now()));
  const std::string made = StringField(response, "name");
  record.set_resource(made.empty() ? StringField(request, "name") : made);
  record.set_request_sha256(key.request_sha256);
  return transaction.Put(kAudit, AuditKey(transaction.Now()), record.SerializeAsString()).status();
}

absl::StatusOr<int> ForgetOldAnswers(store::Store& store) {
  constexpr int kBatch = 500;
  int forgotten = 0;
  std::string after;
  while (true) {
    std::vector<store::Record> page;
    MORTISE_RETURN_IF_ERROR(store.Read([&](store::ReadTransaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(page,
                               transaction.List(kAnswers, {.after_key = after, .limit = kBatch}));
      return absl::OkStatus();
    }));
    if (page.empty()) return forgotten;
    after = page.back().key;
    const absl::Time oldest = store.Now() - kAnswerRetention;
    std::erase_if(page, [&](const store::Record& record) { return record.updated_at >= oldest; });
    if (page.empty()) continue;
    MORTISE_RETURN_IF_ERROR(store.Transact([&](store::Transaction& transaction) -> absl::Status {
      for (const store::Record& record : page) {
        absl::Status status = transaction.Delete(kAnswers, record.key);
        if (!status.ok() && !absl::IsNotFound(status)) return status;
      }
      return absl::OkStatus();
    }));
    forgotten += static_cast<int>(page.size());
  }
}

absl::StatusOr<resources::Page<v1::AuditRecord>> ListAudit(store::Store& store,
                                                           const resources::PageQuery& query) {
  resources::Page<v1::AuditRecord> page;
  MORTISE_RETURN_IF_ERROR(store.Read([&](store::ReadTransaction& transaction) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(page, resources::ReadPage<v1::AuditRecord>(
                                       transaction, {.kind = kAudit, .newest_first = true}, query));
    return absl::OkStatus();
  }));
  return page;
}

}  // namespace mortise::rpc
