#include "common/assembly/codec/connection_codec.h"

#include "common/assembly/connections/connection_optimizer.h"
#include "common/files/axis_codec.h"
#include "common/messages/vector_codec.h"

namespace mortise::parametric {
namespace {

void SetProto(const BoundingBox& box, v1::ConnectionPatch::Piece* message) {
  *message->mutable_minimum() = VectorToProto(box.minimum);
  *message->mutable_maximum() = VectorToProto(box.maximum);
}

v1::ConnectionPatch::Kind KindToProto(PatchKind kind) {
  switch (kind) {
    case PatchKind::kContact:
      return v1::ConnectionPatch::CONTACT;
    case PatchKind::kGap:
      return v1::ConnectionPatch::GAP;
    case PatchKind::kWhole:
      return v1::ConnectionPatch::WHOLE;
  }
  return v1::ConnectionPatch::KIND_UNSPECIFIED;
}

void SetProto(const ElementConnection& connection, const ConnectionPatch& patch,
              v1::ConnectionPatch* message) {
  message->set_kind(KindToProto(patch.kind));
  message->set_first(connection.elements[static_cast<std::size_t>(patch.first)].name);
  message->set_second(connection.elements[static_cast<std::size_t>(patch.second)].name);
  message->set_normal(AxisToProto(patch.normal));
  for (const BoundingBox& piece : patch.pieces) SetProto(piece, message->add_pieces());
  SetProto(patch.region, message->mutable_region());
  message->set_area(patch.area);
}

}  // namespace

v1::ElementConnection ToProto(const ElementConnection& connection) {
  v1::ElementConnection message;
  message.set_name(connection.name);
  if (connection.group > 0) {
    message.set_group(connection.assembly.groups[static_cast<std::size_t>(connection.group)].name);
  }
  const auto principals = static_cast<std::size_t>(connection.principal_count());
  for (std::size_t i = 0; i < connection.elements.size(); ++i) {
    const std::string& name = connection.elements[i].name;
    if (i < principals) {
      message.add_principals(name);
    } else {
      message.add_connecting(name);
    }
  }
  for (const ConnectionPatch& patch : connection.patches) {
    SetProto(connection, patch, message.add_patches());
  }
  for (const Relationship& hard : connection.hard) {
    v1::HardRelationship* described = message.add_hard();
    described->set_description(hard.description);
    described->set_equality(hard.equality);
  }
  for (const SoftRelationship& soft : connection.soft) {
    v1::SoftRelationship* described = message.add_soft();
    described->set_description(soft.description);
    described->set_weight(soft.weight);
  }
  message.set_degrees_of_freedom(ConnectionOptimizer(connection).degrees_of_freedom());
  return message;
}

}  // namespace mortise::parametric
