#include "services/composer/records/drawing.h"

#include <google/protobuf/util/message_differencer.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/codec/assembly_codec.h"
#include "common/assembly/codec/shape_codec.h"
#include "common/base/errors.h"
#include "common/files/shape_name.h"
#include "common/files/template_codec.h"
#include "common/messages/message_digest.h"
#include "common/messages/vector_codec.h"
#include "common/resources/resource_tags.h"

namespace mortise::composer {
namespace {

using google::protobuf::util::MessageDifferencer;

template <typename Message>
const Message* FindNamed(const google::protobuf::RepeatedPtrField<Message>& messages,
                         const std::string& name) {
  const auto found = std::find_if(messages.begin(), messages.end(),
                                  [&](const Message& message) { return message.name() == name; });
  return found == messages.end() ? nullptr : &*found;
}

template <typename Message>
Message* FindNamed(google::protobuf::RepeatedPtrField<Message>* messages, const std::string& name) {
  const auto found = std::find_if(messages->begin(), messages->end(),
                                  [&](const Message& message) { return message.name() == name; });
  return found == messages->end() ? nullptr : &*found;
}

template <typename Message>
void SortByName(google::protobuf::RepeatedPtrField<Message>& messages) {
  std::sort(messages.begin(), messages.end(),
            [](const Message& a, const Message& b) { return a.name() < b.name(); });
}

// A size such that a box that begins at `minimum` ends at `maximum` to the last bit, wherever
// there is one: what is drawn anew again and again stays where it is.
double SizeBetween(double minimum, double maximum) {
  const double size = maximum - minimum;
  const double next = std::nextafter(size, size + 1), before = std::nextafter(size, 0.0);
  for (const double each : {size, next, before}) {
    if (minimum + each == maximum) return each;
  }
  return size;
}

std::string GroupName(const parametric::Assembly& assembly, int group) {
  return group <= 0 ? "" : assembly.groups[static_cast<std::size_t>(group)].name;
}

void AddGroups(const parametric::Assembly& assembly, v1::Assembly* message) {
  for (std::size_t i = 1; i < assembly.groups.size(); ++i) {
    v1::AssemblyGroup* group = message->add_groups();
    group->set_name(assembly.groups[i].name);
    group->set_parent(GroupName(assembly, assembly.groups[i].parent));
  }
}

// What a part looks like: shapes/{digest}, its own or its item's; empty for neither.
std::string ShapeOf(const v1::AssemblyPart& part, const v1::AssemblyBundle& bundle) {
  if (!part.shape().empty()) return part.shape();
  const v1::Item* const item = FindNamed(bundle.items(), part.item());
  return item == nullptr ? "" : item->shape();
}

// Copies the shape of a name from the drawing that has it.
void AddShape(const std::string& name, const v1::AssemblyBundle& from, v1::AssemblyBundle* to) {
  if (name.empty() || FindNamed(to->shapes(), name) != nullptr) return;
  if (const v1::Shape* const shape = FindNamed(from.shapes(), name)) *to->add_shapes() = *shape;
}

// Whether what is made of one item could be made of the other.
bool AreAlike(const v1::Item& one, const v1::Item& other) {
  if (one.kind() != other.kind() || one.material() != other.material() ||
      one.shape() != other.shape() || one.dimensions_size() != other.dimensions_size()) {
    return false;
  }
  for (int i = 0; i < one.dimensions_size(); ++i) {
    if (!MessageDifferencer::Equals(one.dimensions(i), other.dimensions(i))) return false;
  }
  return true;
}

// What a part or joint is called in a drawing; the drawing has it.
template <typename Message>
absl::StatusOr<const Message*> CopyOf(const CopiedFrom& from,
                                      const std::map<std::string, const Message*>& by_name) {
  const auto found = by_name.find(from.name);
  if (found != by_name.end()) return found->second;
  return absl::InternalError(absl::StrCat("a drawing lacks '", from.name, "'"));
}

// The parts and joints of drawings by their names.
struct DrawingNames {
  std::map<std::string, const v1::AssemblyPart*> parts;
  std::map<std::string, const v1::Joint*> joints;
};

class NamesByDrawing {
 public:
  const DrawingNames& Of(const Drawing& drawing) {
    const auto [entry, is_new] = names_.try_emplace(&drawing);
    if (is_new) {
      const v1::Assembly& assembly = drawing.bundle.assembly();
      for (const v1::AssemblyPart& part : assembly.parts()) {
        entry->second.parts[part.name()] = &part;
      }
      for (const v1::Joint& joint : assembly.joints()) entry->second.joints[joint.name()] = &joint;
      order_.push_back(&drawing);
    }
    return entry->second;
  }

  // In the order in which they were asked for.
  const std::vector<const Drawing*>& drawings() const { return order_; }

