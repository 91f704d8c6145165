#include "gateway/forwarding/event_codec.h"

#include <google/protobuf/util/time_util.h>

#include "mortise/v1/events.pb.h"

namespace mortise::gateway {

using google::protobuf::util::TimeUtil;

v1::Event ToProto(const bus::Event& event) {
  v1::Event proto;
  proto.set_stream(event.stream);
  proto.set_epoch(event.epoch);
  proto.set_number(event.number);
  proto.set_type(event.type);
  proto.set_subject(event.subject);
  *proto.mutable_time() = TimeUtil::MicrosecondsToTimestamp(absl::ToUnixMicros(event.time));
  proto.set_trace_id(event.trace_id);
  proto.set_data(event.payload);
  return proto;
}

bus::Event FromProto(const v1::Event& event) {
  bus::Event result;
  result.stream = event.stream();
  result.epoch = event.epoch();
  result.number = event.number();
  result.type = event.type();
  result.subject = event.subject();
  result.time = absl::FromUnixMicros(TimeUtil::TimestampToMicroseconds(event.time()));
  result.trace_id = event.trace_id();
  result.payload = event.data();
  return result;
}

}  // namespace mortise::gateway
