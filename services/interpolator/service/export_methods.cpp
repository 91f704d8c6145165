#include "services/interpolator/service/export_methods.h"

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/interpolator/service/loaded_maps.h"
#include "services/interpolator/service/map_export.h"
#include "services/interpolator/service/map_queries.h"

namespace mortise::interpolator::methods {
namespace {

using Writer = rpc::StreamWriter<v1::MapExportPart>;

absl::Status CheckGeometry(const LoadedMap& map, const v1::ExportMapRequest& asked) {
  if (asked.geometry() == v1::GEOMETRY_KIND_UNSPECIFIED) {
    if (asked.fields().empty()) return absl::OkStatus();
    return InvalidField("fields", "lie on a geometry; ask for that, too");
  }
  return WithDetail(
      absl::FailedPreconditionError(absl::StrCat(map.record.name(), " has metrics alone")),
      {"MAP_WITHOUT_SHAPES", map.record.name()});
}

// What is sent of a map, one message after the other, each made when there is room for it.
class Export {
 public:
  Export(std::shared_ptr<const LoadedMap> map, std::size_t structure,
         const std::vector<int>& metrics)
      : map_(std::move(map)), trees_(CutTree(ExportTree(map_->structures[structure], metrics))) {}

  // Returns the next message; nothing after the last.
  std::optional<v1::MapExportPart> Next() {
    if (next_tree_ == trees_.size()) return std::nullopt;
    v1::MapExportPart part;
    *part.mutable_tree() = std::move(trees_[next_tree_++]);
    return part;
  }

 private:
  const std::shared_ptr<const LoadedMap> map_;
  std::vector<v1::MapTree> trees_;
  std::size_t next_tree_ = 0;
};

}  // namespace

absl::Status ExportMap(const Interpolator& interpolator, const rpc::Call&,
                       const v1::ExportMapRequest& asked, const std::shared_ptr<Writer>& writer) {
  MORTISE_ASSIGN_OR_RETURN(std::shared_ptr<const LoadedMap> map,
                           interpolator.loaded->Get(asked.name()));
  const int structures = static_cast<int>(map->structures.size());
  if (asked.structure() < 0 || asked.structure() >= structures) {
    return InvalidField("structure", absl::StrCat("is ", asked.structure(), "; the map has ",
                                                  structures, ", from 0"));
  }
  MORTISE_ASSIGN_OR_RETURN(const std::vector<int> metrics,
                           MetricColumns(map->record, asked.metrics()));
  MORTISE_RETURN_IF_ERROR(CheckGeometry(*map, asked));
  auto parts = std::make_shared<Export>(std::move(map), static_cast<std::size_t>(asked.structure()),
                                        metrics);
  // The writer keeps what it pulls from; this must not keep the writer.
  std::weak_ptr<Writer> weak = writer;
  writer->Pull([parts, weak]() -> absl::StatusOr<std::optional<v1::MapExportPart>> {
    std::optional<v1::MapExportPart> part = parts->Next();
    if (!part) {
      if (const std::shared_ptr<Writer> alive = weak.lock()) alive->Finish(absl::OkStatus());
    }
    return part;
  });
  return absl::OkStatus();
}

}  // namespace mortise::interpolator::methods
