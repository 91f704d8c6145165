#include "services/composer/records/turned_drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/assembly/codec/shape_codec.h"
#include "common/base/errors.h"
#include "common/cad/stretch/solid_shape.h"
#include "common/files/axis_codec.h"
#include "common/mesh/shapes/drawn_shape.h"
#include "common/messages/vector_codec.h"
#include "services/composer/model/quarter_turn.h"

namespace mortise::composer {
namespace {

using parametric::AssemblyPart;

constexpr double kSamePlace = 1e-6;  // of a shape's box

// The places of a shape's vertices in its box, without an order.
std::vector<std::array<std::int64_t, 3>> PlacesOf(const mesh::DrawnShape& shape) {
  std::vector<std::array<std::int64_t, 3>> places;
  for (Eigen::Index k = 0; k < shape.fractions.cols(); ++k) {
    const Eigen::Vector3d at = shape.fractions.col(k) / kSamePlace;
    places.push_back({std::llround(at.x()), std::llround(at.y()), std::llround(at.z())});
  }
  std::sort(places.begin(), places.end());
  return places;
}

bool LookTheSame(const mesh::DrawnShape& a, const mesh::DrawnShape& b) {
  if ((a.size - b.size).cwiseAbs().maxCoeff() > kSamePlace * a.size.maxCoeff()) return false;
  return a.fractions.cols() == b.fractions.cols() && PlacesOf(a) == PlacesOf(b);
}

class DrawingTurner {
 public:
  DrawingTurner(const Drawing& drawing, const Eigen::Matrix3d& turn)
      : bundle_(drawing.bundle), turn_(turn) {}

  absl::StatusOr<Drawing> Turn() {
    MORTISE_ASSIGN_OR_RETURN(shapes_, parametric::FromProto(bundle_.shapes()));
    MORTISE_ASSIGN_OR_RETURN(const parametric::Assembly drawn, ReadAssembly(bundle_));
    const parametric::Assembly turned = Turned(drawn, turn_);
    v1::Assembly& message = *bundle_.mutable_assembly();
    for (std::size_t i = 0; i < turned.parts.size(); ++i) {
      MORTISE_RETURN_IF_ERROR(
          TurnPart(turned.parts[i], message.mutable_parts(static_cast<int>(i))));
    }
    for (std::size_t j = 0; j < turned.joints.size(); ++j) {
      TurnJoint(turned.joints[j], message.mutable_joints(static_cast<int>(j)));
    }
    KeepWhatIsUsed(&bundle_);
    return MakeDrawing(std::move(bundle_));
  }

 private:
  absl::Status TurnPart(const AssemblyPart& part, v1::AssemblyPart* message) {
    message->set_length_axis(parametric::AxisToProto(part.item_axes[0]));
    message->set_thickness_axis(parametric::AxisToProto(part.item_axes[2]));
    for (v1::ProminentPlane& plane : *message->mutable_prominent_planes()) {
      for (const parametric::ProminentPlane& now : part.prominent_planes) {
        if (now.name == plane.name()) plane.set_axis(parametric::AxisToProto(now.axis));
      }
    }
    PutIntoBox(part, message);
    if (part.shape == nullptr) return absl::OkStatus();
    MORTISE_ASSIGN_OR_RETURN(*message->mutable_shape(), ShapeOf(part, *message));
    return absl::OkStatus();
  }

  void TurnJoint(const parametric::Joint& joint, v1::Joint* message) {
    *message->mutable_center() = VectorToProto(joint.center);
    if (message->has_axis()) *message->mutable_axis() = VectorToProto(joint.axis);
    for (v1::RestPose& pose : *message->mutable_rest_poses()) {
      if (!pose.has_rotation()) continue;
      *pose.mutable_rotation() =
          VectorToProto(Eigen::Vector3d((turn_ * VectorFromProto(pose.rotation())).array() + 0.0));
    }
  }

  // What the part's shape is called that lies so: nothing where it is its item's.
  absl::StatusOr<std::string> ShapeOf(const AssemblyPart& part, const v1::AssemblyPart& message) {
    const auto drawn = shapes_.find(part.shape->name);
    if (drawn == shapes_.end()) return absl::InternalError("a drawing lacks a shape");
    const bool is_own = !message.shape().empty();
    const mesh::DrawnShape usual =
        is_own ? *drawn->second
               : mesh::Turned(*drawn->second, static_cast<int>(part.item_axes[0]),
                              static_cast<int>(part.item_axes[2]));
    if (usual.turn == part.shape->turn || LookTheSame(usual, *part.shape)) return message.shape();
    std::string& name = own_[part.shape.get()];
    if (name.empty()) {
      MORTISE_ASSIGN_OR_RETURN(const mesh::DrawnShape made, cad::ShapeDrawnTurned(*part.shape));
      name = AddOwnShape(made, &bundle_);
    }
    return name;
  }

  v1::AssemblyBundle bundle_;
  const Eigen::Matrix3d turn_;
  parametric::ShapesByName shapes_;                     // as drawn
  std::map<const mesh::DrawnShape*, std::string> own_;  // names of those made here
};

}  // namespace

absl::StatusOr<Drawing> TurnedDrawing(const Drawing& drawing, const Eigen::Matrix3d& turn) {
  if (turn.isIdentity(0)) return drawing;
  return DrawingTurner(drawing, turn).Turn();
}

}  // namespace mortise::composer
