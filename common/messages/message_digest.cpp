#include "common/messages/message_digest.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include "common/base/digest.h"

namespace mortise::parametric {
namespace {

std::string DeterministicBytes(const google::protobuf::Message& message) {
  std::string bytes;
  // The streams flush when they go out of scope.
  google::protobuf::io::StringOutputStream stream(&bytes);
  google::protobuf::io::CodedOutputStream coded(&stream);
  coded.SetSerializationDeterministic(true);
  message.SerializeToCodedStream(&coded);
  coded.Trim();
  return bytes;
}

}  // namespace

std::string MessageDigest(const google::protobuf::Message& message) {
  return Sha256Hex(DeterministicBytes(message));
}

void ClearRevisions(google::protobuf::RepeatedPtrField<v1::Item>& items,
                    google::protobuf::RepeatedPtrField<v1::Material>& materials) {
  for (v1::Item& item : items) {
    item.clear_revision();
    item.clear_update_time();
  }
  for (v1::Material& material : materials) material.clear_revision();
}

}  // namespace mortise::parametric
