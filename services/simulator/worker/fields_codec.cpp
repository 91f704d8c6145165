#include "services/simulator/worker/fields_codec.h"

#include <algorithm>
#include <cstdint>

namespace mortise::simulator {

FieldsDemand ReadDemand(const v1::DesignFieldsRequest& request) {
  FieldsDemand demand;
  demand.tetrahedra = request.geometry() == v1::TETRAHEDRA;
  demand.fields = {request.fields().begin(), request.fields().end()};
  demand.regions = {request.regions().begin(), request.regions().end()};
  demand.modes = std::max(1, request.modes());
  return demand;
}

fields::WriteOptions ReadWriteOptions(const v1::DesignFieldsRequest& request) {
  fields::WriteOptions options;
  options.position_step = request.position_step();
  options.single_precision = request.single_precision();
  return options;
}

v1::DesignFields Describe(const fields::DesignFields& design, const std::string& sha256,
                          std::size_t size) {
  v1::DesignFields message;
  message.set_sha256(sha256);
  message.set_size(static_cast<std::int64_t>(size));
  message.set_geometry(design.tetrahedra.cols() > 0 ? v1::TETRAHEDRA : v1::SURFACE);
  message.set_nodes(design.nodes.cols());
  message.set_triangles(design.triangles.cols());
  message.set_tetrahedra(design.tetrahedra.cols());
  for (const fields::Region& region : design.regions) message.add_regions(region.name);
  for (const fields::Field& field : design.fields) {
    if (std::count(message.fields().begin(), message.fields().end(), field.name) == 0) {
      message.add_fields(field.name);
    }
  }
  message.set_control_points(std::ssize(design.control_points));
  message.set_paths(std::ssize(design.paths) + std::ssize(design.ways));
  return message;
}

}  // namespace mortise::simulator
