// The connections of all assemblies that the catalog has templates of: what a component is
// connected by where its own design does not say how (thesis §5.6.1).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/base/single_flight_cache.h"
#include "common/rpc/channel.h"
#include "services/composer/catalog/origin_source.h"
#include "services/composer/connecting/connect.h"
#include "services/composer/connecting/part_connection.h"
#include "services/composer/records/model_drawings.h"

namespace mortise::composer {

// An assembly with its connections, and a template of it.
struct ConnectionOrigin {
  std::shared_ptr<const Drawing> drawing;
  std::shared_ptr<const Connections> connections;
  std::string template_name = {};  // templates/{id}
  std::int64_t template_revision = 0;
};

// By the source that their connections name: the assembly, "assemblies/bookshelf", or of one that
// is turned "assemblies/bookshelf turned z".
using ConnectionOrigins = std::map<std::string, ConnectionOrigin>;

// Returns all connections of these assemblies, which they outlive.
std::vector<const CollectionConnection*> ConnectionsIn(const ConnectionOrigins& origins);

// Leaves out the assemblies that are made of other revisions of items than these, with other sizes:
// what is carried over from them would not fit.
void LeaveOutOtherItems(const v1::AssemblyBundle& items, ConnectionOrigins& origins);

// Returns those of the assemblies that have a connection, with connecting parts, of a part that is
// of a material of one drawing with a part of a material of the other: of no other assembly is
// anything taken to connect what they draw. An item without a material stands for itself.
ConnectionOrigins ThatMayHold(const ConnectionOrigins& origins, const Drawing& one,
                              const Drawing& other);

// Returns the material of each item, by name, of the assemblies and of the body of a model, whose
// own count.
std::map<std::string, std::string> MaterialsOf(const Drawing& body,
                                               const ConnectionOrigins& origins);

// Returns how a component is connected to the body of a model by connections of these assemblies:
// with the materials of MaterialsOf, and the kinds of items likewise.
ConnectOptions ConnectOptionsFor(const Drawing& body, const ConnectionOrigins& origins);

// Thread safe.
class CollectionConnections {
 public:
  // All outlive it. `capacity`: bytes of drawings that are kept with their connections.
  CollectionConnections(std::shared_ptr<grpc::Channel> catalog, OriginSource* origins,
                        ModelDrawings* drawings, std::size_t capacity = std::size_t{256} << 20);

  // The assemblies that the caller's templates are of now; each once, as the template that comes
  // last by name has it. What cannot be read, or was removed meanwhile, is left out. The first call
  // takes some 50 ms an assembly. UNAVAILABLE; CANCELLED once `is_given_up`.
  absl::StatusOr<ConnectionOrigins> All(const rpc::Origin& caller, const IsGivenUp& is_given_up);

  // The same assemblies turned by right angles, whose connections hold together what lies so. The
  // first call takes some 100 ms an assembly. Fails as ModelDrawings::Turned; CANCELLED.
  absl::StatusOr<ConnectionOrigins> Turned(const ConnectionOrigins& origins,
                                           const Eigen::Matrix3d& turn,
                                           const IsGivenUp& is_given_up);

 private:
  absl::StatusOr<ConnectionOrigin> Read(const std::string& name, std::int64_t revision,
                                        const rpc::Origin& caller);

  const std::shared_ptr<grpc::Channel> catalog_;
  OriginSource* const origins_;
  ModelDrawings* const drawings_;
  SingleFlightCache<ConnectionOrigin> kept_;    // by name and revision of the template
  SingleFlightCache<ConnectionOrigin> turned_;  // by digest of the drawing, and quarter turns
};

}  // namespace mortise::composer
