#include "gateway/contract/transcoder.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/type.pb.h>
#include <google/protobuf/unknown_field_set.h>
#include <google/protobuf/util/json_util.h>
#include <google/protobuf/util/type_resolver.h>
#include <google/protobuf/util/type_resolver_util.h>

#include <mutex>
#include <shared_mutex>
#include <unordered_map>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/messages/json_faults.h"
#include "gateway/contract/contract.h"

namespace mortise::gateway {
namespace {

namespace pb = google::protobuf;
using pb::util::Status;

constexpr char kTypePrefix[] = "type.googleapis.com";

std::string TypeUrl(const pb::Descriptor& type) {
  return absl::StrCat(kTypePrefix, "/", type.full_name());
}

// Protobuf describes a type anew each time it is asked; this remembers the descriptions.
class RememberingResolver final : public pb::util::TypeResolver {
 public:
  explicit RememberingResolver(const pb::DescriptorPool& pool)
      : source_(pb::util::NewTypeResolverForDescriptorPool(kTypePrefix, &pool)) {}

  Status ResolveMessageType(const std::string& url, pb::Type* type) override {
    return Resolve(url, type, types_, [this](const std::string& asked, pb::Type* answer) {
      return source_->ResolveMessageType(asked, answer);
    });
  }

  Status ResolveEnumType(const std::string& url, pb::Enum* type) override {
    return Resolve(url, type, enums_, [this](const std::string& asked, pb::Enum* answer) {
      return source_->ResolveEnumType(asked, answer);
    });
  }

 private:
  // Only types that exist are remembered, so clients cannot make the table grow.
  template <class T, class Source>
  Status Resolve(const std::string& url, T* type, std::unordered_map<std::string, T>& known,
                 const Source& source) {
    {
      std::shared_lock lock(mutex_);
      const auto found = known.find(url);
      if (found != known.end()) {
        *type = found->second;
        return {};
      }
    }
    const Status status = source(url, type);
    if (status.ok()) {
      std::unique_lock lock(mutex_);
      known.emplace(url, *type);
    }
    return status;
  }

  const std::unique_ptr<pb::util::TypeResolver> source_;
  std::shared_mutex mutex_;
  std::unordered_map<std::string, pb::Type> types_;
  std::unordered_map<std::string, pb::Enum> enums_;
};

// What is said of no field is said of the request.
absl::Status Refusal(std::vector<FieldViolation> faults) {
  for (FieldViolation& fault : faults) {
    if (fault.field.empty()) fault.field = "request";
  }
  return InvalidFields(faults);
}

// What would be refused with misleading words: nothing, and marks that some editors put first.
absl::Status CheckText(std::string_view json) {
  if (json.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    return InvalidField("request", "is empty; one without fields is {}");
  }
  for (const std::string_view mark : {"\xef\xbb\xbf", "\xff\xfe", "\xfe\xff"}) {
    if (!json.starts_with(mark)) continue;
    return InvalidField("request", "begins with a byte-order mark; JSON is UTF-8 without one");
  }
  return absl::OkStatus();
}

}  // namespace

Transcoder::Transcoder(const Contract& contract)
    : resolver_(std::make_unique<RememberingResolver>(contract.pool())) {}

Transcoder::~Transcoder() = default;

absl::StatusOr<std::string> Transcoder::ToBinary(const pb::Descriptor& type,
                                                 std::string_view json) const {
  MORTISE_RETURN_IF_ERROR(CheckText(json));
  std::string binary;
  pb::io::ArrayInputStream input(json.data(), static_cast<int>(json.size()));
  pb::io::StringOutputStream output(&binary);
  pb::util::JsonParseOptions options;
  options.ignore_unknown_fields = false;
  try {
    const Status status =
        pb::util::JsonToBinaryStream(resolver_.get(), TypeUrl(type), &input, &output, options);
    std::vector<FieldViolation> faults = JsonFaults(json, type, status);
    if (!faults.empty()) return Refusal(std::move(faults));
    return binary;
  } catch (const std::exception& error) {
    return InvalidField("request", error.what());
  }
}

absl::StatusOr<std::string> Transcoder::ToJson(const pb::Descriptor& type,
                                               std::string_view message) const {
  // The stream below reads what it can of a torn message without complaint.
  pb::UnknownFieldSet fields;
  if (!fields.ParseFromArray(message.data(), static_cast<int>(message.size()))) {
    return absl::InternalError(absl::StrCat("a torn ", type.full_name()));
  }
  std::string json;
  pb::io::ArrayInputStream input(message.data(), static_cast<int>(message.size()));
  pb::io::StringOutputStream output(&json);
  try {
    const Status status = pb::util::BinaryToJsonStream(resolver_.get(), TypeUrl(type), &input,
                                                       &output, pb::util::JsonPrintOptions());
    if (status.ok()) return json;
    return absl::InternalError(absl::StrCat(
        "a ", type.full_name(), " cannot be written as JSON: ", std::string(status.message())));
  } catch (const std::exception& error) {
    return absl::InternalError(error.what());
  }
}

}  // namespace mortise::gateway
