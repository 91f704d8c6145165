#include "services/interpolator/service/map_shape.h"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/rpc/server_limits.h"
#include "services/interpolator/service/map_queries.h"
#include "services/interpolator/service/mesh_messages.h"
#include "services/interpolator/shapes/proportions.h"

namespace mortise::interpolator {
namespace {

using Field = v1::MapShapes::Field;

absl::Status Damaged(const v1::DesignMap& map, const std::string& why) {
  return WithDetail(
      absl::DataLossError(absl::StrCat("what is stored of ", map.name(), " cannot be used (", why,
                                       "); building the map again mends it")),
      {"MAP_DAMAGED", map.name()});
}

// The packed shapes that act at a place, with their weights.
struct ActingShapes {
  std::vector<std::shared_ptr<const PackedShape>> kept;  // as long as they are blended
  std::vector<WeightedShape> weighted;
};

absl::StatusOr<ActingShapes> LoadActing(const LoadedMap& map, LoadedShapes& shapes,
                                        const StoredMesh& mesh,
                                        const std::vector<maps::SampleWeight>& weights) {
  ActingShapes acting;
  for (const maps::SampleWeight& weight : weights) {
    const auto file = mesh.shapes.find(weight.sample);
    if (file == mesh.shapes.end()) return Damaged(map.record, "it lacks the shape of a sample");
    MORTISE_ASSIGN_OR_RETURN(auto shape, shapes.Shape(mesh.file, file->second));
    acting.weighted.push_back({shape.get(), weight.weight});
    acting.kept.push_back(std::move(shape));
  }
  return acting;
}

// Adds those of the map's fields that a canonical mesh has, and their numbers in it: structures may
// have different load cases.
void AddFields(const v1::DesignMap& map, const CanonicalMesh& canonical,
               const std::vector<int>& fields, std::vector<int>& there, std::vector<int>& numbers) {
  for (const int f : fields) {
    const Field& field = map.shapes().fields(f);
    const int number = canonical.FindField(field.name(), field.load_case());
    if (number < 0) continue;
    there.push_back(f);
    numbers.push_back(number);
  }
}

// Reads which fields are wanted, in the order of the map.
absl::StatusOr<std::vector<int>> ReadFields(
    const v1::DesignMap& map, const google::protobuf::RepeatedPtrField<std::string>& names,
    bool without_fields, v1::GeometryKind geometry) {
  if (without_fields && !names.empty()) {
    return InvalidField("without_fields", "must not be set where fields are named");
  }
  std::vector<int> chosen;
  if (without_fields) return chosen;
  const auto& fields = map.shapes().fields();
  for (int f = 0; f < fields.size() && names.empty(); ++f) {
    if (geometry == v1::TETRAHEDRA || !fields[f].of_elements()) chosen.push_back(f);
  }
  std::set<std::string> known;
  for (int i = 0; i < names.size(); ++i) {
    const std::string place = absl::StrCat("fields[", i, "]");
    if (!known.insert(names[i]).second) return InvalidField(place, "is given twice");
    const std::size_t before = chosen.size();
    for (int f = 0; f < fields.size(); ++f) {
      if (fields[f].name() != names[i]) continue;
      if (fields[f].of_elements() && geometry != v1::TETRAHEDRA) {
        return InvalidField(place, absl::StrCat("'", names[i],
                                                "' is of tetrahedra: it needs the geometry "
                                                "TETRAHEDRA"));
      }
      chosen.push_back(f);
    }
    if (chosen.size() > before) continue;
    return InvalidField(place, absl::StrCat("the map has no field '", names[i], "'"));
  }
  std::ranges::sort(chosen);
  return chosen;
}

absl::StatusOr<v1::GeometryKind> ReadGeometry(const v1::DesignMap& map, v1::GeometryKind asked) {
  if (!map.has_shapes()) {
    return PreconditionFailed("MAP_WITHOUT_SHAPES",
                              absl::StrCat(map.name(),
                                           " is of metrics alone: it was built without "
                                           "`shape`"),
                              map.name());
  }
  if (asked == v1::GEOMETRY_KIND_UNSPECIFIED) return v1::SURFACE;
  if (!v1::GeometryKind_IsValid(asked)) {
    return InvalidField("geometry", "must be SURFACE or TETRAHEDRA");
  }
  if (asked > map.shapes().geometry()) {
    return InvalidField("geometry", "the map has no tetrahedra; there is the SURFACE");
  }
  return asked;
}

// Returns whether the map has any values there.
bool SetMetrics(const LoadedMap& map, std::size_t structure, const Eigen::VectorXd& place,
                const std::vector<int>& columns, v1::MapShape& shape) {
  const maps::InterpolationMap& metrics = map.structures[structure];
  Eigen::VectorXd values(metrics.outputs()), errors(metrics.outputs());
  if (!metrics.EvaluateOne(place.data(), values.data(), errors.data(), nullptr)) return false;
  for (const int column : columns) {
    shape.add_metrics(map.record.metrics(column).name());
    shape.add_values(values[column]);
    shape.add_metric_errors(errors[column]);
  }
  return true;
}

// The element that a place lies in, in the order of RefinementTree::Elements, and which samples act
// there with which weights.
std::size_t ElementAt(const ServedShapes& shapes, const Eigen::VectorXd& place,
                      std::vector<maps::SampleWeight>& weights) {
  const auto node = static_cast<std::size_t>(shapes.weights.At(place.data(), weights));
  return static_cast<std::size_t>(shapes.order[node]);
}

void SetErrors(const StoredShapes& stored, int element, const std::vector<int>& fields,
               v1::MapShape& shape) {
  shape.set_error(stored.shape_errors[element]);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    shape.mutable_fields(static_cast<int>(i))->set_error(stored.field_errors(fields[i], element));
  }
}

void SetProportions(const BlendedShape& blended, const CanonicalMesh& canonical,
                    v1::MapShape& shape) {
  const Proportions proportions = ProportionsOf(blended, canonical);
  shape.set_surface_area(proportions.surface_area);
  if (!proportions.has_volume) return;
  shape.set_volume(proportions.volume);
  shape.mutable_centroid()->set_x(proportions.centroid.x());
  shape.mutable_centroid()->set_y(proportions.centroid.y());
  shape.mutable_centroid()->set_z(proportions.centroid.z());
}

}  // namespace

