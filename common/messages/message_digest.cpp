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

// Nor what only says by which numbers and words it is found, and who created it.
template <typename Message>
void ClearRevision(Message& message) {
  message.clear_revision();
  message.clear_external_ids();
  message.clear_labels();
  message.clear_creator();
  message.clear_create_time();
}

}  // namespace

std::string MessageDigest(const google::protobuf::Message& message) {
  return Sha256Hex(DeterministicBytes(message));
}

void ClearRevisions(google::protobuf::RepeatedPtrField<v1::Item>& items,
                    google::protobuf::RepeatedPtrField<v1::Material>& materials) {
  for (v1::Item& item : items) {
    item.clear_update_time();
    ClearRevision(item);
  }
  for (v1::Material& material : materials) ClearRevision(material);
}

}  // namespace mortise::parametric
