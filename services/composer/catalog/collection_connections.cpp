#include "services/composer/catalog/collection_connections.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/bundles/bundle_source.h"
#include "common/bundles/template_list.h"
#include "services/composer/model/quarter_turn.h"

namespace mortise::composer {
namespace {

// The kind of each item, by name; the body's own count.
std::map<std::string, parametric::ItemKind> KindsOf(const Drawing& body,
                                                    const ConnectionOrigins& origins) {
  std::map<std::string, parametric::ItemKind> kinds;
  const auto add = [&](const Drawing& drawing) {
    for (const v1::Item& item : drawing.bundle.items()) {
      if (item.kind() == v1::ITEM_KIND_UNSPECIFIED) continue;
      kinds[item.name()] = static_cast<parametric::ItemKind>(item.kind());
    }
  };
  for (const auto& [name, origin] : origins) add(*origin.drawing);
  add(body);
  return kinds;
}

// What an item can be exchanged for: any of its material.
const std::string& MaterialOrItem(const v1::Item& item) {
  return item.material().empty() ? item.name() : item.material();
}

std::set<std::string> MaterialsIn(const Drawing& drawing) {
  std::set<std::string> materials;
  for (const v1::Item& item : drawing.bundle.items()) materials.insert(MaterialOrItem(item));
  return materials;
}

// Whether two principals of the connection are of a material of each.
bool MayHold(const parametric::ElementConnection& connection,
             const std::map<std::string, std::string>& materials, const std::set<std::string>& one,
             const std::set<std::string>& other) {
  int of_one = 0, of_other = 0, of_either = 0;
  for (int i = 0; i < connection.principal_count(); ++i) {
    const std::string& item = connection.elements[static_cast<std::size_t>(i)].item;
    const auto known = materials.find(item);
    const std::string& material = known == materials.end() ? item : known->second;
    const bool is_of_one = one.contains(material), is_of_other = other.contains(material);
    of_one += is_of_one ? 1 : 0;
    of_other += is_of_other ? 1 : 0;
    of_either += is_of_one || is_of_other ? 1 : 0;
  }
  return !connection.connecting.empty() && of_one > 0 && of_other > 0 && of_either > 1;
}

}  // namespace

std::vector<const CollectionConnection*> ConnectionsIn(const ConnectionOrigins& origins) {
  std::vector<const CollectionConnection*> connections;
  for (const auto& [name, origin] : origins) {
    for (const CollectionConnection& each : *origin.connections) connections.push_back(&each);
  }
  return connections;
}

void LeaveOutOtherItems(const v1::AssemblyBundle& items, ConnectionOrigins& origins) {
  std::erase_if(origins, [&](const auto& origin) {
    return !CheckItems(origin.second.drawing->bundle, items).ok();
  });
}

ConnectionOrigins ThatMayHold(const ConnectionOrigins& origins, const Drawing& one,
                              const Drawing& other) {
  const std::set<std::string> of_one = MaterialsIn(one), of_other = MaterialsIn(other);
  ConnectionOrigins may_hold;
  for (const auto& [name, origin] : origins) {
    std::map<std::string, std::string> materials;
    for (const v1::Item& item : origin.drawing->bundle.items()) {
      materials[item.name()] = MaterialOrItem(item);
    }
    const bool may = std::ranges::any_of(*origin.connections, [&](const auto& each) {
      return MayHold(each.connection, materials, of_one, of_other);
    });
    if (may) may_hold.emplace(name, origin);
  }
  return may_hold;
}

std::map<std::string, std::string> MaterialsOf(const Drawing& body,
                                               const ConnectionOrigins& origins) {
  std::map<std::string, std::string> materials;
  const auto add = [&](const Drawing& drawing) {
    for (const v1::Item& item : drawing.bundle.items()) materials[item.name()] = item.material();
  };
  for (const auto& [name, origin] : origins) add(*origin.drawing);
  add(body);
  return materials;
}

ConnectOptions ConnectOptionsFor(const Drawing& body, const ConnectionOrigins& origins) {
  ConnectOptions options;
  options.material_of = [materials = MaterialsOf(body, origins)](const std::string& item) {
    const auto found = materials.find(item);
    return found == materials.end() ? std::string() : found->second;
  };
  options.item_kind_of = [kinds = KindsOf(body, origins)](const std::string& item) {
    const auto found = kinds.find(item);
    return found == kinds.end() ? std::nullopt : std::optional(found->second);
  };
  return options;
}

CollectionConnections::CollectionConnections(std::shared_ptr<grpc::Channel> catalog,
                                             OriginSource* origins, ModelDrawings* drawings,
                                             std::size_t capacity)
    : catalog_(std::move(catalog)),
      origins_(origins),
      drawings_(drawings),
      kept_(capacity),
      turned_(capacity) {}

absl::StatusOr<ConnectionOrigins> CollectionConnections::All(const rpc::Origin& caller,
                                                             const IsGivenUp& is_given_up) {
  v1::ListTemplatesRequest request;
  request.set_kind(v1::ListTemplatesRequest::ASSEMBLY);
  MORTISE_ASSIGN_OR_RETURN(const std::vector<v1::Template> templates,
                           bundles::ListTemplates(catalog_, std::move(request), caller));
  ConnectionOrigins all;
  for (const v1::Template& each : templates) {
    if (is_given_up()) return absl::CancelledError("nobody waits for the answer any more");
    absl::StatusOr<ConnectionOrigin> read = Read(each.name(), each.revision(), caller);
    if (bundles::IsPassingFailure(read.status())) return read.status();
    if (!read.ok()) {
      Log(LogLevel::kWarning, "connections of a template not read",
          {{"template", each.name()}, {"error", read.status().message()}});
      continue;
    }
    const std::string assembly = read->drawing->bundle.assembly().name();
    all.insert_or_assign(assembly, *std::move(read));
  }
  return all;
}

absl::StatusOr<ConnectionOrigins> CollectionConnections::Turned(const ConnectionOrigins& origins,
                                                                const Eigen::Matrix3d& turn,
                                                                const IsGivenUp& is_given_up) {
  using Made = SingleFlightCache<ConnectionOrigin>::Made;
  std::string how = turn.isIdentity(0) ? " as drawn" : " turned ";
  for (const Axis axis : QuarterTurnsOf(turn)) absl::StrAppend(&how, AxisName(axis));
  ConnectionOrigins all;
  for (const auto& [name, origin] : origins) {
    if (is_given_up()) return absl::CancelledError("nobody waits for the answer any more");
    const std::string source = absl::StrCat(name, how);
    const std::shared_ptr<const Drawing>& drawn = origin.drawing;
    MORTISE_ASSIGN_OR_RETURN(
        all[source], turned_.Get(absl::StrCat(drawn->digest, how), [&]() -> absl::StatusOr<Made> {
          ConnectionOrigin made;
          MORTISE_ASSIGN_OR_RETURN(made.drawing, drawings_->Turned(drawn, turn));
          MORTISE_ASSIGN_OR_RETURN(const auto connections, drawings_->ConnectionsIn(*made.drawing));
          auto named = std::make_shared<Connections>(*connections);
          for (CollectionConnection& each : *named) each.source = source;
          made.connections = std::move(named);
          const std::size_t bytes = made.drawing->bundle.SpaceUsedLong();
          return Made{std::move(made), bytes};
        }));
  }
  return all;
}

absl::StatusOr<ConnectionOrigin> CollectionConnections::Read(const std::string& name,
                                                             std::int64_t revision,
                                                             const rpc::Origin& caller) {
  using Made = SingleFlightCache<ConnectionOrigin>::Made;
  return kept_.Get(absl::StrCat(name, "/", revision), [&]() -> absl::StatusOr<Made> {
    MORTISE_ASSIGN_OR_RETURN(const ComponentOrigin origin, origins_->Get(name, revision, caller));
    ConnectionOrigin made{.drawing = origin.drawing,
                          .connections = nullptr,
                          .template_name = origin.template_name,
                          .template_revision = origin.revision};
    MORTISE_ASSIGN_OR_RETURN(made.connections, drawings_->ConnectionsIn(*origin.drawing));
    const std::size_t bytes = origin.drawing->bundle.SpaceUsedLong();
    return Made{std::move(made), bytes};
  });
}

}  // namespace mortise::composer