 private:
  std::map<const Drawing*, DrawingNames> names_;
  std::vector<const Drawing*> order_;
};

// Adds a part of the assembly.
absl::Status AddPart(const parametric::Assembly& assembly, std::size_t i, const CopiedFrom& from,
                     NamesByDrawing& names, v1::AssemblyBundle* bundle) {
  const parametric::AssemblyPart& part = assembly.parts[i];
  MORTISE_ASSIGN_OR_RETURN(const v1::AssemblyPart* const source,
                           CopyOf(from, names.Of(*from.drawing).parts));
  v1::AssemblyPart* const message = bundle->mutable_assembly()->add_parts();
  *message = *source;
  if (!from.keeps_priority) message->clear_priority();
  message->set_name(part.name);
  message->set_group(GroupName(assembly, part.group));
  PutIntoBox(part, message);
  if (part.shape != nullptr && part.shape->name.empty()) {
    message->set_shape(AddOwnShape(*part.shape, bundle));
  }
  AddShape(ShapeOf(*message, from.drawing->bundle), from.drawing->bundle, bundle);
  return absl::OkStatus();
}

}  // namespace

std::set<std::string> ShapesUsed(const v1::AssemblyBundle& bundle) {
  std::set<std::string> names;
  for (const v1::AssemblyPart& part : bundle.assembly().parts()) {
    names.insert(ShapeOf(part, bundle));
  }
  names.erase("");
  return names;
}

void PutIntoBox(const parametric::AssemblyPart& part, v1::AssemblyPart* message) {
  *message->mutable_position() = VectorToProto(part.box.minimum);
  Eigen::Vector3d size;
  for (int axis = 0; axis < 3; ++axis) {
    size[axis] = SizeBetween(part.box.minimum[axis], part.box.maximum[axis]);
  }
  *message->mutable_size() = VectorToProto(size);
  for (v1::ProminentPlane& plane : *message->mutable_prominent_planes()) {
    for (const parametric::ProminentPlane& now : part.prominent_planes) {
      if (now.name == plane.name()) plane.set_position(now.position);
    }
  }
}

std::string AddOwnShape(const mesh::DrawnShape& shape, v1::AssemblyBundle* bundle) {
  v1::Shape message = parametric::ToProto(shape);
  message.set_name(parametric::NameOf(message));
  if (FindNamed(bundle->shapes(), message.name()) == nullptr) *bundle->add_shapes() = message;
  return message.name();
}

void KeepWhatIsUsed(v1::AssemblyBundle* bundle) {
  std::set<std::string> items, materials;
  for (const v1::AssemblyPart& part : bundle->assembly().parts()) items.insert(part.item());
  google::protobuf::RepeatedPtrField<v1::Item> used;
  for (v1::Item& item : *bundle->mutable_items()) {
    if (!items.contains(item.name())) continue;
    materials.insert(item.material());
    *used.Add() = std::move(item);
  }
  *bundle->mutable_items() = std::move(used);
  google::protobuf::RepeatedPtrField<v1::Material> of_items;
  for (v1::Material& material : *bundle->mutable_materials()) {
    if (materials.contains(material.name())) *of_items.Add() = std::move(material);
  }
  *bundle->mutable_materials() = std::move(of_items);
  const std::set<std::string> shapes_used = ShapesUsed(*bundle);
  google::protobuf::RepeatedPtrField<v1::Shape> shapes;
  for (v1::Shape& shape : *bundle->mutable_shapes()) {
    if (shapes_used.contains(shape.name())) *shapes.Add() = std::move(shape);
  }
  *bundle->mutable_shapes() = std::move(shapes);
  SortByName(*bundle->mutable_items());
  SortByName(*bundle->mutable_materials());
  SortByName(*bundle->mutable_shapes());
}

Drawing MakeDrawing(v1::AssemblyBundle bundle) {
  v1::Assembly& assembly = *bundle.mutable_assembly();
  resources::ClearTags(&assembly);
  assembly.clear_revision();
  assembly.clear_create_time();
  assembly.clear_digest();
  v1::AssemblyBundle content = bundle;
  content.clear_shapes();  // their names say what they are
  // When a catalog took them makes no other drawing: a script gives the same one everywhere.
  parametric::ClearRevisions(*content.mutable_items(), *content.mutable_materials());
  return {parametric::MessageDigest(content), std::move(bundle)};
}

absl::StatusOr<parametric::Assembly> ReadAssembly(const v1::AssemblyBundle& bundle) {
  std::vector<parametric::Item> items;
  for (const v1::Item& message : bundle.items()) {
    MORTISE_ASSIGN_OR_RETURN(parametric::Item item, parametric::FromProto(message));
    items.push_back(std::move(item));
  }
  MORTISE_ASSIGN_OR_RETURN(const parametric::ShapesByName shapes,
                           parametric::FromProto(bundle.shapes()));
  return parametric::FromProto(bundle.assembly(), items, shapes);
}

absl::StatusOr<Drawing> ReadDrawing(const v1::AssemblyBundle& bundle) {
  MORTISE_ASSIGN_OR_RETURN(const parametric::Assembly assembly, ReadAssembly(bundle));
  v1::AssemblyBundle apart = bundle;
  apart.mutable_assembly()->clear_parts();
  // Parts of the struct stand in the order of the message, the rows' one by one.
  std::size_t next = 0;
  for (const v1::AssemblyPart& message : bundle.assembly().parts()) {
    int count = 1;
    for (const v1::Repeat& repeat : message.repeat()) count *= repeat.count();
    for (int i = 0; i < count; ++i, ++next) {
      v1::AssemblyPart* const part = apart.mutable_assembly()->add_parts();
      *part = message;
      part->clear_repeat();
      part->set_name(assembly.parts[next].name);
      PutIntoBox(assembly.parts[next], part);
    }
  }
  return MakeDrawing(std::move(apart));
}

bool IsDrawnAs(const Drawing& drawing, const parametric::Assembly& assembly) {
  const absl::StatusOr<parametric::Assembly> read = ReadAssembly(drawing.bundle);
  if (!read.ok() || read->parts.size() != assembly.parts.size() ||
      read->joints.size() != assembly.joints.size()) {
    return false;
  }
  for (std::size_t i = 0; i < read->parts.size(); ++i) {
    const parametric::AssemblyPart &one = read->parts[i], &other = assembly.parts[i];
    if (one.name != other.name || one.group != other.group ||
        one.box.minimum != other.box.minimum || one.box.maximum != other.box.maximum ||
        !std::equal(one.prominent_planes.begin(), one.prominent_planes.end(),
                    other.prominent_planes.begin(), other.prominent_planes.end(),
                    [](const auto& a, const auto& b) {
                      return a.name == b.name && a.position == b.position;
                    })) {
      return false;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (one.limits[axis].minimum != other.limits[axis].minimum ||
          one.limits[axis].maximum != other.limits[axis].maximum) {
        return false;
      }
    }
  }
  return std::equal(read->joints.begin(), read->joints.end(), assembly.joints.begin(),
                    [](const parametric::Joint& a, const parametric::Joint& b) {
                      return a.name == b.name && a.group == b.group && a.center == b.center;
                    });
}

absl::Status CheckItems(const v1::AssemblyBundle& from, const v1::AssemblyBundle& to) {
  for (const v1::Item& item : from.items()) {
    const v1::Item* const present = FindNamed(to.items(), item.name());
    if (present == nullptr || AreAlike(*present, item)) continue;
    return PreconditionFailed(
        "ITEM_DIFFERS",
        absl::StrCat(item.name(), " is of another material, size or shape in revision ",
                     item.revision(), " than in revision ", present->revision(),
                     ": import what is of the earlier one again"),
        item.name());
  }
  return absl::OkStatus();
}

absl::Status CombineItems(const v1::AssemblyBundle& from, v1::AssemblyBundle* to) {
  MORTISE_RETURN_IF_ERROR(CheckItems(from, *to));
  for (const v1::Item& item : from.items()) {
    v1::Item* const present = FindNamed(to->mutable_items(), item.name());
    if (present == nullptr) {
      *to->add_items() = item;
    } else if (present->revision() < item.revision()) {
      *present = item;
    }
  }
  for (const v1::Material& material : from.materials()) {
    v1::Material* const present = FindNamed(to->mutable_materials(), material.name());
    if (present == nullptr) {
      *to->add_materials() = material;
    } else if (present->revision() < material.revision()) {
      *present = material;
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<Drawing> DrawAnew(const std::string& name, const parametric::Assembly& assembly,
                                 const std::vector<CopiedFrom>& parts,
                                 const std::vector<CopiedFrom>& joints) {
  NamesByDrawing names;
  v1::AssemblyBundle bundle;
  v1::Assembly& message = *bundle.mutable_assembly();
  message.set_name(name);
  AddGroups(assembly, &message);
  for (std::size_t i = 0; i < assembly.parts.size(); ++i) {
    MORTISE_RETURN_IF_ERROR(AddPart(assembly, i, parts[i], names, &bundle));
  }
  for (std::size_t i = 0; i < assembly.joints.size(); ++i) {
    const parametric::Joint& joint = assembly.joints[i];
    MORTISE_ASSIGN_OR_RETURN(const v1::Joint* const source,
                             CopyOf(joints[i], names.Of(*joints[i].drawing).joints));
    v1::Joint* const added = message.add_joints();
    *added = *source;
    added->set_name(joint.name);
    added->set_group(GroupName(assembly, joint.group));
    *added->mutable_center() = VectorToProto(joint.center);
  }
  for (const Drawing* const drawing : names.drawings()) {
    MORTISE_RETURN_IF_ERROR(CombineItems(drawing->bundle, &bundle));
  }
  KeepWhatIsUsed(&bundle);
  return MakeDrawing(std::move(bundle));
}

}  // namespace mortise::composer