absl::StatusOr<std::optional<ShapePlace>> BlendAt(const LoadedMap& map, LoadedShapes& shapes,
                                                  std::size_t structure,
                                                  const Eigen::VectorXd& place, bool surface_only,
                                                  const std::vector<int>& fields,
                                                  BlendedShape& out) {
  const ServedShapes& of_structure = map.shapes[structure];
  std::vector<maps::SampleWeight> weights;
  const std::size_t element = ElementAt(of_structure, place, weights);
  ShapePlace there;
  there.element = static_cast<int>(element);
  there.mesh = of_structure.stored.element_meshes[element];
  const auto& cut_off = map.structures[structure].content().cut_off;
  if (there.mesh < 0 || cut_off[element] != 0) return std::nullopt;
  const StoredMesh& mesh = of_structure.stored.meshes[static_cast<std::size_t>(there.mesh)];
  MORTISE_ASSIGN_OR_RETURN(there.canonical, shapes.Mesh(mesh.file));
  BlendedParts parts{surface_only, {}};
  AddFields(map.record, *there.canonical, fields, there.fields, parts.fields);
  MORTISE_ASSIGN_OR_RETURN(const ActingShapes acting, LoadActing(map, shapes, mesh, weights));
  MORTISE_RETURN_IF_ERROR(Blend(acting.weighted, *there.canonical, parts, out));
  return there;
}

int MeshAt(const LoadedMap& map, std::size_t structure, const Eigen::VectorXd& place) {
  const ServedShapes& of_structure = map.shapes[structure];
  std::vector<maps::SampleWeight> weights;
  return of_structure.stored.element_meshes[ElementAt(of_structure, place, weights)];
}

bool HasMetricsAt(const LoadedMap& map, std::size_t structure, const Eigen::VectorXd& place) {
  std::vector<maps::SampleWeight> weights;
  const std::size_t element = ElementAt(map.shapes[structure], place, weights);
  return map.structures[structure].content().cut_off[element] == 0;
}

