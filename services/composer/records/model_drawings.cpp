#include "services/composer/records/model_drawings.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/codec/parametrization_codec.h"
#include "common/assembly/memory_use.h"
#include "common/base/errors.h"
#include "common/messages/vector_codec.h"
#include "common/resources/collection.h"
#include "services/composer/model/quarter_turn.h"
#include "services/composer/records/drawing_records.h"
#include "services/composer/records/turned_drawing.h"

namespace mortise::composer {
namespace {

// Messages are small beside what is made of them.
constexpr std::size_t kShareOfDrawings = 8;

// What a connection takes is mostly its elements and relationships.
std::size_t MemoryOf(const Connections& connections) {
  constexpr std::size_t kOfEach = 4096, kOfElement = 1024;  // bytes
  std::size_t bytes = sizeof(Connections);
  for (const CollectionConnection& each : connections) {
    bytes += kOfEach + kOfElement * each.connection.elements.size();
  }
  return bytes;
}

}  // namespace

ModelDrawings::ModelDrawings(store::Store* store, std::size_t capacity)
    : store_(store),
      drawings_(capacity / kShareOfDrawings),
      parametrised_(capacity),
      connections_(capacity / kShareOfDrawings) {}

absl::StatusOr<std::shared_ptr<const Drawing>> ModelDrawings::Get(const std::string& model,
                                                                  const std::string& digest) {
  using Made = SingleFlightCache<std::shared_ptr<const Drawing>>::Made;
  return drawings_.Get(digest, [&]() -> absl::StatusOr<Made> {
    MORTISE_ASSIGN_OR_RETURN(Drawing drawing, resources::ReadFrom<Drawing>(
                                                  *store_, [&](store::ReadTransaction& reading) {
                                                    return GetDrawing(reading, model, digest);
                                                  }));
    const std::size_t bytes = drawing.bundle.SpaceUsedLong();
    return Made{std::make_shared<const Drawing>(std::move(drawing)), bytes};
  });
}

absl::StatusOr<std::shared_ptr<const Drawing>> ModelDrawings::Turned(
    const std::shared_ptr<const Drawing>& drawing, const Eigen::Matrix3d& turn) {
  if (turn.isIdentity(0)) return drawing;
  std::string key = absl::StrCat(drawing->digest, "/");
  for (const Axis axis : QuarterTurnsOf(turn)) absl::StrAppend(&key, AxisName(axis));
  using Made = SingleFlightCache<std::shared_ptr<const Drawing>>::Made;
  return drawings_.Get(key, [&]() -> absl::StatusOr<Made> {
    MORTISE_ASSIGN_OR_RETURN(Drawing turned, TurnedDrawing(*drawing, turn));
    const std::size_t bytes = turned.bundle.SpaceUsedLong();
    return Made{std::make_shared<const Drawing>(std::move(turned)), bytes};
  });
}

absl::StatusOr<std::shared_ptr<const parametric::ParametricAssembly>> ModelDrawings::Parametrize(
    const Drawing& drawing, const std::string& group, const IsGivenUp& is_given_up,
    const std::vector<const parametric::ParametricAssembly*>& known) {
  using Made = SingleFlightCache<std::shared_ptr<const parametric::ParametricAssembly>>::Made;
  return parametrised_.Get(absl::StrCat(drawing.digest, "/", group), [&]() -> absl::StatusOr<Made> {
    MORTISE_ASSIGN_OR_RETURN(
        auto made, parametric::ParametrizeKnowing(known, drawing.bundle, is_given_up, group,
                                                  parametric::LoosePolicy::kHold));
    const std::size_t bytes = parametric::MemoryUse(*made);
    return Made{std::move(made), bytes};
  });
}

void ModelDrawings::Keep(const Drawing& drawing,
                         std::shared_ptr<const parametric::ParametricAssembly> parametrised) {
  using Made = SingleFlightCache<std::shared_ptr<const parametric::ParametricAssembly>>::Made;
  const std::size_t bytes = parametric::MemoryUse(*parametrised);
  // It is there before anybody asks for it; a failure to keep it only costs time.
  parametrised_
      .Get(absl::StrCat(drawing.digest, "/"),
           [&]() -> absl::StatusOr<Made> {
             return Made{parametrised, bytes};
           })
      .IgnoreError();
}

absl::StatusOr<std::shared_ptr<const Connections>> ModelDrawings::ConnectionsIn(
    const Drawing& drawing) {
  using Made = SingleFlightCache<std::shared_ptr<const Connections>>::Made;
  return connections_.Get(drawing.digest, [&]() -> absl::StatusOr<Made> {
    MORTISE_ASSIGN_OR_RETURN(const parametric::Assembly assembly, ReadAssembly(drawing.bundle));
    MORTISE_ASSIGN_OR_RETURN(Connections found,
                             ConnectionsOf(drawing.bundle.assembly().name(), assembly));
    const std::size_t bytes = MemoryOf(found);
    return Made{std::make_shared<const Connections>(std::move(found)), bytes};
  });
}

absl::StatusOr<Design> ModelDrawings::DesignOf(const std::string& model, const DesignState& state,
                                               const IsGivenUp& is_given_up) {
  MORTISE_ASSIGN_OR_RETURN(const auto drawing, Get(model, state.drawing()));
  Design design;
  MORTISE_ASSIGN_OR_RETURN(design.assembly, Parametrize(*drawing, state.group(), is_given_up));
  if (state.q_size() != design.assembly->drawn().size()) {
    return StorageFailed(model, "its parameters are not those of its drawing");
  }
  design.q = Eigen::Map<const Eigen::VectorXd>(state.q().data(), state.q_size());
  design.shift = VectorFromProto(state.shift());
  return design;
}

DesignState StateOf(const Design& design, const std::string& drawing, const std::string& group) {
  DesignState state;
  state.set_drawing(drawing);
  state.set_group(group);
  state.mutable_q()->Add(design.q.begin(), design.q.end());
  *state.mutable_shift() = VectorToProto(design.shift);
  return state;
}

}  // namespace mortise::composer