template <typename Request>
absl::StatusOr<ShapeDemand> ReadShapeDemand(const v1::DesignMap& map, const Request& asked) {
  ShapeDemand demand;
  MORTISE_ASSIGN_OR_RETURN(demand.geometry, ReadGeometry(map, asked.geometry()));
  MORTISE_ASSIGN_OR_RETURN(
      demand.fields, ReadFields(map, asked.fields(), asked.without_fields(), demand.geometry));
  MORTISE_ASSIGN_OR_RETURN(demand.metrics, MetricColumns(map, asked.metrics()));
  return demand;
}

template absl::StatusOr<ShapeDemand> ReadShapeDemand(const v1::DesignMap&,
                                                     const v1::EvaluateMapShapeRequest&);
template absl::StatusOr<ShapeDemand> ReadShapeDemand(const v1::DesignMap&,
                                                     const v1::FollowMapShapeRequest::Begin&);

absl::StatusOr<AnsweredShape> ShapeAt(const LoadedMap& map, LoadedShapes& shapes,
                                      const ShapeDemand& demand,
                                      const google::protobuf::RepeatedField<double>& point,
                                      BlendedShape& scratch) {
  MORTISE_ASSIGN_OR_RETURN(const MapPoints read, ReadPoint(map.record, point));
  const std::size_t structure = read.structures.front();
  const Eigen::VectorXd place = UnitPlaces(map.record, read.points);
  MORTISE_ASSIGN_OR_RETURN(const std::optional<ShapePlace> there,
                           BlendAt(map, shapes, structure, place, demand.geometry == v1::SURFACE,
                                   demand.fields, scratch));
  AnsweredShape answer;
  if (!SetMetrics(map, structure, place, demand.metrics, answer.shape)) {
    answer.shape.set_uncovered(true);
    return answer;
  }
  answer.shape.set_structure(static_cast<int>(structure));
  if (!there) {
    answer.shape.set_shapeless(true);
    return answer;
  }
  answer.canonical = there->canonical;
  answer.shape.set_mesh(there->mesh);
  SetShape(scratch, *there->canonical, answer.shape);
  SetErrors(map.shapes[structure].stored, there->element, there->fields, answer.shape);
  SetProportions(scratch, *there->canonical, answer.shape);
  return answer;
}

absl::Status CheckMessageSize(const v1::MapShape& shape) {
  const auto size = static_cast<double>(shape.ByteSizeLong());
  if (size <= rpc::kMaxMessageBytes) return absl::OkStatus();
  double fields = 0;
  for (const v1::MapFieldValues& field : shape.fields()) {
    fields += static_cast<double>(field.ByteSizeLong());
  }
  const bool is_of_fields = size - fields <= rpc::kMaxMessageBytes;
  return WithDetail(
      absl::ResourceExhaustedError(absl::StrCat(
          is_of_fields ? "fields" : "geometry", ": the answer would have ", size,
          " bytes, of at most ", rpc::kMaxMessageBytes, "; ",
          is_of_fields ? "ask for fewer fields" : "ask for the SURFACE, or by FollowMapShape")),
      {"TOO_LARGE", is_of_fields ? "fields" : "geometry"});
}

absl::StatusOr<v1::MapShape> EvaluateShape(const LoadedMap& map, LoadedShapes& shapes,
                                           const v1::EvaluateMapShapeRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(const ShapeDemand demand, ReadShapeDemand(map.record, asked));
  BlendedShape scratch;
  MORTISE_ASSIGN_OR_RETURN(AnsweredShape answer,
                           ShapeAt(map, shapes, demand, asked.point(), scratch));
  v1::MapShape& shape = answer.shape;
  const bool is_known = asked.has_known_structure() && asked.has_known_mesh() &&
                        asked.known_structure() == shape.structure() &&
                        asked.known_mesh() == shape.mesh();
  if (answer.canonical != nullptr && !is_known) {
    *shape.mutable_new_mesh() =
        std::move(MeshMessages(*answer.canonical, shape.structure(), shape.mesh(), demand.geometry,
                               std::numeric_limits<std::size_t>::max())
                      .front());
  }
  MORTISE_RETURN_IF_ERROR(CheckMessageSize(shape));
  return std::move(shape);
}

}  // namespace mortise::interpolator
